//! What sweeps and steps of Newton's method cost: how many sweeps one has the choice to make instead.

use crate::contact::ContactProblem;
use crate::linear::PaddedLu;

/// Operations on floating-point numbers in the time that is spent on a contact besides those on entries of `G`, in a sweep
/// and in a step of Newton's method.
const VISIT: f64 = 400.0;
const JET: f64 = 800.0;
/// The same per entry of `G`, of which a step takes several products.
const PRODUCT: f64 = 2.0;
const STEP: f64 = 8.0;
/// Sweeps in the time in which a pattern is analysed: between 10 and 40 on the stored problems of `auto.rs`.
const ANALYSIS: f64 = 20.0;
/// Steps that an attempt by Newton's method is expected to take. `Auto` takes 0.70, 0.71 and 0.77 times as long with 5, 6 and
/// 8 as without attempts on the stored problems of up to 400 contacts, and 0.66 and 0.68 times with 5 and 8 on 240 problems
/// of 4 to 100 contacts (scenes and random ones, laws of all dimensions), as geometric means.
const STEPS: f64 = 6.0;

/// Costs of a problem, or of one of its islands, in operations.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cost {
    rows: usize,
    sweep: f64,
    /// A step of Newton's method without its factorisation.
    step: f64,
}

impl Cost {
    /// Of some contacts that influence no others.
    pub(crate) fn of(problem: &ContactProblem, contacts: impl Iterator<Item = usize>) -> Self {
        let blocks = problem.delassus().blocks();
        let (mut count, mut rows, mut entries) = (0.0, 0, 0);
        for i in contacts {
            count += 1.0;
            rows += blocks.size(i);
            entries += blocks.row(i).map(|(_, block)| block.len()).sum::<usize>();
        }
        let entries = entries as f64;
        let (sweep, step) = (PRODUCT * entries + VISIT * count, STEP * entries + JET * count);
        Self { rows, sweep, step }
    }

    /// Sweeps in the time of an attempt with so many operations per factorisation; the pattern is analysed first where
    /// they are not known.
    pub(crate) fn attempt(&self, factorization: Option<f64>) -> f64 {
        let analysis = if factorization.is_some() { 0.0 } else { ANALYSIS };
        STEPS * (factorization.unwrap_or(0.0) + self.step) / self.sweep + analysis
    }

    /// The same where the matrix is factored whatever its pattern.
    pub(crate) fn dense_attempt(&self) -> f64 {
        self.attempt(Some(PaddedLu::operations(self.rows)))
    }
}

//! What sweeps and steps of Newton's method cost: how many sweeps one has the choice to make instead.

use crate::contact::ContactProblem;
use crate::solver::newton_matrix::NewtonMatrix;

/// Operations on floating-point numbers in the time that a sweep spends on a contact besides those on entries of `G`, and per
/// entry.
const VISIT: f64 = 400.0;
const PRODUCT: f64 = 2.0;
/// Contacts from which on an island is large: its data do not stay in the cache of the processor.
const LARGE: f64 = 1000.0;
/// Steps that an attempt by Newton's method is expected to take, and sweeps in the time of one without its factorisation.
const STEPS: f64 = 6.0;
const STEP: f64 = 3.0;

/// Costs of a problem, or of one of its islands, in operations.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cost {
    contacts: f64,
    rows: usize,
    sweep: f64,
}

impl Cost {
    /// Sweeps in the time in which a pattern is analysed: between 10 and 40.
    pub(crate) const ANALYSIS: f64 = 20.0;

    /// Of some contacts that influence no others.
    pub(crate) fn of(problem: &ContactProblem, contacts: impl Iterator<Item = usize>) -> Self {
        let blocks = problem.delassus().blocks();
        let (mut count, mut rows, mut entries) = (0.0, 0, 0);
        for i in contacts {
            count += 1.0;
            rows += blocks.size(i);
            entries += blocks.entries_of(i);
        }
        Self { contacts: count, rows, sweep: PRODUCT * entries as f64 + VISIT * count }
    }

    /// Whether sweeps wait for memory, and factorisations do not.
    pub(crate) fn is_large(&self) -> bool {
        self.contacts >= LARGE
    }

    /// Sweeps in the time of an attempt, as far as that is known before the pattern is analysed; its analysis counts, whether
    /// one was made before or not.
    pub(crate) fn first_estimate(&self) -> f64 {
        match NewtonMatrix::known_operations(self.rows) {
            Some(operations) => self.attempt(operations),
            None => self.attempt(0.0) + Self::ANALYSIS,
        }
    }

    /// Sweeps in the time of an attempt with so many operations per factorisation.
    pub(crate) fn attempt(&self, factorization: f64) -> f64 {
        STEPS * (self.sweeps(factorization) + STEP)
    }

    /// Sweeps with as many operations.
    pub(crate) fn sweeps(&self, operations: f64) -> f64 {
        operations / self.sweep
    }
}

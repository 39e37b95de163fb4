//! Friction that depends on the speed, within a step.
//!
//! A factor `f` of the friction force, taken at the speed at the beginning of the step, makes the law
//! `−P ∈ f C(P_N)`. In `P̃ = P/f` it is the law without a factor again, and `G P = G F P̃` with the factors on
//! the diagonal of `F`: the columns of the Delassus operator are scaled and no solver needs to know.

use asperity_set::Vector;
use nalgebra::DMatrix;

use crate::contact::{ContactProblem, Delassus};

/// Factors below this one count as it.
const SMALLEST: f64 = 1e-12;

/// The factors of all rows of a contact problem.
#[derive(Debug, Default)]
pub(super) struct Factors {
    rows: Vec<f64>,
    /// The dense Delassus operator without factors.
    plain: DMatrix<f64>,
    /// Whether some law depends on the speed.
    any: bool,
}

impl Factors {
    /// Forgets the factors: the problem has new contacts.
    pub(super) fn reset(&mut self, problem: &ContactProblem) {
        self.any = problem.contacts.iter().any(|contact| contact.law.rate().is_some());
        self.rows.clear();
        self.rows.resize(problem.rows(), 1.0);
        if let (true, Delassus::Dense(delassus)) = (self.any, &problem.delassus) {
            self.plain = delassus.clone();
        }
    }

    /// Whether some law depends on the speed.
    #[inline]
    pub(super) fn any(&self) -> bool {
        self.any
    }

    /// Remembers a dense operator that has just been filled in.
    pub(super) fn keep(&mut self, problem: &ContactProblem) {
        if let (true, Delassus::Dense(delassus)) = (self.any, &problem.delassus) {
            self.plain.copy_from(delassus);
        }
    }

    /// Takes the factors for relative velocities `slip(row)`.
    pub(super) fn update(&mut self, problem: &ContactProblem, slip: impl Fn(usize) -> f64) {
        for contact in &problem.contacts {
            let Some(rate) = contact.law.rate() else { continue };
            let own = contact.tangent()..contact.offset + contact.len();
            let mut velocity = Vector::<3>::zeros();
            for (value, row) in velocity.iter_mut().zip(own.clone()) {
                *value = slip(row);
            }
            // Without any friction the contact would have no operator.
            self.rows[own].fill(rate.factor(velocity.norm()).max(SMALLEST));
        }
    }

    /// Scales the columns of a dense operator.
    pub(super) fn apply(&self, problem: &mut ContactProblem) {
        let Delassus::Dense(delassus) = &mut problem.delassus else { return };
        for (column, factor) in self.rows.iter().enumerate() {
            let plain = self.plain.column(column);
            for (scaled, entry) in delassus.column_mut(column).iter_mut().zip(&plain) {
                *scaled = entry * factor;
            }
        }
        problem.update_rho();
    }

    /// The factor of a row, one for rows without.
    #[inline]
    pub(super) fn of(&self, row: usize) -> f64 {
        self.rows[row]
    }
}

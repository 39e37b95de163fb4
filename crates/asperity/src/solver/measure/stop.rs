//! When a solver stops.

use std::time::Instant;

use super::natural_map::natural_map;
use super::natural_residual::{Residual, natural_residual};
use crate::contact::ContactProblem;

/// What decides whether a problem is solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// [`natural_residual`](crate::solver::natural_residual): the largest relative defect of a contact.
    Contact,
    /// [`natural_map`](crate::solver::natural_map): the defect of all contacts together.
    Global,
}

/// When a solver stops.
#[derive(Clone, Copy)]
pub struct Stop<'a> {
    /// Largest residual that counts as solved.
    pub tolerance: f64,
    /// Which residual.
    pub measure: Measure,
    /// Wall clock limit.
    pub deadline: Option<Instant>,
    /// Asked between sweeps; the solver gives up when it answers yes.
    pub cancelled: Option<&'a dyn Fn() -> bool>,
}

impl Stop<'_> {
    /// Stops at the tolerance only.
    pub fn at(tolerance: f64) -> Self {
        Self { tolerance, measure: Measure::Contact, deadline: None, cancelled: None }
    }

    /// The residual that decides.
    pub(crate) fn residual(
        &self,
        problem: &ContactProblem,
        percussion: &[f64],
        velocity: &[f64],
    ) -> Residual {
        let contact = natural_residual(problem, percussion, velocity);
        match self.measure {
            Measure::Contact => contact,
            Measure::Global => {
                let value = natural_map(problem, percussion, velocity);
                Residual { value, ..contact }
            }
        }
    }

    /// Whether to give up before the tolerance is reached.
    pub(crate) fn early(&self) -> bool {
        self.deadline.is_some_and(|deadline| Instant::now() >= deadline)
            || self.cancelled.is_some_and(|cancelled| cancelled())
    }
}

//! When a solver stops.

use std::time::Instant;

use super::natural_map;
use super::natural_residual::{self, Measured, Residual};
use crate::contact::ContactProblem;

/// Natural map of one contact, in tolerances, up to which the measure of contacts is looked at, which takes longer to find.
const NEAR: f64 = 500.0;

/// What decides whether a problem is solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Measure {
    /// [`natural_residual`](crate::solver::natural_residual): the largest relative defect of a contact.
    Contact,
    /// [`natural_map`](crate::solver::natural_map): the defect of all contacts together.
    Global,
}

/// When a solver stops.
///
/// ```
/// use std::time::{Duration, Instant};
///
/// use asperity::solver::{Measure, Stop};
///
/// let soon = Instant::now() + Duration::from_secs(1);
/// let stop = Stop::at(1e-8).with_measure(Measure::Global).with_deadline(soon);
/// assert_eq!(stop.tolerance, 1e-8);
/// assert_eq!(Stop::default().tolerance, 1e-10);
/// ```
#[derive(Clone, Copy)]
#[non_exhaustive]
pub struct Stop<'a> {
    /// Largest residual that counts as solved.
    pub tolerance: f64,
    /// Which residual.
    pub measure: Measure,
    /// Wall clock limit.
    pub deadline: Option<Instant>,
    /// Asked between sweeps, after the first one and then as soon as some hundred contacts were visited, with laws that are not
    /// isotropic after every one, and on the way through factorisations; the solver gives up when it answers yes.
    pub cancelled: Option<&'a dyn Fn() -> bool>,
}

impl<'a> Stop<'a> {
    /// Stops at the tolerance only, by the largest relative defect of a contact.
    pub fn at(tolerance: f64) -> Self {
        Self { tolerance, measure: Measure::Contact, deadline: None, cancelled: None }
    }

    /// The same by another measure.
    #[must_use]
    pub fn with_measure(self, measure: Measure) -> Self {
        Self { measure, ..self }
    }

    /// The same, but not later than at a time.
    #[must_use]
    pub fn with_deadline(self, deadline: Instant) -> Self {
        Self { deadline: Some(deadline), ..self }
    }

    /// The same, unless `cancelled` says that nobody waits any longer: it is asked again and again, and should be quick
    /// to answer. In one solve it is not asked any more once it has answered yes.
    #[must_use]
    pub fn unless(self, cancelled: &'a dyn Fn() -> bool) -> Self {
        Self { cancelled: Some(cancelled), ..self }
    }

    /// The residual that decides.
    pub(crate) fn residual(
        &self,
        problem: &ContactProblem,
        percussion: &[f64],
        velocity: &[f64],
    ) -> Residual {
        let measured = Measured { problem, percussion, velocity };
        self.decisive(&measured, || natural_map::map(&measured))
    }

    /// The same where the natural map is known.
    pub(crate) fn residual_with_map(
        &self,
        problem: &ContactProblem,
        percussion: &[f64],
        velocity: &[f64],
        map: f64,
    ) -> Residual {
        self.decisive(&Measured { problem, percussion, velocity }, || map)
    }

    /// The same of contacts that influence no others, as if there were only these.
    pub(crate) fn residual_of(&self, measured: &Measured<'_>, contacts: &[usize]) -> Residual {
        let contact = natural_residual::residual_of(measured, contacts.iter().copied());
        match self.measure {
            Measure::Contact => contact,
            Measure::Global => {
                Residual { value: natural_map::map_of(measured, contacts).0, ..contact }
            }
        }
    }

    fn decisive(&self, measured: &Measured<'_>, map: impl FnOnce() -> f64) -> Residual {
        let contact = natural_residual::residual(measured);
        match self.measure {
            Measure::Contact => contact,
            Measure::Global => Residual { value: map(), ..contact },
        }
    }

    /// Whether the measure of so many contacts may be small where their natural map is `map`: it takes longer to find, and is
    /// not looked at where the other one is far off.
    #[inline]
    pub(crate) fn is_near(&self, map: f64, contacts: usize) -> bool {
        map <= NEAR * self.tolerance * (contacts as f64).sqrt()
    }

    /// Whether to give up before the tolerance is reached.
    pub(crate) fn early(&self) -> bool {
        self.deadline.is_some_and(|deadline| Instant::now() >= deadline)
            || self.cancelled.is_some_and(|cancelled| cancelled())
    }
}

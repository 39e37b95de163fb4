//! A step of Moreau's midpoint rule, and what systems that turn give for it.

use std::fmt::Debug;

use super::held::Held;
use super::{Configuration, SystemError};

/// A step of Moreau's midpoint rule, from the state before it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step<'a> {
    /// Time of its midpoint in s.
    pub midpoint: f64,
    /// Its length in s.
    pub dt: f64,
    /// Coordinates before it.
    pub q: &'a [f64],
    /// Velocities before it.
    pub u: &'a [f64],
}

/// A system at the midpoint of a step.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Midpoint {
    /// Time in s.
    pub t: f64,
    /// Coordinates `q_M`.
    pub q: Vec<f64>,
    /// What [`Turning::derive`] makes of them.
    pub derived: Vec<f64>,
    /// Velocities before the step, as they are expressed at the midpoint.
    pub before: Vec<f64>,
    /// Forces `h(t_M, q_M, u_B)` without those of the contacts.
    pub forces: Vec<f64>,
    /// What [`Turning::momenta`] carries from step to step.
    pub momenta: Vec<f64>,
    /// What joints or constraints hold.
    pub(crate) held: Vec<Held>,
}

impl Midpoint {
    /// Where the system is there.
    #[inline]
    pub fn configuration(&self) -> Configuration<'_> {
        Configuration { t: self.t, piece: self.t, q: &self.q, derived: &self.derived }
    }
}

/// What bodies that turn give besides a [`System`](super::System): attitudes, momenta that a step keeps, and the turning of
/// the directions of contacts in a step.
pub trait Turning: Debug + Sync {
    /// What follows from the coordinates and is asked for contact by contact, such as the attitudes of bodies. Every method
    /// that is given a [`Configuration`] must do without it, too.
    fn derive(&self, q: &[f64], derived: &mut Vec<f64>);

    /// What the rows of a contact change by in a step whose velocities do not: `correction` such that
    /// `W(q_M)ᵀũ + χ + correction` are its mean velocities from this midpoint to the next, which
    /// `q_M ⊕ Δt ũ` is. The velocities ũ are those with which the motion would go on as it was before the step, with
    /// its velocities; `rows` are those at the midpoint. Contacts that stay closed ask for it: without it they are
    /// of first order. Returns whether there is any.
    fn chord(
        &self,
        midpoint: &Midpoint,
        step: &Step<'_>,
        contact: usize,
        rows: &[f64],
        correction: &mut [f64],
    ) -> bool;

    /// The momenta that a motion carries from step to step, as they follow from coordinates and velocities.
    fn momenta(&self, q: &[f64], u: &[f64]) -> Vec<f64>;

    /// Whether these momenta belong to a state, but for rounding.
    fn has_momenta(&self, q: &[f64], u: &[f64], momenta: &[f64]) -> bool;

    /// Refuses coordinates that joints do not allow, and velocities that lead to such in a step.
    ///
    /// # Errors
    ///
    /// [`SystemError::Argument`] that names the joint.
    fn meets(&self, _q: &[f64], _u: &[f64], _dt: f64) -> Result<(), SystemError> {
        Ok(())
    }

    /// Changes the velocities `after` all other forces have acted by those of joints, so that they hold at the end of the
    /// step.
    ///
    /// # Errors
    ///
    /// Where no forces of joints do.
    fn hold(&self, _midpoint: &Midpoint, _after: &mut [f64], _dt: f64) -> Result<(), SystemError> {
        Ok(())
    }

    /// The first half of a step: `q_M = q ⊕ ½Δt u`, and the forces there.
    ///
    /// # Errors
    ///
    /// As [`System::forces`](super::System::forces).
    fn begin(&self, step: &Step<'_>, midpoint: &mut Midpoint) -> Result<(), SystemError>;

    /// The second half: `u` and `q = q_M ⊕ ½Δt u` from the velocities `after` all forces and percussions have acted.
    ///
    /// # Errors
    ///
    /// Where the system cannot be moved so far; `q`, `u` and the momenta must then be as before.
    fn finish(
        &self,
        midpoint: &mut Midpoint,
        after: &[f64],
        dt: f64,
        q: &mut [f64],
        u: &mut [f64],
    ) -> Result<(), SystemError>;
}

//! Moreau's midpoint rule for a system: half a step before the contact problem, half a step after it.

use std::fmt::Debug;

use super::constrained::{self, Constraints, Own};
use super::held::Held;
use super::{Configuration, System, SystemError};
use crate::vectors::copy;

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

/// What a system of bodies that turn gives besides a [`System`]: attitudes, momenta that a step keeps, and the turning of
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
    /// As [`System::forces`].
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

/// [`Turning::derive`], where there is anything to derive.
#[inline]
pub(crate) fn derive(system: &dyn System, q: &[f64], derived: &mut Vec<f64>) {
    if let Some(turning) = system.turning() {
        turning.derive(q, derived);
    }
}

/// [`Turning::momenta`], or none.
pub(crate) fn momenta(system: &dyn System, q: &[f64], u: &[f64]) -> Vec<f64> {
    system.turning().map_or_else(Vec::new, |turning| turning.momenta(q, u))
}

/// [`Turning::meets`], or the same for constraints of the system.
pub(crate) fn meets(system: &dyn System, q: &[f64], u: &[f64], dt: f64) -> Result<(), SystemError> {
    match system.turning() {
        Some(turning) => turning.meets(q, u, dt),
        None if system.constraints() > 0 => constrained::check(&Own(system), q, u, 0.5 * dt),
        None => Ok(()),
    }
}

/// [`Turning::hold`], or the same for constraints of the system.
pub(crate) fn hold(
    system: &dyn System,
    midpoint: &Midpoint,
    after: &mut [f64],
    dt: f64,
) -> Result<(), SystemError> {
    match system.turning() {
        Some(turning) => turning.hold(midpoint, after, dt),
        None => constrained::hold(&Own(system), midpoint, after, 0.5 * dt),
    }
}

/// [`Turning::begin`], or the same for velocities that are rates of coordinates.
#[inline]
pub(crate) fn begin(
    system: &dyn System,
    step: &Step<'_>,
    midpoint: &mut Midpoint,
) -> Result<(), SystemError> {
    if let Some(turning) = system.turning() {
        return turning.begin(step, midpoint);
    }
    let &Step { midpoint: t, dt, q, u } = step;
    midpoint.t = t;
    let Midpoint { q: at_midpoint, derived, before, forces, held, .. } = midpoint;
    system.advance(q, u, 0.5 * dt, at_midpoint);
    if system.constraints() > 0 {
        constrained::begin(&Own(system), step, at_midpoint, held)?;
    }
    copy(u, before);
    system.forces(&Configuration { t, piece: t, q: at_midpoint, derived }, u, forces)
}

/// [`Turning::finish`], or the same for velocities that are rates of coordinates.
#[inline]
pub(crate) fn finish(
    system: &dyn System,
    midpoint: &mut Midpoint,
    after: &[f64],
    dt: f64,
    q: &mut [f64],
    u: &mut [f64],
) -> Result<(), SystemError> {
    if let Some(turning) = system.turning() {
        return turning.finish(midpoint, after, dt, q, u);
    }
    if !midpoint.held.is_empty() {
        let [end, velocities, _] = Own(system).end(midpoint, after, 0.5 * dt)?;
        copy(&end, q);
        copy(&velocities, u);
        return Ok(());
    }
    copy(after, u);
    system.advance(&midpoint.q, u, 0.5 * dt, q);
    Ok(())
}

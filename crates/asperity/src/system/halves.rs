//! Moreau's midpoint rule for a system: half a step before the contact problem, half a step after it.

use super::constrained::{self, Constraints, Own};
use super::turning::{Midpoint, Step};
use super::{Configuration, System, SystemError};
use crate::vectors::copy;

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
        None if system.constraints() > 0 => {
            Own(system).check_rows(q)?;
            constrained::check(&Own(system), q, u, 0.5 * dt)
        }
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

//! What contacts do, told from percussions and velocities.

use super::natural_residual::Measured;
use crate::contact::{ContactState, NormalForce, Phase};

/// The states after a step in which contacts did what the percussions and velocities of an iteration say.
pub(crate) fn classify(measured: &Measured<'_>, states: &mut [ContactState]) {
    for (contact, state) in states.iter_mut().enumerate() {
        let (phase, slip) = phase_of(measured, contact);
        *state = state.after(phase, slip);
    }
}

/// Phase and slip velocity of a contact, by the switches of the natural map: percussions and velocities of an
/// iteration come with errors.
pub(crate) fn phase_of(measured: &Measured<'_>, contact: usize) -> (Phase, [f64; 3]) {
    let rho = measured.problem.rho(contact);
    let rows = &measured.problem.contacts()[contact];
    let friction = measured.friction(rows);
    let phase = phase(measured, contact, friction.normal, || rows.law.is_projected(friction, rho));
    (phase, measured.slip(rows))
}

/// The phase of a contact with its normal percussion, of which the law says whether it slips.
pub(super) fn phase(
    measured: &Measured<'_>,
    contact: usize,
    normal: f64,
    slips: impl FnOnce() -> bool,
) -> Phase {
    let rho = measured.problem.rho(contact);
    let rows = &measured.problem.contacts()[contact];
    // The switch of the natural map: an iteration leaves tiny percussions at contacts that open.
    let opens = rows.normal == NormalForce::Unilateral && normal <= rho * measured.xi(rows.offset);
    if normal <= 0.0 || opens {
        Phase::Open
    } else if slips() {
        Phase::Slip
    } else {
        Phase::Stick
    }
}

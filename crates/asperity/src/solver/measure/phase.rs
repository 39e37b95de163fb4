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
    // The switch of the natural map: an iteration leaves tiny percussions at contacts that open.
    let opens =
        rows.normal == NormalForce::Unilateral && friction.normal <= rho * measured.xi(rows.offset);
    let phase = if friction.normal <= 0.0 || opens {
        Phase::Open
    } else if rows.law.is_projected(friction, rho) {
        Phase::Slip
    } else {
        Phase::Stick
    };
    (phase, friction.slip)
}

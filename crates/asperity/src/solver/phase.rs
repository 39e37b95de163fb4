//! What contacts do, told from percussions and velocities.

use asperity_set::{StarSet, Vector};

use super::Workspace;
use crate::contact::{ContactProblem, NormalForce, Phase};
use crate::law::{FrictionLaw, Law};

/// Phases and slip directions of the percussions and velocities of an iteration.
pub(super) fn classify(problem: &ContactProblem, workspace: &mut Workspace) {
    let Workspace { percussion, velocity, states, .. } = workspace;
    for (contact, state) in states.iter_mut().enumerate() {
        let (phase, slip) = phase_of(problem, contact, percussion, velocity);
        *state = state.after(phase, slip);
    }
}

/// Phase and slip velocity of a contact, by the switches of the natural map: percussions and velocities of an
/// iteration come with errors.
pub(super) fn phase_of(
    problem: &ContactProblem,
    contact: usize,
    percussion: &[f64],
    velocity: &[f64],
) -> (Phase, [f64; 3]) {
    let rows = &problem.contacts()[contact];
    let normal = match rows.normal {
        NormalForce::Prescribed(value) => value,
        NormalForce::Unilateral => percussion[rows.offset],
    };
    let first = rows.tangent();
    let (rho, mut slip) = (problem.rho(contact), [0.0; 3]);
    for (component, row) in slip.iter_mut().zip(first..rows.offset + rows.len()) {
        *component = velocity[row] + problem.restitution()[row];
    }
    let tangent = &percussion[first..];
    let slips = match &rows.law {
        Law::One(law) => is_projected(law, (normal, rho), tangent, &slip),
        Law::Two(law) => is_projected(law, (normal, rho), tangent, &slip),
        Law::Three(law) => is_projected(law, (normal, rho), tangent, &slip),
    };
    // The switch of the natural map: an iteration leaves tiny percussions at contacts that open.
    let opens = rows.normal == NormalForce::Unilateral && {
        let xi = velocity[rows.offset] + problem.restitution()[rows.offset];
        normal <= problem.rho(contact) * xi
    };
    let phase = if normal <= 0.0 || opens {
        Phase::Open
    } else if slips {
        Phase::Slip
    } else {
        Phase::Stick
    };
    (phase, slip)
}

/// Whether the projection of the natural map has to do something: `α(x)(x + ρξ_T/P_N)` outside *D*.
fn is_projected<const P: usize>(
    law: &FrictionLaw<P>,
    (normal, rho): (f64, f64),
    tangent: &[f64],
    slip: &[f64; 3],
) -> bool {
    let x = Vector::<P>::from_fn(|i, _| -tangent[i] / normal);
    let moved = x + Vector::<P>::from_fn(|i, _| slip[i]) * (rho / normal);
    let alpha = if x.amax() == 0.0 { 1.0 } else { law.alpha(&x) };
    law.direction().gauge(&(moved * alpha)) > 1.0 + 1e-12
}

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

/// Phase and slip velocity of a contact, whose percussions and velocities come with errors of the size of
/// an iteration's tolerance.
pub(super) fn phase_of(
    problem: &ContactProblem,
    contact: usize,
    percussion: &[f64],
    velocity: &[f64],
) -> (Phase, [f64; 3]) {
    let rows = &problem.contacts[contact];
    let own = |i: usize| {
        let i = rows.normal_rows() + i;
        problem.delassus.own(contact, rows.offset, i, i)
    };
    let normal = match rows.normal {
        NormalForce::Prescribed(value) => value,
        NormalForce::Unilateral => percussion[rows.offset],
    };
    let first = rows.tangent();
    let gauge = match &rows.law {
        Law::One(law) => is_projected(law, normal, rho, own),
        Law::Two(law) => is_projected(law, normal, rho, own),
        Law::Three(law) => is_projected(law, normal, rho, own),
    };
    let mut slip = [0.0; 3];
    let (mut moving, mut reference) = (0.0_f64, 0.0_f64);
    for (i, component) in slip.iter_mut().enumerate().take(rows.law.dimension()) {
        *component = velocity[first + i] + problem.restitution[first + i];
        moving = moving.max(component.abs());
        reference = reference
            .max(problem.free_velocity[first + i].abs())
            .max((own(i) * percussion[first + i]).abs());
    }
    // The switch of the natural map: an iteration leaves tiny percussions at contacts that open.
    let opens = rows.normal == NormalForce::Unilateral && {
        let xi = velocity[rows.offset] + problem.restitution[rows.offset];
        normal <= problem.rho[contact] * xi
    };
    let phase = if normal <= 0.0 || opens {
        Phase::Open
    } else if gauge >= 1.0 - 1e-9 && moving > 1e-13 * reference {
        Phase::Slip
    } else {
        Phase::Stick
    };
    (phase, slip)
}

fn reservoir_gauge<const P: usize>(law: &FrictionLaw<P>, normal: f64, tangent: &[f64]) -> f64 {
    law.reservoir().gauge(&Vector::<P>::from_fn(|i, _| -tangent[i] / normal))
}

//! What closed contacts without slip do next: the contact problem on the level of accelerations.

use crate::contact::{ContactProblem, Phase};
use crate::integrator::event::contact_problem::problem::{Decision, Participants, Solved, Solving};
use crate::integrator::event::dynamics::{Dynamics, ROWS, SlidingForces};
use crate::integrator::event::state::{EvaluationError, State};
use crate::vectors::{add, largest, norm};

/// Slip acceleration over the load that counts as none.
const AT_REST: f64 = 1e-11;
/// The same of contacts that share the load on boundaries that are curved, of which it is known less well, see the polish
/// of their solution: at 1e-11, boxes that a growing force pulled began to slip too early, by 1.3e-8 of the time.
const AT_REST_SHARED: f64 = 1e-9;

/// Decides on the contacts that are undecided. Afterwards the dynamics hold the accelerations, the modes, and for
/// contacts that begin to slip γ̇ in place of γ.
pub(crate) fn decide(
    dynamics: &mut Dynamics<'_>,
    state: &State,
    solving: &Solving<'_, '_>,
) -> Result<Decision, EvaluationError> {
    // A slipping contact that the others lift opens, and all decide again.
    loop {
        dynamics.contacts.iter_mut().filter(|c| c.undecided).for_each(|c| c.mode = Phase::Open);
        dynamics.evaluate(state.t, &state.q, &state.u, SlidingForces::Updated)?;
        let n = dynamics.n;
        // The slipping contacts, whose normal forces change with those of the others.
        let slipping: Vec<usize> = dynamics.constrained_rows().iter().map(|r| r / ROWS).collect();
        let mut normal_forces = dynamics.constraint_forces().to_vec();
        let undecided =
            (0..dynamics.contacts.len()).filter(|&i| dynamics.contacts[i].undecided).collect();
        let (mut participants, mut answers) = Participants::constrained(dynamics, undecided);
        let immobile = participants.immobile(dynamics);
        if !immobile.is_empty() {
            participants.contacts.retain(|i| !immobile.contains(i));
            (participants, answers) = Participants::constrained(dynamics, participants.contacts);
        }
        let rate = |&row: &usize| dynamics.rate(row, &dynamics.acceleration);
        let load: Vec<f64> = participants.rows.iter().map(rate).collect();
        let problem = participants.problem(dynamics, &load, |contact| contact.prescribed)?;
        let solved = match participants.solve(&problem, solving) {
            Ok(solved) => solved,
            Err(outcome) => return Ok(Decision::Ended(outcome)),
        };
        for (k, force) in solved.found.percussion.iter().enumerate() {
            add(&mut dynamics.acceleration, *force, &participants.responses[k * n..][..n]);
            add(&mut normal_forces, *force, &answers[k * slipping.len()..][..slipping.len()]);
        }
        if let Some(lifted) = normal_forces.iter().position(|&force| force < 0.0) {
            dynamics.contacts[slipping[lifted]].mode = Phase::Open;
            continue;
        }
        for (&i, &force) in slipping.iter().zip(&normal_forces) {
            // The evaluation knew nothing of the contacts that have been decided on.
            let contact = &mut dynamics.contacts[i];
            (contact.normal_force, contact.force) = (force, contact.sliding.map(|f| f * force));
        }
        for &i in &immobile {
            let contact = &mut dynamics.contacts[i];
            (contact.mode, contact.undecided, contact.tolerated_excess) =
                (Phase::Stick, false, 0.0);
            (contact.force, contact.slip) = ([0.0; 3], [0.0; 3]);
            contact.normal_force = contact.prescribed.unwrap_or(0.0);
        }
        adopt(dynamics, &participants, &problem, &solved);
        stick_at_limit(dynamics, &participants, &problem, &solved.velocity);
        return Ok(Decision::Made { ambiguous: solved.ambiguous });
    }
}

/// Takes over modes, forces and slip accelerations of the contacts that have been decided on.
fn adopt(
    dynamics: &mut Dynamics<'_>,
    participants: &Participants,
    problem: &ContactProblem,
    Solved { found, velocity, .. }: &Solved,
) {
    for (k, (&i, rows)) in participants.contacts.iter().zip(problem.contacts()).enumerate() {
        let contact = &mut dynamics.contacts[i];
        (contact.mode, contact.undecided) = (found.states[k].phase, false);
        contact.tolerated_excess = 0.0;
        contact.normal_force = rows.normal_percussion(&found.percussion);
        for (r, row) in rows.tangential_rows().enumerate() {
            contact.force[r] = found.percussion[row];
            contact.slip[r] = velocity[row];
        }
        if contact.mode == Phase::Slip && contact.normal_force > 0.0 {
            contact.sliding = contact.force.map(|f| f / contact.normal_force);
            dynamics.contacts[i].resistance = dynamics.resistance(i);
        }
    }
}

/// Contacts that begin to slip or to open by rounding only stick: the others prevent it, the load is just what
/// friction can hold, or other contacts carry all of it.
fn stick_at_limit(
    dynamics: &mut Dynamics<'_>,
    participants: &Participants,
    problem: &ContactProblem,
    accelerations: &[f64],
) {
    let load = largest(problem.free_velocity());
    let curved = |&i: &usize| dynamics.contacts[i].p > 1;
    let shared = participants.contacts.len() > 1 && participants.contacts.iter().any(curved);
    let at_rest = if shared { AT_REST_SHARED } else { AT_REST };
    for (&i, rows) in participants.contacts.iter().zip(problem.contacts()) {
        let contact = &mut dynamics.contacts[i];
        let own = &accelerations[rows.offset..rows.offset + rows.len()];
        let rests = norm(own) <= at_rest * load;
        let may_stick = contact.mode == Phase::Slip || contact.prescribed.is_none();
        if rests && may_stick {
            contact.mode = Phase::Stick;
            contact.slip = [0.0; 3];
        }
    }
}

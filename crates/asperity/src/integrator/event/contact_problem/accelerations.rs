//! What closed contacts without slip do next: the contact problem on the level of accelerations.

use crate::contact::{ContactProblem, Phase};
use crate::integrator::event::contact_problem::problem::{
    Decision, Participants, Question, Solved, Solving,
};
use crate::integrator::event::dynamics::{ContactVariables, Dynamics, ROWS, SlidingForces};
use crate::integrator::event::outcome::{Outcome, Stagnation};
use crate::integrator::event::state::{EvaluationError, State};
use crate::vectors::{add, largest, norm};

/// Slip acceleration over the load that counts as none.
const AT_REST: f64 = 1e-11;
/// The same of contacts that share the load on boundaries that are curved, of which it is known less well, see the polish
/// of their solution: at 1e-11, boxes that a growing force pulled began to slip too early, by 1.3e-8 of the time.
const AT_REST_SHARED: f64 = 1e-9;

/// Closed contacts that the contact problem leaves out.
#[derive(Default)]
struct SetAside {
    /// Those that the slipping contacts hold in all their directions already.
    immobile: Vec<usize>,
    /// Those that would have to pull to have their share of the normal forces.
    unloaded: Vec<usize>,
}

/// Decides on the contacts that are undecided. Afterwards the dynamics hold the accelerations, the modes, and for
/// contacts that begin to slip γ̇ in place of γ.
///
/// Contacts that can share normal forces in many ways have the shares of equal compliance. What the contact problem finds
/// without this rule holds where it finds nothing with it.
pub(crate) fn decide(
    dynamics: &mut Dynamics<'_>,
    state: &State,
    question: Question,
    solving: &Solving<'_, '_>,
) -> Result<Decision, EvaluationError> {
    let asked = dynamics.contacts.clone();
    let closed = |contact: &&ContactVariables| !contact.is_free() && contact.prescribed.is_none();
    if asked.iter().filter(closed).count() > 1 {
        dynamics.undecided_share = true;
        let shared = decide_with_shares(dynamics, state, question, solving);
        dynamics.undecided_share = false;
        let decision = shared?;
        if !matches!(
            decision,
            Decision::Ended(Outcome::NoSolution { .. } | Outcome::Stagnated { .. })
        ) {
            return Ok(decision);
        }
        dynamics.contacts = asked;
    }
    decide_with_shares(dynamics, state, question, solving)
}

/// Decides with the shares that the dynamics find, if they look for them.
fn decide_with_shares(
    dynamics: &mut Dynamics<'_>,
    state: &State,
    question: Question,
    solving: &Solving<'_, '_>,
) -> Result<Decision, EvaluationError> {
    let mut aside = SetAside::default();
    let mut returned = 0;
    // A slipping contact that the others lift opens, one that the contact problem leaves out is set aside, and all decide
    // again.
    loop {
        dynamics.contacts.iter_mut().filter(|c| c.undecided).for_each(|c| c.mode = Phase::Open);
        dynamics.evaluate(state.t, &state.q, &state.u, SlidingForces::Updated)?;
        let n = dynamics.n;
        // The slipping contacts, whose normal forces change with those of the others.
        let slipping = dynamics.constrained_rows().to_vec();
        let mut normal_forces = dynamics.constraint_forces().to_vec();
        let undecided =
            (0..dynamics.contacts.len()).filter(|&i| dynamics.contacts[i].undecided).collect();
        let (participants, answers) = Participants::constrained(dynamics, undecided);
        let immobile = participants.immobile(dynamics);
        if !immobile.is_empty() {
            immobile.iter().for_each(|&i| dynamics.contacts[i].undecided = false);
            aside.immobile.extend(immobile);
            continue;
        }
        let load: Vec<f64> = {
            let shared = |row| dynamics.sharing.product(row, &slipping, &normal_forces);
            let rate = |&row: &usize| dynamics.rate(row, &dynamics.acceleration) + shared(row);
            participants.rows.iter().map(rate).collect()
        };
        let problem =
            participants.problem(dynamics, &load, question, |contact| contact.prescribed)?;
        let solved = match participants.solve(&problem, solving) {
            Ok(solved) => solved,
            Err(outcome) => return Ok(Decision::Ended(outcome)),
        };
        if let Some(i) = most_lifted(dynamics, &participants, &problem, &solved) {
            dynamics.contacts[i].undecided = false;
            aside.unloaded.push(i);
            continue;
        }
        for (k, force) in solved.found.percussion.iter().enumerate() {
            add(&mut dynamics.acceleration, *force, &participants.responses[k * n..][..n]);
            add(&mut normal_forces, *force, &answers[k * slipping.len()..][..slipping.len()]);
        }
        let smallest =
            (0..slipping.len()).min_by(|&a, &b| normal_forces[a].total_cmp(&normal_forces[b]));
        if let Some(lifted) = smallest.filter(|&k| normal_forces[k] < 0.0) {
            dynamics.contacts[slipping[lifted] / ROWS].mode = Phase::Open;
            continue;
        }
        let scale = largest(&load).max(dynamics.load);
        let approach = |&i: &usize| dynamics.rate(ROWS * i, &dynamics.acceleration);
        let closes = |i: &usize| approach(i) < -AT_REST_SHARED * scale;
        if let Some(k) = aside.unloaded.iter().position(closes) {
            let contact = aside.unloaded.swap_remove(k);
            returned += 1;
            if returned > dynamics.contacts.len() {
                let cause = Stagnation::Unsolved;
                return Ok(Decision::Ended(Outcome::Stagnated { cause, contact: Some(contact) }));
            }
            dynamics.contacts[contact].undecided = true;
            continue;
        }
        for (row, &force) in slipping.iter().zip(&normal_forces) {
            // The evaluation knew nothing of the contacts that have been decided on.
            let contact = &mut dynamics.contacts[row / ROWS];
            (contact.normal_force, contact.force) = (force, contact.sliding.map(|f| f * force));
        }
        for &i in &aside.immobile {
            let contact = &mut dynamics.contacts[i];
            (contact.mode, contact.tolerated_excess) = (Phase::Stick, 0.0);
            (contact.force, contact.slip) = ([0.0; 3], [0.0; 3]);
            contact.normal_force = contact.prescribed.unwrap_or(0.0);
        }
        for &i in &aside.unloaded {
            let rows = dynamics.rows_of(i);
            let rates = rows.map(|row| dynamics.rate(row, &dynamics.acceleration).abs());
            let rests = rates.fold(0.0, f64::max) <= AT_REST_SHARED * scale;
            let contact = &mut dynamics.contacts[i];
            contact.mode = if rests { Phase::Stick } else { Phase::Open };
            (contact.normal_force, contact.force, contact.slip) = (0.0, [0.0; 3], [0.0; 3]);
            contact.tolerated_excess = 0.0;
        }
        adopt(dynamics, &participants, &problem, &solved);
        stick_at_limit(dynamics, &participants, &problem, &solved.velocity);
        return Ok(Decision::Made { ambiguous: solved.ambiguous });
    }
}

/// The contact that opens fastest among those that share normal forces: its share would pull, and the others share
/// without it.
fn most_lifted(
    dynamics: &Dynamics<'_>,
    participants: &Participants,
    problem: &ContactProblem,
    solved: &Solved,
) -> Option<usize> {
    let shares = |k: &usize| dynamics.sharing.includes(participants.contacts[*k]);
    let opens = |k: &usize| solved.found.states[*k].phase == Phase::Open;
    let speed = |k: &usize| solved.velocity[problem.contacts()[*k].offset];
    let lifted = (0..participants.contacts.len()).filter(|k| shares(k) && opens(k));
    lifted.max_by(|a, b| speed(a).total_cmp(&speed(b))).map(|k| participants.contacts[k])
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

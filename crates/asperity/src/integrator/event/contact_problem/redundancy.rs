//! Closed contacts that can share their forces in many ways.

use crate::contact::Phase;
use crate::integrator::event::contact_problem::accelerations::decide;
use crate::integrator::event::contact_problem::problem::{Decision, Question, Solving};
use crate::integrator::event::dynamics::{ContactVariables, Dynamics, SlidingForces};
use crate::integrator::event::event_function::{contact_event_function, rounded_excess};
use crate::integrator::event::state::{EvaluationError, State};

/// Change of the acceleration, over the load, by shared forces at the end of stick, whose time is known to about 1e-8.
const AT_END_OF_STICK: f64 = 1e-6;

/// Evaluates the dynamics at the time of `solving`. Closed contacts whose shares they cannot carry one by one, though
/// together they can, are given parts that they can carry. The accelerations stay the same.
pub(crate) fn evaluate(
    dynamics: &mut Dynamics<'_>,
    q: &[f64],
    u: &[f64],
    sliding_forces: SlidingForces,
    solving: &Solving<'_, '_>,
) -> Result<(), EvaluationError> {
    let t = solving.t;
    dynamics.evaluate(t, q, u, sliding_forces)?;
    if !dynamics.is_indeterminate() {
        return Ok(());
    }
    // A contact that is just at its limit, though together all can go on, would be taken for an event.
    if is_overloaded(dynamics, -rounded_excess(dynamics)) {
        let state = State { t, q: q.to_vec(), u: u.to_vec() };
        if !redistribute(dynamics, &state, solving)? {
            dynamics.evaluate(t, q, u, sliding_forces)?;
        }
    }
    Ok(())
}

/// Gives the contacts at an event, the end of a stick that they share, parts that they can carry. There the load is just the
/// one that friction can hold, and the contact problem finds the slip that begins. Its forces are in the reservoirs and
/// balance, unless slip begins with another force: then the parts are those of `before`, if there are any and they could be
/// carried; otherwise they stay as they are. Modes and accelerations stay the same, and nothing is evaluated.
pub(crate) fn share_at_event(
    dynamics: &mut Dynamics<'_>,
    state: &State,
    before: &[ContactVariables],
    solving: &Solving<'_, '_>,
) -> Result<(), EvaluationError> {
    if !dynamics.is_indeterminate() || can_carry(dynamics) {
        return Ok(());
    }
    let (mut kept, acceleration) = (dynamics.contacts.clone(), dynamics.acceleration.clone());
    dynamics.leave_stick_undecided();
    let decision = decide(dynamics, state, Question::WhetherStickGoesOn, solving)?;
    let changes = dynamics.acceleration.iter().zip(&acceleration).map(|(a, b)| (a - b).abs());
    let balances = changes.fold(0.0, f64::max) <= AT_END_OF_STICK * dynamics.load;
    let found = matches!(decision, Decision::Made { .. }) && balances;
    if !found {
        dynamics.contacts = before.to_vec();
    }
    if found || can_carry(dynamics) {
        for (contact, share) in kept.iter_mut().zip(&dynamics.contacts) {
            if contact.mode != Phase::Open {
                (contact.force, contact.normal_force) = (share.force, share.normal_force);
            }
        }
    }
    (dynamics.contacts, dynamics.acceleration) = (kept, acceleration);
    Ok(())
}

/// Whether each closed contact can carry its force.
pub(crate) fn can_carry(dynamics: &Dynamics<'_>) -> bool {
    !is_overloaded(dynamics, rounded_excess(dynamics))
}

/// Whether the event function of a closed contact is beyond the limit.
fn is_overloaded(dynamics: &Dynamics<'_>, limit: f64) -> bool {
    let overloaded = |i: usize| {
        dynamics.contacts[i].mode != Phase::Open && contact_event_function(dynamics, i) > limit
    };
    (0..dynamics.contacts.len()).any(overloaded)
}

/// Whether all contacts can go on sticking and slipping; then takes the forces of the contact problem.
fn redistribute(
    dynamics: &mut Dynamics<'_>,
    state: &State,
    solving: &Solving<'_, '_>,
) -> Result<bool, EvaluationError> {
    let (kept, acceleration) = (dynamics.contacts.clone(), dynamics.acceleration.clone());
    dynamics.leave_stick_undecided();
    let decision = decide(dynamics, state, Question::WhetherStickGoesOn, solving)?;
    let goes_on = |(now, kept): (&ContactVariables, &ContactVariables)| {
        (now.mode, now.unloaded) == (kept.mode, kept.unloaded)
    };
    let all_go_on = matches!(decision, Decision::Made { .. })
        && dynamics.contacts.iter().zip(&kept).all(goes_on);
    for (contact, kept) in dynamics.contacts.iter_mut().zip(kept) {
        let (force, normal_force) = (contact.force, contact.normal_force);
        *contact = kept;
        if all_go_on && contact.mode != Phase::Open {
            (contact.force, contact.normal_force, contact.redistributed) =
                (force, normal_force, true);
        }
    }
    if all_go_on {
        // The constraints hold exactly there, in the contact problem to the accuracy of its solver only.
        dynamics.acceleration = acceleration;
        dynamics.find_unloaded_shares();
    }
    Ok(all_go_on)
}

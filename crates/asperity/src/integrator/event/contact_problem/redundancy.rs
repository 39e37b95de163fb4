//! Closed contacts that can share their forces in many ways.

use crate::contact::Phase;
use crate::integrator::event::contact_problem::accelerations::decide;
use crate::integrator::event::contact_problem::problem::{Decision, Question, Solving};
use crate::integrator::event::dynamics::{ContactVariables, Dynamics, SlidingForces};
use crate::integrator::event::event_function::{contact_event_function, rounded_excess};
use crate::integrator::event::state::{EvaluationError, State};

/// Evaluates the dynamics at the time of `solving`. Closed contacts that share their forces so that one could not carry
/// its part or would have to pull, though together they can, are given parts that they can carry. The accelerations stay
/// the same.
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
    let limit = -rounded_excess(dynamics);
    let overloaded = |i: usize| {
        dynamics.contacts[i].mode != Phase::Open && contact_event_function(dynamics, i) > limit
    };
    if (0..dynamics.contacts.len()).any(overloaded) {
        let state = State { t, q: q.to_vec(), u: u.to_vec() };
        if !redistribute(dynamics, &state, solving)? {
            dynamics.evaluate(t, q, u, sliding_forces)?;
        }
    }
    Ok(())
}

/// Asks the contact problem whether all sticking contacts can stick on and all slipping ones stay closed, and takes
/// its forces if they can; whether they can.
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

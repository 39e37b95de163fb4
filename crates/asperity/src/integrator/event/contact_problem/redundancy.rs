//! Forces of contacts that share them in many ways.

use crate::contact::{ContactState, Phase};
use crate::integrator::event::contact_problem::accelerations::{self, Decision};
use crate::integrator::event::dynamics::Field;
use crate::integrator::event::dynamics::contact_variables::{FieldError, State, Touch};
use crate::integrator::event::event_function::alarm;
use crate::integrator::event::integration::time_loop::Runner;
use crate::integrator::event::observer::Poll;

impl Runner<'_> {
    /// Evaluates the field. Closed contacts that share their forces so that one could not carry its part or would
    /// have to pull, though together they can, are given parts that they can carry: the accelerations stay the same.
    pub(crate) fn evaluate(
        &mut self,
        (t, q, u): (f64, &[f64], &[f64]),
        frozen: bool,
    ) -> Result<(), FieldError> {
        self.field.evaluate(t, q, u, frozen)?;
        let overloaded =
            |i: usize| self.field.touches[i].mode != Phase::Open && alarm(&self.field, i) > 0.0;
        if self.field.indeterminate() && (0..self.memory.len()).any(overloaded) {
            let state = State { t, q: q.to_vec(), u: u.to_vec() };
            if !share(&mut self.field, &state, &self.memory, &self.poll)? {
                self.field.evaluate(t, q, u, frozen)?;
            }
        }
        Ok(())
    }
}

/// Asks the contact problem whether all sticking contacts can stick on and all slipping ones stay closed; whether
/// they can.
fn share(
    field: &mut Field<'_>,
    state: &State,
    memory: &[ContactState],
    poll: &Poll<'_>,
) -> Result<bool, FieldError> {
    let (kept, acceleration) = (field.touches.clone(), field.acceleration.clone());
    for touch in &mut field.touches {
        touch.resting = touch.mode == Phase::Stick;
    }
    let decision = accelerations::decide(field, state, memory, poll)?;
    let goes_on = |(touch, kept): (&Touch, &Touch)| touch.mode == kept.mode;
    let sticks =
        matches!(decision, Decision::Made { .. }) && field.touches.iter().zip(&kept).all(goes_on);
    for (touch, kept) in field.touches.iter_mut().zip(kept) {
        let (force, normal_force) = (touch.force, touch.normal_force);
        *touch = kept;
        if sticks && touch.mode != Phase::Open {
            (touch.force, touch.normal_force, touch.shared) = (force, normal_force, true);
        }
    }
    if sticks {
        // The constraints hold exactly there, to the accuracy of the solver here.
        field.acceleration = acceleration;
    }
    Ok(sticks)
}

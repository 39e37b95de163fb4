//! Evaluation of the accelerations and contact forces in the present mode.

use crate::contact::Phase;
use crate::integrator::event::dynamics::contact_variables::ROWS;
use crate::integrator::event::dynamics::equations::Dynamics;
use crate::integrator::event::state::EvaluationError;
use crate::vectors::{add, largest};

/// What an evaluation does with the sliding forces for unit normal force.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SlidingForces {
    /// They follow the slip.
    Updated,
    /// They stay as they are, such as where a slip begins and its direction is known but no slip is there yet.
    Kept,
}

impl Dynamics<'_> {
    /// Accelerations and contact forces.
    pub(crate) fn evaluate(
        &mut self,
        t: f64,
        q: &[f64],
        u: &[f64],
        sliding_forces: SlidingForces,
    ) -> Result<(), EvaluationError> {
        let t = t.min(self.latest);
        self.kinematics(t, q, u)?;
        // Before the drift, for which the chart is placed elsewhere.
        let mut acceleration = std::mem::take(&mut self.acceleration);
        let evaluated = self.free_acceleration(t, u, &mut acceleration);
        self.acceleration = acceleration;
        evaluated?;
        if !self.constant {
            self.update_drift(t, q, u, |contact| !contact.is_free())?;
        }
        self.load = largest(&self.acceleration);
        if sliding_forces == SlidingForces::Updated {
            for i in 0..self.contacts.len() {
                if self.contacts[i].mode == Phase::Slip
                    && let Some(sliding) = self.law(i).sliding(&self.contacts[i].slip)
                {
                    self.contacts[i].sliding = sliding;
                }
            }
        }
        for &(i, z) in &self.direction_points {
            let slip = self.contacts[i].slip;
            if let Some(at) = self.law(i).at_point(&z, &slip) {
                self.contacts[i].sliding = at.sliding;
            }
        }
        self.add_prescribed_friction();
        self.add_constraint_forces();
        self.find_unloaded_shares();
        Ok(())
    }

    /// Friction forces of slipping contacts with given normal force.
    fn add_prescribed_friction(&mut self) {
        let n = self.n;
        for (i, contact) in self.contacts.iter_mut().enumerate() {
            (contact.force, contact.redistributed) = ([0.0; 3], false);
            contact.normal_force = contact.prescribed.unwrap_or(0.0);
            if let (Phase::Slip, Some(normal_force)) = (contact.mode, contact.prescribed) {
                for r in 0..contact.p {
                    contact.force[r] = normal_force * contact.sliding[r];
                    let column = &self.response[(ROWS * i + 1 + r) * n..][..n];
                    add(&mut self.acceleration, contact.force[r], column);
                    self.load = self.load.max(contact.force[r].abs() * largest(column));
                }
            }
        }
    }
}

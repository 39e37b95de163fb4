//! What rounding leaves in accelerations, gaps and velocities, beside what is known from the motion so far.
//!
//! Where nothing has moved yet, functions of time are all there is to compare errors with: the parts of which they are
//! made, whose small difference a load, a gap or a velocity may be.

use crate::argument::length;
use crate::integrator::event::dynamics::Dynamics;
use crate::integrator::event::dynamics::buffers::TimeParts;
use crate::integrator::event::dynamics::time_dependence::sampled;
use crate::integrator::event::resolution::{NOTHING, ROUNDED_OVERLAP, ROUNDING};
use crate::integrator::event::state::EvaluationError;
use crate::system::{SystemError, TimeDependence};
use crate::vectors::{largest, norm};

impl Dynamics<'_> {
    /// Asks for the parts of functions of time, as seen from the coordinates and velocities of the system at which the
    /// kinematics have been evaluated. They give contacts what gaps and slips are compared with at least.
    pub(crate) fn account_for_time(
        &mut self,
        q: &[f64],
        u: &[f64],
        t_end: f64,
    ) -> Result<(), EvaluationError> {
        if self.system.constancy().autonomous {
            return Ok(());
        }
        let known = self.system.time_dependence(q, t_end);
        let found = known.unwrap_or_else(|| sampled(self.system, q, u, t_end));
        let TimeDependence { mut forces, mut impulses, gaps, velocities } = found;
        let (n, contacts) = (self.n, self.contacts.len());
        for (sizes, count) in
            [(&forces, n), (&impulses, n), (&gaps, contacts), (&velocities, contacts)]
        {
            length("time_dependence", count, sizes.len()).map_err(SystemError::from)?;
        }
        if let Some(factor) = &self.factor {
            factor.solve(self.system, &mut forces);
            factor.solve(self.system, &mut impulses);
        }
        for (contact, (gap, velocity)) in self.contacts.iter_mut().zip(gaps.iter().zip(&velocities))
        {
            contact.reach = contact.reach.max(ROUNDING / NOTHING * gap);
            contact.speed = contact.speed.max(ROUNDING / NOTHING * velocity);
        }
        self.time_parts = TimeParts {
            load: largest(&forces),
            reach: largest(&impulses),
            velocity: largest(&velocities),
            velocities,
            depends_on_time: true,
        };
        Ok(())
    }

    /// The part of its friction force that rounding of a slip changes: where direction sets are thin, the force turns within
    /// the square of their ratio of axes, as an angle of the slip.
    pub(crate) fn rounding_turns(&self, i: usize) -> f64 {
        let contact = &self.contacts[i];
        let mut turns: f64 = 0.0;
        for r in 0..contact.p {
            for sign in [-1.0, 1.0] {
                let mut slip = contact.slip;
                slip[r] += sign * f64::EPSILON * contact.size;
                if let Some(there) = self.law(i).sliding(&slip) {
                    let change: [f64; 3] = std::array::from_fn(|k| there[k] - contact.sliding[k]);
                    turns = turns.max(norm(&change) / norm(&contact.sliding));
                }
            }
        }
        turns
    }

    /// The overlap of a contact that rounding explains.
    pub(crate) fn rounded_overlap(&self, i: usize) -> f64 {
        (ROUNDED_OVERLAP * self.contacts[i].reach).max(self.creep)
    }

    /// The largest acceleration of which the accelerations keep the rounding: the load, the parts of functions of time,
    /// and those of velocities of surfaces over the width of the stencil of which their rates are differences.
    pub(crate) fn rounded_load(&self) -> f64 {
        let mut load = self.load + self.time_parts.load;
        if self.constant {
            return load;
        }
        for (i, velocity) in self.time_parts.velocities.iter().enumerate() {
            if self.contacts[i].is_free() || *velocity == 0.0 {
                continue;
            }
            for row in self.rows_of(i) {
                let response = self.response(row);
                let per_rate = largest(response) / self.along(row, response);
                load = load.max(velocity / self.stencil.width * per_rate);
            }
        }
        load
    }
}

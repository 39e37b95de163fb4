//! The end of stick: which slip begins, and whether any does.

use crate::contact::{ContactState, Phase};
use crate::integrator::event::dynamics::{ROWS, SlidingForces};
use crate::integrator::event::event_function;
use crate::integrator::event::integration::decision::ONSET_SLIP;
use crate::integrator::event::integration::variables::{Ending, Integration};
use crate::integrator::event::state::EvaluationError;
use crate::vectors::{add, largest, norm};

/// Jump of the accelerations, over those that the force of the contact gives, below which stick goes over to slip
/// without a jump.
const CONTINUOUS: f64 = 1e-3;
/// How long after the end of stick the load is taken, over the length of the step, at first and at most. At the first
/// time the load is outside of the reservoir by more than rounding if it grows at an ordinary rate; at the last one
/// it is still that of this step.
const FIRST_TRIAL: f64 = 1e-7;
const LAST_TRIAL: f64 = 0.1;

impl Integration<'_> {
    /// A sticking contact cannot go on sticking. What it does is decided a little later, with a load that it cannot
    /// carry.
    pub(crate) fn release(&mut self, i: usize) -> Ending {
        let before = self.modes();
        let contact = self.dynamics.contacts[i];
        let stuck = self.a0.clone();
        let excess = event_function::excess(&self.dynamics, i);
        let rounding = event_function::rounded_excess(&self.dynamics);
        let length = self.step_size.h;
        let carried = self.carried_by(i);
        let direction = self.dynamics.law(i).normal(&contact.force);
        let kept = self.memory.clone();
        let mut ahead = self.state.clone();
        let mut later = FIRST_TRIAL * self.step.h;
        loop {
            ahead.extrapolate(&self.state, &stuck, later);
            self.memory.clone_from(&kept);
            self.memory[i] = ContactState::new(Phase::Slip, direction);
            for (contact, mode) in self.dynamics.contacts.iter_mut().zip(&before) {
                contact.mode = mode.unwrap_or_default();
                contact.undecided = contact.mode == Phase::Stick;
            }
            let (events, samples) = (self.motion.events.len(), self.motion.samples.len());
            self.step_size.h = length;
            let outcome = self.decide_modes_at(&ahead, &before)?;
            if outcome.is_some() {
                return Ok(outcome);
            }
            if self.motion.events.len() > events {
                break;
            }
            // The load is not yet outside of the reservoir by more than rounding.
            self.motion.samples.truncate(samples);
            later *= 10.0;
            if later > LAST_TRIAL * self.step.h {
                // The contact can go on sticking: its force has been outside of the reservoir by rounding only.
                (self.a0, self.memory) = (stuck, kept);
                let contact = &mut self.dynamics.contacts[i];
                let shorter = if excess <= rounding { self.step.h } else { 0.25 * self.step.h };
                contact.tolerated_excess += (2.0 * excess).clamp(1e-3 * rounding, rounding);
                return Ok(self.reject(shorter));
            }
        }
        // Contacts may share their forces in another way than before though no acceleration jumps.
        let change: Vec<f64> = self.a0.iter().zip(&stuck).map(|(a, b)| a - b).collect();
        let contact = &self.dynamics.contacts[i];
        if contact.mode == Phase::Slip && largest(&change) <= CONTINUOUS * carried {
            // γ = ½ γ̈ t².
            let growth = norm(&self.memory[i].slip) / later;
            let onset = (2.0 * ONSET_SLIP * contact.reference_speed() / growth).sqrt();
            self.step_size.h = length.max(onset);
            let share = self.share_at_onset(i, &change)?;
            self.a0 = stuck;
            add(&mut self.a0, share, &change);
            self.slope = Some(change.iter().map(|a| (1.0 - share) * a / later).collect());
        }
        Ok(None)
    }

    /// The share of a change of acceleration, from stick to a slip a little later, that is there at the onset already,
    /// as the time at which stick ends is known to rounding only. Without it the first step would begin with an
    /// acceleration that its stages contradict.
    fn share_at_onset(&mut self, i: usize, change: &[f64]) -> Result<f64, EvaluationError> {
        self.evaluate(SlidingForces::Kept)?;
        let (dynamics, direction) = (&self.dynamics, &self.memory[i].slip);
        let (mut present, mut whole) = (0.0, 0.0);
        for (r, slip) in direction[..dynamics.contacts[i].p].iter().enumerate() {
            let row = ROWS * i + 1 + r;
            present += slip * dynamics.rate(row, &dynamics.acceleration);
            whole += slip * dynamics.along(row, change);
        }
        let share = present / whole;
        // More than the whole change is none of the onset: the forces of the slip are shared in another way.
        Ok(if share.abs() < 1.0 { share } else { 0.0 })
    }

    /// The largest acceleration that the friction force of a contact gives.
    fn carried_by(&self, i: usize) -> f64 {
        let contact = &self.dynamics.contacts[i];
        let mut acceleration = vec![0.0; self.dynamics.n];
        for (r, force) in contact.force[..contact.p].iter().enumerate() {
            add(&mut acceleration, *force, self.dynamics.response(ROWS * i + 1 + r));
        }
        largest(&acceleration)
    }
}

//! The end of stick: which slip begins, and whether any does.

use crate::contact::{ContactState, Phase};
use crate::integrator::event::event_function;
use crate::integrator::event::integration::decision::ONSET_SLIP;
use crate::integrator::event::integration::variables::{Ending, Integration};
use crate::vectors::norm;

/// Difference of the sliding forces per normal force below which stick goes over to slip without a jump.
const CONTINUOUS: f64 = 1e-3;
/// Excess of a sticking force over the reservoir that may be rounding, relative to the largest normal force.
const AT_LIMIT: f64 = 1e-9;
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
        let pressing = self.dynamics.contacts.iter().map(|contact| contact.normal_force);
        let rounding = AT_LIMIT * pressing.fold(f64::MIN_POSITIVE, f64::max);
        let length = self.step_size.h;
        let sliding = contact.force.map(|f| f / contact.normal_force);
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
        let contact = &self.dynamics.contacts[i];
        let jump: [f64; 3] = std::array::from_fn(|r| contact.sliding[r] - sliding[r]);
        if contact.mode == Phase::Slip && norm(&jump) <= CONTINUOUS * norm(&sliding) {
            let rate = |(a, b): (&f64, &f64)| (a - b) / later;
            self.slope = Some(self.a0.iter().zip(&stuck).map(rate).collect());
            self.a0 = stuck;
            // γ = ½ γ̈ t².
            let growth = norm(&self.memory[i].slip) / later;
            let onset = (2.0 * ONSET_SLIP * contact.reference_speed() / growth).sqrt();
            self.step_size.h = length.max(onset);
        }
        Ok(None)
    }
}

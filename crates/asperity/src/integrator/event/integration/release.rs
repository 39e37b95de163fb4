//! The end of stick: which slip begins, and whether any does.

use crate::contact::{ContactState, Phase};
use crate::integrator::event::contact_problem::{Decision, Solving, accelerations};
use crate::integrator::event::dynamics::{ContactVariables, ROWS};
use crate::integrator::event::event_function;
use crate::integrator::event::integration::decision::ONSET_SLIP;
use crate::integrator::event::integration::variables::{Ending, Integration};
use crate::integrator::event::state::{EvaluationError, State};
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
            self.leave_undecided(&before);
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
            ahead.extrapolate(&self.state, &stuck, 2.0 * later);
            let at_onset = self.change_at_onset(&ahead, &before, &stuck, &change)?;
            let slope = change.iter().zip(&at_onset).map(|(later_on, now)| later_on - now);
            self.slope = Some(slope.map(|a| a / later).collect());
            self.a0 = stuck;
            add(&mut self.a0, 1.0, &at_onset);
        }
        Ok(None)
    }

    /// Contacts are in the modes that they were in, and those that stuck are undecided.
    fn leave_undecided(&mut self, before: &[Option<Phase>]) {
        for (contact, mode) in self.dynamics.contacts.iter_mut().zip(before) {
            contact.mode = mode.unwrap_or_default();
            contact.undecided = contact.mode == Phase::Stick;
        }
    }

    /// What a slip that begins has changed in the accelerations at its onset already, as the end of a stick that several
    /// contacts share is known to about 1e-8 of its time only: extrapolated from what it changes a little later, and at
    /// `ahead` twice as late. Without it the first step would begin with an acceleration that its stages contradict.
    fn change_at_onset(
        &mut self,
        ahead: &State,
        before: &[Option<Phase>],
        stuck: &[f64],
        change: &[f64],
    ) -> Result<Vec<f64>, EvaluationError> {
        let none = vec![0.0; stuck.len()];
        if before.iter().filter(|mode| **mode == Some(Phase::Stick)).count() < 2 {
            return Ok(none);
        }
        let decided = self.dynamics.contacts.clone();
        self.leave_undecided(before);
        let solving = Solving { memory: &self.memory, observer: &self.observer, t: ahead.t };
        let decision = accelerations::decide(&mut self.dynamics, ahead, &solving)?;
        let twice = self.dynamics.acceleration.clone();
        let modes = |contacts: &[ContactVariables]| -> Vec<Phase> {
            contacts.iter().map(|contact| contact.mode).collect()
        };
        let same = matches!(decision, Decision::Made { .. })
            && modes(&self.dynamics.contacts) == modes(&decided);
        self.dynamics.contacts = decided;
        self.stale = true;
        let later_on = change.iter().zip(&twice).zip(stuck);
        let at_onset: Vec<f64> = later_on.map(|((c, a), stuck)| 2.0 * c - (a - stuck)).collect();
        Ok(if same && largest(&at_onset) < largest(change) { at_onset } else { none })
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

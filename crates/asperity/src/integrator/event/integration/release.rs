//! The end of stick: which slip begins, and whether any does.

use crate::contact::{ContactState, Phase};
use crate::integrator::event::contact_problem::{Decision, Question, Solving, accelerations};
use crate::integrator::event::dynamics::{ContactVariables, ROWS};
use crate::integrator::event::event_function;
use crate::integrator::event::integration::decision::ONSET_SLIP;
use crate::integrator::event::integration::variables::{Ending, Integration};
use crate::integrator::event::state::{EvaluationError, State};
use crate::vectors::{add, largest, norm};

/// Jump of the accelerations, over those that the force of the contact gives, below which slip begins without a jump.
const CONTINUOUS: f64 = 1e-3;
/// First and last time after the end of stick at which the load is taken, over the length of the step: at the first the load
/// is outside of the reservoir by more than rounding, if it grows as usual, at the last it is still that of this step.
const FIRST_TRIAL: f64 = 1e-7;
const LAST_TRIAL: f64 = 0.1;
/// Jump of the accelerations over the load above which the end of a stick that contacts share is slip: below it, it may be
/// the error of the contact solver.
const RESOLVED: f64 = 1e-6;

impl Integration<'_> {
    /// Ends the stick of a contact. Its next mode is decided a little later, with a load that it cannot carry.
    pub(crate) fn release(&mut self, i: usize) -> Ending {
        let before = self.modes();
        let contact = self.dynamics.contacts[i];
        let stuck = self.a0.clone();
        let excess = event_function::excess(&self.dynamics, i);
        let rounding = event_function::rounded_excess(&self.dynamics);
        let length = self.step_size.h;
        let carried = self.carried();
        let shared = before.iter().filter(|mode| **mode == Some(Phase::Stick)).count() > 1;
        let direction = self.dynamics.law(i).normal(&contact.force);
        let (kept, contacts) = (self.memory.clone(), self.dynamics.contacts.clone());
        let mut ahead = self.state.clone();
        let mut later = FIRST_TRIAL * self.step.h;
        loop {
            ahead.extrapolate(&self.state, &stuck, later);
            self.memory.clone_from(&kept);
            self.memory[i] = ContactState::new(Phase::Slip, direction);
            self.dynamics.contacts.clone_from(&contacts);
            self.dynamics.leave_stick_undecided();
            let (events, samples) = (self.motion.events.len(), self.motion.samples.len());
            self.step_size.h = length;
            let outcome = self.decide_modes_at(&ahead, &before)?;
            if outcome.is_some() {
                return Ok(outcome);
            }
            let last = 10.0 * later > LAST_TRIAL * self.step.h;
            let changes = self.motion.events.len() > events;
            let unresolved =
                || largest(&difference(&self.a0, &stuck)) <= RESOLVED * self.dynamics.load;
            if changes && (last || !unresolved()) {
                break;
            }
            // The load is not yet outside of the reservoir by more than rounding.
            self.motion.samples.truncate(samples);
            self.motion.events.truncate(events);
            if last {
                // The contact can go on sticking: its force has been outside of the reservoir by rounding only.
                (self.a0, self.memory) = (stuck, kept);
                // With the excess tolerated before: it adds up until the contact problem finds that the load is not carried.
                self.dynamics.contacts.clone_from(&contacts);
                let contact = &mut self.dynamics.contacts[i];
                let shorter = if excess <= rounding { self.step.h } else { 0.25 * self.step.h };
                contact.tolerated_excess += (2.0 * excess).clamp(1e-3 * rounding, rounding);
                // The event is over: the next one is later.
                self.reset_event_functions(false);
                return Ok(self.reject(shorter));
            }
            later *= 10.0;
        }
        // Contacts may share their forces in another way than before though no acceleration jumps.
        let change = difference(&self.a0, &stuck);
        let continuous = largest(&change) <= CONTINUOUS * carried;
        if continuous {
            // γ = ½ γ̈ t².
            let begins = |&k: &usize| {
                self.dynamics.contacts[k].mode == Phase::Slip && before[k] == Some(Phase::Stick)
            };
            let onset = |k: usize| {
                let growth = norm(&self.memory[k].slip) / later;
                (2.0 * ONSET_SLIP * self.dynamics.contacts[k].reference_speed() / growth).sqrt()
            };
            let fastest = (0..before.len()).filter(begins).map(onset).reduce(f64::min);
            self.step_size.h = fastest.map_or(length, |onset| length.max(onset));
        }
        let at_onset = if shared {
            ahead.extrapolate(&self.state, &stuck, 2.0 * later);
            self.change_at_onset(&ahead, &contacts, &stuck, &change)?
        } else {
            None
        };
        if at_onset.is_some() || continuous {
            let at_onset = at_onset.unwrap_or_else(|| vec![0.0; stuck.len()]);
            let slope = difference(&change, &at_onset);
            self.slope = Some(slope.into_iter().map(|a| a / later).collect());
            self.a0 = stuck;
            add(&mut self.a0, 1.0, &at_onset);
        }
        Ok(None)
    }

    /// The jump of the accelerations at the end of a shared stick, whose time is known to about 1e-8: extrapolated from
    /// their changes a little later and, at `ahead`, twice as late, if the contacts do the same there. Accelerations that
    /// differ from those of the stages would make the first step fail.
    fn change_at_onset(
        &mut self,
        ahead: &State,
        contacts: &[ContactVariables],
        stuck: &[f64],
        change: &[f64],
    ) -> Result<Option<Vec<f64>>, EvaluationError> {
        let decided = self.dynamics.contacts.clone();
        self.dynamics.contacts.copy_from_slice(contacts);
        self.dynamics.leave_stick_undecided();
        let solving = Solving { memory: &self.memory, observer: self.observer, t: ahead.t };
        let decision =
            accelerations::decide(&mut self.dynamics, ahead, Question::WhatNext, &solving)?;
        let twice = difference(&self.dynamics.acceleration, stuck);
        let mut modes = self.dynamics.contacts.iter().zip(&decided);
        let same = matches!(decision, Decision::Made { .. })
            && modes
                .all(|(twice, once)| (twice.mode, twice.unloaded) == (once.mode, once.unloaded));
        self.dynamics.contacts = decided;
        self.stale = true;
        let at_onset: Vec<f64> = change.iter().zip(&twice).map(|(c, t)| 2.0 * c - t).collect();
        Ok((same && largest(&at_onset) <= 2.0 * largest(change)).then_some(at_onset))
    }

    /// The largest acceleration that the friction force of one of the sticking contacts gives.
    fn carried(&self) -> f64 {
        let mut carried: f64 = 0.0;
        for (i, contact) in self.dynamics.contacts.iter().enumerate() {
            if contact.mode == Phase::Stick {
                let mut acceleration = vec![0.0; self.dynamics.n];
                for (r, force) in contact.force[..contact.p].iter().enumerate() {
                    add(&mut acceleration, *force, self.dynamics.response(ROWS * i + 1 + r));
                }
                carried = carried.max(largest(&acceleration));
            }
        }
        carried
    }
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

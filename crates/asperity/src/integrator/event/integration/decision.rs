//! The modes of the contacts after an event, and the phase of the motion that begins with them.

use crate::contact::{ContactState, Phase};
use crate::integrator::event::contact_problem::{Decision, Question, Solving, accelerations};
use crate::integrator::event::dynamics::SlidingForces;
use crate::integrator::event::integration::variables::{Ending, Integration};
use crate::integrator::event::motion::EventKind;
use crate::integrator::event::outcome::Outcome;
use crate::integrator::event::state::{EvaluationError, State};
use crate::vectors::norm;

/// Slip over the speed of the contact that the first step of a slip has to reach: rounding must not decide on its direction.
pub(crate) const ONSET_SLIP: f64 = 1e-8;

impl Integration<'_> {
    /// A contact without approach slips, or sticks until it is decided on.
    pub(crate) fn close_contact(&mut self, i: usize) {
        let contact = &mut self.dynamics.contacts[i];
        contact.unloaded = false;
        if !contact.is_still() {
            contact.mode = Phase::Slip;
            self.memory[i] = ContactState::new(Phase::Slip, contact.slip);
        } else {
            contact.mode = Phase::Stick;
            self.memory[i] = ContactState::new(Phase::Stick, self.memory[i].slip);
        }
    }

    /// Decides on contacts without slip, while all others go on. Changes from the modes `before`, if any, are events.
    pub(crate) fn decide_modes(&mut self, before: &[Option<Phase>]) -> Ending {
        self.dynamics.project(&mut self.state)?;
        for contact in &mut self.dynamics.contacts {
            let may_slip = contact.mode == Phase::Slip || contact.unloaded;
            contact.undecided = contact.mode == Phase::Stick || (may_slip && contact.is_still());
        }
        let state = self.state.clone();
        let outcome = self.decide_modes_at(&state, before)?;
        if outcome.is_none() && !self.starting {
            // The constraints hold exactly here, in the contact problem to the accuracy of its solver only.
            self.evaluate(SlidingForces::Updated)?;
            self.a0.copy_from_slice(&self.dynamics.acceleration);
        }
        Ok(outcome)
    }

    /// Decides on the contacts that are undecided, with the loads of a state.
    pub(crate) fn decide_modes_at(&mut self, at: &State, before: &[Option<Phase>]) -> Ending {
        let contacts = &self.dynamics.contacts;
        let undecided: Vec<bool> = contacts.iter().map(|contact| contact.undecided).collect();
        let solving = Solving { memory: &self.memory, observer: self.observer, t: at.t };
        let ambiguous =
            match accelerations::decide(&mut self.dynamics, at, Question::WhatNext, &solving)? {
                Decision::Made { ambiguous } => ambiguous,
                Decision::Ended(outcome) => return Ok(Some(outcome)),
            };
        self.starting = false;
        let mut onset: f64 = 0.0;
        for i in 0..undecided.len() {
            let contact = &mut self.dynamics.contacts[i];
            let (mode, slip) = (contact.mode, contact.slip);
            if undecided[i] {
                let begins = mode == Phase::Slip;
                if begins {
                    self.starting = true;
                    onset = onset.max(ONSET_SLIP * contact.reference_speed() / norm(&slip));
                }
                let remembered = if begins { slip } else { self.memory[i].slip };
                self.memory[i] = ContactState::new(mode, remembered);
                contact.slip = [0.0; 3];
            } else if mode != self.memory[i].phase {
                // It has been given load, or has lost it.
                let slipping = if mode == Phase::Slip { slip } else { self.memory[i].slip };
                self.memory[i] = ContactState::new(mode, slipping);
            }
            if before[i].is_some_and(|before| before != mode) {
                let kind = match mode {
                    Phase::Stick => EventKind::Stick,
                    Phase::Slip => EventKind::Slip,
                    _ => EventKind::Open,
                };
                self.record_event(Some(i), kind, ambiguous && undecided[i]);
            }
        }
        let contacts = &self.dynamics.contacts;
        for event in self.motion.events.iter_mut().rev().take_while(|e| e.phase.is_none()) {
            event.phase = event.contact.map(|i| contacts[i].mode);
        }
        self.start_phase(onset)?;
        let too_many = self.motion.events.len() - self.uncounted >= self.options.max_events;
        Ok(too_many.then_some(Outcome::TooManyEvents))
    }

    /// The motion goes on in new modes, with steps of at least the length `onset`.
    fn start_phase(&mut self, onset: f64) -> Result<(), EvaluationError> {
        self.step_size.h = self.step_size.h.max(onset);
        self.a0.copy_from_slice(&self.dynamics.acceleration);
        self.keep_sliding();
        (self.slope, self.smooth, self.linearised) = (None, false, None);
        self.dynamics.smooth.together = None;
        self.step_size.forget_rates(&self.dynamics);
        self.dynamics.widen_stencil(&self.state)?;
        self.reset_event_functions(true);
        if self.options.sample.is_none() {
            self.record();
        }
        Ok(())
    }
}

//! Impacts, with and without collision, and what contacts do after velocities have jumped.

use crate::contact::{ContactState, Phase};
use crate::integrator::event::contact_problem::impacts::{self};
use crate::integrator::event::contact_problem::{Decision, ImpactLaw, Solving};
use crate::integrator::event::dynamics::{ContactVariables, ROWS, SlidingForces};
use crate::integrator::event::integration::variables::{Ending, Integration};
use crate::integrator::event::motion::EventKind;
use crate::integrator::event::outcome::{Outcome, Stagnation};
use crate::integrator::event::resolution::{NOTHING, ROUNDED, shortest_step};
use crate::integrator::event::state::{EvaluationError, State};

/// Whether a unilateral contact touches without being closed, or with it.
pub(crate) fn touches(contact: &ContactVariables) -> bool {
    contact.prescribed.is_none() && contact.gap <= NOTHING * contact.reach
}

impl Integration<'_> {
    /// A gap has closed.
    pub(crate) fn collide(&mut self, contact: usize) -> Ending {
        let mut before = self.modes();
        let still = self.zero_velocity();
        // One that closes though it leaves, in a bounce that is not told from its overlap, does so with all that are like it.
        let bounces = self.approach(contact) > still;
        let involved: Vec<usize> = (0..self.memory.len())
            .filter(|&i| {
                let variables = &self.dynamics.contacts[i];
                let meets =
                    touches(variables) && (self.approach(i) <= still || bounces && !self.leaves(i));
                variables.is_closed_unilateral() || variables.unloaded || meets || i == contact
            })
            .collect();
        let (start, mut after) = (self.state.clone(), vec![0.0; involved.len()]);
        let mut ambiguous = false;
        if involved.iter().any(|&i| self.approach(i) < -still) {
            for law in [ImpactLaw::Newton, ImpactLaw::Plastic, ImpactLaw::Closing] {
                // What is closed at last is what a plastic impact leaves: of the impact itself the laws have decided.
                if law != ImpactLaw::Closing {
                    self.state.clone_from(&start);
                }
                let solving = Solving { memory: &self.memory, observer: self.observer, t: start.t };
                let (dynamics, state) = (&mut self.dynamics, &mut self.state);
                let impact =
                    impacts::collide(dynamics, state, &involved, law, &mut after, &solving)?;
                match impact {
                    Decision::Made { ambiguous: several } => ambiguous = several,
                    Decision::Ended(outcome) => return Ok(Some(outcome)),
                }
                if !self.bounces_negligibly(&involved, &after)? {
                    break;
                }
            }
            ambiguous |= self.drives_back(&involved)?;
        }
        for &i in &involved {
            let unloaded = self.dynamics.contacts[i].unloaded && i != contact;
            if before[i] == Some(Phase::Open) && !unloaded {
                self.record_event(Some(i), EventKind::Impact, ambiguous);
                before[i] = None;
            }
        }
        self.after_impact(&involved, &after, &before)
    }

    /// Whether an impact drives a contact back that touched and was about to leave. It collides next, and so on:
    /// one impact of both at a time is another law of the corner, to which time steps may converge.
    fn drives_back(&mut self, involved: &[usize]) -> Result<bool, EvaluationError> {
        let State { t, q, u } = &self.state;
        self.dynamics.kinematics(*t, q, u)?;
        let still = self.zero_velocity();
        let mut others = (0..self.memory.len()).filter(|i| !involved.contains(i));
        Ok(others.any(|i| touches(&self.dynamics.contacts[i]) && self.approach(i) < -still))
    }

    /// Whether contacts bounce, all of them lower than can be followed. Those that were closed may be thrown up by the
    /// others: a body that rocks from foot to foot comes to rest within a finite time, too.
    fn bounces_negligibly(
        &mut self,
        involved: &[usize],
        after: &[f64],
    ) -> Result<bool, EvaluationError> {
        let still = self.zero_velocity();
        let bouncing = |(_, v): &(&usize, &f64)| **v > still;
        let bounces: Vec<_> = involved.iter().zip(after).filter(bouncing).collect();
        if bounces.is_empty() {
            return Ok(false);
        }
        // How they fall while the others stay closed.
        let (contacts, memory) = (self.dynamics.contacts.clone(), self.memory.clone());
        let State { t, q, u } = &self.state;
        self.dynamics.kinematics(*t, q, u)?;
        self.set_modes_after(involved, after);
        let State { t, q, u } = &self.state;
        self.dynamics.evaluate(*t, q, u, SlidingForces::Updated)?;
        self.dynamics.drift_of_all(&self.state)?;
        let negligible = bounces.iter().all(|&(&i, &v)| {
            let fall = -self.dynamics.rate(ROWS * i, &self.dynamics.acceleration);
            let low = v * v < 2.0 * fall * ROUNDED * self.dynamics.contacts[i].reach;
            fall > 0.0 && (low || v < fall * shortest_step(self.state.t))
        });
        (self.dynamics.contacts, self.memory) = (contacts, memory);
        Ok(negligible)
    }

    /// Contacts that leave open, the others are decided on. `after` are the normal velocities of those involved.
    fn after_impact(
        &mut self,
        involved: &[usize],
        after: &[f64],
        before: &[Option<Phase>],
    ) -> Ending {
        let State { t, q, u } = &self.state;
        self.dynamics.kinematics(*t, q, u)?;
        self.set_modes_after(involved, after);
        self.decide_modes(before)
    }

    /// Opens the contacts that leave, the others slip or stick; at velocities where the kinematics have been evaluated.
    fn set_modes_after(&mut self, involved: &[usize], after: &[f64]) {
        let still = self.zero_velocity();
        for i in 0..self.memory.len() {
            let place = involved.iter().position(|&k| k == i);
            let closed = self.dynamics.contacts[i].mode != Phase::Open;
            match place {
                Some(k) if after[k] > still => {
                    let contact = &mut self.dynamics.contacts[i];
                    (contact.mode, contact.unloaded) = (Phase::Open, false);
                    self.memory[i] = ContactState::new(Phase::Open, self.memory[i].slip);
                }
                Some(_) => self.close_contact(i),
                None if closed => self.close_contact(i),
                None => {}
            }
        }
    }

    /// A slipping contact that no longer resists normal motions.
    pub(crate) fn singular_contact(&self) -> Option<usize> {
        let contacts = self.dynamics.contacts.iter().zip(self.step_size.resistances());
        let mut slipping = contacts.map(|(contact, resistance)| (contact.mode, *resistance));
        slipping.position(|(mode, resistance)| mode == Phase::Slip && resistance < NOTHING)
    }

    /// Whether a slipping contact that no longer resists opens without its own force. With a negative resistance it
    /// could go on slipping as well, under a force that keeps itself up.
    fn can_open(&mut self, i: usize) -> Result<bool, EvaluationError> {
        let State { t, q, u } = &self.state;
        self.dynamics.contacts[i].mode = Phase::Open;
        self.dynamics.evaluate(*t, q, u, SlidingForces::Updated)?;
        self.dynamics.drift_of_all(&self.state)?;
        self.dynamics.contacts[i].mode = Phase::Slip;
        Ok(self.dynamics.rate(ROWS * i, &self.dynamics.acceleration) >= 0.0)
    }

    /// Painlevé's paradox: a contact that can open, opens; if none can, an impact without collision stops the slip.
    pub(crate) fn resolve_paradox(&mut self, i: usize) -> Ending {
        let mut before = self.modes();
        if self.can_open(i)? {
            self.dynamics.contacts[i].mode = Phase::Open;
            self.memory[i] = ContactState::new(Phase::Open, self.memory[i].slip);
            self.record_event(Some(i), EventKind::Open, true);
            before[i] = None;
            return self.decide_modes(&before);
        }
        let closed = |&k: &usize| self.dynamics.contacts[k].is_closed_unilateral();
        let involved: Vec<usize> = (0..self.memory.len()).filter(closed).collect();
        if !impacts::stop_slip(&mut self.dynamics, &mut self.state, &involved)? {
            let cause = Stagnation::NoImpact;
            return Ok(Some(Outcome::Stagnated { cause, contact: Some(i) }));
        }
        self.record_event(Some(i), EventKind::ImpactWithoutCollision, false);
        before[i] = None;
        let after = vec![0.0; involved.len()];
        self.after_impact(&involved, &after, &before)
    }
}

//! What is done at the end of steps, at events, and where slips come to an end.

use crate::contact::{ContactState, Phase};
use crate::integrator::event::collocation::{STAGES, slip_rate};
use crate::integrator::event::dynamics::ROWS;
use crate::integrator::event::integration::variables::{Ending, Integration, Next};
use crate::integrator::event::motion::EventKind;
use crate::integrator::event::outcome::Outcome;
use crate::integrator::event::resolution::{NOTHING, shortest_step};
use crate::integrator::event::state::{EvaluationError, State};
use crate::vectors::{largest, norm};

/// Slip over the speed of a contact below which rounding may turn its friction force, as it does where *D* is slender.
const NEARLY_ZERO: f64 = 1e-9;
/// Height of a bounce over the overlap with which it begins up to which the contact closes where steps cannot be shorter.
const FAR_HIGHER: f64 = 100.0;
/// Relative change of the velocities in a time in which accelerations do not change, but by rounding.
const UNCHANGING: f64 = 1e-8;
/// Part of the friction force that rounding of the slip may change while the slip still tells the force.
const TURNED: f64 = 0.03;

impl Integration<'_> {
    /// Takes the attempt, which ends at `t`.
    pub(crate) fn accept_step(&mut self, t: f64) -> Result<(), EvaluationError> {
        if self.sample_attempt(t)? || self.interpolated {
            self.evaluate_stage(STAGES - 1)?;
        }
        self.take_end(t, true)?;
        self.dynamics.project(&mut self.state)?;
        std::mem::swap(&mut self.step, &mut self.last);
        (self.smooth, self.starting) = (true, false);
        self.linearised = self.linearised.filter(|_| self.dynamics.constant);
        self.reset_event_functions(false);
        self.sample_end();
        Ok(())
    }

    /// The event of a contact, of the section, or at a border of friction at the present state.
    pub(crate) fn handle_event(&mut self, number: usize) -> Ending {
        if number > self.memory.len() {
            return self.cross_border();
        }
        if number == self.memory.len() {
            let counts = self.options.section.as_ref().is_some_and(|s| self.state.t > s.after);
            self.event_values[number] = 0.0;
            self.reset_event_functions(false);
            self.linearised = None;
            if counts {
                self.record_event(None, EventKind::Section, false);
            }
            if counts && self.options.goes_on {
                // Crossings are no difficulties of the motion. One located a little too early must not be found again.
                self.uncounted += 1;
                self.event_values[number] = self.event_values[number].max(0.0);
                return Ok(None);
            }
            return Ok(counts.then_some(Outcome::Section));
        }
        match self.dynamics.contacts[number].mode {
            Phase::Stick => self.release(number),
            Phase::Slip => {
                let before = self.modes();
                let contact = &mut self.dynamics.contacts[number];
                (contact.mode, contact.unloaded) = (Phase::Open, true);
                self.memory[number] = ContactState::new(Phase::Open, self.memory[number].slip);
                self.decide_modes(&before)
            }
            _ if self.dynamics.contacts[number].share.is_some() => {
                let before = self.modes();
                self.close_contact(number);
                self.decide_modes(&before)
            }
            // Closed a moment ago, by rounding.
            _ if self.approach(number) > self.zero_velocity()
                && 0.25 * self.step.h > shortest_step(self.state.t) =>
            {
                Ok(self.reject(0.25 * self.step.h))
            }
            // By noise of a user's gap.
            _ if self.leaves(number) => {
                self.reset_event_functions(false);
                Ok(None)
            }
            _ => self.collide(number),
        }
    }

    /// Contacts go on in the next regions of their maps of friction: all that reach a border at once, to rounding.
    fn cross_border(&mut self) -> Ending {
        let contacts = self.dynamics.contacts.iter_mut();
        let left: Vec<Option<usize>> = contacts.map(|contact| contact.region.take()).collect();
        let State { t, q, u } = &self.state;
        self.dynamics.kinematics(*t, q, u)?;
        let crosses = |&i: &usize| {
            let (contact, map) =
                (&self.dynamics.contacts[i], self.dynamics.chart.friction_place(self.state.t, i));
            !contact.is_free()
                && contact.region != left[i]
                && map.is_some_and(|(map, _)| map.jumps())
        };
        let crossing: Vec<usize> = (0..left.len()).filter(crosses).collect();
        if crossing.is_empty() {
            self.linearised = None;
            self.reset_event_functions(false);
            return Ok(None);
        }
        for &i in &crossing {
            self.record_event(Some(i), EventKind::Border, false);
        }
        let before = self.modes();
        for k in 0..self.memory.len() {
            if self.dynamics.contacts[k].mode != Phase::Open {
                self.close_contact(k);
            }
        }
        self.decide_modes(&before)
    }

    /// Whether a contact separates so fast that its bounce, of height `γ_N²/(2|γ̇_N|)`, is far higher than its overlap.
    pub(super) fn leaves(&self, i: usize) -> bool {
        let (velocity, rate) = (self.approach(i), self.dynamics.rate(ROWS * i, &self.a0));
        let overlap = (-self.dynamics.contacts[i].gap).max(0.0);
        velocity > self.zero_velocity() && velocity * velocity > -2.0 * rate * FAR_HIGHER * overlap
    }

    /// Slips that come to an end with the last step, and after what time they do.
    pub(crate) fn ending_slips(&self) -> Option<Next> {
        let contacts: Vec<usize> = (0..self.memory.len()).filter(|&i| self.slip_ends(i)).collect();
        let rate = |i: usize| slip_rate(&self.dynamics, i, &self.a0);
        let braked = contacts.iter().filter(|&&i| rate(i) < 0.0);
        let times = braked.map(|&i| -norm(&self.dynamics.contacts[i].slip) / rate(i));
        let left = times.fold(0.0, f64::max);
        // Where the deceleration is rounding, too, the slip ends here: the projection takes it out.
        let unchanging = left * largest(&self.a0) <= UNCHANGING * self.step_size.speed();
        let after =
            if unchanging && self.state.t + left <= self.end_of_piece() { left } else { 0.0 };
        (!contacts.is_empty()).then_some(Next::EndOfSlips { contacts, after })
    }

    /// Ends slips after a time in which accelerations do not change.
    pub(crate) fn end_slips(&mut self, contacts: &[usize], after: f64) -> Ending {
        let mut before = self.modes();
        for &i in contacts {
            self.memory[i] = ContactState::new(Phase::Stick, self.dynamics.contacts[i].slip);
            self.dynamics.contacts[i].mode = Phase::Stick;
            before[i] = Some(Phase::Unknown);
        }
        let start = self.state.clone();
        self.state.extrapolate(&start, &self.a0, after);
        self.decide_modes(&before)
    }

    /// Whether a slip has come to its end, to rounding of the slip or of the time.
    fn slip_ends(&self, i: usize) -> bool {
        let contact = &self.dynamics.contacts[i];
        let speed = norm(&contact.slip);
        if contact.mode != Phase::Slip || speed == 0.0 {
            return contact.mode == Phase::Slip;
        }
        let rate = slip_rate(&self.dynamics, i, &self.a0);
        let rounding = NOTHING * contact.reference_speed();
        rate < 0.0
            && (speed <= f64::max(rounding, -rate * shortest_step(self.state.t))
                || (speed <= NEARLY_ZERO * contact.reference_speed()
                    && self.dynamics.rounding_turns(i) > TURNED))
    }
}

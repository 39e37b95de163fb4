//! What is done at events.

use crate::contact::{ContactState, Phase};
use crate::integrator::event::collocation::step_size;
use crate::integrator::event::contact_problem::accelerations::{self, Decision};
use crate::integrator::event::dynamics::contact_variables::{
    FieldError, ROWS, STILL, State, TOUCHING, Touch, instant,
};
use crate::integrator::event::dynamics::sliding_force::{self, norm};
use crate::integrator::event::dynamics::{add, dot, largest};
use crate::integrator::event::event_function;
use crate::integrator::event::integration::time_loop::Runner;
use crate::integrator::event::{Event, Kind, OptionsError, Outcome};

/// Difference of the sliding forces per normal force below which stick goes over to slip without a jump.
const CONTINUOUS: f64 = 1e-3;
/// Slip over the speed of the contact that the first step of a slip has to reach: rounding must not decide on
/// its direction. The first stage is at 0.06 of the step, where the slip may be 0.003 of that at its end.
const ONSET: f64 = 1e-8;
/// Excess of a sticking force over the reservoir that may be rounding, relative to the largest normal force.
const AT_LIMIT: f64 = 1e-9;

/// Gap in m, and velocity in m/s, that count as none at the beginning, where no length may be known but that of
/// rounding, such as of a body at rest at the origin: states of a size of one are no finer.
const LEAST: f64 = f64::EPSILON;

pub(crate) type Next = Result<Option<Outcome>, FieldError>;

impl Runner<'_> {
    /// Contacts that overlap at the beginning.
    pub(crate) fn penetration(&mut self) -> Result<Option<OptionsError>, FieldError> {
        let State { t, q, u } = &self.state;
        self.field.kinematics(*t, q, u)?;
        self.control.see(&mut self.field, q, u, 0.0);
        // An impact at the beginning is told from rest by the accelerations without contacts.
        self.field.system.forces(*t, q, u, &mut self.a0)?;
        self.field.apply_inverse_mass(&mut self.a0);
        let depth = |touch: &Touch| touch.prescribed.is_none() && touch.gap < -closed(touch);
        Ok(self.field.touches.iter().position(depth).map(|contact| {
            let depth = -self.field.touches[contact].gap;
            let message =
                format!("must not let contacts overlap, contact {contact} does by {depth:.3e}");
            OptionsError { argument: "q0", message }
        }))
    }

    /// Decides what the contacts do at the beginning.
    pub(crate) fn begin(&mut self) -> Next {
        self.field.begin(&self.state, self.options.t_end)?;
        let mut hit = None;
        let still = (STILL * self.control.speed()).max(LEAST);
        for i in 0..self.memory.len() {
            let rows = (1..=self.field.touches[i].p).map(|r| largest(self.field.row(ROWS * i + r)));
            let size = rows.fold(0.0, f64::max);
            // Rounding must not slip.
            if norm(&self.field.touches[i].slip) <= LEAST * size {
                self.field.touches[i].slip = [0.0; 3];
            }
            let touch = self.field.touches[i];
            if touch.prescribed.is_none() && touch.gap <= closed(&touch) {
                let approach = self.approach(i);
                if approach < -still {
                    hit = Some(i);
                } else if approach <= still {
                    self.close(i);
                }
            } else if touch.prescribed.is_some_and(|force| force > 0.0) {
                self.close(i);
            }
        }
        if let Some(contact) = hit {
            return self.collide(contact);
        }
        let phases = self.phases();
        self.settle(&phases.iter().map(|_| None).collect::<Vec<_>>())
    }

    pub(crate) fn phases(&self) -> Vec<Option<Phase>> {
        self.field.touches.iter().map(|touch| Some(touch.mode)).collect()
    }

    /// `γ_N`.
    pub(crate) fn approach(&self, contact: usize) -> f64 {
        dot(self.field.row(ROWS * contact), &self.state.u)
    }

    /// A contact without approach slips, or rests.
    pub(crate) fn close(&mut self, contact: usize) {
        let touch = &mut self.field.touches[contact];
        if norm(&touch.slip) > STILL * touch.reference() {
            touch.mode = Phase::Slip;
            self.memory[contact] = ContactState::new(Phase::Slip, touch.slip);
        } else {
            touch.mode = Phase::Stick;
            let slip = self.memory[contact].slip;
            self.memory[contact] = ContactState::new(Phase::Stick, slip);
        }
    }

    pub(crate) fn event(&mut self, contact: Option<usize>, kind: Kind, ambiguous: bool) {
        let time = self.state.t;
        self.motion.events.push(Event { time, contact, kind, phase: None, ambiguous });
    }

    /// Contacts without slip are decided on, all others go on. `before` are the phases that changes are told
    /// from; none are told of the others.
    pub(crate) fn settle(&mut self, before: &[Option<Phase>]) -> Next {
        self.field.project(&mut self.state)?;
        for touch in &mut self.field.touches {
            let still = norm(&touch.slip) <= STILL * touch.reference();
            touch.resting = touch.mode == Phase::Stick || (touch.mode == Phase::Slip && still);
        }
        let state = self.state.clone();
        let outcome = self.decide(&state, before)?;
        if outcome.is_none() && !self.starting {
            // The constraints hold exactly here, to the accuracy of the solver there.
            self.evaluate((state.t, &state.q, &state.u), false)?;
            self.a0.copy_from_slice(&self.field.acceleration);
        }
        Ok(outcome)
    }

    fn decide(&mut self, at: &State, before: &[Option<Phase>]) -> Next {
        let resting: Vec<bool> = self.field.touches.iter().map(|touch| touch.resting).collect();
        let ambiguous = match accelerations::decide(&mut self.field, at, &self.memory, &self.poll)?
        {
            Decision::Made { ambiguous } => ambiguous,
            Decision::Ended(outcome) => return Ok(Some(outcome)),
        };
        self.starting = false;
        let mut onset: f64 = 0.0;
        for i in 0..resting.len() {
            let touch = &self.field.touches[i];
            let (mode, slip) = (touch.mode, touch.slip);
            if resting[i] {
                self.starting |= mode == Phase::Slip;
                if mode == Phase::Slip {
                    onset = onset.max(ONSET * touch.reference() / norm(&slip));
                }
                let slip = if mode == Phase::Slip { slip } else { self.memory[i].slip };
                self.memory[i] = ContactState::new(mode, slip);
                self.field.touches[i].slip = [0.0; 3];
            }
            if before[i].is_some_and(|before| before != mode) {
                let kind = match mode {
                    Phase::Stick => Kind::Stick,
                    Phase::Slip => Kind::Slip,
                    _ => Kind::Open,
                };
                self.event(Some(i), kind, ambiguous && resting[i]);
            }
        }
        let touches = &self.field.touches;
        for event in self.motion.events.iter_mut().rev().take_while(|e| e.phase.is_none()) {
            event.phase = event.contact.map(|i| touches[i].mode);
        }
        self.resume(onset)?;
        Ok(self.enough())
    }

    /// The motion goes on in new modes, with steps of at least the length `onset`.
    fn resume(&mut self, onset: f64) -> Result<(), FieldError> {
        self.control.h = self.control.h.max(onset);
        self.a0.copy_from_slice(&self.field.acceleration);
        self.keep_sliding();
        (self.slope, self.smooth, self.linear) = (None, false, false);
        self.control.forget(&self.field);
        self.field.survey(&self.state)?;
        self.quiet(true);
        if self.options.sample.is_none() {
            self.record()?;
        }
        Ok(())
    }

    fn enough(&self) -> Option<Outcome> {
        let many = self.motion.events.len() >= self.options.max_events;
        many.then_some(Outcome::TooManyEvents)
    }

    /// An alarm went off at the present state.
    pub(crate) fn happen(&mut self, which: usize) -> Next {
        if which == self.memory.len() {
            let counts = self.options.section.as_ref().is_some_and(|s| self.state.t > s.after);
            self.alarms[which] = 0.0;
            self.quiet(false);
            self.linear = false;
            if counts {
                self.event(None, Kind::Section, false);
            }
            return Ok(counts.then_some(Outcome::Section));
        }
        match self.field.touches[which].mode {
            Phase::Stick => self.let_go(which),
            Phase::Slip => {
                let before = self.phases();
                self.field.touches[which].mode = Phase::Open;
                self.memory[which] = ContactState::new(Phase::Open, self.memory[which].slip);
                self.settle(&before)
            }
            // Closed a moment ago, by rounding.
            _ if self.approach(which) > STILL * self.control.speed()
                && 0.25 * self.step.h > instant(self.state.t) =>
            {
                Ok(self.shorten(0.25 * self.step.h))
            }
            _ => self.collide(which),
        }
    }

    /// A sticking contact cannot go on sticking: what it does is decided a little later, with a load that it
    /// cannot carry.
    fn let_go(&mut self, contact: usize) -> Next {
        let before = self.phases();
        let touch = self.field.touches[contact];
        let stuck = self.a0.clone();
        let excess = event_function::excess(&self.field, contact);
        let pressing = self.field.touches.iter().map(|touch| touch.normal_force);
        let rounding = AT_LIMIT * pressing.fold(f64::MIN_POSITIVE, f64::max);
        let length = self.control.h;
        let sliding = touch.force.map(|f| f / touch.normal_force);
        let direction = sliding_force::direction(self.field.law(contact), &touch.force);
        let kept = self.memory.clone();
        let mut later = 1e-7 * self.step.h;
        loop {
            let mut ahead = self.state.clone();
            ahead.t += later;
            add(&mut ahead.q, later, &self.state.u);
            add(&mut ahead.q, 0.5 * later * later, &stuck);
            add(&mut ahead.u, later, &stuck);
            self.memory.clone_from(&kept);
            self.memory[contact] = ContactState::new(Phase::Slip, direction);
            for (touch, mode) in self.field.touches.iter_mut().zip(&before) {
                touch.mode = mode.unwrap_or_default();
                touch.resting = touch.mode == Phase::Stick;
            }
            let (events, samples) = (self.motion.events.len(), self.motion.t.len());
            self.control.h = length;
            let outcome = self.decide(&ahead, &before)?;
            if outcome.is_some() {
                return Ok(outcome);
            }
            if self.motion.events.len() > events {
                break;
            }
            // Not yet outside by more than rounding.
            self.motion.truncate(samples);
            later *= 10.0;
            if later > 0.1 * self.step.h {
                // It can: its force has been outside the reservoir by rounding only.
                (self.a0, self.memory) = (stuck, kept);
                let touch = &mut self.field.touches[contact];
                let shorter = if excess <= rounding { self.step.h } else { 0.25 * self.step.h };
                touch.tolerated += (2.0 * excess).clamp(1e-3 * rounding, rounding);
                return Ok(self.shorten(shorter));
            }
        }
        let touch = &self.field.touches[contact];
        let jump = touch.sliding.iter().zip(&sliding).map(|(a, b)| a - b);
        let jump = jump.map(|d| d * d).sum::<f64>().sqrt();
        if touch.mode == Phase::Slip && jump <= CONTINUOUS * norm(&sliding) {
            let rate = |(a, b): (&f64, &f64)| (a - b) / later;
            self.slope = Some(self.a0.iter().zip(&stuck).map(rate).collect());
            self.a0 = stuck;
            // γ = ½ γ̈ t².
            let growth = norm(&self.memory[contact].slip) / later;
            let onset = (2.0 * ONSET * self.field.touches[contact].reference() / growth).sqrt();
            self.control.h = length.max(onset);
        }
        Ok(None)
    }

    /// Slips that come to an end with a step.
    pub(crate) fn arrivals(&mut self) -> Next {
        let arrived = self.arrived();
        if arrived.is_empty() {
            return Ok(None);
        }
        let mut before = self.phases();
        let mut left = 0.0;
        for &i in &arrived {
            let slip = self.field.touches[i].slip;
            let rate = step_size::slip_rate(&self.field, i, &self.a0);
            if rate < 0.0 {
                left = f64::max(left, -norm(&slip) / rate);
            }
            self.memory[i] = ContactState::new(Phase::Stick, slip);
            self.field.touches[i].mode = Phase::Stick;
            before[i] = Some(Phase::Unknown);
        }
        self.state.t = (self.state.t + left).min(self.options.t_end);
        add(&mut self.state.q, left, &self.state.u);
        add(&mut self.state.u, left, &self.a0);
        self.settle(&before)
    }
}

/// The gap at which a contact counts as closed at the beginning.
pub(crate) fn closed(touch: &Touch) -> f64 {
    (TOUCHING * touch.reach).max(LEAST)
}

//! The loop over steps.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use super::collocation::Step;
use super::control::Control;
use super::field::Field;
use super::touch::{FieldError, State, instant};
use super::watch::{Lost, Watch};
use super::{Motion, Options, OptionsError, Outcome, Run};
use crate::contact::ContactState;
use crate::system::System;

const POLL_EVERY: Duration = Duration::from_millis(50);
/// Attempts among which the rejected ones are counted, and how many of them are too many: where *D* is nearly
/// flat, the sliding direction is held where Newton's method does not find it.
const WINDOW: usize = 2000;
const TOO_MANY: usize = 800;
/// Events at one time that are too many.
const AT_ONCE: usize = 50;

/// Everything that changes during a run.
pub(super) struct Runner<'a> {
    pub(super) options: &'a Options,
    pub(super) field: Field<'a>,
    pub(super) state: State,
    /// What the contacts did last.
    pub(super) memory: Vec<ContactState>,
    pub(super) control: Control,
    pub(super) motion: Motion,
    /// Accelerations at the present state, and at the beginning of a slip their rate.
    pub(super) a0: Vec<f64>,
    pub(super) slope: Option<Vec<f64>>,
    /// The present attempt, the step before, and steps from the same start to other times.
    pub(super) step: Step,
    pub(super) last: Step,
    pub(super) probe: Step,
    /// Whether a slip begins at the present state.
    pub(super) starting: bool,
    /// Whether the step before was of the same mode, and whether its Jacobian can be used again.
    pub(super) smooth: bool,
    pub(super) linear: bool,
    /// Alarms at the present state, contacts first, then the section.
    pub(super) alarms: Vec<f64>,
    /// Steps made and rejected when they were looked at last.
    counted: (usize, usize),
    /// Number of the next sample.
    pub(super) samples: usize,
}

pub(super) fn run(
    system: &dyn System,
    options: &Options,
    observer: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<Run, OptionsError> {
    let mut runner = Runner::new(system, options);
    let outcome = match runner.penetration() {
        Ok(Some(error)) => return Err(error),
        Ok(None) => runner.go(observer).unwrap_or_else(Outcome::Error),
        Err(error) => Outcome::Error(error),
    };
    Ok(Run { motion: runner.motion, outcome })
}

impl<'a> Runner<'a> {
    fn new(system: &'a dyn System, options: &'a Options) -> Self {
        let (n, contacts) = (system.dof(), system.contacts().len());
        let field = Field::new(system);
        Self {
            options,
            state: State { t: 0.0, q: options.q0.clone(), u: options.u0.clone() },
            memory: vec![ContactState::default(); contacts],
            control: Control::new(options.tolerance, contacts),
            motion: Motion::new(&field),
            field,
            a0: vec![0.0; n],
            slope: None,
            step: Step::new(n),
            last: Step::new(n),
            probe: Step::new(n),
            starting: false,
            smooth: false,
            linear: false,
            alarms: vec![0.0; contacts + 1],
            counted: (0, 0),
            samples: 1,
        }
    }

    fn go(
        &mut self,
        observer: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<Outcome, FieldError> {
        let mut outcome = self.begin()?;
        self.control.begin(self.options.t_end, &self.a0);
        self.motion.record(&self.field, &self.state);
        let mut polled = Instant::now();
        loop {
            if let Some(outcome) = outcome {
                if self.motion.t.last() != Some(&self.state.t) {
                    self.motion.record(&self.field, &self.state);
                }
                return Ok(outcome);
            }
            outcome = self.advance()?;
            if outcome.is_none() && polled.elapsed() >= POLL_EVERY {
                polled = Instant::now();
                if observer(self.state.t).is_break() {
                    outcome = Some(Outcome::Interrupted);
                }
            }
        }
    }

    /// One attempt of a step.
    fn advance(&mut self) -> Result<Option<Outcome>, FieldError> {
        let left = self.options.t_end - self.state.t;
        if left <= 0.0 {
            return Ok(Some(Outcome::Finished));
        }
        let mut limit = self.control.flight(&self.field, &self.state.u, &self.a0);
        if !self.starting {
            limit = limit.min(self.control.limit(&self.field, &self.a0));
        }
        // What ends within less than time resolves is over when it is looked at.
        let h = self.control.h.min(left).min(limit.max(instant(self.state.t)));
        if self.state.t + h == self.state.t {
            return Ok(Some(Outcome::Stuck));
        }
        if self.is_stuck() {
            return Ok(Some(Outcome::Stuck));
        }
        if let Some(contact) = self.singular() {
            return self.stop_without_collision(contact);
        }
        let scale = self.control.scale(h, &self.a0);
        if !self.linear {
            self.field.linearise(&self.state, scale)?;
            self.linear = true;
        }
        if !self.attempt(h)? {
            return Ok(self.shorten(0.25 * h));
        }
        let error = self.step.error(&self.state, &self.a0, scale);
        if !self.control.judge(h, error) {
            let shorter = self.control.h;
            return Ok(self.shorten(shorter));
        }
        match self.watch()? {
            Watch::Singular => Ok(self.shorten(0.5 * h)),
            Watch::Quiet if self.field.narrow(self.step.end(&self.step.u)) => Ok(self.shorten(h)),
            Watch::Quiet => {
                let end = if h == left { self.options.t_end } else { self.state.t + h };
                self.accept(end)?;
                self.arrivals()
            }
            Watch::Alarms(alarms) => match self.locate(&alarms) {
                Ok(which) => self.happen(which),
                Err(Lost::Diverged) => Ok(self.shorten(0.5 * h)),
                Err(Lost::Error(error)) => Err(error),
            },
        }
    }

    /// Whether there is no hope to get on.
    fn is_stuck(&mut self) -> bool {
        let (steps, rejected) = (self.motion.steps, self.motion.rejected_steps);
        let done = (steps - self.counted.0, rejected - self.counted.1);
        if done.0 + done.1 >= WINDOW {
            self.counted = (steps, rejected);
            return done.1 >= TOO_MANY;
        }
        let events = &self.motion.events;
        let before = events.len().checked_sub(AT_ONCE + self.memory.len()).map(|k| events[k].time);
        before == Some(self.state.t)
    }

    /// Tries again with a shorter step.
    pub(super) fn shorten(&mut self, h: f64) -> Option<Outcome> {
        self.control.h = h;
        self.linear = false;
        self.motion.rejected_steps += 1;
        None
    }

    /// Newton's method from the continued polynomial of the step before, else from constant accelerations.
    fn attempt(&mut self, h: f64) -> Result<bool, FieldError> {
        let goal = (self.control.newton, self.control.scale(h, &self.a0));
        if self.smooth && h <= 2.0 * self.last.h {
            self.step.guess_from(h, &self.last, self.last.h);
            if self.step.solve(&mut self.field, &self.state, h, goal)? {
                return Ok(true);
            }
        }
        self.step.guess_line(h, &self.a0, self.slope.as_deref());
        self.step.solve(&mut self.field, &self.state, h, goal)
    }
}

//! The loop over steps.

use std::ops::ControlFlow;

use crate::contact::{ContactState, Phase};
use crate::integrator::event::collocation::dense_output::Dense;
use crate::integrator::event::collocation::initial_step::first_step;
use crate::integrator::event::collocation::step::{Scale, Step};
use crate::integrator::event::collocation::step_size::Control;
use crate::integrator::event::dynamics::contact_variables::{FieldError, ROUNDING, State, instant};
use crate::integrator::event::dynamics::sliding_force::norm;
use crate::integrator::event::dynamics::{Field, add, largest};
use crate::integrator::event::event_function::between_stages::NODES;
use crate::integrator::event::integration::detection::{Lost, Watch};
use crate::integrator::event::observer::Poll;
use crate::integrator::event::{Cause, Motion, Options, OptionsError, Outcome, Run};
use crate::system::System;

/// Attempts among which the rejected ones are counted, and how many of them are too many.
const WINDOW: usize = 2000;
const TOO_MANY: usize = 800;
/// Share of the whole time in which so many attempts are worth the effort, though many are rejected.
const PROGRESS: f64 = 1e-5;
/// Share of the whole time in which so many attempts are worth the effort, even if all succeed: at this pace the
/// motion would take 2e13 steps.
const LEAST_PROGRESS: f64 = 1e-10;
/// Share of the whole time that is left out at its end: events are not located better.
const COAST: f64 = 2e-14;
/// Events at one time that are too many.
const AT_ONCE: usize = 50;

/// Length of a step over the time of an event in it, where the one before was far too long to tell that time.
const SOON: f64 = 4.0;
/// How much longer steps may become before the Jacobian is computed anew: rounding in it grows with their square.
const LONGER: f64 = 4.0;

/// Everything that changes during a run.
pub(crate) struct Runner<'a> {
    pub(crate) options: &'a Options,
    pub(crate) field: Field<'a>,
    pub(crate) state: State,
    /// What the contacts did last.
    pub(crate) memory: Vec<ContactState>,
    pub(crate) control: Control,
    pub(crate) motion: Motion,
    /// Accelerations at the present state, and at the beginning of a slip their rate.
    pub(crate) a0: Vec<f64>,
    pub(crate) slope: Option<Vec<f64>>,
    /// Forces of sliding contacts per unit normal force at the present state.
    pub(crate) sliding: Vec<[f64; 3]>,
    /// The present attempt, the step before, and steps from the same start to other times.
    pub(crate) step: Step,
    pub(crate) last: Step,
    pub(crate) probe: Step,
    /// Whether a slip begins at the present state.
    pub(crate) starting: bool,
    /// How often the first step has been shortened for an event far too early in it.
    pub(crate) shortened: u8,
    /// Whether the step before was of the same mode, and whether its Jacobian can be used again.
    pub(crate) smooth: bool,
    pub(crate) linear: bool,
    /// The length of the step for which it was computed.
    linearised: f64,
    /// Whether the field is where a rejected attempt has left it.
    stale: bool,
    /// Alarms at the present state, contacts first, then the section; those along the attempt.
    pub(crate) alarms: Vec<f64>,
    pub(crate) seen: Vec<[f64; NODES]>,
    /// Steps made and rejected when they were looked at last.
    counted: (usize, usize, f64),
    /// Number of the next sample, what samples are read from, and the last one.
    pub(crate) samples: usize,
    pub(crate) dense: Dense,
    pub(crate) sampled: State,
    pub(crate) poll: Poll<'a>,
}

pub(crate) fn run(
    system: &dyn System,
    options: &Options,
    observer: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<Run, OptionsError> {
    let mut runner = Runner::new(system, options, observer);
    let outcome = match runner.penetration() {
        Ok(Some(error)) => return Err(error),
        Ok(None) => runner.go().unwrap_or_else(Outcome::Error),
        Err(error) => Outcome::Error(error),
    };
    Ok(Run { motion: runner.motion, outcome })
}

impl<'a> Runner<'a> {
    fn new(
        system: &'a dyn System,
        options: &'a Options,
        observer: &'a mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Self {
        let (n, contacts) = (system.dof(), system.contacts().len());
        let field = Field::new(system, options.t_end);
        Self {
            options,
            state: State { t: 0.0, q: options.q0.clone(), u: options.u0.clone() },
            memory: vec![ContactState::default(); contacts],
            control: Control::new(options.tolerance, contacts),
            motion: Motion::new(&field),
            field,
            a0: vec![0.0; n],
            slope: None,
            sliding: vec![[0.0; 3]; contacts],
            step: Step::new(n),
            last: Step::new(n),
            probe: Step::new(n),
            starting: false,
            shortened: 0,
            smooth: false,
            linear: false,
            linearised: 0.0,
            stale: false,
            alarms: vec![0.0; contacts + 1],
            seen: vec![[0.0; NODES]; contacts + 1],
            counted: (0, 0, 0.0),
            samples: 1,
            dense: Dense::new(n),
            sampled: State { t: 0.0, q: vec![0.0; n], u: vec![0.0; n] },
            poll: Poll::new(observer),
        }
    }

    fn go(&mut self) -> Result<Outcome, FieldError> {
        let mut outcome = self.begin()?;
        self.record()?;
        if outcome.is_none() {
            let longest = self.control.first(self.options.t_end, &self.a0);
            self.control.h = first_step(&mut self.field, &self.state, &self.a0, longest)?;
            self.stale = true;
        }
        loop {
            if let Some(outcome) = outcome {
                if self.motion.t.last() != Some(&self.state.t) {
                    self.record()?;
                }
                return Ok(outcome);
            }
            outcome = self.advance()?;
            if outcome.is_none() && self.poll.stops(self.state.t) {
                outcome = Some(Outcome::Interrupted);
            }
        }
    }

    /// One attempt of a step.
    fn advance(&mut self) -> Result<Option<Outcome>, FieldError> {
        let left = self.options.t_end - self.state.t;
        if left <= COAST * self.options.t_end {
            return Ok(Some(self.coast(left)));
        }
        if self.stale {
            let State { t, q, u } = &self.state;
            self.field.evaluate(*t, q, u, self.starting)?;
            // A stencil that has been narrowed for the end of an attempt must not widen for its start.
            self.field.drift_of_all(&self.state)?;
            self.stale = false;
        }
        let mut limit = self.control.flight(&self.field, &self.state.u, &self.a0);
        if !self.starting {
            limit = limit.min(self.control.limit(&self.field, &self.a0));
        }
        // What ends within less than time resolves is over when it is looked at.
        let longest = self.options.max_step.unwrap_or(f64::INFINITY);
        let h = self.control.h.min(left).min(limit.max(instant(self.state.t))).min(longest);
        if let Some(cause) = self.stuck(h) {
            return Ok(Some(Outcome::Stuck { cause, contact: self.hindered(cause) }));
        }
        if let Some(contact) = self.singular() {
            return self.leave_singular(contact);
        }
        self.field.creep = ROUNDING * self.field.load * h * h;
        let scale = self.control.scale(h, self.push(h), self.rounding(self.control.newton));
        if !self.linear || h > LONGER * self.linearised {
            self.field.linearise(&self.state, h, scale)?;
            (self.linear, self.linearised) = (true, h);
        }
        if !self.attempt(h)? {
            return Ok(self.shorten(0.25 * h));
        }
        let push = self.push(h).max(largest(&self.step.a));
        let scale = self.control.scale(h, push, self.rounding(self.control.estimate));
        let error = self.step.error(&self.state, &self.a0, scale);
        if !self.control.judge(h, error) {
            let shorter = self.control.h;
            return Ok(self.shorten(shorter));
        }
        let growth = self.step.growth();
        if self.control.repels(h, growth) {
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
                Err(Lost::Early(at)) => Ok(self.shorten(SOON * at)),
                Err(Lost::Error(error)) => Err(error),
            },
        }
    }

    /// What is left of the time is as short as events are uncertain: velocities and accelerations stay as they are.
    fn coast(&mut self, left: f64) -> Outcome {
        if left > 0.0 {
            self.state.t = self.options.t_end;
            add(&mut self.state.q, left, &self.state.u);
            add(&mut self.state.u, left, &self.a0);
        }
        Outcome::Finished
    }

    /// Why there is no hope to get on with a step of length `h`, if there is none.
    fn stuck(&mut self, h: f64) -> Option<Cause> {
        if self.state.t + h == self.state.t {
            return Some(Cause::Step);
        }
        let (steps, rejected, t) = self.counted;
        let done = (self.motion.steps - steps, self.motion.rejected_steps - rejected);
        if done.0 + done.1 >= WINDOW {
            self.counted = (self.motion.steps, self.motion.rejected_steps, self.state.t);
            let progress = (self.state.t - t) / self.options.t_end;
            if progress < LEAST_PROGRESS {
                return Some(if done.1 >= TOO_MANY { Cause::Rejections } else { Cause::Step });
            }
            return (done.1 >= TOO_MANY && progress < PROGRESS).then_some(Cause::Rejections);
        }
        let events = &self.motion.events;
        let before = events.len().checked_sub(AT_ONCE + self.memory.len()).map(|k| events[k].time);
        (before == Some(self.state.t)).then_some(Cause::Events)
    }

    /// The contact that is most likely to be the reason: of the last event, or the slowest slip.
    fn hindered(&self, cause: Cause) -> Option<usize> {
        if cause == Cause::Events {
            return self.motion.events.last().and_then(|event| event.contact);
        }
        let slow = |&i: &usize| {
            let touch = &self.field.touches[i];
            norm(&touch.slip) / touch.reference()
        };
        let slips = |&i: &usize| self.field.touches[i].mode == Phase::Slip;
        (0..self.memory.len()).filter(slips).min_by(|a, b| slow(a).total_cmp(&slow(b)))
    }

    /// Tries again with a shorter step.
    pub(crate) fn shorten(&mut self, h: f64) -> Option<Outcome> {
        self.control.h = h;
        (self.linear, self.stale) = (false, true);
        self.motion.rejected_steps += 1;
        None
    }

    /// The largest acceleration that is known to come in a time: at the beginning of a slip from rest there is
    /// none yet.
    fn push(&self, h: f64) -> f64 {
        largest(&self.a0) + h * self.slope.as_deref().map_or(0.0, largest)
    }

    /// A relative error that is aimed at, with what decides whether rounding allows it.
    pub(crate) fn rounding(&self, goal: f64) -> (f64, f64) {
        (goal, self.field.load)
    }

    /// Newton's method from the continued polynomial of the step before, else from constant accelerations.
    fn attempt(&mut self, h: f64) -> Result<bool, FieldError> {
        let newton = self.control.newton;
        let goal = (newton, self.control.scale(h, self.push(h), self.rounding(newton)));
        if self.smooth && h <= 2.0 * self.last.h {
            self.step.guess_from(h, &self.last, self.last.h);
            let points_first = self.last.points.used;
            if self.solve(h, goal, points_first)? {
                return Ok(true);
            }
        }
        self.step.guess_line(h, &self.a0, self.slope.as_deref());
        self.solve(h, goal, false)
    }

    fn solve(
        &mut self,
        h: f64,
        goal: (f64, Scale),
        points_first: bool,
    ) -> Result<bool, FieldError> {
        let how = (&self.sliding[..], points_first);
        self.step.solve_by_any(&mut self.field, &self.state, h, goal, how)
    }
}

//! The loop over steps.

use std::ops::ControlFlow;

use crate::argument::ArgumentError;
use crate::contact::Phase;
use crate::integrator::event::collocation::initial_step;
use crate::integrator::event::dynamics::SlidingForces;
use crate::integrator::event::integration::attempt::StateError;
use crate::integrator::event::integration::detection::Detection;
use crate::integrator::event::integration::location::Location;
use crate::integrator::event::integration::variables::{Ending, Integration};
use crate::integrator::event::motion::Motion;
use crate::integrator::event::options::Options;
use crate::integrator::event::outcome::{Outcome, Stagnation};
use crate::integrator::event::state::{EvaluationError, ROUNDING, shortest_step};
use crate::system::{InitialState, System};
use crate::vectors::{add, largest, norm};

/// Attempts among which the rejected ones are counted, and how many of them are too many.
const WINDOW: usize = 2000;
const TOO_MANY: usize = 800;
/// Share of the whole time in which so many attempts are worth the effort, though many are rejected.
const PROGRESS: f64 = 1e-5;
/// Share of the whole time in which so many attempts are worth the effort, even if all succeed.
const LEAST_PROGRESS: f64 = 1e-10;
/// Share of the whole time that is left out at its end: events are not located better.
const UNRESOLVED_END: f64 = 2e-14;
/// Events at one time that are too many, besides one of each contact.
const SIMULTANEOUS: usize = 50;
/// Length of a step over the time of an event in it, where the one before was far too long to tell that time.
const LENGTH_OVER_EVENT: f64 = 4.0;
/// How much longer steps may become before the Jacobian is computed anew: rounding in it grows with their square.
const LENGTHENING: f64 = 4.0;

/// The numbers of steps at one time, with which those at a later time are compared.
#[derive(Default)]
struct Progress {
    steps: usize,
    rejected_steps: usize,
    t: f64,
}

/// Integrates a system; the motion, and why the integration has ended.
pub(crate) fn run(
    system: &dyn System,
    start: &InitialState,
    options: &Options,
    observer: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<(Motion, Outcome), ArgumentError> {
    let mut integration = Integration::new(system, start, options, observer);
    let outcome = match integration.check_overlap() {
        Ok(checked) => {
            checked?;
            integration.integrate().unwrap_or_else(Outcome::Error)
        }
        Err(error) => Outcome::Error(error),
    };
    Ok((integration.motion, outcome))
}

impl Integration<'_> {
    fn integrate(&mut self) -> Result<Outcome, EvaluationError> {
        let mut outcome = self.initialise()?;
        if self.motion.samples.is_empty() {
            self.record();
        }
        if outcome.is_none() && self.end_of_piece() == self.state.t {
            outcome = self.pass_break()?;
        }
        if outcome.is_none() {
            let longest = self.step_size.first_step_limit(self.options.duration(), &self.a0);
            let longest = longest.min(self.dynamics.chart.turn_limit(&self.state, &self.a0));
            let longest = longest.min(self.end_of_piece() - self.state.t);
            let dynamics = &mut self.dynamics;
            let first = initial_step(dynamics, &self.state, &self.a0, longest)?;
            self.step_size.h = first.max(shortest_step(self.state.t));
            self.stale = true;
        }
        let mut progress = Progress { t: self.state.t, ..Progress::default() };
        loop {
            if let Some(outcome) = outcome {
                if self.motion.samples.t.last() != Some(&self.state.t) {
                    self.record();
                }
                return Ok(outcome);
            }
            outcome = self.advance(&mut progress)?;
            if outcome.is_none() && self.observer.asks_to_stop(self.state.t) {
                outcome = Some(Outcome::Interrupted);
            }
        }
    }

    /// One attempt of a step, and the event in it if there is one.
    fn advance(&mut self, progress: &mut Progress) -> Ending {
        let end = self.end_of_piece();
        let left = end - self.state.t;
        if left <= UNRESOLVED_END * self.options.t_end {
            self.extrapolate_to(end);
            let over = end == self.options.t_end;
            return if over { Ok(Some(Outcome::Finished)) } else { self.pass_break() };
        }
        // Where a slip begins, its first step is made in the chart in which its direction is known.
        if !self.starting && self.dynamics.chart.recentre(&mut self.state, &mut self.a0) {
            (self.smooth, self.linearised, self.stale) = (false, None, true);
        }
        if self.stale {
            let sliding_forces =
                if self.starting { SlidingForces::Kept } else { SlidingForces::Updated };
            self.dynamics.evaluate(self.state.t, &self.state.q, &self.state.u, sliding_forces)?;
            // A stencil that has been narrowed for the end of an attempt must not widen for its start.
            self.dynamics.drift_of_all(&self.state)?;
            self.stale = false;
        }
        self.slowest_slip = self.dynamics.slowest_slip();
        let (h, wanted) = (self.length_of_attempt(left), self.step_size.h);
        if let Some(cause) = self.stagnation(h, progress) {
            return Ok(Some(Outcome::Stagnated { cause, contact: self.blocking_contact(cause) }));
        }
        if let Some(contact) = self.singular_contact() {
            return self.resolve_paradox(contact);
        }
        self.dynamics.creep = ROUNDING * self.dynamics.load * h * h;
        if self.linearised.is_none_or(|length| h > LENGTHENING * length) {
            let scale = self.newton_scale(h, self.largest_acceleration(h));
            self.dynamics.linearise(&self.state, h, scale)?;
            self.linearised = Some(h);
        }
        if !self.attempt_step(h)? {
            return Ok(self.reject(0.25 * h));
        }
        if !self.is_accurate(h) {
            return Ok(self.reject(self.step_size.h));
        }
        match self.detect_events()? {
            Detection::TooLong => Ok(self.reject(0.5 * h)),
            Detection::None if self.dynamics.narrow_stencil(self.step.end(&self.step.u)) => {
                Ok(self.reject(h))
            }
            Detection::None => {
                self.accept_step(if h == left { end } else { self.state.t + h })?;
                if h < wanted {
                    // Not the error has made this step short, but the end of a piece, of a flight or of a slip of one body.
                    self.step_size.h = self.step_size.h.max(wanted);
                }
                self.end_slips()
            }
            Detection::Events(bracket) => match self.locate_event(&bracket) {
                Ok(Location::Found(number)) => self.handle_event(number),
                Ok(Location::Early(at)) => Ok(self.reject(LENGTH_OVER_EVENT * at)),
                Err(StateError::Diverged) => Ok(self.reject(0.5 * h)),
                Err(StateError::Evaluation(error)) => Err(error),
            },
        }
    }

    /// How long the next attempt is, where `left` is what is left of the whole time.
    fn length_of_attempt(&self, left: f64) -> f64 {
        let mut limit = self.step_size.gap_limit(&self.dynamics, &self.state.u, &self.a0);
        if !self.starting {
            limit = limit.min(self.step_size.slip_limit(&self.dynamics, &self.a0));
        }
        limit = limit.min(self.dynamics.chart.turn_limit(&self.state, &self.a0));
        // What ends within less than time resolves is over when the step has been made.
        limit = limit.max(shortest_step(self.state.t));
        let longest = self.options.max_step.unwrap_or(f64::INFINITY);
        self.step_size.h.min(left).min(limit).min(longest)
    }

    /// Whether the error of the attempt and the growth of deviations are small. Sets the length of the next attempt.
    fn is_accurate(&mut self, h: f64) -> bool {
        let acceleration = self.largest_acceleration(h).max(largest(&self.step.a));
        let accuracy = self.accuracy(self.step_size.estimate);
        let scale = self.step_size.scale(h, acceleration, accuracy);
        let error = self.step.error(&self.state, &self.a0, scale);
        if !self.step_size.accepts(h, error) {
            return false;
        }
        let growth = self.step.growth();
        !self.step_size.is_unstable(h, growth)
    }

    /// What is left of the piece is as short as events are uncertain: velocities and accelerations stay as they are.
    fn extrapolate_to(&mut self, end: f64) {
        let left = end - self.state.t;
        if left > 0.0 {
            self.state.t = end;
            add(&mut self.state.q, left, &self.state.u);
            add(&mut self.state.u, left, &self.a0);
        }
    }

    /// Why there is no hope to get on with a step of length `h`, if there is none.
    fn stagnation(&self, h: f64, progress: &mut Progress) -> Option<Stagnation> {
        if self.state.t + h == self.state.t {
            return Some(Stagnation::Step);
        }
        let (steps, rejected_steps, t) =
            (self.motion.steps, self.motion.rejected_steps, self.state.t);
        let rejected = rejected_steps - progress.rejected_steps;
        if steps - progress.steps + rejected >= WINDOW {
            let passed = (t - progress.t) / self.options.duration();
            *progress = Progress { steps, rejected_steps, t };
            if passed < LEAST_PROGRESS {
                let many = rejected >= TOO_MANY;
                return Some(if many { Stagnation::Rejections } else { Stagnation::Step });
            }
            return (rejected >= TOO_MANY && passed < PROGRESS).then_some(Stagnation::Rejections);
        }
        let events = &self.motion.events;
        let earlier = events.len().checked_sub(SIMULTANEOUS + self.memory.len());
        (earlier.map(|k| events[k].time) == Some(t)).then_some(Stagnation::Events)
    }

    /// The contact that is most likely to be the reason: that of the last event, or the slowest slip.
    fn blocking_contact(&self, cause: Stagnation) -> Option<usize> {
        if cause == Stagnation::Events {
            return self.motion.events.last().and_then(|event| event.contact);
        }
        let contacts = &self.dynamics.contacts;
        let slow = |&i: &usize| norm(&contacts[i].slip) / contacts[i].reference_speed();
        let slips = |&i: &usize| contacts[i].mode == Phase::Slip;
        (0..self.memory.len()).filter(slips).min_by(|a, b| slow(a).total_cmp(&slow(b)))
    }
}

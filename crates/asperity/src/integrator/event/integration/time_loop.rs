//! Steps one after another: what comes next, and going on to it.

use crate::contact::Phase;
use crate::integrator::event::collocation::initial_step;
use crate::integrator::event::dynamics::SlidingForces;
use crate::integrator::event::integration::attempt::StateError;
use crate::integrator::event::integration::detection::Detection;
use crate::integrator::event::integration::location::Location;
use crate::integrator::event::integration::variables::{Ending, Integration, Next, Progress};
use crate::integrator::event::outcome::{Outcome, Stagnation};
use crate::integrator::event::resolution::{ROUNDING, UNRESOLVED_TIME, shortest_step};
use crate::integrator::event::state::EvaluationError;
use crate::vectors::{add, largest, norm};

/// Attempts among which the rejected ones are counted, and how many of them are too many.
const WINDOW: usize = 2000;
const TOO_MANY: usize = 800;
/// Share of the whole time in which so many attempts are worth the effort, though many are rejected.
const PROGRESS: f64 = 1e-5;
/// Share of the whole time in which so many attempts are worth the effort, even if all succeed.
const LEAST_PROGRESS: f64 = 1e-10;
/// Events at one time that are too many, besides one of each contact.
const SIMULTANEOUS: usize = 50;
/// Length of a step over the time of an event in it, where the one before was far too long to tell that time.
const LENGTH_OVER_EVENT: f64 = 4.0;
/// How much longer steps may become before the Jacobian is computed anew: rounding in it grows with their square.
const LENGTHENING: f64 = 4.0;
/// Estimate of the error, over the tolerance, where slips pass directions in which *D* is not smooth, such as the axes of
/// superellipses: the method is of no higher order than its estimate there, and some errors add up.
const OF_LOW_ORDER: f64 = 0.5;

impl Integration<'_> {
    /// Begins the motion, and chooses the length of the first step.
    pub(crate) fn begin(&mut self) -> Ending {
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
        self.progress.t = self.state.t;
        Ok(outcome)
    }

    /// Finds out what comes next.
    pub(crate) fn look_ahead(&mut self) -> Result<(), EvaluationError> {
        if self.next.is_some() {
            return Ok(());
        }
        self.stale |= self.interpolated;
        (self.interpolated, self.is_dense) = (false, false);
        self.next = self.ending.take();
        while self.next.is_none() {
            self.next = if self.observer.asks_to_stop(self.state.t) {
                Some(Next::Ended(Outcome::Interrupted))
            } else {
                self.attempt()?
            };
        }
        Ok(())
    }

    /// The time of what comes next.
    pub(crate) fn time_of_next(&self) -> f64 {
        match &self.next {
            Some(Next::Step(end) | Next::EndOfPiece(end)) => *end,
            Some(Next::Event(event)) => self.state.t + event.at,
            Some(Next::EndOfSlips { after, .. }) => self.state.t + after,
            _ => self.state.t,
        }
    }

    /// Whether all that is left is the end of the motion.
    pub(crate) fn is_over(&self) -> bool {
        matches!(self.next, Some(Next::EndOfPiece(end)) if end == self.options.t_end)
    }

    /// Goes on to what comes next.
    pub(crate) fn go_on(&mut self) -> Ending {
        let Some(next) = self.next.take() else { return Ok(None) };
        // Samples have left the dynamics elsewhere.
        self.stale |= self.interpolated;
        match next {
            Next::Ended(outcome) => Ok(Some(outcome)),
            Next::EndOfPiece(end) => {
                self.extrapolate_to(end);
                if end == self.options.t_end {
                    return Ok(Some(Outcome::Finished));
                }
                self.pass_break()
            }
            Next::Paradox(contact) => {
                if self.interpolated {
                    self.evaluate_at_start()?;
                }
                self.resolve_paradox(contact)
            }
            Next::Step(end) => {
                let (h, wanted) = (self.step.h, self.wanted);
                self.accept_step(end)?;
                if h < wanted {
                    // Not the error has made this step short, but the end of a piece, of a flight or of a slip of one body.
                    self.step_size.h = self.step_size.h.max(wanted);
                }
                self.ending = self.ending_slips();
                Ok(None)
            }
            Next::EndOfSlips { contacts, after } => self.end_slips(&contacts, after),
            Next::Event(event) => {
                let number = event.number;
                match self.take_event(event) {
                    Ok(()) => self.handle_event(number),
                    Err(StateError::Diverged) => Ok(self.reject(0.5 * self.step.h)),
                    Err(StateError::Evaluation(error)) => Err(error),
                }
            }
        }
    }

    /// Evaluates the dynamics at the present state, where an attempt or samples have left them elsewhere.
    pub(crate) fn evaluate_at_start(&mut self) -> Result<(), EvaluationError> {
        let forces = if self.starting { SlidingForces::Kept } else { SlidingForces::Updated };
        self.dynamics.evaluate(self.state.t, &self.state.q, &self.state.u, forces)?;
        // A stencil that has been narrowed for the end of an attempt must not widen for its start.
        self.dynamics.drift_of_all(&self.state)
    }

    /// One attempt of a step, and what it leads to unless it is rejected.
    fn attempt(&mut self) -> Result<Option<Next>, EvaluationError> {
        let end = self.end_of_piece();
        let left = end - self.state.t;
        if left <= UNRESOLVED_TIME * self.options.t_end {
            return Ok(Some(Next::EndOfPiece(end)));
        }
        // Where a slip begins, its first step is made in the chart in which its direction is known.
        if !self.starting && self.dynamics.chart.recentre(&mut self.state, &mut self.a0) {
            (self.smooth, self.linearised, self.stale) = (false, None, true);
        }
        if self.stale {
            self.evaluate_at_start()?;
            self.stale = false;
        }
        self.slowest_slip = self.dynamics.slowest_slip();
        let h = self.length_of_attempt(left);
        self.wanted = self.step_size.h;
        if let Some(cause) = self.stagnation(h) {
            let contact = self.blocking_contact(cause);
            return Ok(Some(Next::Ended(Outcome::Stagnated { cause, contact })));
        }
        if let Some(contact) = self.singular_contact() {
            return Ok(Some(Next::Paradox(contact)));
        }
        self.dynamics.creep = ROUNDING * self.dynamics.load * h * h;
        if self.linearised.is_none_or(|length| h > LENGTHENING * length) {
            let scale = self.newton_scale(h, self.largest_acceleration(h));
            self.dynamics.linearise(&self.state, h, scale)?;
            self.linearised = Some(h);
        }
        let shorter = if !self.attempt_step(h)? {
            0.25 * h
        } else if !self.is_accurate(h) {
            self.step_size.h
        } else {
            match self.detect_events()? {
                Detection::TooLong => 0.5 * h,
                Detection::None if self.dynamics.narrow_stencil(self.step.end(&self.step.u)) => h,
                Detection::None => {
                    return Ok(Some(Next::Step(if h == left { end } else { self.state.t + h })));
                }
                Detection::Events(bracket) => match self.locate_event(&bracket) {
                    Ok(Location::Found(event)) => return Ok(Some(Next::Event(event))),
                    Ok(Location::Early(at)) => LENGTH_OVER_EVENT * at,
                    Err(StateError::Diverged) => 0.5 * h,
                    Err(StateError::Evaluation(error)) => return Err(error),
                },
            }
        };
        self.reject(shorter);
        Ok(None)
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
        let contacts = self.dynamics.contacts.iter().enumerate();
        let mut slipping = contacts.filter(|(_, contact)| contact.mode == Phase::Slip);
        let smooth = slipping.all(|(i, _)| self.dynamics.law(i).is_smooth());
        let estimate = self.step_size.estimate;
        let goal =
            if smooth { estimate } else { estimate.min(OF_LOW_ORDER * self.options.tolerance) };
        let accuracy = self.accuracy(goal);
        let scale = self.step_size.scale(h, acceleration, accuracy);
        let error = self.step.error(&self.state, &self.a0, scale);
        if !self.step_size.accepts(h, error / goal) {
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
    fn stagnation(&mut self, h: f64) -> Option<Stagnation> {
        let progress = &mut self.progress;
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

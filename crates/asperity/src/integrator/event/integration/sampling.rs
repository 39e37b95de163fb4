//! What is kept of the motion.

use crate::integrator::event::collocation::PLACES;
use crate::integrator::event::contact_problem::{Solving, redundancy};
use crate::integrator::event::dynamics::SlidingForces;
use crate::integrator::event::integration::attempt::StateError;
use crate::integrator::event::integration::variables::{Integration, Located, Next};
use crate::integrator::event::state::{EvaluationError, State};

/// Samples between two readings of the clock.
const RARELY: usize = 256;

impl Integration<'_> {
    /// Samples between the present state and `t`, a time inside the attempt; whether there were any.
    pub(crate) fn sample_before(&mut self, t: f64) -> Result<bool, EvaluationError> {
        self.sample(t, t - self.state.t, false, Self::goes_on)
    }

    /// Samples between the present state and `t`, the end of the attempt; whether there were any.
    pub(crate) fn sample_attempt(&mut self, t: f64) -> Result<bool, EvaluationError> {
        self.sample(t, self.step.h, true, Self::goes_on)
    }

    /// Whether nobody has asked to stop.
    fn goes_on(&self) -> bool {
        !self.observer.has_asked_to_stop()
    }

    /// Keeps the end of a step where all of them are kept, or where a sample is due.
    pub(crate) fn sample_end(&mut self) {
        let due = self.options.sample.map(|dt| self.options.t_start + self.samples as f64 * dt);
        if due.is_none_or(|due| due == self.state.t) {
            self.record();
            self.samples += 1;
        }
    }

    fn sample(
        &mut self,
        t: f64,
        h: f64,
        whole: bool,
        goes_on: fn(&Self) -> bool,
    ) -> Result<bool, EvaluationError> {
        let Some(dt) = self.options.sample else { return Ok(false) };
        // The end of the run is a sample of its own.
        let start = self.options.t_start;
        let time = |k: usize| start + k as f64 * dt;
        let due = |k: usize| time(k) < t;
        if !due(self.samples) {
            return Ok(false);
        }
        self.interpolate(h, whole)?;
        while due(self.samples) && goes_on(self) {
            self.dense_output.at(time(self.samples), &mut self.sampled);
            self.record_sampled()?;
            self.samples += 1;
            if self.samples.is_multiple_of(RARELY) {
                self.observer.asks_to_stop(self.state.t);
            }
        }
        Ok(true)
    }

    /// Keeps the samples that are due before a time of another part of the system, not after what comes next, and one there.
    pub(crate) fn end_beside(&mut self, t: f64) -> Result<(), EvaluationError> {
        // They are as many as the other part has made, also where it was asked to stop.
        let always = |_: &Self| true;
        let sampled = match self.next {
            Some(Next::Step(_)) => self.sample(t, self.step.h, true, always)?,
            Some(Next::Event(Located { at, .. })) if at > 0.0 => {
                self.sample(t, at, false, always)?
            }
            _ => false,
        };
        self.interpolated |= sampled;
        self.is_dense |= sampled;
        if self.motion.samples.t.last() == Some(&t) { Ok(()) } else { self.sample_beside(t) }
    }

    /// Keeps the state at a time of another part of the system, not after what comes next.
    pub(crate) fn sample_beside(&mut self, t: f64) -> Result<(), EvaluationError> {
        if self.motion.samples.t.last() == Some(&t) {
            let last = self.motion.samples.len() - 1;
            self.motion.samples.repeat(last);
            return Ok(());
        }
        let contacts = self.dynamics.contacts.clone();
        let within = match &self.next {
            Some(Next::Step(_)) => Some((self.step.h, true)),
            Some(Next::Event(Located { at, .. })) if *at > 0.0 => Some((*at, false)),
            _ => None,
        };
        if let Some((h, whole)) = within.filter(|_| t > self.state.t) {
            if !std::mem::replace(&mut self.is_dense, true) {
                self.interpolate(h, whole)?;
            }
            self.dense_output.at(t, &mut self.sampled);
        } else {
            self.sampled.extrapolate(&self.state, &self.a0, t - self.state.t);
        }
        self.interpolated = true;
        self.record_sampled()?;
        self.dynamics.contacts = contacts;
        Ok(())
    }

    /// Keeps the state that has been interpolated.
    fn record_sampled(&mut self) -> Result<(), EvaluationError> {
        // Between the ends of steps constraints hold to the tolerance only.
        self.dynamics.project(&mut self.sampled)?;
        let State { t, q, u } = &self.sampled;
        let solving = Solving { memory: &self.memory, observer: self.observer, t: *t };
        redundancy::evaluate(&mut self.dynamics, q, u, SlidingForces::Updated, &solving)?;
        self.motion.record(&mut self.dynamics, &self.sampled);
        Ok(())
    }

    /// The motion over the first `h` of the attempt, or over the `whole` of it.
    fn interpolate(&mut self, h: f64, whole: bool) -> Result<(), EvaluationError> {
        self.dense_output.begin(&self.state, h, &self.a0);
        for k in 1..PLACES {
            if whole && k + 1 == PLACES {
                self.dense_output.set(k, &self.state, &self.step);
                break;
            }
            let part = h * k as f64 / (PLACES - 1) as f64;
            match self.solve_to(part) {
                Ok(()) => {}
                // The polynomial of the attempt is what is left.
                Err(StateError::Diverged) => {
                    self.probe.guess_from(part, &self.step, 0.0);
                    self.probe.stages(&self.state);
                }
                Err(StateError::Evaluation(error)) => return Err(error),
            }
            self.dense_output.set(k, &self.state, &self.probe);
        }
        self.dense_output.finish();
        Ok(())
    }
}

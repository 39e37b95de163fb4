//! What happens along a step: alarms at its stages, the time of the first one, samples.

use crate::contact::Phase;
use crate::integrator::event::collocation::step::{STAGES, Tableau};
use crate::integrator::event::collocation::step_size;
use crate::integrator::event::dynamics::contact_variables::{FieldError, STILL, Touch, instant};
use crate::integrator::event::dynamics::largest;
use crate::integrator::event::event_function::between_stages;
use crate::integrator::event::event_function::{self, alarm};
use crate::integrator::event::integration::time_loop::Runner;
use crate::integrator::event::integration::transition::closed;

/// Share of the first step in which events are not located: to rounding of its length is not to rounding of their
/// time. Later steps are not so much longer than those before.
const EARLY: f64 = 1e-2;
/// Most times that the first step is shortened for such an event: one whose time falls with the step goes off at once.
const MOST_SHORTENED: u8 = 5;

/// What the stages of a step show.
pub(crate) enum Watch {
    Quiet,
    /// A resistance has passed through zero.
    Singular,
    /// Something happens.
    Alarms(Alarms),
}

/// Alarms that go off between two times from the start of a step.
pub(crate) struct Alarms {
    low: f64,
    high: f64,
    /// Numbers of contacts, or the number of contacts for the section, and the values at both times.
    fired: Vec<(usize, f64, f64)>,
}

/// A step to another time that has not been found, or an error.
pub(crate) enum Lost {
    Diverged,
    /// An event so early in the step, at this time from its start, that the step does not tell the time well.
    Early(f64),
    Error(FieldError),
}

impl From<FieldError> for Lost {
    fn from(error: FieldError) -> Self {
        Self::Error(error)
    }
}

impl Runner<'_> {
    /// The value of an alarm where the field has been evaluated.
    fn value(&self, which: usize, q: &[f64], u: &[f64]) -> f64 {
        match &self.options.section {
            Some(section) if which == self.memory.len() => section.height(q, u),
            _ if which == self.memory.len() => -1.0,
            _ => alarm(&self.field, which),
        }
    }

    /// Alarms at the present state, at which the field has been evaluated. What has just been decided on is
    /// quiet. `jumped` says whether velocities may have jumped, over the section too.
    pub(crate) fn quiet(&mut self, jumped: bool) {
        for which in 0..self.memory.len() {
            self.alarms[which] = self.value(which, &self.state.q, &self.state.u).min(0.0);
        }
        if let Some(section) = &self.options.section {
            let (q, u) = (&self.state.q, &self.state.u);
            let height = section.height(q, u);
            let on = height.abs() <= STILL * section.size(q, u);
            let last = &mut self.alarms[self.memory.len()];
            *last = match *last < 0.0 {
                // Arrives from below, or has got above: the next step crosses it at its start.
                true if on || (jumped && self.state.t > section.after) => {
                    height.min(-f64::MIN_POSITIVE)
                }
                // Starts on it: does not cross it there.
                false if on => 0.0,
                _ => height,
            };
        }
    }

    /// Alarms at the stages and between them; without one the field is left at the end of the step.
    pub(crate) fn watch(&mut self) -> Result<Watch, FieldError> {
        let n = self.field.n;
        for (seen, alarm) in self.seen.iter_mut().zip(&self.alarms) {
            seen[0] = *alarm;
        }
        for (stage, c) in Tableau::radau().c.iter().enumerate() {
            let own = stage * n..(stage + 1) * n;
            let high = c * self.step.h;
            self.evaluate_stage(stage)?;
            let singular = |t: &Touch| t.mode == Phase::Slip && t.resistance <= 0.0;
            if self.field.touches.iter().any(singular) {
                return Ok(Watch::Singular);
            }
            let mut fired = Vec::new();
            for which in 0..self.seen.len() {
                let (q, u) = (&self.step.q[own.clone()], &self.step.u[own.clone()]);
                let (low, value) = (self.seen[which][stage], self.value(which, q, u));
                self.seen[which][stage + 1] = value;
                if self.goes_off(which, low, value, self.state.t + high) {
                    fired.push((which, low, value));
                }
            }
            if (!fired.is_empty() || stage + 1 == STAGES)
                && let Some(hidden) = self.between(stage + 1)?
            {
                return Ok(Watch::Alarms(hidden));
            }
            if !fired.is_empty() {
                let low =
                    if stage == 0 { 0.0 } else { Tableau::radau().c[stage - 1] * self.step.h };
                return Ok(Watch::Alarms(Alarms { low, high, fired }));
            }
        }
        Ok(Watch::Quiet)
    }

    /// The field at a stage of the attempt.
    fn evaluate_stage(&mut self, stage: usize) -> Result<(), FieldError> {
        let (n, t) = (self.field.n, self.state.t + Tableau::radau().c[stage] * self.step.h);
        let own = stage * n..(stage + 1) * n;
        self.step.points.hold(&mut self.field, stage);
        let step = std::mem::take(&mut self.step);
        let evaluated = self.evaluate((t, &step.q[own.clone()], &step.u[own]), false);
        self.step = step;
        self.field.held.clear();
        evaluated
    }

    /// Whether something happens between two values of an alarm, the later one at `t`. A section is crossed
    /// upwards; what lies above it from the start does not count.
    fn goes_off(&self, which: usize, low: f64, value: f64, t: f64) -> bool {
        if which < self.memory.len() {
            return value > 0.0;
        }
        let after = self.options.section.as_ref().is_some_and(|section| t > section.after);
        value >= 0.0 && low < 0.0 && after
    }

    /// The first alarm that goes off and is quiet again between two of the first stages.
    fn between(&mut self, stages: usize) -> Result<Option<Alarms>, FieldError> {
        let mut first: Option<(f64, usize)> = None;
        for seen in &self.seen {
            if let Some((node, x)) = between_stages::hidden(&seen[..=stages])
                && first.is_none_or(|(earliest, ..)| x < earliest)
            {
                first = Some((x, node));
            }
        }
        let Some((x, node)) = first else { return Ok(None) };
        let high = x * self.step.h;
        match self.look(high) {
            Ok(()) => {
                let (q, u) = (self.probe.end(&self.probe.q), self.probe.end(&self.probe.u));
                let values = (0..self.seen.len())
                    .map(|which| (which, self.seen[which][node], self.value(which, q, u)));
                let goes_off = |&(which, low, value): &(usize, f64, f64)| {
                    self.goes_off(which, low, value, self.state.t + high)
                };
                let fired: Vec<_> = values.filter(goes_off).collect();
                if !fired.is_empty() {
                    let low =
                        if node == 0 { 0.0 } else { Tableau::radau().c[node - 1] * self.step.h };
                    return Ok(Some(Alarms { low, high, fired }));
                }
            }
            Err(Lost::Diverged | Lost::Early(_)) => {}
            Err(Lost::Error(error)) => return Err(error),
        }
        self.evaluate_stage(STAGES - 1)?;
        Ok(None)
    }

    /// Goes to the first of the alarms; its number.
    pub(crate) fn locate(&mut self, alarms: &Alarms) -> Result<usize, Lost> {
        let width = (1e-14 * alarms.high).max(2.0 * f64::EPSILON * self.state.t);
        let mut first = (alarms.high, alarms.fired[0].0);
        for (k, &(which, f_low, f_high)) in alarms.fired.iter().enumerate() {
            let at = event_function::zero(
                (alarms.low, f_low.min(0.0)),
                (alarms.high, f_high),
                width,
                |h| {
                    self.look(h)?;
                    let (q, u) = (self.probe.end(&self.probe.q), self.probe.end(&self.probe.u));
                    Ok::<f64, Lost>(self.value(which, q, u))
                },
            )?;
            if k == 0 || at < first.0 {
                first = (at, which);
            }
        }
        let (h, which) = first;
        let early = self.motion.steps == 0 && h < EARLY * self.step.h && !self.at_once(which);
        if early && self.shortened < MOST_SHORTENED {
            self.shortened += 1;
            return Err(Lost::Early(h));
        }
        self.sample(self.state.t + h, false)?;
        self.look(h)?;
        self.go_to(self.state.t + h, false)?;
        self.smooth = false;
        self.starting &= h == 0.0;
        self.quiet(false);
        if self.options.sample.is_none() && h > 0.0 {
            self.record()?;
        }
        Ok(which)
    }

    /// Whether an alarm is at its limit at the present state already, so that it goes off at once.
    fn at_once(&self, which: usize) -> bool {
        let limit = match self.field.touches.get(which) {
            Some(touch) if touch.mode == Phase::Open => closed(touch),
            _ => 0.0,
        };
        self.alarms[which] >= -limit
    }

    /// The step from the present state to another time of the present attempt, with the full order; the field
    /// is evaluated there.
    pub(crate) fn look(&mut self, h: f64) -> Result<(), Lost> {
        let newton = self.control.newton;
        let push = largest(&self.step.a);
        let goal = (newton, self.control.scale(self.step.h, push, self.rounding(newton)));
        self.probe.guess_from(h, &self.step, 0.0);
        let how = (&self.sliding[..], self.step.points.used);
        if !self.probe.solve_by_any(&mut self.field, &self.state, h, goal, how)? {
            return Err(Lost::Diverged);
        }
        self.probe.points.hold(&mut self.field, STAGES - 1);
        let probe = std::mem::take(&mut self.probe);
        let (q, u) = (probe.end(&probe.q), probe.end(&probe.u));
        let evaluated = self.evaluate((self.state.t + h, q, u), h == 0.0 && self.starting);
        self.probe = probe;
        self.field.held.clear();
        Ok(evaluated?)
    }

    /// Takes the end of the attempt, or of the last look, as the present state.
    fn go_to(&mut self, t: f64, attempt: bool) -> Result<(), FieldError> {
        let step = if attempt { &self.step } else { &self.probe };
        let (h, unstable) = (step.h, step.unstable);
        self.state.t = t;
        self.state.q.copy_from_slice(step.end(&step.q));
        self.state.u.copy_from_slice(step.end(&step.u));
        self.a0.copy_from_slice(&self.field.acceleration);
        self.keep_sliding();
        self.slope = None;
        self.control.see(&mut self.field, &self.state.q, &self.state.u, h);
        if h > 0.0 {
            self.motion.steps += 1;
            self.control.made(&self.field, h, unstable);
        }
        self.field.survey(&self.state)
    }

    /// Keeps the sliding forces of the present state, at which the field has been evaluated.
    pub(crate) fn keep_sliding(&mut self) {
        for (kept, touch) in self.sliding.iter_mut().zip(&self.field.touches) {
            *kept = touch.sliding;
        }
    }

    /// Takes the attempt, which ends at `t`.
    pub(crate) fn accept(&mut self, t: f64) -> Result<(), FieldError> {
        if self.sample(t, true)? {
            self.evaluate_stage(STAGES - 1)?;
        }
        self.go_to(t, true)?;
        self.field.project(&mut self.state)?;
        std::mem::swap(&mut self.step, &mut self.last);
        (self.smooth, self.starting) = (true, false);
        self.linear = self.field.constant;
        self.quiet(false);
        if self.options.sample.is_none() {
            self.record()?;
        }
        Ok(())
    }

    /// Contacts whose slip has come to an end.
    pub(crate) fn arrived(&self) -> Vec<usize> {
        let ends = |&i: &usize| {
            let touch = &self.field.touches[i];
            let speed = crate::integrator::event::dynamics::sliding_force::norm(&touch.slip);
            if touch.mode != Phase::Slip || speed == 0.0 {
                return touch.mode == Phase::Slip;
            }
            let rate = step_size::slip_rate(&self.field, i, &self.a0);
            rate < 0.0
                && speed <= f64::max(STILL * touch.reference(), -rate * instant(self.state.t))
        };
        (0..self.memory.len()).filter(ends).collect()
    }
}

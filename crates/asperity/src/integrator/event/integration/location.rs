//! Location of events: the time at which the first event function becomes positive.

use crate::contact::Phase;
use crate::integrator::event::contact_problem::{Solving, redundancy};
use crate::integrator::event::dynamics::{ContactVariables, ROWS};
use crate::integrator::event::event_function::root::{self, Value};
use crate::integrator::event::event_function::rounded_excess;
use crate::integrator::event::integration::attempt::StateError;
use crate::integrator::event::integration::detection::Bracket;
use crate::integrator::event::integration::variables::{Integration, Located};
use crate::integrator::event::resolution::{NOTHING, UNRESOLVED_TIME};
use crate::integrator::event::state::EvaluationError;

/// Share of the first step in which events are not located: rounding of its length would be large beside their time.
const EARLY_EVENT: f64 = 1e-2;
/// Relative distance of forces before an event: far above rounding of its time, and small beside changes in a step.
const SHORTLY: f64 = 1e-6;
/// Most times that the first step is shortened for such an event. One whose time falls with the step happens at once.
const MOST_SHORTENED: u8 = 5;

/// What became of an event that was to be located.
pub(crate) enum Location {
    Found(Located),
    /// It is so early in the step, at this time from its start, that the step does not tell the time well.
    Early(f64),
}

/// Where an event function becomes positive.
struct Crossing {
    /// Time from the start of the step.
    at: f64,
    /// The value that was found last.
    value: f64,
    /// Where all steps are kept, the contacts with the last forces before it that all of them could carry, if any were found.
    carried: Vec<ContactVariables>,
}

impl Integration<'_> {
    /// Finds the first of the events.
    pub(crate) fn locate_event(&mut self, bracket: &Bracket) -> Result<Location, StateError> {
        let width = (1e-14 * bracket.high).max(2.0 * f64::EPSILON * self.state.t);
        let mut first: Option<(usize, Crossing)> = None;
        for function in &bracket.triggered {
            let number = function.number;
            let low = Value { value: function.low.value.min(0.0), ..function.low };
            let high = Value { at: bracket.high, value: function.high };
            let mut crossing = self.crossing(number, low, high, width)?;
            // At the low end the function was not yet positive in the whole step. A step that ends there may say that it is: the
            // end of a stick whose forces several contacts share, where the function jumps, was then before.
            let Crossing { at, value, .. } = crossing;
            let late = low.at > 0.0 && at - low.at <= 2.0 * width && value > 0.0;
            if late && self.sticks_within_limit(number) {
                let start = Value { at: 0.0, value: self.event_values[number] };
                match self.crossing(number, start, Value { at, value }, width) {
                    Ok(earlier) => crossing = earlier,
                    Err(StateError::Diverged) => {}
                    Err(error) => return Err(error),
                }
            }
            if first.as_ref().is_none_or(|(_, first)| crossing.at < first.at) {
                first = Some((number, crossing));
            }
        }
        let Some((number, Crossing { at, carried, .. })) = first else {
            return Err(StateError::Diverged);
        };
        let early =
            self.motion.steps == 0 && at < EARLY_EVENT * self.step.h && !self.is_at_limit(number);
        if early && self.shortened < MOST_SHORTENED {
            self.shortened += 1;
            return Ok(Location::Early(at));
        }
        // Whether the state at the event is found.
        self.solve_to(at)?;
        let at = self.at_zero_gap(number, at)?;
        Ok(Location::Found(Located { number, at, width, carried }))
    }

    /// The time at which the gap itself closes, of an impact at `at`, to which the step has been made. Detection allows an
    /// overlap that rounding explains: a body that rocks to rest would get back in every impact what it is worth. Flights of
    /// which the overlap is most are rounding themselves.
    fn at_zero_gap(&mut self, number: usize, at: f64) -> Result<f64, StateError> {
        let free = self.dynamics.contacts.get(number).filter(|contact| contact.is_free());
        let Some(overlap) = free.map(|contact| -contact.gap) else { return Ok(at) };
        let approach = -self.dynamics.velocity(ROWS * number, self.probe.end(&self.probe.u));
        let late = overlap / approach;
        if overlap > 0.0 && late > UNRESOLVED_TIME * self.options.t_end && late < 0.5 * at {
            self.solve_to(at - late)?;
            return Ok(at - late);
        }
        Ok(at)
    }

    /// Goes to an event.
    pub(crate) fn take_event(
        &mut self,
        Located { at: h, width, carried, .. }: Located,
    ) -> Result<(), StateError> {
        let recorded = self.options.sample.is_none() && h > 0.0;
        if self.sample_before(self.state.t + h)? || self.interpolated {
            self.solve_to(h)?;
        }
        let mut before = Vec::new();
        if recorded && self.dynamics.is_indeterminate() {
            let shortly_before = self.solve_to(h * (1.0 - SHORTLY));
            // A body may be jammed or slide, both being solutions: evaluations may find either.
            if shortly_before.is_ok() && redundancy::can_carry(&self.dynamics) {
                before.clone_from(&self.dynamics.contacts);
            } else if !carried.is_empty() {
                before = carried;
            } else if h <= 2.0 * width {
                // It was let go at the start of the step, whose sample was the last.
                before.clone_from(&self.dynamics.contacts);
                self.motion.take_last_forces(&mut before);
            }
            match shortly_before {
                // What is recorded must not decide on the motion.
                Ok(()) | Err(StateError::Diverged) => {}
                Err(error) => return Err(error),
            }
            self.solve_to(h)?;
        }
        self.take_end(self.state.t + h, false)?;
        self.smooth = false;
        self.starting &= h == 0.0;
        self.reset_event_functions(false);
        if recorded {
            self.record_event_state(&before)?;
        }
        Ok(())
    }

    /// Keeps the state at the event, with forces that the contacts can carry; `before` are the last ones, if any.
    fn record_event_state(&mut self, before: &[ContactVariables]) -> Result<(), EvaluationError> {
        let contacts = self.dynamics.contacts.clone();
        let solving = Solving { memory: &self.memory, observer: self.observer, t: self.state.t };
        redundancy::share_at_event(&mut self.dynamics, &self.state, before, &solving)?;
        self.record();
        self.dynamics.contacts = contacts;
        Ok(())
    }

    /// Where an event function becomes positive between two times in the step.
    fn crossing(
        &mut self,
        number: usize,
        low: Value,
        high: Value,
        width: f64,
    ) -> Result<Crossing, StateError> {
        let keeps_all = self.options.sample.is_none();
        let (mut last, mut carried) = (high.value, Vec::new());
        let at = root::zero(low, high, width, |h| {
            last = self.event_function_at(number, h)?;
            if keeps_all && last <= 0.0 && redundancy::can_carry(&self.dynamics) {
                carried.clone_from(&self.dynamics.contacts);
            }
            Ok::<f64, StateError>(last)
        })?;
        Ok(Crossing { at, value: last, carried })
    }

    /// The event function of a contact, or of the section, at the end of a step of this length.
    fn event_function_at(&mut self, number: usize, h: f64) -> Result<f64, StateError> {
        self.solve_to(h)?;
        let (q, u) = (self.probe.end(&self.probe.q), self.probe.end(&self.probe.u));
        Ok(self.event_function(number, q, u))
    }

    /// Whether this is the number of a contact that sticks and is not yet at its limit at the present state.
    fn sticks_within_limit(&self, number: usize) -> bool {
        let contact = self.dynamics.contacts.get(number);
        contact.is_some_and(|contact| contact.mode == Phase::Stick) && !self.is_at_limit(number)
    }

    /// Whether an event function is at its limit at the present state already but for rounding, so that its event is there.
    ///
    /// A body that starts at rest on a belt where it would slide steadily loads its contact with just what friction can hold.
    /// Rounding puts this load a little inside of the reservoir as often as a little outside, and in a step as short as the
    /// time until it leaves, it would not leave by enough to tell slip from rest.
    fn is_at_limit(&self, number: usize) -> bool {
        let limit = match self.dynamics.contacts.get(number) {
            Some(contact) if contact.mode == Phase::Open => closed_gap(contact),
            Some(contact) if contact.mode == Phase::Stick => rounded_excess(&self.dynamics),
            _ => 0.0,
        };
        self.event_values[number] >= -limit
    }
}

/// The gap at which a contact counts as closed at the beginning.
pub(crate) fn closed_gap(contact: &ContactVariables) -> f64 {
    NOTHING * contact.reach
}

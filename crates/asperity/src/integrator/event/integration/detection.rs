//! Detection of events along a step: event functions that become positive.

use crate::contact::Phase;
use crate::integrator::event::collocation::{STAGES, Tableau};
use crate::integrator::event::dynamics::ContactVariables;
use crate::integrator::event::event_function::NODES;
use crate::integrator::event::event_function::between_stages::{self, POINTS};
use crate::integrator::event::event_function::root::Value;
use crate::integrator::event::integration::attempt::StateError;
use crate::integrator::event::integration::variables::Integration;
use crate::integrator::event::state::EvaluationError;

/// What the stages of a step show.
pub(crate) enum Detection {
    /// No event.
    None,
    /// The step is too long: the resistance of a slipping contact has passed through zero, or gaps swing too often.
    TooLong,
    /// Event functions that have become positive.
    Events(Bracket),
}

/// Event functions that have become positive at a time from the start of a step.
pub(crate) struct Bracket {
    pub(crate) high: f64,
    pub(crate) triggered: Vec<Triggered>,
}

/// An event function that has become positive.
pub(crate) struct Triggered {
    /// Number of the contact, the number of contacts for the section, or one more than that and the contact for its borders.
    pub(crate) number: usize,
    /// When it was not yet positive, and what it is now.
    pub(crate) low: Value,
    pub(crate) high: f64,
}

impl Integration<'_> {
    /// Event functions at the stages and between them. Without an event the dynamics are left at the end of the step.
    pub(crate) fn detect_events(&mut self) -> Result<Detection, EvaluationError> {
        let n = self.dynamics.n;
        for (values, start) in self.stage_values.iter_mut().zip(&self.event_values) {
            values[0] = *start;
        }
        for (stage, c) in Tableau::radau().c.iter().enumerate() {
            let own = stage * n..(stage + 1) * n;
            let high = c * self.step.h;
            self.evaluate_stage(stage)?;
            for (places, contact) in self.stage_places.iter_mut().zip(&self.dynamics.contacts) {
                places[stage + 1] = contact.place;
            }
            let singular = |c: &ContactVariables| c.mode == Phase::Slip && c.resistance <= 0.0;
            if self.dynamics.contacts.iter().any(singular) {
                return Ok(Detection::TooLong);
            }
            let mut triggered = Vec::new();
            for number in 0..self.stage_values.len() {
                let (q, u) = (&self.step.q[own.clone()], &self.step.u[own.clone()]);
                let value = self.event_function(number, q, u);
                self.stage_values[number][stage + 1] = value;
                let function = self.function_since(number, stage, value);
                if self.is_event(&function, self.state.t + high) {
                    triggered.push(function);
                }
            }
            if !triggered.is_empty() || stage + 1 == STAGES {
                match self.event_between_stages(stage + 1)? {
                    Detection::None => {}
                    found => return Ok(found),
                }
            }
            if !triggered.is_empty() {
                return Ok(Detection::Events(Bracket { high, triggered }));
            }
        }
        Ok(Detection::None)
    }

    /// The time of the start, or of the stage before the `node`-th, from the start.
    pub(crate) fn time_of_node(&self, node: usize) -> f64 {
        if node == 0 { 0.0 } else { Tableau::radau().c[node - 1] * self.step.h }
    }

    /// An event function with its value at a node and a later one.
    fn function_since(&self, number: usize, node: usize, high: f64) -> Triggered {
        let value = self.stage_values[number][node];
        Triggered { number, low: Value { at: self.time_of_node(node), value }, high }
    }

    /// Whether there is an event between two values of an event function, the later one at `t`; a section is crossed upwards.
    fn is_event(&self, &Triggered { number, low, high }: &Triggered, t: f64) -> bool {
        if number != self.memory.len() {
            return high > 0.0;
        }
        let after = self.options.section.as_ref().is_some_and(|section| t > section.after);
        high >= 0.0 && low.value < 0.0 && after
    }

    /// Times in the attempt at which contacts are outside of the region of friction in which they began it, where the lines
    /// between places a part of a stage apart leave it.
    fn leaving(&self, stages: usize) -> impl Iterator<Item = f64> {
        self.stage_places.iter().enumerate().filter_map(move |(i, places)| {
            let contact = self.dynamics.contacts.get(i).filter(|contact| !contact.is_free())?;
            let (map, _) = self.dynamics.chart.friction_place(self.state.t, i)?;
            let region = contact.region?;
            let at = |x: f64| -> [f64; 2] {
                std::array::from_fn(|k| {
                    let values: [f64; NODES] = places.map(|place| place[k]);
                    between_stages::interpolated(&values[..=stages], x)
                })
            };
            let ends = (1..=stages).flat_map(|node| {
                let ends = [node - 1, node].map(|k| self.time_of_node(k) / self.step.h);
                (0..POINTS).map(move |k| {
                    let width = (ends[1] - ends[0]) / POINTS as f64;
                    [ends[0] + k as f64 * width, ends[0] + (k + 1) as f64 * width]
                })
            });
            let mut left = ends.filter_map(|[start, end]| {
                let part = map.leaves(region, at(start), at(end))?;
                Some((start + part * (end - start)) * self.step.h)
            });
            left.next()
        })
    }

    /// The first event function that has become positive within the first stages, and may not be so at any of them.
    fn event_between_stages(&mut self, stages: usize) -> Result<Detection, EvaluationError> {
        let Some(closings) = self.closings(stages)? else { return Ok(Detection::TooLong) };
        let gap = |number: usize| {
            self.dynamics.contacts.get(number).is_some_and(ContactVariables::is_free)
        };
        let smooth = &self.stage_values[..=self.memory.len()];
        let others = smooth.iter().enumerate().filter(|(number, _)| !gap(*number));
        let hidden =
            others.filter_map(|(_, values)| between_stages::hidden_maximum(&values[..=stages]));
        let times = closings.iter().map(|closing| closing.high.at).chain(self.leaving(stages));
        let Some(high) = times.chain(hidden.map(|x| x * self.step.h)).reduce(f64::min) else {
            return Ok(Detection::None);
        };
        let node = (1..=stages).rev().find(|&k| self.time_of_node(k) < high).unwrap_or_default();
        match self.solve_to(high) {
            Ok(()) => {
                let (q, u) = (self.probe.end(&self.probe.q), self.probe.end(&self.probe.u));
                let functions = (0..self.stage_values.len()).map(|number| {
                    let function =
                        self.function_since(number, node, self.event_function(number, q, u));
                    match closings.iter().find(|closing| closing.contact == number) {
                        Some(closing) => Triggered { low: closing.low, ..function },
                        None => function,
                    }
                });
                let triggered: Vec<_> =
                    functions.filter(|f| self.is_event(f, self.state.t + high)).collect();
                if !triggered.is_empty() {
                    return Ok(Detection::Events(Bracket { high, triggered }));
                }
            }
            Err(StateError::Diverged) => {}
            Err(StateError::Evaluation(error)) => return Err(error),
        }
        self.evaluate_stage(STAGES - 1)?;
        Ok(Detection::None)
    }
}

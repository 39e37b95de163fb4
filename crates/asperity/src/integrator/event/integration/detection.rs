//! Detection of events along a step: event functions that become positive.

use crate::contact::Phase;
use crate::integrator::event::collocation::{STAGES, Tableau};
use crate::integrator::event::dynamics::ContactVariables;
use crate::integrator::event::event_function::between_stages;
use crate::integrator::event::integration::attempt::StateError;
use crate::integrator::event::integration::variables::Integration;
use crate::integrator::event::state::EvaluationError;

/// What the stages of a step show.
pub(crate) enum Detection {
    /// No event.
    None,
    /// The resistance of a slipping contact has passed through zero.
    Singular,
    /// Event functions that have become positive.
    Events(Bracket),
}

/// Event functions that become positive between two times from the start of a step.
pub(crate) struct Bracket {
    pub(crate) low: f64,
    pub(crate) high: f64,
    pub(crate) triggered: Vec<Triggered>,
}

/// An event function that becomes positive.
pub(crate) struct Triggered {
    /// Number of the contact, or the number of contacts for the section.
    pub(crate) number: usize,
    /// The values at both times.
    pub(crate) low: f64,
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
            let singular = |c: &ContactVariables| c.mode == Phase::Slip && c.resistance <= 0.0;
            if self.dynamics.contacts.iter().any(singular) {
                return Ok(Detection::Singular);
            }
            let mut triggered = Vec::new();
            for number in 0..self.stage_values.len() {
                let (q, u) = (&self.step.q[own.clone()], &self.step.u[own.clone()]);
                let low = self.stage_values[number][stage];
                let value = self.event_function(number, q, u);
                self.stage_values[number][stage + 1] = value;
                let function = Triggered { number, low, high: value };
                if self.is_event(&function, self.state.t + high) {
                    triggered.push(function);
                }
            }
            if (!triggered.is_empty() || stage + 1 == STAGES)
                && let Some(hidden) = self.event_between_stages(stage + 1)?
            {
                return Ok(Detection::Events(hidden));
            }
            if !triggered.is_empty() {
                let low = self.time_of_node(stage);
                return Ok(Detection::Events(Bracket { low, high, triggered }));
            }
        }
        Ok(Detection::None)
    }

    /// The time of the start, or of the stage before the `node`-th, from the start.
    fn time_of_node(&self, node: usize) -> f64 {
        if node == 0 { 0.0 } else { Tableau::radau().c[node - 1] * self.step.h }
    }

    /// Whether something happens between two values of an event function, the later one at `t`. A section is crossed
    /// upwards; what lies above it from the start does not count.
    fn is_event(&self, &Triggered { number, low, high }: &Triggered, t: f64) -> bool {
        if number < self.memory.len() {
            return high > 0.0;
        }
        let after = self.options.section.as_ref().is_some_and(|section| t > section.after);
        high >= 0.0 && low < 0.0 && after
    }

    /// The first event function that becomes positive, and is not any more, between two of the first stages.
    fn event_between_stages(&mut self, stages: usize) -> Result<Option<Bracket>, EvaluationError> {
        let mut first: Option<(usize, f64)> = None;
        for values in &self.stage_values {
            if let Some((node, x)) = between_stages::hidden_maximum(&values[..=stages])
                && first.is_none_or(|(_, earliest)| x < earliest)
            {
                first = Some((node, x));
            }
        }
        let Some((node, x)) = first else { return Ok(None) };
        let high = x * self.step.h;
        match self.solve_to(high) {
            Ok(()) => {
                let (q, u) = (self.probe.end(&self.probe.q), self.probe.end(&self.probe.u));
                let functions = (0..self.stage_values.len()).map(|number| Triggered {
                    number,
                    low: self.stage_values[number][node],
                    high: self.event_function(number, q, u),
                });
                let triggered: Vec<_> =
                    functions.filter(|f| self.is_event(f, self.state.t + high)).collect();
                if !triggered.is_empty() {
                    let low = self.time_of_node(node);
                    return Ok(Some(Bracket { low, high, triggered }));
                }
            }
            Err(StateError::Diverged) => {}
            Err(StateError::Evaluation(error)) => return Err(error),
        }
        self.evaluate_stage(STAGES - 1)?;
        Ok(None)
    }
}

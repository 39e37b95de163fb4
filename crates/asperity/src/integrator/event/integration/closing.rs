//! Gaps that close within a step, however often they do.
//!
//! Pieces of the step in which the gap is the polynomial through its values at the nodes, to rounding, have their impacts where
//! this one has; others are halved, unless halving does not help, where a user's gap is noise. With `|g̈_N| ≤ L` a gap that is `g₀` and `g₁` at the ends of a piece of length `w` stays
//! above the parabola through both that bends by L: where that one is positive nothing needs to be looked at.

use crate::integrator::event::collocation::{STAGES, Tableau};
use crate::integrator::event::dynamics::{ContactVariables, Dynamics};
use crate::integrator::event::event_function::NODES;
use crate::integrator::event::event_function::between_stages::{hidden_maximum, interpolated};
use crate::integrator::event::event_function::root::Value;
use crate::integrator::event::integration::variables::Integration;
use crate::integrator::event::resolution::{NOTHING, shortest_step};
use crate::integrator::event::state::EvaluationError;
use crate::system::MotionBounds;

/// Where in a piece the polynomial through its nodes is compared with the gap, in intervals where it is off most: no second
/// place is needed where it is the gap to rounding at the first.
const COMPARED: [f64; 2] = [0.73, 0.16];
/// Gap over the largest difference found there from which on a piece needs no better polynomial: kinks of a user's gap far
/// above the ground.
const CLEAR: f64 = 100.0;
/// Differences are noise of a user's gap if they are at most this part of the contact's reach and halving a piece eight times
/// leaves more than a sixteenth of them: of those at kinks it leaves a 256th. The noise may be four times as large.
const MOST_NOISE: f64 = 1e-6;
const HALVINGS: usize = 8;
const LEFT: f64 = 1.0 / 16.0;
const NOISE: f64 = 4.0;
/// Pieces of a step above which a shorter step is the cheaper one.
const MOST_PIECES: usize = 200;

/// Where the gap of a contact closes: two times between which it does so.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Closing {
    pub(crate) contact: usize,
    pub(crate) low: Value,
    pub(crate) high: Value,
}

/// What a gap does in a step.
enum Search {
    StaysOpen,
    Closes(Closing),
    /// It swings so often that a shorter step is needed.
    Unresolved,
}

/// The highest value between two places of a function whose second derivative is above `−bend`.
fn peak(a: Value, b: Value, bend: f64) -> f64 {
    let (width, ends) = (b.at - a.at, a.value.max(b.value));
    let (bow, slope) = (0.5 * bend * width, (b.value - a.value) / width);
    if slope.abs() >= bow { ends } else { a.value + 0.5 * (slope + bow).powi(2) / bend }
}

impl Integration<'_> {
    /// Where gaps of open contacts close first within the first stages of the attempt; nothing where it is too long to say.
    pub(crate) fn closings(
        &mut self,
        stages: usize,
    ) -> Result<Option<Vec<Closing>>, EvaluationError> {
        let mut found = Vec::new();
        if !self.dynamics.contacts.iter().any(ContactVariables::is_free) {
            return Ok(Some(found));
        }
        self.bound_motion();
        for contact in 0..self.memory.len() {
            if !self.dynamics.contacts[contact].is_free() {
                continue;
            }
            match self.closing(contact, stages)? {
                Search::StaysOpen => {}
                Search::Closes(closing) => found.push(closing),
                Search::Unresolved => return Ok(None),
            }
        }
        Ok(Some(found))
    }

    /// Bounds on velocities and accelerations in the attempt: the largest ones at its start and stages, and their range.
    fn bound_motion(&mut self) {
        let (n, step) = (self.dynamics.n, &self.step);
        let MotionBounds { duration, velocities, accelerations } = &mut self.bounds;
        *duration = step.h;
        for (bounds, start, stages) in
            [(velocities, &self.state.u, &step.u), (accelerations, &self.a0, &step.a)]
        {
            bounds.clear();
            bounds.extend((0..n).map(|k| {
                let values = stages.iter().skip(k).step_by(n).chain([&start[k]]);
                let (least, most) =
                    values.fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(*v), b.max(*v)));
                most.abs().max(least.abs()) + (most - least)
            }));
        }
        self.dynamics.chart.push_bounds(&mut self.bounds);
    }

    /// Whether the gap of an open contact closes within the first stages of the attempt, and where it does so first.
    fn closing(&mut self, contact: usize, stages: usize) -> Result<Search, EvaluationError> {
        let bend = self.dynamics.chart.gap_acceleration(self.state.t, contact, &self.bounds);
        let bend = bend.unwrap_or(f64::INFINITY);
        let node =
            |k: usize| Value { at: self.time_of_node(k), value: self.stage_values[contact][k] };
        if (0..stages).all(|k| peak(node(k), node(k + 1), bend) <= 0.0) {
            return Ok(Search::StaysOpen);
        }
        let known: Option<[Value; NODES]> = (stages == STAGES).then(|| std::array::from_fn(node));
        let found = self.search(contact, known, node(stages), bend);
        self.dynamics.chart.place(self.step.end(&self.step.q));
        found
    }

    /// The same where the bound on the second derivative does not suffice; `known` are the values at all nodes.
    fn search(
        &mut self,
        contact: usize,
        known: Option<[Value; NODES]>,
        end: Value,
        bend: f64,
    ) -> Result<Search, EvaluationError> {
        // Where the start counts as closed, the polynomial goes through what its gap is.
        let decided = known.map(|nodes| nodes[0]).filter(|start| start.value < 0.0);
        let start = decided.map_or_else(|| self.gap_function(contact, 0.0), Ok)?;
        let reach = self.dynamics.contacts[contact].reach;
        let (mut a, mut ends, mut unseen) = (start, vec![end], NOTHING * reach);
        // Differences by the number of halvings, and the noise that they have shown.
        let (mut differences, mut noise) = (Vec::new(), 0.0);
        for _ in 0..MOST_PIECES {
            let Some(&b) = ends.last() else { return Ok(Search::StaysOpen) };
            if b.value <= 0.0 && peak(a, b, bend) <= 0.0 {
                ends.pop();
                a = b;
                continue;
            }
            let width = b.at - a.at;
            let whole = known.filter(|_| width == self.step.h);
            let mut values = whole.unwrap_or([a; NODES]);
            (values[0], values[STAGES]) = (a, b);
            if whole.is_none() {
                for (value, c) in values[1..STAGES].iter_mut().zip(&Tableau::radau().c) {
                    *value = self.gap_function(contact, a.at + c * width)?;
                }
            }
            let heights = values.map(|place| place.value);
            let mut off: f64 = 0.0;
            for x in COMPARED {
                let here = self.gap_function(contact, a.at + x * width)?;
                off = off.max((here.value - interpolated(&heights, x)).abs());
                if off <= unseen {
                    break;
                }
            }
            let clear = heights.iter().all(|height| *height < -CLEAR * off);
            if !clear && off > unseen && width > shortest_step(self.state.t) {
                differences.truncate(ends.len() - 1);
                differences.push(off);
                let before = differences.len().checked_sub(HALVINGS + 1).map(|k| differences[k]);
                if off <= MOST_NOISE * reach && before.is_some_and(|d| off > LEFT * d) {
                    noise = NOISE * off;
                    unseen = unseen.max(noise);
                } else {
                    ends.push(self.gap_function(contact, a.at + 0.5 * width)?);
                }
                continue;
            }
            let positive = values[1..].iter().find(|place| place.value > noise).copied();
            let hidden = hidden_maximum(&heights).map(|x| a.at + x * width);
            let high = match hidden.filter(|x| positive.is_none_or(|high| *x < high.at)) {
                Some(x) => Some(self.gap_function(contact, x)?).filter(|high| high.value > noise),
                None => None,
            };
            if let Some(high) = high.or(positive) {
                let before = values.iter().rev().find(|p| p.at < high.at && p.value <= 0.0);
                let low = *before.unwrap_or(&a);
                return Ok(Search::Closes(Closing { contact, low, high }));
            }
            ends.pop();
            a = b;
        }
        Ok(Search::Unresolved)
    }

    /// The event function of an open contact at a time of the polynomial of the attempt.
    fn gap_function(&mut self, contact: usize, at: f64) -> Result<Value, EvaluationError> {
        self.probe.guess_from(at, &self.step, 0.0);
        self.probe.h = at;
        self.probe.stages(&self.state);
        let Dynamics { chart, latest, .. } = &mut self.dynamics;
        chart.place(self.probe.end(&self.probe.q));
        let gap = chart.gap((self.state.t + at).min(*latest), contact)?;
        Ok(Value { at, value: -gap - self.dynamics.rounded_overlap(contact) })
    }
}

//! Functions of time as data: polynomials between knots, and sines.
//!
//! A signal is smooth but at its breaks. Methods of high order must not evaluate it across one, neither beyond the end
//! of a step that ends there nor before its start; therefore it is evaluated at a [`Moment`], which says besides the time
//! by which smooth piece it is continued.

use std::f64::consts::TAU;

use crate::argument::{ArgumentError, finite, positive, refuse};

/// Difference of slopes over the larger one that is rounding: samples on a straight line have no kink.
const SAME_SLOPE: f64 = 1e-10;
/// Least number of steps in a period of a sine, so that none jumps over an oscillation: polynomials through the stages of a
/// step of `integrate` follow an eighth of a period to 1e-6 of the amplitude.
const PARTS_OF_A_PERIOD: f64 = 8.0;

/// A time, and the smooth piece of functions of time that holds there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment {
    /// Time in s.
    pub t: f64,
    /// A time in s of the smooth piece by which functions of time are continued to `t`; at a break that of what comes
    /// next.
    pub piece: f64,
}

impl Moment {
    /// A time as such; at a break what comes next holds.
    pub fn new(t: f64) -> Self {
        Self { t, piece: t }
    }

    /// Another time of the same smooth piece.
    pub fn at(self, t: f64) -> Self {
        Self { t, ..self }
    }
}

/// How smooth a function of time is at a break.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Smoothness {
    /// The value, its rate or the rate of this jumps: forces, velocities or accelerations do.
    Kink,
    /// Only higher derivatives jump: steps of high order end there, and nothing else happens.
    Knot,
}

/// A time at which a function of time is not smooth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Break {
    /// Time in s.
    pub time: f64,
    /// What jumps there.
    pub smoothness: Smoothness,
}

impl Break {
    /// The earlier one; of two at the same time the less smooth one.
    pub fn earlier(first: Option<Self>, second: Option<Self>) -> Option<Self> {
        match (first, second) {
            (Some(a), Some(b)) if a.time == b.time => {
                Some(Self { smoothness: a.smoothness.min(b.smoothness), ..a })
            }
            (Some(a), Some(b)) => Some(if a.time < b.time { a } else { b }),
            (one, other) => one.or(other),
        }
    }
}

/// Which derivative is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Derivative {
    /// The value itself.
    Value,
    /// The first one.
    First,
    /// The second one.
    Second,
}

/// A function of time with one or more components.
///
/// ```
/// use asperity::system::{Derivative, Moment, Signal};
///
/// let ramp = Signal::linear(&[0.0, 1.0, 3.0], &[0.0, 2.0, 2.0], false)?;
/// let at = |t, derivative| ramp.component(Moment::new(t), 0, derivative);
/// assert_eq!(at(0.25, Derivative::Value), 0.5);
/// assert_eq!(at(0.25, Derivative::First), 2.0);
/// assert_eq!(ramp.integral(0.0, 2.0, 0), 3.0);
/// assert_eq!(ramp.next_break(0.0).map(|found| found.time), Some(1.0));
/// # Ok::<(), asperity::system::SystemError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Signal {
    components: usize,
    shape: Shape,
}

#[derive(Debug, Clone, PartialEq)]
enum Shape {
    Pieces(Pieces),
    Sine(Sine),
}

/// Polynomials between knots; held outside of these, or periodic.
#[derive(Debug, Clone, PartialEq)]
struct Pieces {
    /// Ascending; one more than there are pieces.
    knots: Vec<f64>,
    /// Piece by piece and component by component, about the start of the piece.
    coefficients: Vec<[f64; 4]>,
    /// Integrals from the first knot to every knot.
    integrals: Vec<f64>,
    /// The last values.
    last: Vec<f64>,
    breaks: Vec<Break>,
    periodic: bool,
}

/// `offset + amplitude sin(ωt + phase)`.
#[derive(Debug, Clone, PartialEq)]
struct Sine {
    angular_frequency: f64,
    offset: Vec<f64>,
    amplitude: Vec<f64>,
    phase: Vec<f64>,
}

/// A piece, or what holds outside of all.
enum Place {
    Before,
    /// The piece, and how much later than its knots it is.
    Within(usize, f64),
    After,
}

impl Signal {
    /// Straight lines through samples: the `values` at the first of the `times` in s, those at the second and so on.
    ///
    /// A time given twice is a jump from the first of its values to the second. Before its first and after its last
    /// time the signal keeps the values there, or it is `periodic`: the last sample is the first one of the next period.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] unless there are two different times at least, in ascending order, no time more than
    /// twice and neither the first nor the last one twice, and equally many finite values for all.
    pub fn linear(times: &[f64], values: &[f64], periodic: bool) -> Result<Self, ArgumentError> {
        if times.len() < 2 {
            return refuse("times", "must be two at least");
        }
        if values.is_empty() || !values.len().is_multiple_of(times.len()) {
            return refuse("values", "must be as many for every time, and not none");
        }
        if !times.iter().chain([&(times[times.len() - 1] - times[0])]).all(|t| t.is_finite()) {
            let message = "must be finite, and so must the time between the first and the last";
            return refuse("times", message);
        }
        finite("values", values)?;
        if !times.is_sorted() || times.windows(3).any(|t| t[0] == t[2]) {
            let message = "must ascend, with a time at most twice, where the values jump";
            return refuse("times", message);
        }
        if times[0] == times[1] || times[times.len() - 2] == times[times.len() - 1] {
            return refuse("times", "must not begin or end with a jump");
        }
        let width = values.len() / times.len();
        let mut coefficients = Vec::with_capacity(values.len());
        for (ends, own) in times.windows(2).zip(values.windows(2 * width).step_by(width)) {
            if ends[0] < ends[1] {
                let (start, end) = own.split_at(width);
                let line = |(a, b): (&f64, &f64)| [*a, (b - a) / (ends[1] - ends[0]), 0.0, 0.0];
                coefficients.extend(start.iter().zip(end).map(line));
            }
        }
        let mut knots = times.to_vec();
        knots.dedup();
        Self::cubic(&knots, &coefficients, &values[values.len() - width..], periodic)
            .or_else(|_| refuse("values", "must not change beyond the range of numbers"))
    }

    /// Cubic polynomials between `knots` in s: between knots `i` and `i + 1` component `k` is `Σ c_j (t − t_i)ʲ` with
    /// `c = coefficients[i * last.len() + k]`.
    ///
    /// Where polynomials do not meet, the signal jumps. Before the first knot it keeps the values there and from the last one
    /// on the `last` values, or it is `periodic`.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] unless there are two knots at least, which ascend, finite coefficients of all pieces and components
    /// with finite integrals, and finite `last` values.
    pub fn cubic(
        knots: &[f64],
        coefficients: &[[f64; 4]],
        last: &[f64],
        periodic: bool,
    ) -> Result<Self, ArgumentError> {
        if knots.len() < 2 || !knots.is_sorted_by(|a, b| a < b) {
            return refuse("knots", "must be two at least, which ascend");
        }
        if last.is_empty() || coefficients.len() != (knots.len() - 1) * last.len() {
            return refuse("coefficients", "must be those of every component of every piece");
        }
        finite("last", last)?;
        let pieces = Pieces::new(knots, coefficients, last, periodic);
        if !pieces.coefficients.iter().flatten().chain(&pieces.integrals).all(|c| c.is_finite()) {
            return refuse("coefficients", "must be finite, and so must the integral");
        }
        Ok(Self { components: last.len(), shape: Shape::Pieces(pieces) })
    }

    /// `offset + amplitude sin(2π frequency t + phase)` with the frequency in Hz, component by component.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] unless all are finite, the frequency is positive, and there are as many of all others.
    pub fn sine(
        frequency: f64,
        amplitude: &[f64],
        phase: &[f64],
        offset: &[f64],
    ) -> Result<Self, ArgumentError> {
        let angular_frequency = TAU * positive("frequency", frequency)?;
        finite("frequency", &[angular_frequency])?;
        for (argument, given) in [("amplitude", amplitude), ("phase", phase), ("offset", offset)] {
            if given.is_empty() || given.len() != amplitude.len() {
                return refuse(argument, "must have an entry per component");
            }
            finite(argument, given)?;
        }
        let [offset, amplitude, phase] = [offset, amplitude, phase].map(<[f64]>::to_vec);
        let sine = Sine { angular_frequency, offset, amplitude, phase };
        Ok(Self { components: sine.offset.len(), shape: Shape::Sine(sine) })
    }

    /// Number of components.
    pub fn components(&self) -> usize {
        self.components
    }

    /// The period in s, if it has one.
    pub fn period(&self) -> Option<f64> {
        match &self.shape {
            Shape::Pieces(pieces) => pieces.periodic.then(|| pieces.period()),
            Shape::Sine(sine) => Some(TAU / sine.angular_frequency),
        }
    }

    /// The value of a component or one of its derivatives.
    ///
    /// # Panics
    ///
    /// If there is no such component.
    pub fn component(&self, at: Moment, component: usize, derivative: Derivative) -> f64 {
        assert!(component < self.components, "the signal has {} components", self.components);
        match &self.shape {
            Shape::Pieces(pieces) => match pieces.place(at.piece) {
                Place::Within(piece, shift) => {
                    let own = pieces.coefficients[piece * self.components + component];
                    jet(own, at.t - shift - pieces.knots[piece])[derivative as usize]
                }
                _ if derivative != Derivative::Value => 0.0,
                Place::Before => pieces.coefficients[component][0],
                Place::After => pieces.last[component],
            },
            Shape::Sine(sine) => {
                let (omega, amplitude) = (sine.angular_frequency, sine.amplitude[component]);
                let angle = omega * at.t + sine.phase[component];
                match derivative {
                    Derivative::Value => sine.offset[component] + amplitude * angle.sin(),
                    Derivative::First => amplitude * omega * angle.cos(),
                    Derivative::Second => -amplitude * omega * omega * angle.sin(),
                }
            }
        }
    }

    /// The integral of a component from one time to another one; jumps between them count.
    ///
    /// # Panics
    ///
    /// If there is no such component.
    pub fn integral(&self, from: f64, to: f64, component: usize) -> f64 {
        assert!(component < self.components, "the signal has {} components", self.components);
        match &self.shape {
            Shape::Pieces(pieces) => pieces.integral(from, to, component, self.components),
            Shape::Sine(sine) => {
                let (half, middle) = (0.5 * (to - from), 0.5 * (to + from));
                let (omega, phase) = (sine.angular_frequency, sine.phase[component]);
                let swing = 2.0 / omega * (omega * half).sin() * (omega * middle + phase).sin();
                2.0 * half * sine.offset[component] + sine.amplitude[component] * swing
            }
        }
    }

    /// The first break after a time.
    pub fn next_break(&self, t: f64) -> Option<Break> {
        match &self.shape {
            Shape::Pieces(pieces) => pieces.next_break(t),
            Shape::Sine(sine) => {
                let part = TAU / (PARTS_OF_A_PERIOD * sine.angular_frequency);
                let mut number = (t / part).floor();
                while number * part <= t {
                    number += 1.0;
                }
                // Beyond the resolution of numbers there is none.
                let time = number * part;
                time.is_finite().then_some(Break { time, smoothness: Smoothness::Knot })
            }
        }
    }

    /// Whether its values jump somewhere.
    pub fn jumps(&self) -> bool {
        match &self.shape {
            Shape::Pieces(pieces) => pieces.jumps(self.components),
            Shape::Sine(_) => false,
        }
    }

    /// A bound from below on a component at its samples, or of a sine everywhere.
    pub(super) fn least(&self, component: usize) -> f64 {
        match &self.shape {
            Shape::Pieces(pieces) => {
                let own = pieces.coefficients.iter().skip(component).step_by(self.components);
                own.map(|c| c[0]).fold(pieces.last[component], f64::min)
            }
            Shape::Sine(sine) => sine.offset[component] - sine.amplitude[component].abs(),
        }
    }

    /// Sizes of the terms of a component or one of its derivatives between zero and `t_end`, which give its rounding.
    pub(super) fn size(&self, component: usize, derivative: Derivative, t_end: f64) -> f64 {
        match &self.shape {
            Shape::Pieces(pieces) => pieces.size(component, self.components, derivative, t_end),
            Shape::Sine(sine) => {
                let (omega, amplitude) = (sine.angular_frequency, sine.amplitude[component].abs());
                match derivative {
                    Derivative::Value => sine.offset[component].abs() + amplitude,
                    Derivative::First => amplitude * omega,
                    Derivative::Second => amplitude * omega * omega,
                }
            }
        }
    }

    /// Whether a component is zero at all times.
    pub(super) fn vanishes(&self, component: usize) -> bool {
        match &self.shape {
            Shape::Pieces(pieces) => {
                let own = pieces.coefficients.iter().skip(component).step_by(self.components);
                own.copied().all(|c| c == [0.0; 4]) && pieces.last[component] == 0.0
            }
            Shape::Sine(sine) => sine.offset[component] == 0.0 && sine.amplitude[component] == 0.0,
        }
    }

    /// The signal with these components, zero where there is none.
    pub(super) fn spread(&self, components: &[Option<usize>]) -> Self {
        let width = self.components;
        let choose = |values: &[f64]| -> Vec<f64> {
            components.iter().map(|place| place.map_or(0.0, |k| values[k])).collect()
        };
        let shape = match &self.shape {
            Shape::Pieces(pieces) => Shape::Pieces(Pieces {
                coefficients: pieces
                    .coefficients
                    .chunks_exact(width)
                    .flat_map(|own| components.iter().map(|k| k.map_or([0.0; 4], |k| own[k])))
                    .collect(),
                integrals: pieces.integrals.chunks_exact(width).flat_map(choose).collect(),
                last: choose(&pieces.last),
                ..pieces.clone()
            }),
            Shape::Sine(sine) => Shape::Sine(Sine {
                angular_frequency: sine.angular_frequency,
                offset: choose(&sine.offset),
                amplitude: choose(&sine.amplitude),
                phase: choose(&sine.phase),
            }),
        };
        Self { components: components.len(), shape }
    }
}

impl Pieces {
    fn new(knots: &[f64], coefficients: &[[f64; 4]], last: &[f64], periodic: bool) -> Self {
        let width = last.len();
        let mut pieces = Self {
            knots: knots.to_vec(),
            coefficients: coefficients.to_vec(),
            integrals: vec![0.0; width],
            last: last.to_vec(),
            breaks: Vec::new(),
            periodic,
        };
        for piece in 0..pieces.knots.len() - 1 {
            let h = pieces.knots[piece + 1] - pieces.knots[piece];
            for k in 0..width {
                let before = pieces.integrals[piece * width + k];
                let own = primitive(&pieces.coefficients[piece * width + k], h);
                pieces.integrals.push(before + own);
            }
        }
        pieces.breaks = (0..pieces.knots.len() - usize::from(periodic))
            .filter_map(|knot| {
                let smoothness = pieces.smoothness(knot, width)?;
                Some(Break { time: pieces.knots[knot], smoothness })
            })
            .collect();
        pieces
    }

    fn period(&self) -> f64 {
        self.knots[self.knots.len() - 1] - self.knots[0]
    }

    /// The piece that holds at a time, at a knot the one that begins there.
    fn place(&self, t: f64) -> Place {
        let (first, end) = (self.knots[0], self.knots[self.knots.len() - 1]);
        let shift =
            if self.periodic { ((t - first) / self.period()).floor() * self.period() } else { 0.0 };
        let local = t - shift;
        if !self.periodic && local < first {
            return Place::Before;
        }
        if !self.periodic && local >= end {
            return Place::After;
        }
        let piece = self.knots.partition_point(|knot| *knot <= local).max(1) - 1;
        Place::Within(piece.min(self.knots.len() - 2), shift)
    }

    /// Value and derivatives of all components before and after a knot.
    fn sides(&self, knot: usize, width: usize) -> [Vec<[f64; 4]>; 2] {
        let last = self.knots.len() - 2;
        let held = |values: &[f64]| values.iter().map(|value| [*value, 0.0, 0.0, 0.0]).collect();
        let within = |piece: usize, x: f64| -> Vec<[f64; 4]> {
            let own = &self.coefficients[piece * width..][..width];
            own.iter().map(|own| jet(*own, x)).collect()
        };
        let end = |piece: usize| within(piece, self.knots[piece + 1] - self.knots[piece]);
        let first: Vec<f64> = self.coefficients[..width].iter().map(|own| own[0]).collect();
        let before = match knot {
            0 if self.periodic => end(last),
            0 => held(&first),
            _ => end(knot - 1),
        };
        let after = if knot <= last { within(knot, 0.0) } else { held(&self.last) };
        [before, after]
    }

    /// What jumps at a knot, if anything does.
    fn smoothness(&self, knot: usize, width: usize) -> Option<Smoothness> {
        let [before, after] = self.sides(knot, width);
        let pieces = self.knots.len() - 1;
        let length = |piece: usize| self.knots[piece + 1] - self.knots[piece];
        let h = length((knot + pieces - 1) % pieces).min(length(knot % pieces));
        let kink = before.iter().zip(&after).enumerate().any(|(k, (a, b))| {
            let values = self.coefficients.iter().skip(k).step_by(width).map(|own| own[0].abs());
            let largest = values.fold(self.last[k].abs(), f64::max);
            (0..3).any(|i| {
                // What rounding of the values leaves of differences over the shorter piece.
                let rounding = 64.0 * f64::EPSILON * largest / h.powi(i as i32);
                let own = SAME_SLOPE * a[i].abs().max(b[i].abs());
                (a[i] - b[i]).abs() > own.max(rounding)
            })
        });
        match kink {
            true => Some(Smoothness::Kink),
            false => (before != after).then_some(Smoothness::Knot),
        }
    }

    fn jumps(&self, width: usize) -> bool {
        (0..self.knots.len() - usize::from(self.periodic)).any(|knot| {
            let [before, after] = self.sides(knot, width);
            // Values at the end of a piece are those of the next one to rounding.
            before
                .iter()
                .zip(&after)
                .any(|(a, b)| (a[0] - b[0]).abs() > 1e-12 * self.largest().max(f64::MIN_POSITIVE))
        })
    }

    /// As [`Signal::size`]: the terms of the polynomials that hold there, with the rounding of the time in them.
    fn size(&self, component: usize, width: usize, derivative: Derivative, t_end: f64) -> f64 {
        let held = match derivative {
            Derivative::Value => {
                self.coefficients[component][0].abs().max(self.last[component].abs())
            }
            _ => 0.0,
        };
        let pieces = self.knots.windows(2).enumerate();
        let in_time = |ends: &[f64]| self.periodic || (ends[0] <= t_end && ends[1] > 0.0);
        pieces.filter(|(_, ends)| in_time(ends)).fold(held, |largest, (piece, ends)| {
            let own = self.coefficients[piece * width + component].map(f64::abs);
            let x = if self.periodic { ends[1] } else { ends[1].min(t_end) } - ends[0];
            let time = ends[0].abs().max(t_end);
            let [value, slope, bend, _] = jet(own, x);
            largest.max(match derivative {
                Derivative::Value => value + time * slope,
                Derivative::First => slope + time * bend,
                Derivative::Second => bend + 6.0 * time * own[3],
            })
        })
    }

    fn largest(&self) -> f64 {
        self.coefficients
            .iter()
            .map(|c| c[0].abs())
            .chain(self.last.iter().map(|v| v.abs()))
            .fold(0.0, f64::max)
    }

    fn integral(&self, from: f64, to: f64, component: usize, width: usize) -> f64 {
        if let (Place::Within(a, shift), Place::Within(b, other)) =
            (self.place(from), self.place(to))
            && (a, shift) == (b, other)
        {
            // About the start, without the cancellation of the integral up to there.
            let own = self.coefficients[a * width + component];
            let x = from - shift - self.knots[a];
            let [value, slope, ..] = jet(own, x);
            return primitive(&[value, slope, own[2] + 3.0 * x * own[3], own[3]], to - from);
        }
        let since = |t: f64| {
            let (first, end) = (self.knots[0], self.knots[self.knots.len() - 1]);
            let all = self.integrals[self.integrals.len() - width + component];
            match self.place(t) {
                Place::Before => (t - first) * self.coefficients[component][0],
                Place::After => all + (t - end) * self.last[component],
                Place::Within(piece, shift) => {
                    let own = &self.coefficients[piece * width + component];
                    let whole = (shift / self.period()).round() * all;
                    whole
                        + self.integrals[piece * width + component]
                        + primitive(own, t - shift - self.knots[piece])
                }
            }
        };
        since(to) - since(from)
    }

    fn next_break(&self, t: f64) -> Option<Break> {
        if !self.periodic {
            let next = self.breaks.partition_point(|b| b.time <= t);
            return self.breaks.get(next).copied();
        }
        if self.breaks.is_empty() {
            return None;
        }
        let mut number = ((t - self.knots[0]) / self.period()).floor() - 1.0;
        loop {
            // The same numbers whatever the time is that is asked for, so that none is met twice.
            let shift = number * self.period();
            if !shift.is_finite() || shift + self.period() == shift {
                return None;
            }
            let mut moved = self.breaks.iter().map(|b| Break { time: b.time + shift, ..*b });
            if let Some(found) = moved.find(|b| b.time > t) {
                return Some(found);
            }
            number += 1.0;
        }
    }
}

/// Value and derivatives of a polynomial at `x`.
fn jet([a, b, c, d]: [f64; 4], x: f64) -> [f64; 4] {
    let slope = b + x * (2.0 * c + 3.0 * x * d);
    [a + x * (b + x * (c + x * d)), slope, 2.0 * c + 6.0 * x * d, 6.0 * d]
}

/// The integral of a polynomial from zero to `x`.
fn primitive([a, b, c, d]: &[f64; 4], x: f64) -> f64 {
    x * (a + x * (b / 2.0 + x * (c / 3.0 + x * d / 4.0)))
}

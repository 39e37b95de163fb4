//! Quantities of a run that are found while it goes on, so that nothing of it has to be kept.

use super::keep::Keep;
use crate::contact::Phase;
use crate::integrator::midpoint::Stepper;
use crate::simulate::AT_REST;
use crate::vectors::largest;

/// Such quantities of many runs, an entry per run; those that are not asked for are empty.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct Reduced {
    /// Largest less smallest coordinates `(n, coordinates)`; NaN without a state to look at.
    pub extent: Vec<f64>,
    /// Part of the time in which contacts stick `(n, contacts)`; NaN without a step to look at.
    pub stick_share: Vec<f64>,
    /// Time in s from which on everything rests; NaN of runs that do not end at rest.
    pub rest_time: Vec<f64>,
    /// Number of crossings of the section.
    pub crossings: Vec<i64>,
    /// Time of the last of them in s, or NaN.
    pub crossing_time: Vec<f64>,
    /// Coordinates there `(n, coordinates)`, or NaN.
    pub crossing_q: Vec<f64>,
    /// Velocities there `(n, dof)`, or NaN.
    pub crossing_u: Vec<f64>,
    /// Time between the last two crossings in s, or NaN.
    pub period: Vec<f64>,
}

impl Reduced {
    /// The columns with their entries per run.
    pub(super) fn columns(
        &mut self,
        [coordinates, dof, contacts]: [usize; 3],
    ) -> [(&mut Vec<f64>, usize); 7] {
        [
            (&mut self.extent, coordinates),
            (&mut self.stick_share, contacts),
            (&mut self.rest_time, 1),
            (&mut self.crossing_time, 1),
            (&mut self.crossing_q, coordinates),
            (&mut self.crossing_u, dof),
            (&mut self.period, 1),
        ]
    }
}

/// A state of a run.
#[derive(Debug, Clone, Default)]
struct Seen {
    t: f64,
    q: Vec<f64>,
    u: Vec<f64>,
}

impl Seen {
    fn set(&mut self, t: f64, q: &[f64], u: &[f64]) {
        self.t = t;
        q.clone_into(&mut self.q);
        u.clone_into(&mut self.u);
    }
}

/// Such quantities of one run.
#[derive(Debug, Default)]
pub(super) struct Reduction {
    lowest: Vec<f64>,
    highest: Vec<f64>,
    /// Time in which every contact sticks, and the whole time that was looked at.
    sticking: Vec<f64>,
    watched: f64,
    fastest: f64,
    resting_since: Option<f64>,
    last: Seen,
    height: f64,
    crossings: i64,
    crossing: Seen,
    period: f64,
}

impl Reduction {
    /// Begins a run in a state.
    pub(super) fn begin(&mut self, keep: &Keep, contacts: usize, t: f64, q: &[f64], u: &[f64]) {
        self.lowest.clear();
        self.lowest.resize(q.len(), f64::INFINITY);
        self.highest.clear();
        self.highest.resize(q.len(), f64::NEG_INFINITY);
        self.sticking.clear();
        self.sticking.resize(contacts, 0.0);
        (self.watched, self.fastest, self.resting_since) = (0.0, 0.0, None);
        (self.crossings, self.period) = (0, f64::NAN);
        self.crossing.set(f64::NAN, &[], &[]);
        self.height = keep.section.as_ref().map_or(0.0, |section| section.height(q, u));
        self.last.set(t, q, u);
        self.widen(keep, t, q);
        self.look_for_rest(t, u);
    }

    /// Begins a run in the state of a stepper, if there is something to find.
    pub(super) fn begin_with(&mut self, keep: &Keep, stepper: &Stepper<'_>) {
        if keep.reduces() {
            let contacts = stepper.phases().len();
            self.begin(keep, contacts, stepper.time(), stepper.q(), stepper.u());
        }
    }

    /// Goes on to the state of a stepper, if there is something to find.
    #[inline]
    pub(super) fn go_on_with(&mut self, keep: &Keep, stepper: &Stepper<'_>) {
        if keep.reduces() {
            let phases = stepper.phases().iter().copied();
            self.fastest = self.fastest.max(largest(stepper.problem().free_velocity()));
            self.go_on(keep, stepper.time(), stepper.q(), stepper.u(), phases);
        }
    }

    /// Goes on to a state, in which the contacts have been in these phases since the last one.
    pub(super) fn go_on(
        &mut self,
        keep: &Keep,
        t: f64,
        q: &[f64],
        u: &[f64],
        phases: impl Iterator<Item = Phase>,
    ) {
        if let Some(section) = &keep.section {
            let height = section.height(q, u);
            if self.height <= 0.0 && height > 0.0 {
                let part = self.height / (self.height - height);
                let at = self.last.t + part * (t - self.last.t);
                if at > section.after.max(keep.after) {
                    self.cross(at, part, q, u);
                }
            }
            self.height = height;
        }
        self.go_on_beside_section(keep, t, q, u, phases);
    }

    /// The same where somebody else looks for the section.
    pub(super) fn go_on_beside_section(
        &mut self,
        keep: &Keep,
        t: f64,
        q: &[f64],
        u: &[f64],
        phases: impl Iterator<Item = Phase>,
    ) {
        if keep.stick_share {
            self.count_stick(keep, t, phases);
        }
        self.widen(keep, t, q);
        self.look_for_rest(t, u);
        self.last.set(t, q, u);
    }

    /// Looks at the turning points of the way from the last state to this one, along the cubic polynomials with these
    /// coordinates and their rates, the velocities.
    pub(super) fn widen_between(&mut self, keep: &Keep, t: f64, q: &[f64], u: &[f64]) {
        let h = t - self.last.t;
        if !keep.extent || t <= keep.after || !(h > 0.0) {
            return;
        }
        // A way that began before is looked at from then on.
        let first = ((keep.after - self.last.t) / h).max(0.0);
        for (i, (&x, &v)) in q.iter().zip(u).enumerate() {
            let (before, rate, way) = (self.last.q[i], h * self.last.u[i], x - self.last.q[i]);
            // x(s) = before + rate s + b s² + a s³ for 0 ≤ s ≤ 1, with the rate h v at the end.
            let (a, b) = (rate + h * v - 2.0 * way, 3.0 * way - 2.0 * rate - h * v);
            let root = (b * b - 3.0 * a * rate).max(0.0).sqrt();
            // Both zeros of the rate, without loss of digits; infinite or NaN ones are not in between.
            let far = -(b + root.copysign(b));
            for s in [first, far / (3.0 * a), rate / far] {
                if first <= s && s < 1.0 {
                    let turning = before + s * (rate + s * (b + s * a));
                    self.lowest[i] = self.lowest[i].min(turning);
                    self.highest[i] = self.highest[i].max(turning);
                }
            }
        }
    }

    fn widen(&mut self, keep: &Keep, t: f64, q: &[f64]) {
        if !keep.extent || t < keep.after {
            return;
        }
        for ((low, high), &x) in self.lowest.iter_mut().zip(&mut self.highest).zip(q) {
            *low = low.min(x);
            *high = high.max(x);
        }
    }

    fn count_stick(&mut self, keep: &Keep, t: f64, phases: impl Iterator<Item = Phase>) {
        let time = t - self.last.t.max(keep.after);
        if !(time > 0.0) {
            return;
        }
        self.watched += time;
        for (sticking, phase) in self.sticking.iter_mut().zip(phases) {
            *sticking += if phase == Phase::Stick { time } else { 0.0 };
        }
    }

    fn look_for_rest(&mut self, t: f64, u: &[f64]) {
        let speed = largest(u);
        self.fastest = self.fastest.max(speed);
        let rests = speed <= AT_REST * self.fastest;
        self.resting_since = if rests { self.resting_since.or(Some(t)) } else { None };
    }

    /// A crossing after a part of the way from the last state to this one.
    fn cross(&mut self, t: f64, part: f64, q: &[f64], u: &[f64]) {
        // NaN before the first one.
        self.period = t - self.crossing.t;
        self.crossings += 1;
        let Self { crossing, last, .. } = self;
        crossing.t = t;
        for (to, from, now) in [(&mut crossing.q, &last.q, q), (&mut crossing.u, &last.u, u)] {
            to.clear();
            to.extend(from.iter().zip(now).map(|(a, b)| a + part * (b - a)));
        }
    }

    /// A crossing in a state that is on the section.
    pub(super) fn cross_here(&mut self, t: f64, q: &[f64], u: &[f64]) {
        self.period = t - self.crossing.t;
        self.crossings += 1;
        self.crossing.set(t, q, u);
    }

    /// Appends what was found of the run to the columns; [`f64::NAN`] of a run that could not begin.
    pub(super) fn finish(
        &self,
        keep: &Keep,
        [coordinates, dof, contacts]: [usize; 3],
        to: &mut Reduced,
    ) {
        let nan = f64::NAN;
        if keep.extent {
            let extent = |(low, high): (&f64, &f64)| if low <= high { high - low } else { nan };
            let found = self.lowest.iter().zip(&self.highest).map(extent);
            to.extent.extend(padded(found, coordinates));
        }
        if keep.stick_share {
            // Nothing over nothing is NaN.
            let found = self.sticking.iter().map(|time| time / self.watched);
            to.stick_share.extend(padded(found, contacts));
        }
        if keep.rest_time {
            let rest = self.resting_since.filter(|_| keep.after <= self.last.t);
            to.rest_time.push(rest.map_or(nan, |t| t.max(keep.after)));
        }
        if keep.section.is_some() {
            to.crossings.push(self.crossings);
            to.crossing_time.push(self.crossing.t);
            to.crossing_q.extend(padded(self.crossing.q.iter().copied(), coordinates));
            to.crossing_u.extend(padded(self.crossing.u.iter().copied(), dof));
            to.period.push(self.period);
        }
    }

    /// What there is of a run that could not begin.
    pub(super) fn nothing() -> Self {
        let crossing = Seen { t: f64::NAN, ..Seen::default() };
        Self { crossing, period: f64::NAN, ..Self::default() }
    }
}

/// So many entries, NaN where there are none.
fn padded(values: impl Iterator<Item = f64>, count: usize) -> impl Iterator<Item = f64> {
    values.chain(std::iter::repeat(f64::NAN)).take(count)
}

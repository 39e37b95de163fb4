//! States inside a step: the polynomial of degree eleven through coordinates, velocities and accelerations at
//! four times, so that many samples cost two steps more, not one each.

use crate::integrator::event::collocation::step::Step;
use crate::integrator::event::state::State;

/// Times of a step at which states are found, and the conditions there.
pub(crate) const PLACES: usize = 4;
const CONDITIONS: usize = 3 * PLACES;

/// The polynomial, by Newton's divided differences.
#[derive(Debug)]
pub(crate) struct DenseOutput {
    n: usize,
    start: f64,
    h: f64,
    /// Coordinates at the start. What is interpolated are the ways from there: the slopes of coordinates would have
    /// their rounding errors, over the length of the step.
    origin: Vec<f64>,
    /// Per coordinate.
    differences: Vec<[f64; CONDITIONS]>,
}

/// Where the `i`-th condition holds, relative to the step.
fn place(i: usize) -> f64 {
    (i / 3) as f64 / (PLACES - 1) as f64
}

impl DenseOutput {
    pub(crate) fn new(n: usize) -> Self {
        let (origin, differences) = (vec![0.0; n], vec![[0.0; CONDITIONS]; n]);
        Self { n, start: 0.0, h: 0.0, origin, differences }
    }

    /// A step of length `h` from `start`, with accelerations `a` there.
    pub(crate) fn begin(&mut self, start: &State, h: f64, a: &[f64]) {
        (self.start, self.h) = (start.t, h);
        self.origin.copy_from_slice(&start.q);
        for (i, own) in self.differences.iter_mut().enumerate() {
            own[..3].copy_from_slice(&[0.0, start.u[i], a[i]]);
        }
    }

    /// What holds at one of the later places, where a step ends: its way from the start, velocities and accelerations.
    pub(crate) fn set(&mut self, k: usize, start: &State, step: &Step) {
        let (u, a) = (step.end(&step.u), step.end(&step.a));
        self.set_conditions(k, |i| step.way(start, i), u, a);
    }

    fn set_conditions(&mut self, k: usize, way: impl Fn(usize) -> f64, u: &[f64], a: &[f64]) {
        for (i, own) in self.differences.iter_mut().enumerate() {
            own[3 * k..3 * k + 3].copy_from_slice(&[way(i), u[i], a[i]]);
        }
    }

    /// Divided differences of what has been set.
    pub(crate) fn finish(&mut self) {
        let h = self.h;
        for own in &mut self.differences {
            let given = *own;
            // At one place the differences are the derivatives.
            let repeated = |i: usize, order: usize| match order {
                1 => h * given[i / 3 * 3 + 1],
                _ => 0.5 * h * h * given[i / 3 * 3 + 2],
            };
            let mut column: [f64; CONDITIONS] = std::array::from_fn(|i| given[i / 3 * 3]);
            own[0] = column[0];
            for order in 1..CONDITIONS {
                for i in (order..CONDITIONS).rev() {
                    let width = place(i) - place(i - order);
                    column[i] = if width == 0.0 {
                        repeated(i, order)
                    } else {
                        (column[i] - column[i - 1]) / width
                    };
                }
                own[order] = column[order];
            }
        }
    }

    /// The state at a time.
    pub(crate) fn at(&self, t: f64, state: &mut State) {
        let x = (t - self.start) / self.h;
        state.t = t;
        for (i, own) in self.differences.iter().enumerate().take(self.n) {
            let (mut value, mut slope) = (own[CONDITIONS - 1], 0.0);
            for k in (0..CONDITIONS - 1).rev() {
                slope = slope * (x - place(k)) + value;
                value = value * (x - place(k)) + own[k];
            }
            (state.q[i], state.u[i]) = (self.origin[i] + value, slope / self.h);
        }
    }
}

#[cfg(test)]
mod tests;

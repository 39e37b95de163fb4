//! Velocities that reverse and grow in every step.
//!
//! No motion that the step resolves does so, but forces that act explicitly do where the step is too long for them:
//! a spring with `Δt² k > 4m`, a damper with `Δt d > 2m`.

use crate::vectors::dot;

/// Steps in a row that reverse, and the least growth of the speed over them, of a motion that diverges. Impacts may
/// reverse some steps in a row, but then bodies do not become a thousand times as fast.
const STEPS: usize = 8;
const GROWTH: f64 = 1e3;
/// Square of the growth of the speed since the last look from which on a step is looked at.
const DOUBLED: f64 = 4.0;

/// The last steps, as far as the speed has grown in them.
#[derive(Debug, Default)]
pub(super) struct Reversals {
    /// Square of the speed from which on a step is looked at.
    pub(super) bound: f64,
    /// Number of steps in a row that have reversed all of a growing motion, the last one of them, and the square of the
    /// speed before the first.
    count: usize,
    last: usize,
    first: f64,
}

impl Reversals {
    /// Looks at a step, by its velocities before and after it; whether the motion diverges.
    pub(super) fn look_at(&mut self, step: usize, before: &[f64], after: &[f64]) -> bool {
        let (square, slower) = (dot(after, after), dot(before, before));
        if !(dot(before, after) < 0.0 && square > slower) {
            self.count = 0;
            self.bound = (DOUBLED * square).clamp(f64::MIN_POSITIVE, f64::MAX);
            return false;
        }
        if self.count == 0 || step != self.last + 1 {
            (self.count, self.first) = (0, slower);
        }
        (self.count, self.last) = (self.count + 1, step);
        self.bound = square.min(f64::MAX);
        self.count >= STEPS && square >= GROWTH * GROWTH * self.first
    }

    /// Whether this step has reversed a motion that grows.
    pub(super) fn last_at(&self, step: usize) -> bool {
        self.count > 0 && self.last == step
    }
}

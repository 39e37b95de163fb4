//! Deviations that grow along a step.
//!
//! Radau's method damps whatever changes fast, `R(z) → 0` for `z → ∞` on either side. Where deviations grow at a
//! rate `α` with `αh ≫ 1`, a step would therefore follow a slip that repels its neighbours as if it attracted them:
//! the true motion leaves it at once. The rates are the eigenvalues of the accelerations' Jacobian in the
//! velocities, in which sliding directions put `λ_N/(m‖γ‖)`; what coordinates do is of the time scale that the
//! error sees.

use nalgebra::DMatrix;

use crate::integrator::event::collocation::step::{STAGES, Step, Tableau};
use crate::integrator::event::collocation::step_size::GROWTH;
use crate::integrator::event::dynamics::contact_variables::ROUNDING;

/// Iterations per eigenvalue.
const SWEEPS: usize = 50;
/// Share of the growth that a step allows which need not be known at its end: the next step is at most eight times
/// as long.
const NEXT: f64 = 0.1;

impl Step {
    /// By how many powers of e deviations grow up to a stage at the rate there, the largest of all stages, if that
    /// is more than a step allows; some number up to this one otherwise. Leaves the rate at the end in `unstable`.
    ///
    /// When a slip begins from rest its rates fall with the time since then, and with the length of the step the
    /// number stays what it is: below one, because directions that attract are those for which the slip grows
    /// faster than they turn.
    pub(crate) fn growth(&mut self) -> f64 {
        self.unstable = 0.0;
        // What rests exactly deviates from nothing.
        if self.a.iter().all(|a| *a == 0.0) {
            return 0.0;
        }
        let (n, mut growth) = (self.n, 0.0_f64);
        for (i, c) in Tableau::radau().c.iter().enumerate() {
            let last = i + 1 == STAGES;
            let least = if last { NEXT * GROWTH } else { GROWTH / c };
            let rate = if self.points.used {
                self.by_velocity(i).map_or(0.0, |matrix| largest_rate(n, &matrix, self.h, least))
            } else {
                largest_rate(n, &self.ku[i * n * n..(i + 1) * n * n], self.h, least)
            };
            growth = growth.max(c * rate);
            if last {
                self.unstable = rate / self.h;
            }
        }
        growth
    }
}

/// The largest real part of the eigenvalues of `h` times a matrix as far as it is positive beyond rounding; zero
/// where it cannot reach `least`.
fn largest_rate(n: usize, matrix: &[f64], h: f64, least: f64) -> f64 {
    // No eigenvalue is larger than the matrix.
    let size = h * matrix.iter().map(|m| m * m).sum::<f64>().sqrt();
    if !(size.is_finite() && size > least) {
        return 0.0;
    }
    let rate = match n {
        1 => matrix[0],
        2 => {
            let (middle, half) = (0.5 * (matrix[0] + matrix[3]), 0.5 * (matrix[0] - matrix[3]));
            middle + (half * half + matrix[1] * matrix[2]).max(0.0).sqrt()
        }
        _ => {
            let square = DMatrix::from_row_slice(n, n, matrix);
            let Some(schur) = square.try_schur(f64::EPSILON, SWEEPS * n) else { return 0.0 };
            let values = schur.complex_eigenvalues();
            values.iter().fold(f64::NEG_INFINITY, |m, value| m.max(value.re))
        }
    };
    (h * rate - ROUNDING * size).max(0.0)
}

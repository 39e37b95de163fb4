//! Deviations that grow along a step.
//!
//! Radau's method damps whatever changes fast, `R(z) → 0` for `z → ∞` on either side. Where deviations grow at a rate
//! `α` with `αh ≫ 1`, a step would therefore follow a slip that repels its neighbours as if it attracted them, while
//! the true motion leaves it at once. The rates are the eigenvalues of the accelerations' derivative by the
//! velocities, in which sliding directions put `λ_N/(m‖γ‖)`. What coordinates do is of the time scale that the error
//! estimate sees.

use nalgebra::DMatrix;

use crate::contact::{Components, Members};
use crate::integrator::event::collocation::radau::{STAGES, Tableau};
use crate::integrator::event::collocation::step::Step;
use crate::integrator::event::resolution::ROUNDING;

/// Powers of e by which deviations may grow within a step. The method is exact to 1e-8 there, and to 1e-3 at 3; from
/// 6 on, beyond its pole, it damps.
pub(crate) const GROWTH: f64 = 1.0;
/// Iterations per eigenvalue: the QR algorithm takes two or three of them.
const SWEEPS: usize = 50;
/// Share of the allowed growth that need not be known at the end of a step: the next one is at most eight times as long.
const NEXT: f64 = 0.1;
/// Regularisation of `1 − ∂prox_D`, which the contraction makes positive, but not where the boundary is flat.
const FLAT: f64 = 1e-8;

impl Step {
    /// By how many powers of e deviations grow up to a stage at the rate there, the largest of all stages, if that is
    /// more than a step allows; some number up to this one otherwise. Leaves the rate at the end in `growth_rate`.
    ///
    /// When a slip begins from rest its rates fall with the time since then, and with the length of the step the
    /// number stays what it is: below one, because directions that attract are those for which the slip grows faster
    /// than they turn.
    pub(crate) fn growth(&mut self) -> f64 {
        self.growth_rate = 0.0;
        // What rests exactly deviates from nothing.
        if self.a.iter().all(|a| *a == 0.0) {
            return 0.0;
        }
        let mut growth = 0.0_f64;
        for (i, c) in Tableau::radau().c.iter().enumerate() {
            let last = i + 1 == STAGES;
            let least = if last { NEXT * GROWTH } else { GROWTH / c };
            let rate = if self.acceleration_by_velocity(i) {
                largest_rate(self.n, &self.total_by_u, self.h, least)
            } else {
                0.0
            };
            growth = growth.max(c * rate);
            if last {
                self.growth_rate = rate / self.h;
            }
        }
        growth
    }

    /// The derivatives of the accelerations by the velocities at a stage into `total_by_u`, with points of *D* that follow from
    /// slips; false where they do not follow.
    fn acceleration_by_velocity(&mut self, stage: usize) -> bool {
        let (n, m) = (self.n, self.points.count());
        self.by_u[stage * n * n..(stage + 1) * n * n].clone_into(&mut self.total_by_u);
        if m == 0 {
            return true;
        }
        let matrix = self.matrix.begin(m);
        for (r, row) in matrix.chunks_exact_mut(m).enumerate() {
            row.copy_from_slice(self.points.defect_by_points(stage, r));
            row[r] += FLAT;
        }
        if !self.matrix.factor(0.0) {
            return false;
        }
        let turn = &mut self.residual;
        for column in 0..n {
            turn.clear();
            turn.extend((0..m).map(|r| self.points.defect_by_u(stage, r)[column]));
            if !self.matrix.solve(turn) {
                return false;
            }
            for r in 0..n {
                let by_points = self.points.acceleration_by_points(stage, r);
                self.total_by_u[r * n + column] +=
                    by_points.iter().zip(&*turn).map(|(a, z)| a * z).sum::<f64>();
            }
        }
        true
    }
}

/// The largest positive real part of the eigenvalues of `h` times a matrix; zero where it cannot reach `least`.
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
            // Of parts that nothing connects the eigenvalues are those of each.
            let mut connections = Components::default();
            connections.separate(n);
            let connected = |(k, entry): (usize, &f64)| (*entry != 0.0).then_some((k / n, k % n));
            for (i, j) in matrix.iter().enumerate().filter_map(connected) {
                connections.join(i, j);
            }
            let mut parts = Members::default();
            parts.update(&mut connections);
            if parts.count() > 1 {
                let rate = |part: usize| {
                    let rows = parts.of(part);
                    let entry = |k: usize| matrix[rows[k / rows.len()] * n + rows[k % rows.len()]];
                    let own: Vec<f64> = (0..rows.len() * rows.len()).map(entry).collect();
                    largest_rate(rows.len(), &own, h, least)
                };
                return (0..parts.count()).map(rate).fold(0.0, f64::max);
            }
            let square = DMatrix::from_row_slice(n, n, matrix);
            let Some(schur) = square.try_schur(f64::EPSILON, SWEEPS * n) else { return 0.0 };
            let values = schur.complex_eigenvalues();
            values.iter().fold(f64::NEG_INFINITY, |m, value| m.max(value.re))
        }
    };
    (h * rate - ROUNDING * size).max(0.0)
}

//! A collocation step for systems of second order: its stages, and guesses for them.
//!
//! The accelerations `a_i` at the stages are the unknowns: `U = u₀ + hAa`, `Q = q₀ + hcu₀ + h²A²a`. The method is
//! implicit because the sliding direction relaxes at the rate `1/‖γ‖` when a slip begins and when it ends
//! (\[HairerWanner1996\] IV.5, IV.8).

use crate::integrator::event::collocation::direction_points::DirectionPoints;
use crate::integrator::event::collocation::radau::{STAGES, Tableau, lagrange};
use crate::integrator::event::state::State;
use crate::linear::BlockLu;

/// One step with its stages.
#[derive(Debug, Clone, Default)]
pub(crate) struct Step {
    /// Number of degrees of freedom.
    pub(crate) n: usize,
    /// Length.
    pub(crate) h: f64,
    /// Accelerations, velocities and coordinates, stage after stage.
    pub(crate) a: Vec<f64>,
    pub(crate) u: Vec<f64>,
    pub(crate) q: Vec<f64>,
    /// Derivatives of the accelerations by velocities and by coordinates at the stages.
    pub(crate) by_u: Vec<f64>,
    pub(crate) by_q: Vec<f64>,
    /// Rate at which deviations grow at the end, zero if they do not.
    pub(crate) growth_rate: f64,
    /// Points of direction sets, where they are unknowns of their own.
    pub(crate) points: DirectionPoints,
    /// What Newton's method and the estimate of the error work in.
    pub(crate) matrix: BlockLu,
    pub(crate) residual: Vec<f64>,
    pub(crate) guess: Vec<f64>,
    pub(crate) total_by_u: Vec<f64>,
}

impl Step {
    pub(crate) fn new(n: usize) -> Self {
        let (row, block) = (vec![0.0; STAGES * n], vec![0.0; STAGES * n * n]);
        Self {
            n,
            a: row.clone(),
            u: row.clone(),
            q: row.clone(),
            by_u: block.clone(),
            by_q: block,
            residual: row,
            ..Self::default()
        }
    }

    /// Guesses accelerations that change along a straight line from `a0`.
    pub(crate) fn guess_line(&mut self, h: f64, a0: &[f64], slope: Option<&[f64]>) {
        for (c, a) in Tableau::radau().c.iter().zip(self.a.chunks_exact_mut(self.n)) {
            for (k, a) in a.iter_mut().enumerate() {
                *a = a0[k] + slope.map_or(0.0, |slope| slope[k] * c * h);
            }
        }
    }

    /// Guesses the accelerations of another step, continued if need be, whose start lies `ahead` before this one's.
    pub(crate) fn guess_from(&mut self, h: f64, other: &Self, ahead: f64) {
        let c = &Tableau::radau().c;
        for (ci, a) in c.iter().zip(self.a.chunks_exact_mut(self.n)) {
            let weights = lagrange(c, (ahead + ci * h) / other.h);
            for (k, a) in a.iter_mut().enumerate() {
                *a = (0..STAGES).map(|j| weights[j] * other.a[j * self.n + k]).sum();
            }
        }
    }

    /// The states at the stages that follow from the accelerations there.
    pub(crate) fn stages(&mut self, start: &State) {
        let (n, h, table) = (self.n, self.h, Tableau::radau());
        for i in 0..STAGES {
            for k in 0..n {
                let (mut du, mut dq) = (0.0, 0.0);
                for j in 0..STAGES {
                    let a = self.a[j * n + k];
                    du += table.a[(i, j)] * a;
                    dq += table.a_squared[(i, j)] * a;
                }
                self.u[i * n + k] = start.u[k] + h * du;
                self.q[i * n + k] = start.q[k] + h * (table.c[i] * start.u[k] + h * dq);
            }
        }
    }

    /// The way of a coordinate from the start to the end, without the rounding of the coordinate.
    pub(crate) fn way(&self, start: &State, k: usize) -> f64 {
        let weights = Tableau::radau().a_squared.row(STAGES - 1);
        let second: f64 = (0..STAGES).map(|j| weights[j] * self.a[j * self.n + k]).sum();
        self.h * (start.u[k] + self.h * second)
    }

    /// The last stage, which is the end of the step.
    pub(crate) fn end<'a>(&self, values: &'a [f64]) -> &'a [f64] {
        &values[(STAGES - 1) * self.n..]
    }
}

//! Radau IIA collocation with five stages, of order nine, for second-order systems.
//!
//! The accelerations `a_i` at the stages are the unknowns: `U = u₀ + hAa`, `Q = q₀ + hcu₀ + h²A²a`. Implicit,
//! because the sliding direction relaxes at the rate `1/‖γ‖` when a slip begins and when it ends
//! (\[HairerWanner1996\] IV.5, IV.8).

use std::sync::OnceLock;

use nalgebra::SMatrix;

use crate::integrator::event::collocation::direction_points::Points;
use crate::integrator::event::collocation::lu;
use crate::integrator::event::dynamics::Field;
use crate::integrator::event::dynamics::contact_variables::{FieldError, State};

/// Number of stages.
pub(crate) const STAGES: usize = 5;
/// Iterations of Newton's method.
pub(crate) const ITERATIONS: usize = 12;

type Square = SMatrix<f64, STAGES, STAGES>;

/// The coefficients of the method.
#[derive(Debug)]
pub(crate) struct Tableau {
    /// Nodes, the last one is 1.
    pub(crate) c: [f64; STAGES],
    pub(crate) a: Square,
    pub(crate) a_squared: Square,
    /// The real eigenvalue of `A`.
    gamma: f64,
    /// Lagrange polynomials at zero.
    at_start: [f64; STAGES],
}

impl Tableau {
    /// The coefficients, computed once.
    pub(crate) fn radau() -> &'static Self {
        static RADAU: OnceLock<Tableau> = OnceLock::new();
        RADAU.get_or_init(Self::new)
    }

    fn new() -> Self {
        let c = nodes();
        // `A V = C` with the powers of the nodes and their integrals, refined once.
        let powers = Square::from_fn(|j, k| c[j].powi(k as i32));
        let integrals = Square::from_fn(|i, k| c[i].powi(k as i32 + 1) / (k as f64 + 1.0));
        let inverse = powers.try_inverse().unwrap_or_else(Square::zeros);
        let mut a = integrals * inverse;
        a += (integrals - a * powers) * inverse;
        let gamma = bisect(0.0, 1.0, |x| (a - Square::identity() * x).determinant());
        Self { c, a, a_squared: a * a, gamma, at_start: lagrange(&c, 0.0) }
    }
}

/// Zeros of `P₅ − P₄` on `[0, 1]`, Legendre's polynomials: the nodes of Radau's quadrature.
fn nodes() -> [f64; STAGES] {
    let difference = |x: f64| {
        let (mut last, mut next) = (1.0, x);
        for k in 1..STAGES {
            let k = k as f64;
            (last, next) = (next, ((2.0 * k + 1.0) * x * next - k * last) / (k + 1.0));
        }
        next - last
    };
    const CELLS: usize = 64;
    let at = |k: usize| -1.0 + 2.0 * k as f64 / CELLS as f64;
    let mut c = [1.0; STAGES];
    let changes =
        (0..CELLS - 1).filter(|&k| (difference(at(k)) > 0.0) != (difference(at(k + 1)) > 0.0));
    for (node, k) in c.iter_mut().zip(changes) {
        *node = 0.5 * (1.0 + bisect(at(k), at(k + 1), difference));
    }
    c
}

fn bisect(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    let rising = f(high) > 0.0;
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if (f(middle) > 0.0) == rising { high = middle } else { low = middle }
    }
    0.5 * (low + high)
}

fn lagrange(c: &[f64; STAGES], x: f64) -> [f64; STAGES] {
    std::array::from_fn(|j| lagrange_at(c, j, x))
}

/// The polynomial that is one at the `j`-th node and zero at the others.
pub(crate) fn lagrange_at(nodes: &[f64], j: usize, x: f64) -> f64 {
    let others = (0..nodes.len()).filter(|&k| k != j);
    others.map(|k| (x - nodes[k]) / (nodes[j] - nodes[k])).product()
}

/// What velocities and coordinates are compared with.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scale {
    pub(crate) q: f64,
    pub(crate) u: f64,
}

/// One step with its stages.
#[derive(Debug, Clone, Default)]
pub(crate) struct Step {
    pub(crate) n: usize,
    /// Length.
    pub(crate) h: f64,
    /// Accelerations, velocities and coordinates, stage after stage.
    pub(crate) a: Vec<f64>,
    pub(crate) u: Vec<f64>,
    pub(crate) q: Vec<f64>,
    /// Jacobians of the accelerations in `u` and `q` at the stages.
    pub(crate) ku: Vec<f64>,
    pub(crate) kq: Vec<f64>,
    matrix: Vec<f64>,
    residual: Vec<f64>,
    small: Vec<f64>,
    /// Rate at which deviations grow at the end, zero if they do not.
    pub(crate) unstable: f64,
    /// Points of direction sets, where they are unknowns of their own.
    pub(crate) points: Points,
}

impl Step {
    pub(crate) fn new(n: usize) -> Self {
        let (row, block) = (vec![0.0; STAGES * n], vec![0.0; STAGES * n * n]);
        Self {
            n,
            h: 0.0,
            a: row.clone(),
            u: row.clone(),
            q: row.clone(),
            ku: block.clone(),
            kq: block,
            matrix: vec![0.0; STAGES * n * STAGES * n],
            residual: row,
            small: vec![0.0; n * n],
            unstable: 0.0,
            points: Points::default(),
        }
    }

    /// Accelerations `a₀ + slope t` as the first guess.
    pub(crate) fn guess_line(&mut self, h: f64, a0: &[f64], slope: Option<&[f64]>) {
        for (c, a) in Tableau::radau().c.iter().zip(self.a.chunks_exact_mut(self.n)) {
            for (k, a) in a.iter_mut().enumerate() {
                *a = a0[k] + slope.map_or(0.0, |slope| slope[k] * c * h);
            }
        }
    }

    /// The polynomial of `other`, whose start lies `ahead` before this one's.
    pub(crate) fn guess_from(&mut self, h: f64, other: &Self, ahead: f64) {
        let c = &Tableau::radau().c;
        for (ci, a) in c.iter().zip(self.a.chunks_exact_mut(self.n)) {
            let weights = lagrange(c, (ahead + ci * h) / other.h);
            for (k, a) in a.iter_mut().enumerate() {
                *a = (0..STAGES).map(|j| weights[j] * other.a[j * self.n + k]).sum();
            }
        }
    }

    /// Newton's method for the stages of a step of length `h`; whether it has converged.
    ///
    /// The guess is in `a`; the field holds the smooth part of the Jacobian.
    pub(crate) fn solve(
        &mut self,
        field: &mut Field<'_>,
        start: &State,
        h: f64,
        (tolerance, scale): (f64, Scale),
    ) -> Result<bool, FieldError> {
        (self.h, self.points.used) = (h, false);
        let mut last = f64::INFINITY;
        for iteration in 0..ITERATIONS {
            self.stages(start);
            self.linearise(field, start)?;
            self.assemble();
            if !lu::solve(&mut self.matrix, &mut self.residual) {
                return Ok(false);
            }
            for (a, step) in self.a.iter_mut().zip(&self.residual) {
                *a += step;
            }
            let largest = self.residual.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
            // As velocities and as coordinates.
            let norm = largest * h * (1.0 / scale.u).max(h / scale.q);
            if !norm.is_finite() {
                return Ok(false);
            }
            let rate = if iteration == 0 { 1.0 } else { norm / last };
            let left = if rate < 1.0 { rate / (1.0 - rate) * norm } else { f64::INFINITY };
            if left < tolerance || norm < 1e-3 * tolerance || norm == 0.0 {
                self.stages(start);
                return Ok(true);
            }
            if iteration > 2 && rate > 2.0 {
                return Ok(false);
            }
            last = norm;
        }
        Ok(false)
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

    /// Residuals and Jacobians at the stages.
    fn linearise(&mut self, field: &mut Field<'_>, start: &State) -> Result<(), FieldError> {
        let n = self.n;
        for (i, c) in Tableau::radau().c.iter().enumerate() {
            let own = i * n..(i + 1) * n;
            let residual = &mut self.residual[own.clone()];
            let time = start.t + c * self.h;
            field.evaluate(time, &self.q[own.clone()], &self.u[own.clone()], false)?;
            for ((r, f), a) in residual.iter_mut().zip(&field.acceleration).zip(&self.a[own]) {
                *r = f - a;
            }
            let block = i * n * n..(i + 1) * n * n;
            field.jacobian(&mut self.ku[block.clone()], &mut self.kq[block]);
        }
        Ok(())
    }

    fn assemble(&mut self) {
        let (n, h, table) = (self.n, self.h, Tableau::radau());
        let width = STAGES * n;
        for i in 0..STAGES {
            for j in 0..STAGES {
                let (first, second) = (h * table.a[(i, j)], h * h * table.a_squared[(i, j)]);
                for r in 0..n {
                    let from = (i * n + r) * n;
                    let row = &mut self.matrix[(i * n + r) * width + j * n..][..n];
                    let (ku, kq) = (&self.ku[from..from + n], &self.kq[from..from + n]);
                    for ((m, ku), kq) in row.iter_mut().zip(ku).zip(kq) {
                        *m = -first * ku - second * kq;
                    }
                    if i == j {
                        row[r] += 1.0;
                    }
                }
            }
        }
    }

    /// Estimate of the error of order six, filtered by `(I − hγJ)⁻¹`; `a0` is the acceleration at the
    /// start. The larger of the errors in `q` and `u`, relative to the scales.
    pub(crate) fn error(&mut self, start: &State, a0: &[f64], scale: Scale) -> f64 {
        let (n, table) = (self.n, Tableau::radau());
        let step = self.h * table.gamma;
        let at_zero = |values: &[f64], k: usize| -> f64 {
            (0..STAGES).map(|j| table.at_start[j] * values[j * n + k]).sum()
        };
        // The first stage is near the start, where the Jacobian may not exist.
        let (ku, kq) = (&self.ku[..n * n], &self.kq[..n * n]);
        let (u, q) = self.residual.split_at_mut(n);
        let q = &mut q[..n];
        for (k, q) in q.iter_mut().enumerate() {
            *q = step * (start.u[k] - at_zero(&self.u, k));
        }
        for r in 0..n {
            let row = &kq[r * n..(r + 1) * n];
            let coupled: f64 = row.iter().zip(q.iter()).map(|(k, e)| k * e).sum();
            u[r] = step * (a0[r] - at_zero(&self.a, r)) + step * coupled;
        }
        if self.points.used {
            let mut values = u[..n].to_vec();
            if !self.filter_with_points(step, &mut values) {
                return f64::INFINITY;
            }
            self.residual[..n].copy_from_slice(&values);
        } else {
            for (k, m) in self.small.iter_mut().enumerate() {
                *m = f64::from(u8::from(k % (n + 1) == 0)) - step * (ku[k] + step * kq[k]);
            }
            if !lu::solve(&mut self.small, u) {
                return f64::INFINITY;
            }
        }
        let (u, q) = self.residual.split_at(n);
        let errors = q.iter().zip(u.iter());
        errors.fold(0.0, |m: f64, (q, u)| {
            m.max((u / scale.u).abs()).max(((q + step * u) / scale.q).abs())
        })
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_and_weights_have_the_order_nine() {
        let table = Tableau::radau();
        assert_eq!(table.c[STAGES - 1], 1.0);
        for k in 0..9 {
            let sum: f64 = (0..STAGES).map(|j| table.a[(STAGES - 1, j)] * table.c[j].powi(k)).sum();
            assert!((sum - 1.0 / (f64::from(k) + 1.0)).abs() < 1e-14, "{k}: {sum}");
        }
        let sum: f64 = (0..STAGES).map(|j| table.a[(STAGES - 1, j)] * table.c[j].powi(9)).sum();
        assert!((sum - 0.1).abs() > 1e-6);
    }
}

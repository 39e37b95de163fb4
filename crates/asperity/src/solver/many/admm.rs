//! Alternating direction method of multipliers for laws with Lorentz cones (`cones.rs`).
//!
//! In `x = T P` and `ξ̂ = K ξ`: `x ← (Ĝ + βI)⁻¹(β(y − w) − b̂ − s)`, `y ← proj(x + w)`, `w ← w + x − y` with De
//! Saxcé's shift `s_N = ‖ξ̂_T‖` (\[DeSaxceFeng1998\]) of the last iterate. One factorisation serves until the
//! penalty `β` changes:
//! the method of choice where a factorisation is too dear to be repeated.

use nalgebra::Vector4;

use super::cones::own_rows;
use super::{Many, Method, Run};
use crate::solver::natural_map::Small;

type V = Vector4<f64>;

/// Iterations between two looks at the residuals, and how many of them early in the run.
const CHECK: usize = 10;
const EARLY: usize = 100;
const LATE: usize = 50;
/// Ratio of the residuals beyond which the penalty changes.
const UNBALANCED: f64 = 10.0;

/// Buffers.
#[derive(Debug, Clone, Default)]
pub(super) struct Admm {
    /// Projected percussions and multipliers, in the coordinates of the cones.
    y: Vec<V>,
    w: Vec<V>,
    a: Vec<Small>,
    step: Vec<f64>,
}

impl Run<'_, '_> {
    /// Iterates from the best percussions; whether the limit of iterations ended it.
    pub(super) fn admm(&mut self, max_iterations: usize) -> bool {
        let problem = self.problem;
        self.adopt_best();
        self.start_admm();
        let unit = 1.0 / problem.global_rho();
        let mut penalty = unit;
        let (mut iterations, mut factorizations) = (0, 1);
        if !self.factor_admm(penalty) {
            self.record(Method::Admm, 0, 1);
            return false;
        }
        while !self.solved && iterations < max_iterations && !self.stop.early() {
            iterations += 1;
            let (primal, dual) = self.iterate_admm(penalty);
            if iterations % CHECK != 0 && iterations != max_iterations {
                continue;
            }
            self.grade_admm();
            let due = iterations < EARLY || iterations % LATE == 0;
            let ratio = primal / dual;
            if due && !(1.0 / UNBALANCED..=UNBALANCED).contains(&ratio) {
                let factor = ratio.sqrt().clamp(0.1, 10.0);
                penalty *= factor;
                self.many.admm.w.iter_mut().for_each(|w| *w /= factor);
                factorizations += 1;
                if !self.factor_admm(penalty) {
                    break;
                }
            }
        }
        self.record(Method::Admm, iterations, factorizations);
        iterations == max_iterations
    }

    fn start_admm(&mut self) {
        let Many { admm, cones, centre, velocity, .. } = &mut *self.many;
        let problem = self.problem;
        problem.velocity(centre, velocity);
        let unit = problem.global_rho();
        admm.step.resize(problem.rows(), 0.0);
        admm.a.resize(problem.contacts().len(), Small::zeros());
        admm.y.clear();
        admm.w.clear();
        for (i, rows) in problem.contacts().iter().enumerate() {
            let own = |values: &[f64]| own_rows(values, rows.offset, rows.len());
            let p = own(centre);
            let xi = own(velocity) + own(problem.restitution());
            let mut v = cones.k[i] * xi;
            v[0] = v[0].max(0.0) + v.rows(1, 3).norm();
            admm.y.push(cones.t[i] * p);
            admm.w.push(-v * unit);
        }
    }

    fn factor_admm(&mut self, penalty: f64) -> bool {
        let Many { admm, cones, matrix, .. } = &mut *self.many;
        for (a, t) in admm.a.iter_mut().zip(&cones.t) {
            *a = t * penalty;
        }
        matrix.factor(self.problem, &admm.a, &cones.k)
    }

    /// One iteration; primal and dual residuals relative to their sizes.
    fn iterate_admm(&mut self, penalty: f64) -> (f64, f64) {
        let Many { admm, cones, matrix, .. } = &mut *self.many;
        let problem = self.problem;
        for (i, rows) in problem.contacts().iter().enumerate() {
            let own = |values: &[f64]| own_rows(values, rows.offset, rows.len());
            let b = own(problem.free_velocity()) + own(problem.restitution());
            let mut right = (admm.y[i] - admm.w[i]) * penalty - cones.k[i] * b;
            right[0] -= penalty * admm.w[i].rows(1, 3).norm();
            admm.step[rows.rows()].copy_from_slice(&right.as_slice()[..rows.len()]);
        }
        matrix.solve(problem, &mut admm.step);
        let (mut primal, mut dual, mut size) = (0.0, 0.0, 0.0);
        for (i, rows) in problem.contacts().iter().enumerate() {
            let p = own_rows(&admm.step, rows.offset, rows.len());
            let x = cones.t[i] * p;
            let y = project(&(x + admm.w[i]));
            primal += (x - y).norm_squared();
            dual += (y - admm.y[i]).norm_squared();
            size += y.norm_squared();
            admm.w[i] += x - y;
            admm.y[i] = y;
        }
        let loads = problem.load_norm().powi(2);
        let relative = |square: f64, of: f64| (square / of.max(f64::MIN_POSITIVE)).sqrt();
        (relative(primal, size), relative(dual * penalty * penalty, loads).max(f64::MIN_POSITIVE))
    }

    fn grade_admm(&mut self) {
        let Many { admm, cones, trial, .. } = &mut *self.many;
        for (i, rows) in self.problem.contacts().iter().enumerate() {
            let p = cones.t_inverse[i] * admm.y[i];
            trial[rows.rows()].copy_from_slice(&p.as_slice()[..rows.len()]);
        }
        self.grade_trial();
    }
}

/// Projection onto the Lorentz cone.
fn project(v: &V) -> V {
    let t = v.rows(1, 3).norm();
    if t <= v[0] {
        return *v;
    }
    if t <= -v[0] {
        return V::zeros();
    }
    let half = 0.5 * (v[0] + t);
    let mut out = v * (half / t);
    out[0] = half;
    out
}

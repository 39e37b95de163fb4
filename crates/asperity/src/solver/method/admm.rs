//! Alternating direction method of multipliers for laws with Lorentz cones (`cones.rs`).
//!
//! In `x = T P` and `ξ̂ = K ξ`: `x ← (Ĝ + βI)⁻¹(β(y − w) − b̂ − s)`, `y ← proj(x + w)`, `w ← w + x − y` with De
//! Saxcé's shift `s_N = ‖ξ̂_T‖` (\[DeSaxceFeng1998\]) of the last iterate. One factorisation serves until the
//! penalty `β` changes:
//! the method of choice where a factorisation is too dear to be repeated.

use super::cones::{Cones, own_rows};
use super::progress::Progress;
use crate::contact::ContactProblem;
use crate::law::{ContactMatrix, ContactVector};
use crate::solver::newton_matrix::NewtonMatrix;
use crate::solver::report::Method;

type V = ContactVector;

/// Iterations between two looks at the residuals; the penalty may change at each of them early in the run, later after
/// more iterations. Of the first two half as many solve one stored problem of `auto.rs` more, twice as many make no
/// difference; iterations change by at most two in a hundred. Of the last a quarter costs 1 % more iterations on
/// 31 problems of that folder with up to 310 contacts, half costs none, double solves one problem more with as many, four
/// times as many costs 7 %.
const CHECK: usize = 10;
const EARLY: usize = 100;
const LATE: usize = 50;
/// Ratio of the residuals beyond which the penalty changes, which takes a factorisation. On the stored problems of
/// `auto.rs` 92 of them come with 22 350 iterations within two seconds each, at half 130 with 24 100 and as many problems
/// solved, at double 82 with 24 360 and one problem fewer.
const UNBALANCED: f64 = 10.0;

/// Buffers.
#[derive(Debug, Clone, Default)]
pub(crate) struct Admm {
    /// Projected percussions and multipliers, in the coordinates of the cones.
    y: Vec<V>,
    w: Vec<V>,
    a: Vec<ContactMatrix>,
    step: Vec<f64>,
    percussion: Vec<f64>,
    velocity: Vec<f64>,
}

impl Admm {
    /// Iterates from the best percussions; whether the limit of iterations ended it.
    pub(crate) fn iterate(
        &mut self,
        progress: &mut Progress<'_>,
        cones: &Cones,
        matrix: &mut NewtonMatrix,
        max_iterations: usize,
    ) -> bool {
        let problem = progress.task.problem;
        progress.start_from_best(&mut self.percussion);
        self.start(problem, cones);
        let unit = 1.0 / problem.global_rho();
        let mut penalty = unit;
        let (mut iterations, mut factorizations) = (0, 1);
        if !self.factor(problem, cones, matrix, penalty) {
            progress.record(Method::Admm, 0, 1);
            return false;
        }
        while !progress.is_solved() && iterations < max_iterations && !progress.task.stop.early() {
            iterations += 1;
            let (primal, dual) = self.update(problem, cones, matrix, penalty);
            if iterations % CHECK != 0 && iterations != max_iterations {
                continue;
            }
            self.restore(problem, cones);
            progress.grade(&self.percussion);
            let due = iterations < EARLY || iterations % LATE == 0;
            let ratio = primal / dual;
            if due && !(1.0 / UNBALANCED..=UNBALANCED).contains(&ratio) {
                let factor = ratio.sqrt().clamp(0.1, 10.0);
                penalty *= factor;
                self.w.iter_mut().for_each(|w| *w /= factor);
                factorizations += 1;
                if !self.factor(problem, cones, matrix, penalty) {
                    break;
                }
            }
        }
        progress.record(Method::Admm, iterations, factorizations);
        iterations == max_iterations
    }

    fn start(&mut self, problem: &ContactProblem, cones: &Cones) {
        self.velocity.resize(problem.rows(), 0.0);
        problem.velocity(&self.percussion, &mut self.velocity);
        let unit = problem.global_rho();
        self.step.resize(problem.rows(), 0.0);
        self.a.resize(problem.contacts().len(), ContactMatrix::zeros());
        self.y.clear();
        self.w.clear();
        for (i, rows) in problem.contacts().iter().enumerate() {
            let own = |values: &[f64]| own_rows(values, rows.offset, rows.len());
            let p = own(&self.percussion);
            let xi = own(&self.velocity) + own(problem.restitution());
            let mut v = cones.k[i] * xi;
            v[0] = v[0].max(0.0) + v.rows(1, 3).norm();
            self.y.push(cones.t[i] * p);
            self.w.push(-v * unit);
        }
    }

    fn factor(
        &mut self,
        problem: &ContactProblem,
        cones: &Cones,
        matrix: &mut NewtonMatrix,
        penalty: f64,
    ) -> bool {
        for (a, t) in self.a.iter_mut().zip(&cones.t) {
            *a = t * penalty;
        }
        matrix.factor(problem, &self.a, &cones.k)
    }

    /// One iteration; primal and dual residuals relative to their sizes.
    fn update(
        &mut self,
        problem: &ContactProblem,
        cones: &Cones,
        matrix: &mut NewtonMatrix,
        penalty: f64,
    ) -> (f64, f64) {
        for (i, rows) in problem.contacts().iter().enumerate() {
            let own = |values: &[f64]| own_rows(values, rows.offset, rows.len());
            let b = own(problem.free_velocity()) + own(problem.restitution());
            let mut right = (self.y[i] - self.w[i]) * penalty - cones.k[i] * b;
            right[0] -= penalty * self.w[i].rows(1, 3).norm();
            self.step[rows.rows()].copy_from_slice(&right.as_slice()[..rows.len()]);
        }
        matrix.solve(problem, &mut self.step);
        let (mut primal, mut dual, mut size) = (0.0, 0.0, 0.0);
        for (i, rows) in problem.contacts().iter().enumerate() {
            let p = own_rows(&self.step, rows.offset, rows.len());
            let x = cones.t[i] * p;
            let y = project(&(x + self.w[i]));
            primal += (x - y).norm_squared();
            dual += (y - self.y[i]).norm_squared();
            size += y.norm_squared();
            self.w[i] += x - y;
            self.y[i] = y;
        }
        let loads = problem.load_norm().powi(2);
        let relative = |square: f64, of: f64| (square / of.max(f64::MIN_POSITIVE)).sqrt();
        (relative(primal, size), relative(dual * penalty * penalty, loads).max(f64::MIN_POSITIVE))
    }

    /// The projected percussions in the coordinates of the problem.
    fn restore(&mut self, problem: &ContactProblem, cones: &Cones) {
        for (i, rows) in problem.contacts().iter().enumerate() {
            let p = cones.t_inverse[i] * self.y[i];
            self.percussion[rows.rows()].copy_from_slice(&p.as_slice()[..rows.len()]);
        }
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

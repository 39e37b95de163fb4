//! Semismooth Newton method on the natural map of all contacts, with a proximal term.
//!
//! Zero of `F(P, ξ)` with `ξ = (G + εI) P + b − ε c`: for `ε = 0` the contact problem itself
//! (\[AlartCurnier1991\]), for `ε > 0` one step of the proximal point iteration from the centre `c`, which is
//! well posed even where `G` has no full rank.

use crate::contact::{ContactProblem, ContactRows};
use crate::law::{ContactMatrix, ContactPoint, Derivatives, Rho};
use crate::solver::gauss_seidel::Task;
use crate::solver::newton_matrix::NewtonMatrix;
use crate::vectors::norm;

/// Halvings of a step, and values of `‖F‖` among which the largest must be undercut: more let steps pass that lead
/// past a kink, and others that lead astray.
const HALVINGS: usize = 12;
const MEMORY: usize = 5;
/// What to solve.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Goal {
    /// `ε`, in units of `G`.
    pub(crate) epsilon: f64,
    /// Regularisation of the matrices only, in units of `1/ρ` of the contact: it changes the steps, not where they lead.
    pub(crate) shift: f64,
    /// `‖F‖` that will do, a percussion.
    pub(crate) tolerance: f64,
    /// `‖F‖` from which on percussions may pass the measure of the stop, which then ends the work.
    pub(crate) promising: f64,
    pub(crate) max_iterations: usize,
    /// Iterations within which `‖F‖` must halve.
    pub(crate) patience: usize,
}

/// Buffers.
#[derive(Debug, Clone, Default)]
pub(crate) struct Newton {
    /// Factor of the prox parameters `ρ_N = f/G_NN`, `ρ_T = p f/tr G_TT` of every contact.
    rho: Vec<Rho>,
    a: Vec<ContactMatrix>,
    b: Vec<ContactMatrix>,
    f: Vec<f64>,
    xi: Vec<f64>,
    step: Vec<f64>,
    /// `(G + εI) d` of the step.
    change: Vec<f64>,
    trial: Vec<f64>,
    trial_xi: Vec<f64>,
    best: Vec<f64>,
    norms: Vec<f64>,
    /// Factorisations so far.
    pub(crate) factorizations: usize,
}

impl Newton {
    /// Buffers for this problem.
    pub(crate) fn prepare(&mut self, problem: &ContactProblem) {
        let (rows, contacts) = (problem.rows(), problem.contacts().len());
        for list in [
            &mut self.f,
            &mut self.xi,
            &mut self.step,
            &mut self.change,
            &mut self.trial,
            &mut self.trial_xi,
            &mut self.best,
        ] {
            list.resize(rows, 0.0);
        }
        self.a.resize(contacts, ContactMatrix::zeros());
        self.b.resize(contacts, ContactMatrix::zeros());
        self.factorizations = 0;
        self.scale_rho(problem, 1.0);
    }

    /// Sets the prox parameters; large ones help where percussions are large against loads.
    pub(crate) fn scale_rho(&mut self, problem: &ContactProblem, factor: f64) {
        self.rho.clear();
        self.rho.extend(problem.contacts().iter().enumerate().map(|(i, rows)| {
            let diagonal = |k: usize| problem.delassus().own(i, k, k);
            let first = rows.normal_rows();
            let tangent: f64 = (first..rows.len()).map(diagonal).sum();
            let normal = if first == 1 { factor / diagonal(0) } else { 0.0 };
            // Without friction there is no tangent, and nobody asks for its parameter but `match_rho`.
            let tangents = rows.len() - first;
            let tangent = if tangents == 0 { normal } else { factor * tangents as f64 / tangent };
            Rho { normal, tangent }
        }));
    }

    /// Sets the prox parameter of every contact to that with which its velocity weighs as much as its percussion, at
    /// most `largest` times the one that its own block gives.
    pub(crate) fn match_rho(&mut self, problem: &ContactProblem, percussion: &[f64], largest: f64) {
        problem.velocity(percussion, &mut self.xi);
        self.scale_rho(problem, 1.0);
        for (rows, rho) in problem.contacts().iter().zip(&mut self.rho) {
            let own = |values: &[f64]| norm(&values[rows.rows()]);
            let velocity = self.xi[rows.rows()].iter().zip(&problem.restitution()[rows.rows()]);
            let xi = velocity.map(|(gamma, e)| (gamma + e) * (gamma + e)).sum::<f64>().sqrt();
            let matching = own(percussion) / (rho.tangent * xi);
            // Not a number where nothing pushes and nothing moves.
            let factor = if matching > 1.0 { matching.min(largest) } else { 1.0 };
            rho.normal *= factor;
            rho.tangent *= factor;
        }
    }

    /// Solves from `percussion`, which receives the best iterate; `‖F‖` there and the iterations.
    pub(crate) fn solve(
        &mut self,
        task: &Task<'_>,
        matrix: &mut NewtonMatrix,
        percussion: &mut [f64],
        centre: &[f64],
        goal: Goal,
    ) -> (f64, usize) {
        let Task { problem, stop, .. } = *task;
        self.start(problem, percussion, centre, goal.epsilon);
        let mut norm = self.linearize(problem, percussion, goal);
        self.best.copy_from_slice(percussion);
        let mut best = norm;
        self.norms.clear();
        self.norms.push(norm);
        let mut iterations = 0;
        while norm > goal.tolerance && iterations < goal.max_iterations && !stop.early() {
            iterations += 1;
            if !self.direction(task, matrix, goal.epsilon) {
                break;
            }
            norm = self.search(problem, percussion, goal);
            self.norms.push(norm);
            if norm < best {
                best = norm;
                self.best.copy_from_slice(percussion);
                if norm <= goal.promising && self.is_solved(task, percussion) {
                    break;
                }
            }
            let len = self.norms.len();
            if len > goal.patience && norm > 0.5 * self.norms[len - goal.patience] {
                break;
            }
        }
        percussion.copy_from_slice(&self.best);
        (best, iterations)
    }

    /// Whether percussions pass the measure of the stop.
    fn is_solved(&mut self, task: &Task<'_>, percussion: &[f64]) -> bool {
        let Task { problem, stop, .. } = *task;
        let velocity = &mut self.trial_xi;
        problem.velocity(percussion, velocity);
        stop.residual(problem, percussion, velocity).value <= 0.5 * stop.tolerance
    }

    /// `ξ = G P + b + e γ_B + ε(P − c)`.
    fn start(&mut self, problem: &ContactProblem, percussion: &[f64], centre: &[f64], eps: f64) {
        problem.velocity(percussion, &mut self.xi);
        for (row, xi) in self.xi.iter_mut().enumerate() {
            *xi += problem.restitution()[row] + eps * (percussion[row] - centre[row]);
        }
    }

    /// `F`, its Jacobians `A + (ε + shift) B`, `B`, and `‖F‖`.
    fn linearize(&mut self, problem: &ContactProblem, percussion: &[f64], goal: Goal) -> f64 {
        for (i, rows) in problem.contacts().iter().enumerate() {
            let (a, b) = (&mut self.a[i], &mut self.b[i]);
            let at = point(rows, self.rho[i], percussion, &self.xi);
            let derivatives = Derivatives { a: &mut *a, b: &mut *b };
            rows.law.natural_map_jet(at, &mut self.f[rows.rows()], derivatives);
            *a += *b * (goal.epsilon + goal.shift / self.rho[i].tangent);
        }
        norm(&self.f)
    }

    /// The Newton step `(A + εB + BG) d = −F`; false if there is none.
    fn direction(&mut self, task: &Task<'_>, matrix: &mut NewtonMatrix, epsilon: f64) -> bool {
        let Task { problem, stop, .. } = *task;
        self.factorizations += 1;
        if !matrix.factor(problem, &self.a, &self.b, &|| stop.early()) {
            return false;
        }
        for (d, f) in self.step.iter_mut().zip(&self.f) {
            *d = -f;
        }
        matrix.solve(problem, &mut self.step);
        if self.step.iter().any(|d| !d.is_finite()) {
            return false;
        }
        problem.delassus().apply(&self.step, &mut self.change);
        for (change, d) in self.change.iter_mut().zip(&self.step) {
            *change += epsilon * d;
        }
        true
    }

    /// Goes along the step as far as `‖F‖` falls below its largest of the last iterations, else to the best
    /// point that was seen.
    fn search(&mut self, problem: &ContactProblem, percussion: &mut [f64], goal: Goal) -> f64 {
        let recent = self.norms.iter().rev().take(MEMORY);
        let reference = recent.fold(0.0_f64, |m, &v| m.max(v));
        let (mut length, mut best, mut shortest) = (1.0, f64::INFINITY, 1.0);
        for _ in 0..HALVINGS {
            let norm = self.try_length(problem, percussion, length);
            if norm < best {
                (best, shortest) = (norm, length);
            }
            if norm <= (1.0 - 1e-4 * length) * reference {
                break;
            }
            length *= 0.5;
        }
        if !(best <= (1.0 - 1e-4 * length) * reference) || shortest != length {
            self.try_length(problem, percussion, shortest);
        }
        percussion.copy_from_slice(&self.trial);
        self.xi.copy_from_slice(&self.trial_xi);
        self.linearize(problem, percussion, goal)
    }

    /// `‖F‖` a part of the step ahead.
    fn try_length(&mut self, problem: &ContactProblem, percussion: &[f64], length: f64) -> f64 {
        for (row, trial) in self.trial.iter_mut().enumerate() {
            *trial = percussion[row] + length * self.step[row];
            self.trial_xi[row] = self.xi[row] + length * self.change[row];
        }
        for (i, rows) in problem.contacts().iter().enumerate() {
            let at = point(rows, self.rho[i], &self.trial, &self.trial_xi);
            rows.law.natural_map(at, &mut self.f[rows.rows()]);
        }
        norm(&self.f)
    }
}

/// What the natural map of a contact is a function of.
fn point<'a>(
    rows: &ContactRows,
    rho: Rho,
    percussion: &'a [f64],
    xi: &'a [f64],
) -> ContactPoint<'a> {
    let prescribed = rows.normal.prescribed();
    ContactPoint { prescribed, rho, percussion: &percussion[rows.rows()], xi: &xi[rows.rows()] }
}

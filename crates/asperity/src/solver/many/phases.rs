//! In which order the phases come.

use super::newton::Goal;
use super::{Many, Method, Run, exact, infeasible};
use crate::contact::{ContactProblem, ContactState, Memory, Phase};
use crate::solver::report::Ended;
use crate::solver::threads::Threads;
use crate::solver::{Stop, Workspace};

/// Sweeps before the first judgement of their rate, and most sweeps at all.
const TRIAL_SWEEPS: usize = 20;
const MOST_SWEEPS: usize = 400;
/// Further sweeps that are worth waiting for.
const WORTHWHILE: f64 = 250.0;
/// Newton iterations of a step of the first attempt.
const ATTEMPT: usize = 6;
const INTERIOR: usize = 40;
/// Outer steps of the last phase.
const OUTER: usize = 5000;
/// Natural map below which Newton's method finds the digits that rounding keeps from the interior point method.
const POLISHED: f64 = 1e-4;
/// Regularisation of the matrices of Newton's method alone, relative to the blocks of `G`: elimination among bodies
/// divides by it, and half the digits of the steps are left on either side.
const SHIFT: f64 = 1e-8;
/// Natural map at which the interior point method, whose digits end there, hands over.
const INTERIOR_GOAL: f64 = 1e-7;

/// Sweeps, then Newton, then interior point and proximal point.
pub(crate) fn automatic(
    problem: &ContactProblem,
    stop: Stop<'_>,
    (with_interior, threads): (bool, &Threads),
    memory: &Memory,
    workspace: &mut Workspace,
) -> (usize, Ended) {
    let mut run = Run::new(problem, stop, memory, workspace);
    run.many.newton.threads = threads.clone();
    run.gauss_seidel();
    if !run.over() {
        run.look_for_paradox();
    }
    if !run.over() {
        run.prepare_newton();
        run.newton_attempt(ATTEMPT);
    }
    if !run.over() && with_interior && run.cones_fit() {
        run.interior_point(INTERIOR, INTERIOR_GOAL);
    }
    if !run.over() {
        run.proximal_point(OUTER);
    }
    run.continue_states();
    run.finish(false)
}

/// One phase alone.
pub(crate) fn single(
    problem: &ContactProblem,
    stop: Stop<'_>,
    (method, max_iterations): (Method, usize),
    memory: &Memory,
    workspace: &mut Workspace,
) -> (usize, Ended) {
    let mut run = Run::new(problem, stop, memory, workspace);
    let conic = matches!(method, Method::InteriorPoint | Method::Admm);
    if conic && !run.cones_fit() {
        run.finish(false);
        return (0, Ended::NotApplicable);
    }
    run.many.newton.threads = Threads::default();
    run.prepare_newton();
    let limited = match method {
        Method::InteriorPoint => {
            let limited = run.interior_point(max_iterations, 0.0);
            if !limited && !run.over() && run.grade < POLISHED {
                run.newton_attempt(ATTEMPT);
            }
            limited
        }
        Method::Admm => run.admm(max_iterations),
        Method::Newton => run.plain_newton(max_iterations),
        _ => run.proximal_point(max_iterations),
    };
    run.finish(limited)
}

impl Run<'_, '_> {
    fn over(&self) -> bool {
        self.solved || self.workspace.infeasibility.is_some() || self.stop.early()
    }

    /// Whether a contact that sweeps could not solve has no solution whatever the others do.
    fn look_for_paradox(&mut self) {
        if let Some(contact) = self.stuck {
            let percussion = &self.workspace.percussion;
            let proof = infeasible::prove_alone(self.problem, contact, percussion);
            self.workspace.infeasibility = proof;
        }
    }

    /// Where contacts have several solutions, goes to those that continue their states, if that is a solution
    /// of the whole.
    fn continue_states(&mut self) {
        let known = |state: &ContactState| state.phase != Phase::Unknown;
        if !self.solved || !self.memory.states.iter().any(known) {
            return;
        }
        self.workspace.percussion.copy_from_slice(&self.many.best);
        exact::sweep(self.problem, self.memory, self.workspace, true);
        if !self.workspace.ambiguous.contains(&true) {
            return;
        }
        // The solution of before stays in `trial`, in case the sweeps do not end in another one.
        let Many { best, trial, .. } = &mut *self.many;
        trial.copy_from_slice(best);
        let before = self.grade;
        for _ in 0..TRIAL_SWEEPS {
            (self.solved, self.grade) = (false, f64::INFINITY);
            self.grade_sweeps();
            if self.solved {
                return;
            }
            if self.stop.early() {
                break;
            }
            exact::sweep(self.problem, self.memory, self.workspace, false);
        }
        (self.solved, self.grade, self.growth) = (true, before, None);
        let Many { best, trial, .. } = &mut *self.many;
        best.copy_from_slice(trial);
    }

    /// Sweeps while their rate promises an end.
    fn gauss_seidel(&mut self) {
        let (mut last, mut last_at, mut next) = (f64::INFINITY, 0, 1);
        let mut k = 0;
        while !self.solved && k < MOST_SWEEPS {
            self.sweep();
            k += 1;
            if k < next && !self.stop.early() {
                continue;
            }
            let grade = self.grade_sweeps();
            if self.stop.early() {
                break;
            }
            if k >= TRIAL_SWEEPS {
                let rate = (grade / last).ln() / (k - last_at) as f64;
                let left = (0.5 * self.stop.tolerance / grade).ln() / rate;
                // The comparisons also turn away NaN.
                if !(rate < 0.0) || left > WORTHWHILE {
                    break;
                }
            }
            (last, last_at) = (grade, k);
            next = match k {
                0..5 => k + 1,
                5..20 => k + 5,
                _ => k + k * 3 / 10,
            };
        }
        self.record(Method::GaussSeidel, k, 0);
    }

    /// Newton's method on the problem itself, its matrices with as much regularisation as rounding has; whether
    /// the limit of iterations ended it.
    fn plain_newton(&mut self, max_iterations: usize) -> bool {
        let grade = self.adopt_best();
        let goal = Goal { shift: SHIFT, ..self.inner_goal(grade, 0.0, max_iterations) };
        let (_, iterations) = self.newton_from_centre(goal);
        self.grade_trial();
        self.record(Method::Newton, iterations, self.many.newton.factorizations);
        iterations == max_iterations
    }
}

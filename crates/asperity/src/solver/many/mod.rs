//! Problems of many contacts: the phases of [`Solver::Auto`](super::Solver::Auto) and the solvers made of
//! one phase each.
//!
//! Sweeps end most problems and give the others a start; Newton's method ends those of full rank; the
//! interior point method, where the laws allow it, and the proximal point iteration end the rest. Everything
//! is cheap against sweeps because a factorisation costs as much as some tens of them.

mod admm;
mod body_space;
mod cones;
mod interior;
mod newton;
mod newton_matrix;
mod phases;
mod proximal;

use super::exact;
use super::natural::natural_map;
use super::quick;
use super::report::{Ended, Method, Stage};
use super::residual::{approach, natural_residual, runaway};
use super::{Measure, Stop, Workspace};
use crate::contact::{ContactProblem, Memory};
pub(super) use phases::{automatic, single};

use admm::Admm;
use cones::Cones;
use interior::Interior;
use newton::{Newton, norm};
use newton_matrix::NewtonMatrix;

/// Buffers of the phases.
#[derive(Debug, Clone, Default)]
pub(super) struct Many {
    newton: Newton,
    matrix: NewtonMatrix,
    cones: Cones,
    interior: Interior,
    admm: Admm,
    /// Best percussions so far.
    best: Vec<f64>,
    centre: Vec<f64>,
    trial: Vec<f64>,
    velocity: Vec<f64>,
}

impl Many {
    /// Forgets what depends on the pattern of `G`.
    pub(super) fn reset(&mut self) {
        self.matrix.reset();
    }
}

/// A solve under way.
pub(super) struct Run<'a, 'b> {
    problem: &'a ContactProblem,
    stop: Stop<'b>,
    memory: &'a Memory,
    workspace: &'a mut Workspace,
    many: Box<Many>,
    /// Natural map of the best percussions.
    grade: f64,
    /// Whether they pass the measure of the stop.
    solved: bool,
    stuck: Option<usize>,
    /// The contact that goes on approaching while percussions grow.
    runs_away: Option<usize>,
    sweeps: usize,
}

/// Whether a contact has no solution with the others held.
fn has_none(problem: &ContactProblem, contact: usize, percussion: &[f64]) -> bool {
    let listed = problem.contacts[contact].law.dimension() < 3;
    listed && exact::all_solutions(problem, contact, percussion).is_empty()
}

impl<'a, 'b> Run<'a, 'b> {
    /// Begins with the percussions in the workspace.
    pub(super) fn new(
        problem: &'a ContactProblem,
        stop: Stop<'b>,
        memory: &'a Memory,
        workspace: &'a mut Workspace,
    ) -> Self {
        let many = workspace.many.take().unwrap_or_default();
        workspace.stages.clear();
        let (grade, solved, stuck, sweeps) = (f64::INFINITY, false, None, 0);
        let mut run = Self {
            problem,
            stop,
            memory,
            workspace,
            many,
            grade,
            solved,
            stuck,
            sweeps,
            runs_away: None,
        };
        let rows = problem.rows();
        let Many { best, centre, trial, velocity, .. } = &mut *run.many;
        for list in [best, centre, trial, velocity] {
            list.resize(rows, 0.0);
        }
        run.grade_sweeps();
        run
    }

    /// Puts the best percussions back; iterations and why it ended.
    pub(super) fn finish(self) -> (usize, Ended) {
        let Self { problem, workspace, many, solved, stuck, runs_away, stop, .. } = self;
        workspace.percussion.copy_from_slice(&many.best);
        workspace.many = Some(many);
        let iterations = workspace.stages.iter().map(|stage| stage.iterations).sum();
        let ended = if solved {
            Ended::Done
        } else if stop.early() {
            Ended::TimeLimit
        } else {
            match (runs_away, stuck) {
                (Some(contact), _) => Ended::NoSolution(contact),
                (None, Some(contact)) if has_none(problem, contact, &workspace.percussion) => {
                    Ended::NoSolution(contact)
                }
                _ => Ended::MaxIterations,
            }
        };
        (iterations, ended)
    }

    /// Prepares Newton's method: orderings and buffers.
    fn prepare_newton(&mut self) {
        self.many.newton.prepare(self.problem);
        self.many.matrix.prepare(self.problem);
    }

    /// One sweep of exact one-contact solves over the workspace's percussions.
    fn sweep(&mut self) {
        let first = self.sweeps == 0;
        self.stuck = quick::sweep(self.problem, self.memory, self.workspace, first);
        self.sweeps += 1;
    }

    /// Natural map of the workspace's percussions, kept if they are the best so far.
    fn grade_sweeps(&mut self) -> f64 {
        let percussion = std::mem::take(&mut self.workspace.percussion);
        let grade = self.grade(&percussion);
        self.workspace.percussion = percussion;
        grade
    }

    /// The same for the trial percussions.
    fn grade_trial(&mut self) -> f64 {
        let trial = std::mem::take(&mut self.many.trial);
        let grade = self.grade(&trial);
        self.many.trial = trial;
        grade
    }

    fn grade(&mut self, percussion: &[f64]) -> f64 {
        self.problem.velocity(percussion, &mut self.many.velocity);
        let velocity = &self.many.velocity;
        let grade = natural_map(self.problem, percussion, velocity);
        let goal = 0.5 * self.stop.tolerance;
        let small = match self.stop.measure {
            Measure::Global => grade <= goal,
            // The measure of contacts is the dearer one; it is not looked at where the other is far off.
            Measure::Contact => {
                grade <= 1e3 * goal * (self.problem.contacts.len() as f64).sqrt()
                    && natural_residual(self.problem, percussion, velocity).value <= goal
            }
        };
        if runaway(self.problem, percussion, velocity).is_some() {
            return grade;
        }
        let solved = small && approach(self.problem, velocity).is_none();
        if solved && !self.solved || grade < self.grade && solved >= self.solved {
            (self.grade, self.solved) = (grade, solved);
            self.many.best.copy_from_slice(percussion);
        }
        grade
    }

    /// Starts a phase from the best percussions.
    fn adopt_best(&mut self) -> f64 {
        let Many { best, centre, .. } = &mut *self.many;
        centre.copy_from_slice(best);
        self.grade
    }

    /// `max(‖P‖, ρ‖b‖)`, what defects are compared with.
    fn scale(&self, percussion: &[f64]) -> f64 {
        f64::max(norm(percussion), self.problem.global_rho() * self.problem.load_norm())
    }

    /// Smallest relative `‖F‖` that is asked for.
    fn floor(&self) -> f64 {
        match self.stop.measure {
            Measure::Global => (1e-3 * self.stop.tolerance).clamp(1e-15, 2e-12),
            Measure::Contact => 1e-15,
        }
    }

    fn record(&mut self, method: Method, iterations: usize, factorizations: usize) {
        let residual = self.grade;
        self.workspace.stages.push(Stage { method, iterations, factorizations, residual });
    }
}

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
use super::growth::{self, BOUNDLESS, Groups, Growth, Kind};
use super::infeasible;
use super::natural::natural_map;
use super::quick;
use super::report::{Ended, Method, Stage};
use super::residual::natural_residual;
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
    /// The last percussions that ran away.
    astray: Vec<f64>,
    groups: Groups,
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
    /// The contact of the last sweep that had no solution, the others held.
    stuck: Option<usize>,
    /// Percussions have grown beyond those kept, and a contact goes on approaching.
    growth: Option<Growth>,
    /// Growth at which a proof that there is no solution is tried next.
    suspicion: f64,
    sweeps: usize,
}

/// Growth at which a proof is tried for the first time, and its factor to the next time: percussions come closer
/// to a direction that proves it the more they grow.
const SUSPICION: f64 = 1e4;

impl<'a, 'b> Run<'a, 'b> {
    /// Begins with the percussions in the workspace.
    pub(super) fn new(
        problem: &'a ContactProblem,
        stop: Stop<'b>,
        memory: &'a Memory,
        workspace: &'a mut Workspace,
    ) -> Self {
        let many = workspace.many.take().unwrap_or_default();
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
            growth: None,
            suspicion: SUSPICION,
            sweeps,
        };
        let rows = problem.rows();
        let Many { best, centre, trial, velocity, astray, groups, .. } = &mut *run.many;
        groups.resize(problem.contacts().len());
        for list in [best, centre, trial, velocity, astray] {
            list.clear();
            list.resize(rows, 0.0);
        }
        run.grade_sweeps();
        run
    }

    /// Puts the best percussions back; iterations and why it ended, `limited` by the user's number of iterations
    /// or not.
    pub(super) fn finish(mut self, limited: bool) -> (usize, Ended) {
        let early = self.stop.early();
        if !self.solved && !early {
            self.is_infeasible();
        }
        let Self { workspace, many, growth, .. } = self;
        workspace.percussion.copy_from_slice(&many.best);
        workspace.many = Some(many);
        let iterations = workspace.stages.iter().map(|stage| stage.iterations).sum();
        let ended = match (growth, self.stuck) {
            _ if self.solved => Ended::Done,
            _ if early => Ended::TimeLimit,
            (Some(growth), _) if !limited || growth.factor >= BOUNDLESS => {
                Ended::Unbounded(growth.contact)
            }
            _ if limited => Ended::MaxIterations,
            (_, Some(contact)) => Ended::Stuck(contact),
            _ => Ended::Stalled,
        };
        (iterations, ended)
    }

    /// Whether growth is beyond all bounds or proves that there is no solution.
    fn is_hopeless(&mut self) -> bool {
        let Some(growth) = self.growth else { return false };
        if growth.factor < self.suspicion {
            return false;
        }
        self.suspicion = SUSPICION * growth.factor;
        self.is_infeasible() || growth.factor >= BOUNDLESS
    }

    /// Whether the percussions that run away prove that there is no solution.
    fn is_infeasible(&mut self) -> bool {
        let proof = &mut self.workspace.infeasibility;
        if self.growth.is_some() && proof.is_none() {
            *proof = infeasible::prove(self.problem, &self.many.astray);
        }
        proof.is_some()
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
                grade <= 1e3 * goal * (self.problem.contacts().len() as f64).sqrt()
                    && natural_residual(self.problem, percussion, velocity).value <= goal
            }
        };
        let better = small && !self.solved || grade < self.grade && small >= self.solved;
        if better {
            self.keep(percussion, grade, small);
        }
        grade
    }

    /// Keeps better percussions than before, unless they run away: such look better and better, and are no start
    /// for anything.
    fn keep(&mut self, percussion: &[f64], grade: f64, small: bool) {
        let Many { astray, velocity, groups, .. } = &mut *self.many;
        self.growth = growth::of(self.problem, percussion, velocity, groups);
        let kind = self.growth.map(|growth| growth.kind);
        if kind >= Some(Kind::Suspicious) {
            astray.copy_from_slice(percussion);
        }
        if kind >= Some(Kind::Boundless)
            || kind == Some(Kind::Suspicious) && small && self.is_infeasible()
        {
            return;
        }
        let solved = small && kind != Some(Kind::Separating);
        if solved || !self.solved {
            (self.grade, self.solved, self.growth) = (grade, solved, None);
            self.many.best.copy_from_slice(percussion);
        }
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

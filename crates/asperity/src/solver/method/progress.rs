//! How far a solve has come: the best percussions so far, and whether they run away.
//!
//! Every method hands the percussions that it finds to [`Progress::grade`], which keeps the best ones by the natural map
//! of the whole problem and by the measure of the stop, and begins with the best ones of the method before.

use crate::contact::{ContactRows, NormalForce};
use crate::solver::gauss_seidel::{Iterate, Past, Reached, Sweeper, Task};
use crate::solver::infeasibility::prove_closing;
use crate::solver::measure::growth::{self, BOUNDLESS, Groups, Growth, GrowthKind};
use crate::solver::measure::natural_map::{self, Scale};
use crate::solver::measure::natural_residual::{self, Measured, Residual};
use crate::solver::measure::stop::Measure;
use crate::solver::one_contact::solve::Policy;
use crate::solver::report::{Ended, Method, Stage};
use crate::vectors::norm;

/// Growth at which a proof is tried for the first time, and its factor to the next time: percussions come closer
/// to a direction that proves it the more they grow.
const SUSPICION: f64 = 1e4;
/// Velocity relative to the largest load from which on a contact separates, and the part of the contacts that may do so in
/// what may stand. Stacks, walls and arches have at most 4 % after their first sweeps, and so have five of the twenty stored
/// problems that sweeps do not end.
const SEPARATING: f64 = 1e-3;
const FEW_SEPARATE: f64 = 0.05;

/// Buffers.
#[derive(Debug, Clone, Default)]
pub(crate) struct Buffers {
    /// Percussions that the solve began with.
    first: Vec<f64>,
    /// Best percussions so far.
    best: Vec<f64>,
    /// The best percussions while others that continue the states of contacts are looked for.
    other: Vec<f64>,
    velocity: Vec<f64>,
    /// The last percussions that ran away.
    astray: Vec<f64>,
    groups: Groups,
}

impl Buffers {
    /// The operator has other entries.
    pub(crate) fn forget_operator(&mut self) {
        self.groups.forget();
    }
}

/// A solve under way.
pub(crate) struct Progress<'a> {
    pub(crate) task: Task<'a>,
    /// Sweeps change its percussions.
    pub(crate) iterate: Iterate<'a>,
    sweeper: &'a mut Sweeper,
    buffers: &'a mut Buffers,
    scale: Scale,
    first_grade: f64,
    /// Natural map of the best percussions.
    grade: f64,
    /// Whether the velocities in the buffers are those of the best percussions.
    known: bool,
    /// The residual by the measure of contacts of the best percussions, where the stop asks for it and it was looked at.
    residual: Option<Residual>,
    /// How they have grown, if they have.
    best_growth: Option<Growth>,
    /// Whether they pass the measure of the stop.
    solved: bool,
    /// The contact of the last sweep that had no solution, the others held.
    stuck: Option<usize>,
    /// Whether better percussions were not kept because they seemed to run away, whether it was asked if a solution exists, and
    /// whether that is proven: better ones are kept then though they have grown, but are not a solution while contacts approach.
    refused: bool,
    asked: bool,
    solvable: bool,
    /// Percussions have grown beyond those kept, and a contact goes on approaching.
    growth: Option<Growth>,
    /// Growth at which a proof that there is no solution is tried next.
    suspicion: f64,
    sweeps: usize,
}

impl<'a> Progress<'a> {
    /// Begins with the percussions of the iterate.
    pub(crate) fn new(
        task: Task<'a>,
        iterate: Iterate<'a>,
        sweeper: &'a mut Sweeper,
        buffers: &'a mut Buffers,
    ) -> Self {
        for list in [&mut buffers.best, &mut buffers.velocity, &mut buffers.astray] {
            list.clear();
            list.resize(task.problem.rows(), 0.0);
        }
        let (grade, solved, stuck, growth) = (f64::INFINITY, false, None, None);
        let (suspicion, sweeps) = (SUSPICION, 0);
        let mut progress = Self {
            task,
            iterate,
            sweeper,
            buffers,
            scale: Scale::of(task.problem),
            first_grade: grade,
            grade,
            known: false,
            residual: None,
            best_growth: None,
            solved,
            stuck,
            refused: false,
            asked: false,
            solvable: false,
            growth,
            suspicion,
            sweeps,
        };
        if task.past == Past::Unswept {
            progress.grade_sweeps();
        } else {
            progress.buffers.velocity.copy_from_slice(progress.iterate.velocity);
            progress.grade_iterate();
        }
        if progress.grade.is_infinite() {
            // Percussions that run away are no start for anything; none at all are.
            progress.iterate.percussion.fill(0.0);
            progress.task.past = Past::Unswept;
            progress.grade_sweeps();
        }
        progress.first_grade = progress.grade;
        progress.buffers.first.clone_from(&progress.buffers.best);
        progress
    }

    /// Puts the best percussions back and tells what has been reached, `limited` by the user's number of iterations or not.
    pub(crate) fn finish(mut self, limited: bool) -> Reached {
        let early = !self.solved && self.task.stop.early();
        if !self.solved && !early {
            self.is_infeasible();
        }
        let Self { task, mut iterate, buffers, growth, best_growth, solvable, .. } = self;
        iterate.percussion.copy_from_slice(&buffers.best);
        let residual = if self.known {
            iterate.velocity.copy_from_slice(&buffers.velocity);
            let Iterate { percussion, velocity, .. } = &iterate;
            self.residual.unwrap_or_else(|| {
                task.stop.residual_with_map(task.problem, percussion, velocity, self.grade)
            })
        } else {
            iterate.measure(&task)
        };
        let iterations = iterate.stages.iter().map(|stage| stage.iterations).sum();
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
        Reached { iterations, ended, residual, growth: best_growth, solvable }
    }

    /// Whether hardly a contact separates with the best percussions: bodies may rest on each other then.
    pub(crate) fn may_stand(&mut self) -> bool {
        let problem = self.task.problem;
        let Buffers { best, velocity, .. } = &mut *self.buffers;
        if !self.known {
            problem.velocity(best, velocity);
            self.known = self.grade.is_finite();
        }
        let loads = problem.free_velocity().iter().zip(problem.restitution());
        let largest = loads.fold(0.0, |m: f64, (b, e)| m.max((b + e).abs()));
        let measured = Measured { problem, percussion: best, velocity };
        let separates = |rows: &&ContactRows| {
            let row = rows.offset;
            // What is pressed by a prescribed force rests upon nothing.
            rows.normal != NormalForce::Unilateral
                || best[row] <= 0.0 && measured.xi(row) > SEPARATING * largest
        };
        let count = problem.contacts().iter().filter(separates).count();
        (count as f64) < FEW_SEPARATE * problem.contacts().len() as f64
    }

    /// Natural map of the best percussions.
    pub(crate) fn best_grade(&self) -> f64 {
        self.grade
    }

    /// Whether the best percussions pass the measure of the stop.
    pub(crate) fn is_solved(&self) -> bool {
        self.solved
    }

    /// Whether nothing is left to do: the problem is solved, has no solution, or the stop says so.
    pub(crate) fn is_over(&self) -> bool {
        self.solved || self.iterate.infeasibility.is_some() || self.task.stop.early()
    }

    /// The contact of the last sweep that had no solution, the others held.
    pub(crate) fn stuck(&self) -> Option<usize> {
        self.stuck
    }

    /// Whether growth is beyond all bounds or proves that there is no solution.
    pub(crate) fn is_hopeless(&mut self) -> bool {
        let Some(growth) = self.growth.filter(|_| !self.solvable) else { return false };
        if growth.factor < self.suspicion {
            return false;
        }
        self.suspicion = SUSPICION * growth.factor;
        self.is_infeasible() || growth.factor >= BOUNDLESS
    }

    /// Whether the percussions that run away prove that there is no solution.
    fn is_infeasible(&mut self) -> bool {
        let proof = &mut *self.iterate.infeasibility;
        if self.growth.is_some() && !self.solvable && proof.is_none() {
            *proof = prove_closing(self.task.problem, &self.buffers.astray);
        }
        proof.is_some()
    }

    /// One sweep over the percussions of the iterate.
    pub(crate) fn sweep(&mut self) {
        let first = self.sweeps == 0;
        let policy = Policy::FirstFound;
        self.stuck = self.sweeper.sweep(&self.task, &mut self.iterate, policy, first);
        self.sweeps += 1;
    }

    /// Where contacts have several solutions, goes to those that continue their states, if that is a solution of the
    /// whole: at most so many sweeps from the best percussions.
    pub(crate) fn continue_states(&mut self, sweeps: usize) {
        self.iterate.percussion.copy_from_slice(&self.buffers.best);
        self.sweeper.sweep(&self.task, &mut self.iterate, Policy::Prove, true);
        if !self.iterate.ambiguous.contains(&true) {
            return;
        }
        // The solution of before, in case the sweeps do not end in another one.
        let (grade, growth) = (self.grade, self.best_growth);
        self.buffers.other.clone_from(&self.buffers.best);
        for _ in 0..sweeps {
            (self.solved, self.grade) = (false, f64::INFINITY);
            self.grade_sweeps();
            if self.solved {
                return;
            }
            if self.task.stop.early() {
                break;
            }
            self.sweeper.sweep(&self.task, &mut self.iterate, Policy::Prove, false);
        }
        (self.solved, self.known, self.grade, self.growth) = (true, false, grade, None);
        (self.residual, self.best_growth) = (None, growth);
        self.buffers.best.clone_from(&self.buffers.other);
    }

    /// Natural map of the percussions of the iterate, kept if they are the best so far.
    pub(crate) fn grade_sweeps(&mut self) -> f64 {
        self.task.problem.velocity(self.iterate.percussion, &mut self.buffers.velocity);
        self.grade_iterate()
    }

    /// The same where the velocities in the buffers are those of the iterate.
    fn grade_iterate(&mut self) -> f64 {
        let percussion = std::mem::take(&mut self.iterate.percussion);
        let grade = self.grade_with_velocities(percussion);
        self.iterate.percussion = percussion;
        grade
    }

    /// Natural map of percussions, kept if they are the best so far.
    pub(crate) fn grade(&mut self, percussion: &[f64]) -> f64 {
        self.velocity(percussion);
        self.grade_with_velocities(percussion)
    }

    /// Velocities `γ_E` of percussions, in the buffers.
    pub(crate) fn velocity(&mut self, percussion: &[f64]) -> &[f64] {
        self.known = false;
        self.task.problem.velocity(percussion, &mut self.buffers.velocity);
        &self.buffers.velocity
    }

    /// The same as [`grade`](Self::grade) where the velocities in the buffers are those of the percussions.
    pub(crate) fn grade_with_velocities(&mut self, percussion: &[f64]) -> f64 {
        let Task { problem, stop, .. } = self.task;
        self.known = false;
        let velocity = &self.buffers.velocity;
        let measured = Measured { problem, percussion, velocity };
        let grade = natural_map::map_with(&measured, self.scale);
        let goal = 0.5 * stop.tolerance;
        let near = stop.is_near(grade, problem.contacts().len());
        let by_contacts = stop.measure == Measure::Contact && near;
        let residual = by_contacts.then(|| natural_residual::residual(&measured));
        let small = match stop.measure {
            Measure::Global => grade <= goal,
            Measure::Contact => residual.is_some_and(|residual| residual.value <= goal),
        };
        let better = small && !self.solved || grade < self.grade && small >= self.solved;
        if better {
            self.keep(percussion, (grade, residual), small);
        }
        grade
    }

    /// Keeps better percussions than before, unless they run away: such look better and better, and are no start
    /// for anything.
    fn keep(&mut self, percussion: &[f64], measures: (f64, Option<Residual>), small: bool) {
        let Buffers { astray, velocity, groups, .. } = &mut *self.buffers;
        let growth = growth::of(self.task.problem, percussion, velocity, groups);
        let kind = growth.map(|growth| growth.kind);
        self.growth = growth;
        if kind >= Some(GrowthKind::Suspicious) {
            astray.copy_from_slice(percussion);
        }
        let runs = kind >= Some(GrowthKind::Boundless);
        if !self.solvable
            && (runs || kind == Some(GrowthKind::Suspicious) && small && self.is_infeasible())
        {
            self.refused |= runs;
            return;
        }
        let solved = small && !runs && kind != Some(GrowthKind::Separating);
        self.growth = None;
        // What passes the measure of contacts but is not kept as solved may be worse than what was there.
        if solved || !self.solved && measures.0 < self.grade {
            (self.grade, self.residual) = measures;
            (self.known, self.solved) = (true, solved);
            self.best_growth = growth;
            self.buffers.best.copy_from_slice(percussion);
        }
    }

    /// Natural map of the percussions that the solve began with.
    pub(crate) fn first_grade(&self) -> f64 {
        self.first_grade
    }

    /// Copies those percussions.
    pub(crate) fn start_from_first(&self, percussion: &mut Vec<f64>) {
        percussion.clone_from(&self.buffers.first);
    }

    /// Copies the best percussions, from which a method starts, and returns their grade.
    pub(crate) fn start_from_best(&self, percussion: &mut Vec<f64>) -> f64 {
        percussion.clone_from(&self.buffers.best);
        self.grade
    }

    /// `max(‖P‖, ρ‖b‖)`, what defects are compared with.
    pub(crate) fn scale(&self, percussion: &[f64]) -> f64 {
        f64::max(norm(percussion), self.scale.loads)
    }

    /// Smallest relative `‖F‖` that is asked for.
    pub(crate) fn floor(&self) -> f64 {
        match self.task.stop.measure {
            Measure::Global => (1e-3 * self.task.stop.tolerance).clamp(1e-15, 2e-12),
            Measure::Contact => 1e-15,
        }
    }

    /// Records what a method did.
    pub(crate) fn record(&mut self, method: Method, iterations: usize, factorizations: usize) {
        let residual = self.grade;
        self.iterate.stages.push(Stage { method, iterations, factorizations, residual });
    }
}

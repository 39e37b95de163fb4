//! The best percussions of a solve so far, and whether they run away.
//!
//! Every method hands the percussions that it finds to [`Incumbent::grade`], which keeps the best ones by the natural map
//! of the whole problem and by the measure of the stop, and begins with the best ones of the method before.

use crate::contact::{ContactRows, NormalForce};
use crate::solver::gauss_seidel::{Iterate, Past, Reached, Sweeper, Task};
use crate::solver::infeasible::prove_closing;
use crate::solver::measure::approach::{Approach, RUNNING};
use crate::solver::measure::natural_map::{self, Scale};
use crate::solver::measure::natural_residual::{self, Measured, Residual};
use crate::solver::measure::stop::Measure;
use crate::solver::one_contact::solve::Policy;
use crate::solver::report::{Ended, Method, Stage};
use crate::vectors::norm;

/// Growth at which a proof is tried for the first time, its factor to the next time, and that from which on percussions are no
/// good start: they come closer to a direction that proves it the more they grow.
const SUSPICION: f64 = 1e4;
/// Velocity relative to the largest load from which on a contact separates, and the part of the contacts that may do so where
/// bodies may rest on each other: stacks, walls and arches have at most 4 % after their first sweeps.
const SEPARATING: f64 = 1e-3;
const FEW_SEPARATE: f64 = 0.05;

/// Buffers.
#[derive(Debug, Clone, Default)]
pub(crate) struct Buffers {
    /// Best percussions so far.
    best: Vec<f64>,
    /// The best percussions while others that continue the states of contacts are looked for.
    other: Vec<f64>,
    velocity: Vec<f64>,
    /// The last percussions that ran away.
    astray: Vec<f64>,
}

/// A solve under way.
pub(crate) struct Incumbent<'a> {
    pub(crate) task: Task<'a>,
    /// Sweeps change its percussions.
    pub(crate) iterate: Iterate<'a>,
    sweeper: &'a mut Sweeper,
    buffers: &'a mut Buffers,
    scale: Scale,
    /// Natural map of the best percussions.
    grade: f64,
    /// Whether the velocities in the buffers are those of the best percussions.
    known: bool,
    /// The residual by the measure of contacts of the best percussions, where the stop asks for it and it was looked at.
    residual: Option<Residual>,
    /// How contacts move with them.
    approach: Option<Approach>,
    /// Their natural map times what they have grown by.
    merit: f64,
    /// Whether they pass the measure of the stop.
    solved: bool,
    /// The contact of the last sweep that had no solution, the others held.
    stuck: Option<usize>,
    /// How far percussions that may prove that there is no solution have grown.
    astray: Option<Approach>,
    /// Whether these were not yet asked for a proof, and whether a small residual was found where contacts move.
    asks: bool,
    doubts: bool,
    /// Growth at which a proof that there is no solution is tried next.
    suspicion: f64,
    sweeps: usize,
}

impl<'a> Incumbent<'a> {
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
        let (grade, solved, stuck) = (f64::INFINITY, false, None);
        let (suspicion, sweeps) = (SUSPICION, 0);
        let mut incumbent = Self {
            task,
            iterate,
            sweeper,
            buffers,
            scale: Scale::of(task.problem),
            grade,
            known: false,
            residual: None,
            approach: None,
            merit: grade,
            solved,
            stuck,
            astray: None,
            asks: false,
            doubts: false,
            suspicion,
            sweeps,
        };
        if task.past == Past::Unswept {
            incumbent.grade_sweeps();
        } else {
            incumbent.buffers.velocity.copy_from_slice(incumbent.iterate.velocity);
            incumbent.grade_iterate();
        }
        if incumbent.merit.is_infinite() {
            // Percussions that run away are no start for anything; none at all are.
            incumbent.iterate.percussion.fill(0.0);
            incumbent.task.past = Past::Unswept;
            incumbent.grade_sweeps();
        }
        incumbent
    }

    /// Puts the best percussions back and tells what has been reached, `limited` by the user's number of iterations or not.
    pub(crate) fn finish(mut self, limited: bool) -> Reached {
        let early = !self.solved && self.task.stop.early();
        if !self.solved && !early {
            self.is_infeasible();
        }
        let Self { task, mut iterate, buffers, astray, .. } = self;
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
        let Iterate { percussion, velocity, .. } = &iterate;
        let measured = Measured { problem: task.problem, percussion, velocity };
        let contacts = 0..task.problem.contacts().len();
        let approach =
            self.approach.unwrap_or_else(|| Approach::of(&measured, contacts, task.stop.tolerance));
        let diverged = astray.filter(Approach::has_diverged).and_then(|astray| astray.flaw());
        let ended = match (diverged, self.stuck) {
            _ if self.solved => Ended::Done,
            _ if early => Ended::TimeLimit,
            (Some(flaw), _) => Ended::Unbounded(flaw.contact),
            _ if limited => Ended::MaxIterations,
            (_, Some(contact)) => Ended::Stuck(contact),
            _ => Ended::Stalled,
        };
        Reached { iterations, ended, residual, approach }
    }

    /// Whether hardly a contact separates with the best percussions: bodies may rest on each other then.
    pub(crate) fn may_rest(&mut self) -> bool {
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
        self.is_infeasible() || self.astray.is_some_and(|astray| astray.has_diverged())
    }

    /// Whether the percussions that run away prove that there is no solution.
    fn is_infeasible(&mut self) -> bool {
        let proof = &mut *self.iterate.infeasibility;
        if std::mem::take(&mut self.asks) && proof.is_none() {
            *proof = prove_closing(self.task.problem, &self.buffers.astray, true);
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
        let before = (self.grade, self.merit, self.approach);
        self.buffers.other.clone_from(&self.buffers.best);
        for _ in 0..sweeps {
            (self.solved, self.merit) = (false, f64::INFINITY);
            self.grade_sweeps();
            if self.solved {
                return;
            }
            if self.task.stop.early() {
                break;
            }
            self.sweeper.sweep(&self.task, &mut self.iterate, Policy::Prove, false);
        }
        (self.grade, self.merit, self.approach) = before;
        (self.solved, self.known, self.residual) = (true, false, None);
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
        let approach = Approach::of(&measured, 0..problem.contacts().len(), stop.tolerance);
        let merit = grade * (approach.growth / RUNNING).max(1.0);
        if approach.growth >= self.suspicion {
            self.suspicion = SUSPICION * approach.growth;
            (self.astray, self.asks) = (Some(approach), true);
            self.buffers.astray.copy_from_slice(percussion);
        }
        if approach.has_diverged() {
            return grade;
        }
        let solved = small && approach.flaw().is_none();
        if small && !solved && !std::mem::replace(&mut self.doubts, true) {
            (self.astray, self.asks) = (Some(approach), true);
            self.buffers.astray.copy_from_slice(percussion);
            self.is_infeasible();
        }
        if solved && !self.solved || merit < self.merit && solved >= self.solved {
            self.astray = None;
            (self.grade, self.merit, self.residual) = (grade, merit, residual);
            (self.known, self.solved, self.approach) = (true, solved, Some(approach));
            self.buffers.best.copy_from_slice(percussion);
        }
        grade
    }

    /// Whether what was found has at most this part of the natural map of the percussions that the solve began with.
    pub(crate) fn has_left(&mut self, part: f64) -> bool {
        let Task { problem, start: percussion, .. } = self.task;
        let velocity = self.velocity(percussion);
        let measured = Measured { problem, percussion, velocity };
        let first = natural_map::map(&measured);
        self.grade <= part * first
    }

    /// Copies the best percussions, from which a method starts, and returns their grade.
    pub(crate) fn start_from_best(&self, percussion: &mut Vec<f64>) -> f64 {
        percussion.clone_from(&self.buffers.best);
        self.grade
    }

    /// An iteration begins anew: how far earlier percussions had grown says nothing of it.
    pub(crate) fn begin_anew(&mut self) {
        self.astray = None;
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

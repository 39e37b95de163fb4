//! A solve: every island of the problem is solved by itself, one island as a list of one.
//!
//! The natural map of the whole weighs islands with one prox parameter: where each of them is solved but not
//! the whole, all of them go on to a smaller tolerance.

use std::cell::Cell;
use std::num::NonZeroU64;

use super::gauss_seidel::{Iterate, Own, Past, Swept, Task};
use super::infeasible::Infeasibility;
use super::island::{Buffers, Islands};
use super::list::{Before, List};
use super::measure::approach::Approach;
use super::measure::natural_residual::{Measured, Residual};
use super::measure::stop::{Measure, Stop};
use super::method::ProxStep;
use super::one_contact::ImplicitRate;
use super::one_contact::block::Block;
use super::one_contact::solve::{ImplicitSolution, OneContact};
use super::report::{Ended, Findings, Method, SolveReport, Stage, Status};
use super::settings::Solver;
use crate::contact::{ContactProblem, ContactState, Members, Memory};
use crate::threads::Threads;

/// Times that all islands go on to a tenth of the tolerance where the natural map of the whole is not small.
const ROUNDS: i32 = 3;
/// What takes the place of [`Solver::Auto`] for a matrix-free operator.
const MATRIX_FREE: Solver =
    Solver::ProxJacobi { step: ProxStep::Adaptive, max_iterations: 1_000_000 };

/// Buffers, and what was found at the last call besides percussions and states.
///
/// What it holds of one problem is found again as long as that is solved; for another one it is prepared anew.
#[derive(Debug, Clone, Default)]
pub struct Workspace {
    /// `γ_E`.
    pub(crate) velocity: Vec<f64>,
    /// Contacts that had more than one solution.
    ambiguous: Vec<bool>,
    /// The proof that there is no solution.
    pub(crate) infeasibility: Option<Infeasibility>,
    stages: Vec<Stage>,
    /// The problem that the buffers were prepared for, if it never changes.
    prepared_for: Option<NonZeroU64>,
    /// What was remembered before the last call.
    before: Memory,
    buffers: Buffers,
    list: List,
}

impl Workspace {
    /// Velocities `γ_E = G P + b` in m/s at the last call, row by row.
    pub fn velocity(&self) -> &[f64] {
        &self.velocity
    }

    /// Whether each contact had more than one solution at the last call, while the others were held.
    pub fn ambiguous(&self) -> &[bool] {
        &self.ambiguous
    }

    /// The proof, where the last call ended as [`Status::NoSolution`].
    pub fn infeasibility(&self) -> Option<&Infeasibility> {
        self.infeasibility.as_ref()
    }

    /// What the methods did at the last call.
    pub fn stages(&self) -> &[Stage] {
        &self.stages
    }

    /// How every island was solved at the last call, which ended with `report` at these percussions.
    pub(super) fn islands(
        &self,
        problem: &ContactProblem,
        stop: Stop<'_>,
        percussion: &[f64],
        report: &SolveReport,
    ) -> Islands {
        let measured = Measured { problem, percussion, velocity: &self.velocity };
        let members = self.buffers.sweeper.islands();
        self.list.islands(members, report, stop, &measured, &self.ambiguous)
    }

    /// Contacts that influence each other.
    pub(super) fn members(&self) -> &Members {
        self.buffers.sweeper.islands()
    }

    /// Buffers for this problem; to be called again whenever its Delassus operator or its laws change.
    #[inline(never)]
    pub(crate) fn prepare(&mut self, problem: &ContactProblem) {
        self.prepared_for = problem.identity();
        self.velocity.resize(problem.rows(), 0.0);
        self.ambiguous.resize(problem.contacts().len(), false);
        self.buffers.prepare(problem);
        self.list = List::default();
    }

    /// Buffers for this problem that know nothing of the problems before.
    pub(crate) fn restart(&mut self, problem: &ContactProblem) {
        *self = Self::default();
        self.prepare(problem);
    }

    /// Brings the buffers up to date with the entries of the Delassus operator, whose pattern has not changed.
    #[inline(never)]
    pub(crate) fn refresh(&mut self, problem: &ContactProblem) {
        self.prepared_for = problem.identity();
        self.buffers.refresh(problem);
        self.list.refresh();
    }

    /// Residual to which Newton's method alone leads the only island of a problem that this was prepared for. Neither proofs nor
    /// other solutions are looked for: where rounding ends it, there is nothing to prove.
    pub(super) fn polish(
        &mut self,
        problem: &ContactProblem,
        stop: Stop<'_>,
        memory: &mut Memory,
        max_iterations: usize,
    ) -> f64 {
        let Self { velocity, ambiguous, infeasibility, stages, before, buffers, .. } = self;
        before.copy_from(memory);
        *infeasibility = None;
        stages.clear();
        let Memory { percussion, states } = memory;
        let mut iterate =
            Iterate { percussion, velocity, states, ambiguous, stages, infeasibility };
        let (start, history, past) = (&before.percussion[..], &before.states[..], Past::Unswept);
        let task = Task { problem, stop, start, history, threads: Threads::NONE, past };
        let methods = buffers.methods.get_or_insert_default();
        let own = iterate.reborrow();
        let reached =
            methods.single(task, own, &mut buffers.sweeper, Method::Newton, max_iterations);
        iterate.classify(problem);
        reached.residual.value
    }

    /// Solves the only contact of a problem.
    #[inline(always)]
    fn solve_only(
        &mut self,
        problem: &ContactProblem,
        history: &ContactState,
        memory: &mut Memory,
    ) -> Option<Swept> {
        let Memory { percussion, states } = memory;
        let Self { velocity, ambiguous, buffers, .. } = self;
        let ([state], [ambiguous]) = (&mut states[..], &mut ambiguous[..]) else { return None };
        let own = Own { percussion, velocity, state, ambiguous };
        Some(buffers.sweeper.solve_only(problem, history, own))
    }

    /// The report on a problem that one sweep has solved.
    #[inline(always)]
    fn solved(&mut self, residual: Residual, ambiguous: bool) -> SolveReport {
        self.infeasibility = None;
        self.list.reports.clear();
        let stage = Stage::of(Method::GaussSeidel, 1, residual);
        if let [only] = &mut self.stages[..] {
            *only = stage;
        } else {
            self.stages.clear();
            self.stages.push(stage);
        }
        let Residual { value: residual, worst_contact } = residual;
        let status = Status::Converged;
        SolveReport { status, iterations: 1, residual, worst_contact, ambiguous }
    }

    /// Whether the buffers have the sizes of this problem.
    #[inline]
    fn fits(&self, problem: &ContactProblem) -> bool {
        self.velocity.len() == problem.rows()
            && self.buffers.sweeper.contacts() == problem.contacts().len()
    }
}

impl Solver {
    /// Solves `problem` from the percussions and states in `memory`, which receives the new ones.
    ///
    /// `workspace` holds the velocities afterwards; it may be that of any problem, and is fastest with that of the last
    /// call. A memory of another size is forgotten.
    pub fn solve(
        &self,
        problem: &ContactProblem,
        stop: Stop<'_>,
        memory: &mut Memory,
        workspace: &mut Workspace,
    ) -> SolveReport {
        if problem.identity().is_none() || problem.identity() != workspace.prepared_for {
            workspace.prepare(problem);
        }
        self.solve_prepared(problem, stop, memory, workspace)
    }

    /// The same with a workspace that has been prepared since the operator or the laws were changed.
    pub(crate) fn solve_prepared(
        &self,
        problem: &ContactProblem,
        stop: Stop<'_>,
        memory: &mut Memory,
        workspace: &mut Workspace,
    ) -> SolveReport {
        let mut before = std::mem::take(&mut workspace.before);
        std::mem::swap(&mut before, memory);
        let report = self.solve_from(problem, stop, &before, memory, workspace);
        workspace.before = before;
        report
    }

    /// Solves `problem` from what was remembered `before`; `memory` receives what is remembered next.
    #[inline]
    pub(crate) fn solve_from(
        &self,
        problem: &ContactProblem,
        stop: Stop<'_>,
        before: &Memory,
        memory: &mut Memory,
        workspace: &mut Workspace,
    ) -> SolveReport {
        // The belt and the disk of many a model: nothing is done here but what one contact needs.
        let mut only = None;
        if let [history] = &before.states[..]
            && self.sweeps_once(problem)
            && workspace.fits(problem)
            && before.fits(problem)
        {
            memory.start_from(before);
            if let Some(swept) = workspace.solve_only(problem, history, memory) {
                let residual = match stop.measure {
                    Measure::Contact => swept.residual(),
                    Measure::Global => {
                        stop.residual(problem, &memory.percussion, &workspace.velocity)
                    }
                };
                if residual.value <= stop.tolerance && swept.is_clear() {
                    return workspace.solved(residual, swept.ambiguous);
                }
                only = Some(swept.measured(residual));
            }
        }
        // Who has given up once has given up: that some work was left is not to be forgotten.
        let given_up = Cell::new(false);
        let ask = |cancelled: &dyn Fn() -> bool| {
            given_up.set(given_up.get() || cancelled());
            given_up.get()
        };
        let latched = || stop.cancelled.is_some_and(ask);
        let cancelled = stop.cancelled.is_some().then_some(&latched as &dyn Fn() -> bool);
        let stop = Stop { cancelled, ..stop };
        if !workspace.fits(problem) {
            workspace.prepare(problem);
        }
        let nothing;
        let before = if before.fits(problem) {
            before
        } else {
            nothing = Memory::new(problem.rows(), problem.contacts().len());
            &nothing
        };
        let solver = match self {
            Self::Auto { .. } if problem.delassus().is_matrix_free() => &MATRIX_FREE,
            solver => solver,
        };
        let by_products = matches!(solver, Self::ProxJacobi { .. });
        if problem.delassus().is_matrix_free() && !by_products {
            return not_applicable(problem, stop, before, memory, workspace);
        }
        solver.solve_list(problem, stop, (before, only), memory, workspace)
    }

    /// The same for any number of contacts, and where something is wrong; `only` is what the sweep over a single contact has
    /// come to, whose percussion the memory holds then.
    #[inline(never)]
    fn solve_list(
        &self,
        problem: &ContactProblem,
        stop: Stop<'_>,
        (before, only): (&Memory, Option<Swept>),
        memory: &mut Memory,
        workspace: &mut Workspace,
    ) -> SolveReport {
        if only.is_none() {
            memory.start_from(before);
        }
        workspace.infeasibility = None;
        workspace.stages.clear();
        let own_threads;
        let threads = match self {
            Self::Auto { threads, .. } => {
                own_threads = Threads::new(*threads, problem.contacts().len());
                &own_threads
            }
            _ => Threads::NONE,
        };
        let (start, history, past) = (&before.percussion[..], &before.states[..], Past::Unswept);
        let mut task = Task { problem, stop, start, history, threads, past };
        let Memory { percussion, states } = memory;
        let Workspace { velocity, ambiguous, infeasibility, stages, buffers, list, .. } = workspace;
        let mut iterate =
            Iterate { percussion, velocity, states, ambiguous, stages, infeasibility };
        list.reports.clear();
        if only.is_none() {
            iterate.ambiguous.fill(false);
        }
        let start;
        if !self.sweeps_once(problem) {
            let sweeps = matches!(self, Self::Exact { .. } | Self::Auto { .. });
            let islands = (buffers.sweeper.islands(), sweeps);
            if let Some(forgotten) = forget_runaways(&task, &mut iterate, islands) {
                start = forgotten;
                task.start = &start;
            }
            // What sweeps find depends on the memory, not on what the workspace has seen before.
            iterate.states.copy_from_slice(task.history);
        } else if problem.contacts().len() != 1 {
            let swept = buffers.sweeper.solve_uncoupled(&task, &mut iterate);
            let residual = swept.measure(&task, &mut iterate);
            // Most steps end here: what follows looks for what is wrong.
            if swept.is_clear() && residual.value <= stop.tolerance {
                return workspace.solved(residual, swept.ambiguous);
            }
        }
        let mut whole = list.solve(self, &task, &mut iterate, buffers, only);
        for round in 1..=ROUNDS {
            let solved = list.reports.iter().all(|own| own.status == Status::Converged);
            if !solved || whole.residual <= stop.tolerance || stop.early() {
                break;
            }
            let before = Before::of(&iterate, &list.reports);
            let tolerance = stop.tolerance * 0.1_f64.powi(round);
            let finer = Task { stop: Stop { tolerance, ..stop }, ..task };
            list.solve(self, &finer, &mut iterate, buffers, None);
            list.keep(&before, &task, &mut iterate, buffers.sweeper.islands());
            whole = list.whole(&task, &iterate);
        }
        whole
    }

    /// Whether one sweep ends the work: no contact influences another.
    #[inline]
    fn sweeps_once(&self, problem: &ContactProblem) -> bool {
        matches!(self, Self::Exact { .. } | Self::Auto { .. }) && problem.is_uncoupled()
    }
}

/// The report of a solver that needs the entries of an operator: nothing changes.
#[cold]
fn not_applicable(
    problem: &ContactProblem,
    stop: Stop<'_>,
    before: &Memory,
    memory: &mut Memory,
    workspace: &mut Workspace,
) -> SolveReport {
    memory.copy_from(before);
    workspace.infeasibility = None;
    workspace.stages.clear();
    workspace.list.reports.clear();
    problem.velocity(&memory.percussion, &mut workspace.velocity);
    let residual = stop.residual(problem, &memory.percussion, &workspace.velocity);
    SolveReport::new(Ended::NotApplicable, 0, residual, Findings::default(), stop.tolerance)
}

/// The report on the percussions of a memory as they are, whoever has found them.
pub(crate) fn grade(
    problem: &ContactProblem,
    stop: Stop<'_>,
    memory: &Memory,
    workspace: &mut Workspace,
) -> SolveReport {
    problem.velocity(&memory.percussion, &mut workspace.velocity);
    let residual = stop.residual(problem, &memory.percussion, &workspace.velocity);
    // A residual is small for percussions that run away, too.
    let (percussion, velocity) = (&memory.percussion[..], &workspace.velocity[..]);
    let measured = Measured { problem, percussion, velocity };
    let approach = Approach::of(&measured, 0..problem.contacts().len(), stop.tolerance);
    let findings = Findings { flaw: approach.flaw(), ..Findings::default() };
    SolveReport::new(Ended::Done, 0, residual, findings, stop.tolerance)
}

/// The solution of one contact with a factor of the speed at the end of the step that continues `state`, the
/// percussions of the other contacts held; `None` where there is none, and with drilling friction.
#[cold]
pub(crate) fn solve_implicit(
    problem: &ContactProblem,
    contact: usize,
    percussion: &[f64],
    state: &ContactState,
    factor: &ImplicitRate<'_>,
    workspace: &mut Workspace,
) -> Option<ImplicitSolution> {
    if problem.delassus().is_matrix_free() {
        return None;
    }
    let block = Block::new(problem, contact);
    let one = OneContact::new(problem, contact, &block, percussion);
    one.solve_implicit(state, factor, &mut workspace.buffers.sweeper.candidates)
}

/// Starts from zero where the percussions of before run away from an island, as they might look like a solution; the start then.
fn forget_runaways(
    task: &Task<'_>,
    iterate: &mut Iterate<'_>,
    (islands, sweeps): (&Members, bool),
) -> Option<Vec<f64>> {
    let (problem, Iterate { percussion, velocity, .. }) = (task.problem, iterate);
    let (mut known, mut forgotten) = (false, false);
    for contacts in (0..islands.count()).map(|island| islands.of(island)) {
        let rows = || contacts.iter().flat_map(|&i| problem.contacts()[i].rows());
        // Sweeps solve a single contact whatever its percussions were.
        if sweeps && contacts.len() == 1 || rows().all(|row| percussion[row] == 0.0) {
            continue;
        }
        if !std::mem::replace(&mut known, true) {
            problem.velocity(percussion, velocity);
        }
        let measured = Measured { problem, percussion, velocity };
        let own = contacts.iter().copied();
        let approach = Approach::of(&measured, own, task.stop.tolerance);
        let finite = rows().all(|row| percussion[row].is_finite());
        if !finite || approach.has_grown() && approach.flaw().is_some() {
            rows().for_each(|row| percussion[row] = 0.0);
            forgotten = true;
        }
    }
    forgotten.then(|| percussion.to_vec())
}

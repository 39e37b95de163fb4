//! Solvers of contact problems.
//!
//! | solver | file | method |
//! |---|---|---|
//! | [`Solver::Auto`] | `auto.rs` | sweeps, Newton, interior point, proximal point: what it takes |
//! | [`Solver::Exact`] | `method/sweeps/sweep.rs` | block Gauss–Seidel, every contact solved exactly (`one_contact/`) |
//! | [`Solver::ProxJacobi`] | `method/prox.rs` | the iteration of \[WL19\] (20)–(22), (69), (70) |
//! | [`Solver::ProxGaussSeidel`] | `method/prox.rs` | the same, contact after contact |
//! | [`Solver::Newton`] | `method/newton.rs` | semismooth Newton on the natural map |
//! | [`Solver::ProximalPoint`] | `method/proximal.rs` | Newton within a proximal point iteration |
//! | [`Solver::InteriorPoint`] | `method/interior.rs` | primal-dual, elliptic laws |
//! | [`Solver::Admm`] | `method/admm.rs` | few factorisations, elliptic laws |
//!
//! `islands.rs` solves contacts that influence no others by themselves, `neighbourhood.rs` some of those that do, while the
//! others are held. The measures in `measure/` belong to no solver and grade them all; `infeasible/` proves that there
//! is no solution.

mod auto;
mod findings;
mod infeasible;
mod islands;
mod measure;
mod method;
mod neighbourhood;
mod newton_matrix;
mod one_contact;
mod report;
mod solution;

pub use infeasible::{Infeasibility, InfeasibilityKind, Unsolvable};
pub use islands::{Island, Islands};
pub use measure::certificate::Certificate;
pub use measure::natural_map::natural_map;
pub use measure::natural_residual::{Residual, natural_residual};
pub use measure::stop::{Measure, Stop};
pub use method::ProxStep;
pub use one_contact::solutions::{ContactSolution, solutions};
pub(crate) use one_contact::{Rising, Uniqueness};
pub use report::{Method, SolveReport, Stage, Status};
pub use solution::Solution;

use std::cell::Cell;
use std::num::NonZeroU64;

use crate::contact::{ContactProblem, ContactRows, ContactState, Members, Memory};
use crate::threads::Threads;
use auto::Methods;
use islands::{Buffers, Found, Parts, Unsolved};
use measure::approach::Approach;
use measure::natural_residual::Measured;
use method::{
    Iterate, Order, Own, Past, Plan, ProxIteration, Reached, Sweeper, Swept, Task, mark_ambiguous,
};
use neighbourhood::Neighbourhood;
use newton_matrix::NewtonMatrix;
use one_contact::block::Block;
use one_contact::solve::{OneContact, Settled};
use report::{Ended, Findings};

/// A solver and its options.
///
/// ```
/// use asperity::contact::{ContactProblem, Memory, NormalForce};
/// use asperity::law::FrictionLaw;
/// use asperity::nalgebra::DMatrix;
/// use asperity::solver::{Solver, Status, Stop, Workspace};
///
/// let contact = (FrictionLaw::<1>::isotropic(0.5)?.into(), NormalForce::Prescribed(2.0));
/// let problem = ContactProblem::new(DMatrix::identity(1, 1), vec![3.0], [contact])?;
/// // Many solves share their buffers and remember what contacts have done.
/// let (mut memory, mut workspace) = (Memory::default(), Workspace::default());
/// let solver = Solver::Exact { max_sweeps: 100 };
/// let report = solver.solve(&problem, Stop::default(), &mut memory, &mut workspace);
/// assert_eq!(report.status, Status::Converged);
/// assert_eq!((&memory.percussion[..], workspace.velocity()), (&[-1.0][..], &[2.0][..]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Solver {
    /// Block Gauss–Seidel whose one-contact solve is exact; one contact needs one sweep.
    Exact {
        /// Sweeps after which the solver gives up.
        max_sweeps: usize,
    },
    /// The solver for everything: sweeps first, then what the problem needs.
    Auto {
        /// Whether the interior point method may be used where the laws allow it.
        interior_point: bool,
        /// Threads for work that is done contact by contact, for islands side by side and for factorisations with large
        /// fronts; results do not depend on it.
        threads: usize,
    },
    /// Semismooth Newton on the natural map: problems of full rank.
    Newton {
        /// Iterations after which the solver gives up.
        max_iterations: usize,
    },
    /// Newton within a proximal point iteration: problems without full rank.
    ProximalPoint {
        /// Outer steps after which the solver gives up.
        max_iterations: usize,
    },
    /// Primal-dual interior point method: unilateral contacts with ellipsoids as reservoir and direction set.
    InteriorPoint {
        /// Iterations after which the solver gives up.
        max_iterations: usize,
    },
    /// Alternating direction method of multipliers, for the same laws.
    Admm {
        /// Iterations after which the solver gives up.
        max_iterations: usize,
    },
    /// The paper's iteration: all contacts at once.
    ProxJacobi {
        /// Prox parameter.
        step: ProxStep,
        /// Iterations after which the solver gives up.
        max_iterations: usize,
    },
    /// The paper's iteration, contact after contact.
    ProxGaussSeidel {
        /// Prox parameter.
        step: ProxStep,
        /// Iterations after which the solver gives up.
        max_iterations: usize,
    },
}

/// Where a solve begins.
#[derive(Clone, Copy)]
struct Start<'a> {
    /// What was remembered before.
    before: &'a Memory,
    past: Past,
    /// Whether the problem is a part of another one, whose other contacts are held.
    within_another: bool,
}

impl<'a> From<&'a Memory> for Start<'a> {
    fn from(before: &'a Memory) -> Self {
        Self { before, past: Past::Unswept, within_another: false }
    }
}

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
    sweeper: Sweeper,
    /// Percussions of a prox iteration.
    next: Vec<f64>,
    methods: Option<Box<Methods>>,
    parts: Parts<Workspace>,
    /// The buffers of neighbourhoods.
    nearby: Option<Box<Workspace>>,
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
    fn islands(
        &self,
        problem: &ContactProblem,
        stop: Stop<'_>,
        percussion: &[f64],
        report: &SolveReport,
    ) -> Islands {
        let measured = Measured { problem, percussion, velocity: &self.velocity };
        self.parts.islands(self.sweeper.islands(), report, stop, &measured)
    }

    /// Buffers for this problem; to be called again whenever its Delassus operator or its laws change.
    #[inline(never)]
    pub(crate) fn prepare(&mut self, problem: &ContactProblem) {
        let contacts = problem.contacts().len();
        self.prepared_for = problem.identity();
        self.velocity.resize(problem.rows(), 0.0);
        self.ambiguous.resize(contacts, false);
        self.sweeper.prepare(problem);
        self.parts.reset();
        if let Some(methods) = &mut self.methods {
            methods.reset();
        }
    }

    /// Buffers for this problem that know nothing of the problems before.
    pub(crate) fn restart(&mut self, problem: &ContactProblem) {
        self.ambiguous.clear();
        self.velocity.clear();
        self.infeasibility = None;
        self.stages.clear();
        self.before.clear();
        self.methods = None;
        self.prepare(problem);
    }

    /// Brings the buffers up to date with the entries of the Delassus operator, whose pattern has not changed.
    #[inline(never)]
    pub(crate) fn refresh(&mut self, problem: &ContactProblem) {
        self.prepared_for = problem.identity();
        self.sweeper.refresh(problem);
        self.parts.refresh();
        if let Some(methods) = &mut self.methods {
            methods.reset();
        }
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
        let Self { velocity, ambiguous, sweeper, .. } = self;
        let ([state], [ambiguous]) = (&mut states[..], &mut ambiguous[..]) else { return None };
        let own = Own { percussion, velocity, state, ambiguous };
        Some(sweeper.solve_only(problem, history, own))
    }

    /// The report on a problem that sweeps have solved.
    #[inline(always)]
    fn solved(&mut self, residual: Residual, iterations: usize, ambiguous: bool) -> SolveReport {
        self.infeasibility = None;
        let stage = Stage::of(Method::GaussSeidel, iterations, residual);
        if let [only] = &mut self.stages[..] {
            *only = stage;
        } else {
            self.stages.clear();
            self.stages.push(stage);
        }
        let Residual { value, worst_contact } = residual;
        let (status, residual) = (Status::Converged, value);
        SolveReport { status, iterations, residual, worst_contact, ambiguous }
    }

    /// Whether the buffers have the sizes of this problem.
    #[inline]
    fn fits(&self, problem: &ContactProblem) -> bool {
        self.velocity.len() == problem.rows() && self.sweeper.contacts() == problem.contacts().len()
    }
}

impl Buffers for Workspace {
    fn prepare(&mut self, problem: &ContactProblem) {
        self.prepare(problem);
    }

    fn refresh(&mut self, problem: &ContactProblem) {
        self.refresh(problem);
    }

    fn are_soon_prepared(problem: &ContactProblem) -> bool {
        NewtonMatrix::known_operations(problem.rows()).is_some()
    }

    fn velocity_mut(&mut self) -> &mut [f64] {
        &mut self.velocity
    }

    fn found(&self) -> Found<'_> {
        let Self { velocity, ambiguous, stages, infeasibility, .. } = self;
        Found { velocity, ambiguous, stages, infeasibility: infeasibility.as_ref() }
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
        if let [history] = &before.states[..]
            && self.sweeps_once(problem)
            && workspace.fits(problem)
            && before.fits(problem)
        {
            memory.start_from(before);
            if let Some(swept) = workspace.solve_only(problem, history, memory) {
                let residual = swept.residual();
                let residual = match stop.measure {
                    Measure::Contact => residual,
                    Measure::Global => {
                        stop.residual(problem, &memory.percussion, &workspace.velocity)
                    }
                };
                if residual.value <= stop.tolerance && swept.is_clear() {
                    return workspace.solved(residual, 1, swept.ambiguous);
                }
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
        self.solve_many(problem, stop, Start::from(before), memory, workspace)
    }

    /// The same for any number of contacts, and where something is wrong.
    #[inline(never)]
    fn solve_many(
        &self,
        problem: &ContactProblem,
        stop: Stop<'_>,
        start: Start<'_>,
        memory: &mut Memory,
        workspace: &mut Workspace,
    ) -> SolveReport {
        let Start { before, past, within_another } = start;
        if !workspace.fits(problem) {
            workspace.prepare(problem);
        }
        if !before.fits(problem) {
            let nothing = Memory::new(problem.rows(), problem.contacts().len());
            let start = Start { before: &nothing, ..start };
            return self.solve_many(problem, stop, start, memory, workspace);
        }
        if problem.delassus().is_matrix_free() {
            match self {
                Self::ProxJacobi { .. } => {}
                Self::Auto { .. } => {
                    return MATRIX_FREE.solve_many(problem, stop, start, memory, workspace);
                }
                _ => return not_applicable(problem, stop, before, memory, workspace),
            }
        }
        memory.start_from(before);
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
        let history = &before.states[..];
        let mut task = Task { problem, stop, history, threads, past, within_another };
        let Memory { percussion, states } = memory;
        let Workspace { velocity, ambiguous, infeasibility, stages, .. } = workspace;
        let Workspace { sweeper, next, methods, parts, nearby, .. } = workspace;
        let mut iterate =
            Iterate { percussion, velocity, states, ambiguous, stages, infeasibility };
        parts.forget_reports();
        iterate.ambiguous.fill(false);
        let mut once = self.sweeps_once(problem);
        let mut found = None;
        if once {
            let swept = sweeper.solve_uncoupled(&task, &mut iterate);
            let residual = swept.measure(&task, &mut iterate);
            // Most steps end here: what follows looks for what is wrong.
            if swept.is_clear() && residual.value <= stop.tolerance {
                return workspace.solved(residual, 1, swept.ambiguous);
            }
            found =
                Some(Reached::of(&task, &iterate, (1, swept.ended), residual, sweeper.islands()));
        } else {
            if forget_runaways(&task, &mut iterate, sweeper.islands()) {
                task.past = Past::Unswept;
            }
        }
        let ends_early = found.is_some_and(|found| found.ended == Ended::TimeLimit);
        let goes_on = matches!(self, Self::Auto { .. }) && !ends_early;
        let by_islands = goes_on && sweeper.islands().count() > 1;
        // With drilling friction the search of a contact is not complete: other methods may find what it has missed.
        let drills = |rows: &ContactRows| rows.law.dimension() == 3;
        if once && goes_on && !by_islands && problem.contacts().iter().any(drills) {
            (once, found, task.past) = (false, None, Past::Stuck);
        }
        if !once || by_islands {
            // What sweeps find depends on the memory, not on what the workspace has seen before.
            iterate.states.copy_from_slice(task.history);
            sweeper.renew_efforts();
        }
        match *self {
            Self::Auto { interior_point, threads } if by_islands => {
                let solve = |island: Unsolved<'_, Workspace>, stop: Stop<'_>, threads| {
                    let Unsolved { problem, before, past, memory, buffers } = island;
                    let solver = Self::Auto { interior_point, threads };
                    let start = Start { before, past, within_another };
                    solver.solve_many(problem, stop, start, memory, buffers)
                };
                if let Some(report) = parts.solve(&task, &mut iterate, sweeper, threads, solve) {
                    return report;
                }
                // All go on together, whatever a sweep over contacts that do not influence each other has found.
                (once, found) = (false, None);
            }
            Self::Exact { max_sweeps } if !once && stop.measure == Measure::Contact => {
                let swept = parts.sweep(&task, &mut iterate, sweeper, max_sweeps);
                let residual = swept.measure(&task, &mut iterate);
                if swept.is_clear() && residual.value <= stop.tolerance {
                    return workspace.solved(residual, swept.sweeps, swept.ambiguous);
                }
                let ended = (swept.sweeps, swept.ended);
                found = Some(Reached::of(&task, &iterate, ended, residual, sweeper.islands()));
            }
            _ => {}
        }
        let reached = match found {
            Some(found) => found,
            None => self.run(&task, &mut iterate, sweeper, methods, nearby, next),
        };
        let mut findings = findings::judge(&task, &reached, &mut iterate);
        let Reached { iterations, ended, residual, .. } = reached;
        // Who has cancelled does not wait for a search of all contacts.
        let left = residual.value > stop.tolerance && stop.early();
        if left || problem.delassus().is_matrix_free() {
            iterate.ambiguous.fill(false);
        } else if !once {
            // A sweep marks contacts before the last ones have moved.
            mark_ambiguous(&task, &mut iterate, sweeper);
        }
        findings.ambiguous = iterate.ambiguous.contains(&true);
        let method = if once { Some(Method::GaussSeidel) } else { self.only_method() };
        if method != Some(Method::GaussSeidel) {
            iterate.states.copy_from_slice(task.history);
            iterate.classify(problem);
        }
        if let Some(method) = method {
            iterate.stages.push(Stage::of(method, iterations, residual));
        }
        let report = SolveReport::new(ended, iterations, residual, findings, stop.tolerance);
        parts.correct(sweeper.islands(), &report);
        report
    }

    /// Whether one sweep ends the work: no contact influences another.
    #[inline]
    fn sweeps_once(&self, problem: &ContactProblem) -> bool {
        matches!(self, Self::Exact { .. } | Self::Auto { .. }) && problem.is_uncoupled()
    }

    /// The method of a solver that has one and does not record what it does.
    fn only_method(&self) -> Option<Method> {
        match self {
            Self::Exact { .. } => Some(Method::GaussSeidel),
            Self::ProxJacobi { .. } | Self::ProxGaussSeidel { .. } => Some(Method::Prox),
            _ => None,
        }
    }

    /// Runs the method.
    #[inline(never)]
    fn run(
        &self,
        task: &Task<'_>,
        iterate: &mut Iterate<'_>,
        sweeper: &mut Sweeper,
        methods: &mut Option<Box<Methods>>,
        nearby: &mut Option<Box<Workspace>>,
        next: &mut Vec<f64>,
    ) -> Reached {
        let mut single = |method, max_iterations| {
            let methods = methods.get_or_insert_default();
            methods.single(*task, iterate.reborrow(), sweeper, method, max_iterations)
        };
        let ended = match *self {
            Self::Exact { max_sweeps } => {
                sweeper.solve_together(task, iterate, Plan::exact(&task.stop, max_sweeps))
            }
            Self::ProxJacobi { step, max_iterations } => {
                let iteration = ProxIteration { order: Order::Jacobi, step, max_iterations };
                iteration.solve(task, iterate, next)
            }
            Self::ProxGaussSeidel { step, max_iterations } => {
                let iteration = ProxIteration { order: Order::GaussSeidel, step, max_iterations };
                iteration.solve(task, iterate, next)
            }
            Self::Auto { interior_point, .. } => {
                let methods = methods.get_or_insert_default();
                let solver = Self::Auto { interior_point, threads: 1 };
                let solve = |part: Neighbourhood<'_>| {
                    let Neighbourhood { problem, stop, before, found } = part;
                    let workspace = nearby.get_or_insert_default();
                    workspace.restart(problem);
                    let start = Start { before, past: Past::Unswept, within_another: true };
                    solver.solve_many(problem, stop, start, found, workspace);
                    workspace.stages.iter().map(|stage| stage.factorizations).sum()
                };
                let iterate = iterate.reborrow();
                return methods.automatic(*task, iterate, sweeper, interior_point, solve);
            }
            Self::Newton { max_iterations } => return single(Method::Newton, max_iterations),
            Self::ProximalPoint { max_iterations } => {
                return single(Method::ProximalPoint, max_iterations);
            }
            Self::InteriorPoint { max_iterations } => {
                return single(Method::InteriorPoint, max_iterations);
            }
            Self::Admm { max_iterations } => return single(Method::Admm, max_iterations),
        };
        let residual = iterate.measure(task);
        Reached::of(task, iterate, ended, residual, sweeper.islands())
    }
}

/// What takes the place of [`Solver::Auto`] for a matrix-free operator.
const MATRIX_FREE: Solver =
    Solver::ProxJacobi { step: ProxStep::Adaptive, max_iterations: 1_000_000 };

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
pub(crate) fn settle(
    problem: &ContactProblem,
    contact: usize,
    percussion: &[f64],
    state: &ContactState,
    factor: &Rising<'_>,
    workspace: &mut Workspace,
) -> Option<Settled> {
    if problem.delassus().is_matrix_free() {
        return None;
    }
    let block = Block::new(problem, contact);
    let one = OneContact::new(problem, contact, &block, percussion);
    one.settle(state, factor, &mut workspace.sweeper.candidates)
}

/// Starts from zero where the percussions of before run away from an island: they might look like a solution; whether it does.
fn forget_runaways(task: &Task<'_>, iterate: &mut Iterate<'_>, islands: &Members) -> bool {
    let (problem, Iterate { percussion, velocity, .. }) = (task.problem, iterate);
    let (mut known, mut forgotten) = (false, false);
    for contacts in (0..islands.count()).map(|island| islands.of(island)) {
        let vanishes = |i: &usize| percussion[problem.contacts()[*i].offset] == 0.0;
        if contacts.len() == 1 || contacts.iter().all(vanishes) {
            continue;
        }
        if !std::mem::replace(&mut known, true) {
            problem.velocity(percussion, velocity);
        }
        let measured = Measured { problem, percussion, velocity };
        let own = contacts.iter().copied();
        let approach = Approach::of(&measured, own, task.stop.tolerance);
        let rows = || contacts.iter().flat_map(|&i| problem.contacts()[i].rows());
        let finite = rows().all(|row| percussion[row].is_finite());
        if !finite || approach.has_grown() && approach.flaw().is_some() {
            rows().for_each(|row| percussion[row] = 0.0);
            forgotten = true;
        }
    }
    forgotten
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::contact::NormalForce;
    use crate::law::FrictionLaw;

    /// Sweeps leave islands whose contacts share a load, unless they start from the solution.
    #[test]
    fn islands_that_sweeps_solve_are_forgotten_after_some_solves() {
        let mut delassus = DMatrix::identity(4, 4);
        for (i, j) in [(0, 2), (1, 3)] {
            (delassus[(i, j)], delassus[(j, i)]) = (0.999, 0.999);
        }
        let law = FrictionLaw::<1>::isotropic(0.5).unwrap();
        let contacts = vec![(law.into(), NormalForce::Prescribed(2.0)); 4];
        let problem = ContactProblem::new(delassus, vec![0.3, 0.2, 0.3, 0.2], contacts).unwrap();
        for measure in [Measure::Contact, Measure::Global] {
            let (mut workspace, mut memory) = (Workspace::default(), Memory::default());
            let stop = Stop::default().with_measure(measure);
            let mut solve = |memory: &mut Memory| {
                let report = Solver::default().solve(&problem, stop, memory, &mut workspace);
                assert_eq!(report.status, Status::Converged);
                workspace.parts.kept()
            };
            assert_eq!(solve(&mut memory), 2);
            let kept: Vec<usize> = (0..40).map(|_| solve(&mut memory)).collect();
            let last = 32;
            assert_eq!(kept[..last], vec![2; last]);
            assert_eq!(kept[last..], [0; 8]);
            assert_eq!(solve(&mut Memory::default()), 2);
        }
    }

    /// Whenever time ends, also between two measures, what is said is the measure of the percussions that are returned.
    #[test]
    fn velocities_and_residuals_are_those_of_the_percussions_whenever_time_ends() {
        let law = crate::law::Law::from(FrictionLaw::<1>::isotropic(0.5).unwrap());
        let mut ended = Vec::new();
        // Of the last two contacts the whole sees nothing where their loads are small.
        for (coupling, load) in [(0.45, 1.0), (1e-4, 1e-13)] {
            let mut delassus = DMatrix::identity(6, 6);
            for (i, j, value) in [(0, 1, coupling), (2, 3, coupling), (4, 5, 0.45)] {
                (delassus[(i, j)], delassus[(j, i)]) = (value, value);
            }
            let contacts = vec![(law.clone(), NormalForce::Prescribed(2.0)); 6];
            let free = vec![0.3, 0.2, 0.3, 0.4, -0.2 * load, -0.3 * load];
            let problem = ContactProblem::new(delassus, free, contacts).unwrap();
            let measures = [Measure::Contact, Measure::Global].into_iter();
            for (measure, questions) in measures.flat_map(|m| (0..40).map(move |n| (m, n))) {
                let left = Cell::new(questions);
                let ask = || {
                    let none = left.get() == 0;
                    left.set(usize::saturating_sub(left.get(), 1));
                    none
                };
                let stop = Stop::at(1e-10).with_measure(measure).unless(&ask);
                let solution = problem.solve(&Solver::default(), stop);
                let velocity = problem.velocities(&solution.percussion).unwrap();
                assert_eq!(solution.velocity, velocity, "{load} {measure:?} {questions}");
                let residual = stop.residual(&problem, &solution.percussion, &velocity).value;
                assert_eq!(solution.report.residual, residual, "{load} {measure:?} {questions}");
                assert_eq!(solution.report.status == Status::Converged, residual <= 1e-10);
                ended.push(solution.report.status);
            }
        }
        assert!(ended.contains(&Status::TimeLimit) && ended.contains(&Status::Converged));
    }

    /// Of contacts without any defect the first one is named.
    #[test]
    fn the_worst_contact_is_one_of_those_that_are_asked_for() {
        let law = FrictionLaw::<1>::isotropic(0.5).unwrap();
        let contacts = vec![(law.into(), NormalForce::Unilateral); 3];
        let problem = ContactProblem::new(DMatrix::identity(6, 6), vec![0.0; 6], contacts).unwrap();
        let measured = Measured { problem: &problem, percussion: &[0.0; 6], velocity: &[0.0; 6] };
        let residual = measure::natural_residual::residual_of(&measured, [1, 2]);
        assert_eq!((residual.value, residual.worst_contact), (0.0, 1));
    }
}

//! A solve: every island of the problem is solved by itself, one island as a list of one.
//!
//! Sweeps go over all islands where they are and solve most of them. What they leave is solved as a problem with the rows of
//! that island only. The natural map of the whole weighs islands with one prox parameter: where each of them is solved but not
//! the whole, all of them go on to a smaller tolerance.

use std::cell::Cell;
use std::num::NonZeroU64;
use std::sync::atomic::{AtomicBool, Ordering};

use super::gauss_seidel::{Iterate, Own, Past, Plan, Swept, Task};
use super::infeasible::Infeasibility;
use super::island::{Buffers, Given, Islands, Subproblem};
use super::measure::approach::{Approach, Flaw};
use super::measure::natural_residual::{Measured, Residual, is_worse};
use super::measure::phase::phase_of;
use super::measure::stop::{Measure, Stop};
use super::method::ProxStep;
use super::one_contact::Rising;
use super::one_contact::block::Block;
use super::one_contact::solve::{OneContact, Settled};
use super::report::{Ended, Findings, Method, SolveReport, Stage, Status, flaw_status};
use super::settings::Solver;
use crate::contact::{ContactProblem, ContactState, Members, Memory};
use crate::threads::Threads;

/// Contacts that are worth a second thread: what sweeps leave takes some tens of microseconds per contact.
const WORTHWHILE: usize = 64;
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
        self.list.islands(self.buffers.sweeper.islands(), report, stop, &measured)
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
        self.list.own.iter_mut().flatten().for_each(|own| own.stale = true);
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
        solver.solve_list(problem, stop, before, memory, workspace)
    }

    /// The same for any number of contacts, and where something is wrong.
    #[inline(never)]
    fn solve_list(
        &self,
        problem: &ContactProblem,
        stop: Stop<'_>,
        before: &Memory,
        memory: &mut Memory,
        workspace: &mut Workspace,
    ) -> SolveReport {
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
        let (start, history, past) = (&before.percussion[..], &before.states[..], Past::Unswept);
        let task = Task { problem, stop, start, history, threads, past };
        let Memory { percussion, states } = memory;
        let Workspace { velocity, ambiguous, infeasibility, stages, buffers, list, .. } = workspace;
        let mut iterate =
            Iterate { percussion, velocity, states, ambiguous, stages, infeasibility };
        list.reports.clear();
        iterate.ambiguous.fill(false);
        if self.sweeps_once(problem) {
            let swept = buffers.sweeper.solve_uncoupled(&task, &mut iterate);
            let residual = swept.measure(&task, &mut iterate);
            // Most steps end here: what follows looks for what is wrong.
            if swept.is_clear() && residual.value <= stop.tolerance {
                return workspace.solved(residual, swept.ambiguous);
            }
        } else {
            forget_runaways(&task, &mut iterate, buffers.sweeper.islands());
        }
        // What sweeps find depends on the memory, not on what the workspace has seen before.
        iterate.states.copy_from_slice(task.history);
        buffers.sweeper.renew_efforts();
        let mut whole = list.solve(self, &task, &mut iterate, buffers);
        for round in 1..=ROUNDS {
            let solved = list.reports.iter().all(|own| own.status == Status::Converged);
            if !solved || !(whole.residual > stop.tolerance) || stop.early() {
                break;
            }
            let tolerance = stop.tolerance * 0.1_f64.powi(round);
            let task = Task { stop: Stop { tolerance, ..stop }, ..task };
            let reports = list.reports.clone();
            whole = list.solve(self, &task, &mut iterate, buffers);
            list.keep_status(&reports, stop.tolerance);
            whole = list.whole(&Task { stop, ..task }, &iterate, whole.iterations);
        }
        whole
    }

    /// Whether one sweep ends the work: no contact influences another.
    #[inline]
    fn sweeps_once(&self, problem: &ContactProblem) -> bool {
        matches!(self, Self::Exact { .. } | Self::Auto { .. }) && problem.is_uncoupled()
    }

    /// The sweeps over all islands that a solver begins with.
    fn plan(&self, stop: &Stop<'_>) -> Option<Plan> {
        match *self {
            Self::Auto { .. } => Some(Plan::trial(stop)),
            Self::Exact { max_sweeps } => Some(Plan::exact(stop, max_sweeps)),
            _ => None,
        }
    }
}

/// An island that is being solved, with its number.
type Work = (usize, Box<Subproblem>);

/// The islands of a problem, and what is kept of them from one solve to the next.
#[derive(Debug, Clone, Default)]
struct List {
    /// The islands that sweeps have left once.
    own: Vec<Option<Box<Subproblem>>>,
    /// Those that are being solved.
    work: Vec<Work>,
    /// What sweeps have come to, and what they have left.
    swept: Vec<Swept>,
    left: Vec<usize>,
    /// How islands ended.
    reports: Vec<SolveReport>,
}

impl List {
    /// Solves all islands; how the whole has ended.
    fn solve(
        &mut self,
        solver: &Solver,
        task: &Task<'_>,
        iterate: &mut Iterate<'_>,
        buffers: &mut Buffers,
    ) -> SolveReport {
        let Task { problem, stop, .. } = *task;
        let count = buffers.sweeper.islands().count();
        self.reports.clear();
        self.swept.clear();
        let plan = solver.plan(&stop);
        if let Some(plan) = plan {
            buffers.sweeper.solve_islands(task, iterate, plan, &mut self.swept);
            let all = self.swept.iter().fold(Swept::NOTHING, |all, swept| all.and(*swept));
            iterate.stages.push(Stage::of(Method::GaussSeidel, all.sweeps, all.residual()));
        }
        let first_stages = iterate.stages.len();
        self.reports.extend(self.swept.iter().map(|swept| {
            let findings = Findings { ambiguous: swept.ambiguous, ..Findings::default() };
            SolveReport::new(swept.ended, swept.sweeps, swept.residual(), findings, stop.tolerance)
        }));
        let visited = self.reports.len();
        // Where time has ended the sweeps, no island is solved any more, and those that were not visited are measured at the end.
        let cut = plan.is_some()
            && (visited < count || self.swept.iter().any(|own| own.ended == Ended::TimeLimit));
        let unknown = Residual { value: f64::INFINITY, worst_contact: 0 };
        let waiting =
            SolveReport::new(Ended::TimeLimit, 0, unknown, Findings::default(), stop.tolerance);
        self.reports.resize(count, waiting);
        self.choose_left(solver, stop.tolerance);
        if stop.deadline.is_some() {
            // A large one that takes all the time would leave many small ones unsolved.
            self.left.sort_by_key(|&island| buffers.sweeper.islands().of(island).len());
        }
        let mut waits = cut;
        if !cut && count == 1 && self.left == [0] {
            let report = buffers.solve(solver, *task, iterate, self.swept.first());
            self.put(0, report);
        } else if !cut && !self.left.is_empty() {
            waits = self.solve_left(solver, task, iterate, buffers, first_stages);
        }
        for &island in self.left.iter().filter(|_| cut) {
            self.reports[island].status = Status::TimeLimit;
        }
        if waits {
            problem.velocity(iterate.percussion, iterate.velocity);
            let Iterate { percussion, velocity, states, .. } = iterate;
            let measured = Measured { problem, percussion, velocity };
            for (island, report) in self.reports.iter_mut().enumerate() {
                if report.status != Status::TimeLimit {
                    continue;
                }
                let contacts = buffers.sweeper.islands().of(island);
                for &i in contacts {
                    let (phase, slip) = phase_of(&measured, i);
                    states[i] = task.history[i].after(phase, slip);
                }
                *report = graded(*report, stop, &measured, contacts);
            }
        }
        let iterations = iterate.stages.iter().map(|stage| stage.iterations).sum();
        self.whole(task, iterate, iterations)
    }

    /// The islands that sweeps have not solved, or have not looked at.
    fn choose_left(&mut self, solver: &Solver, tolerance: f64) {
        let selects = matches!(solver, Solver::Exact { .. });
        self.left.clear();
        self.left.extend((0..self.reports.len()).filter(|&island| {
            self.swept.get(island).is_none_or(|swept| {
                // Which of several solutions continues the states of contacts, the first that is found does not decide.
                let decided = selects || swept.is_decided();
                !(decided && swept.is_clear() && swept.residual().value <= tolerance)
            })
        }));
    }

    /// Takes in how an island ended that sweeps had left.
    fn put(&mut self, island: usize, found: SolveReport) {
        let iterations = self.swept.get(island).map_or(0, |swept| swept.sweeps);
        let iterations = iterations + found.iterations;
        self.reports[island] = SolveReport { iterations, ..found };
    }

    /// Solves what sweeps have left as problems of their own, side by side where that is worth it; whether some of them wait.
    fn solve_left(
        &mut self,
        solver: &Solver,
        task: &Task<'_>,
        iterate: &mut Iterate<'_>,
        buffers: &mut Buffers,
        first_stages: usize,
    ) -> bool {
        let Task { problem, start, history, .. } = *task;
        let islands = buffers.sweeper.islands();
        self.own.resize_with(islands.count(), || None);
        for &island in &self.left {
            let make = || Box::new(Subproblem::new(problem, islands.of(island)));
            let mut own = self.own[island].take().unwrap_or_else(make);
            own.report = None;
            self.work.push((island, own));
        }
        let Iterate { percussion, velocity, states, .. } = &*iterate;
        let given = Given { problem, start, history, states, percussion, velocity };
        solve_all(solver, (&mut self.work, &self.swept), task, given);
        // What is said of them does not depend on the order in which they were solved.
        self.work.sort_by_key(|(island, _)| *island);
        let mut waits = false;
        for (island, own) in std::mem::take(&mut self.work) {
            match own.end(problem, iterate, first_stages) {
                Some(report) => self.put(island, report),
                None => {
                    self.reports[island].status = Status::TimeLimit;
                    waits = true;
                }
            }
            self.own[island] = Some(own);
        }
        waits
    }

    /// An island that has passed the tolerance of the user is solved, whatever a smaller one has left.
    fn keep_status(&mut self, before: &[SolveReport], tolerance: f64) {
        for (report, before) in self.reports.iter_mut().zip(before) {
            if report.status != Status::NoSolution && report.residual <= tolerance {
                report.status = before.status;
            }
        }
    }

    /// The report on all islands: the gravest status of them is that of the whole.
    fn whole(&self, task: &Task<'_>, iterate: &Iterate<'_>, iterations: usize) -> SolveReport {
        let Task { problem, stop, .. } = *task;
        let mut worst = self.reports[0];
        let mut residual = Residual { value: f64::NEG_INFINITY, worst_contact: 0 };
        for report in &self.reports {
            if is_graver(report.status, worst.status) {
                worst = *report;
            }
            if is_worse(report.residual, residual.value) {
                residual = Residual { value: report.residual, worst_contact: report.worst_contact };
            }
        }
        if stop.measure == Measure::Global {
            residual = stop.residual(problem, iterate.percussion, iterate.velocity);
            if worst.status == Status::Converged && residual.value > stop.tolerance {
                let ended = if stop.early() { Ended::TimeLimit } else { Ended::Done };
                worst = SolveReport::new(ended, 0, residual, Findings::default(), stop.tolerance);
            }
        }
        let proven = iterate.infeasibility.as_ref().map(|proof| proof.contact);
        let worst_contact = match worst.status {
            Status::Converged => residual.worst_contact,
            Status::NoSolution => proven.unwrap_or(worst.worst_contact),
            _ => worst.worst_contact,
        };
        SolveReport {
            status: worst.status,
            iterations,
            residual: residual.value,
            worst_contact,
            ambiguous: iterate.ambiguous.contains(&true),
        }
    }

    /// How every island was solved; of a problem that one sweep has solved they are measured now.
    fn islands(
        &self,
        members: &Members,
        whole: &SolveReport,
        stop: Stop<'_>,
        measured: &Measured<'_>,
    ) -> Islands {
        let mut reports = self.reports.clone();
        if reports.len() != members.count() {
            let report = |island: usize| match members.count() {
                1 => *whole,
                _ => graded(*whole, stop, measured, members.of(island)),
            };
            reports = (0..members.count()).map(report).collect();
        }
        Islands { members: members.clone(), reports }
    }
}

/// Solves islands as problems of their own, side by side where that is worth it.
fn solve_all(
    solver: &Solver,
    (work, swept): (&mut [Work], &[Swept]),
    task: &Task<'_>,
    given: Given<'_>,
) {
    let threads = match solver {
        Solver::Auto { threads, .. } => *threads,
        _ => 1,
    };
    let contacts: usize = work.iter().map(|(_, own)| own.len()).sum();
    let Stop { tolerance, measure, deadline, .. } = task.stop;
    if work.len() > 1 && contacts >= WORTHWHILE {
        let given_up = AtomicBool::new(false);
        let share = |(island, own): &mut Work| {
            let cancelled = || given_up.load(Ordering::Relaxed);
            if cancelled() {
                return;
            }
            let stop = Stop { tolerance, measure, deadline, cancelled: Some(&cancelled) };
            let task = Task {
                problem: given.problem,
                stop,
                start: given.start,
                history: given.history,
                threads: Threads::NONE,
                past: Past::Unswept,
            };
            own.solve(solver, task, given, swept.get(*island));
        };
        let ask = || {
            if task.stop.early() {
                given_up.store(true, Ordering::Relaxed);
            }
        };
        if Threads::of(threads).share(work, share, ask) {
            return;
        }
    }
    for (island, own) in work {
        if task.stop.early() {
            break;
        }
        let threads = &Threads::new(threads, own.len());
        own.solve(solver, Task { threads, ..*task }, given, swept.get(*island));
    }
}

/// The report on an island that was measured and not solved by itself.
fn graded(
    ended: SolveReport,
    stop: Stop<'_>,
    measured: &Measured<'_>,
    contacts: &[usize],
) -> SolveReport {
    let Residual { value, worst_contact } = stop.residual_of(measured, contacts);
    let approach = Approach::of(measured, contacts.iter().copied(), stop.tolerance);
    let (status, worst_contact) = match approach.flaw() {
        _ if !(value <= stop.tolerance) => (ended.status, worst_contact),
        Some(flaw) => (flaw_status(flaw), flaw.contact),
        None => (Status::Converged, worst_contact),
    };
    SolveReport { status, residual: value, worst_contact, ..ended }
}

/// The gravest status of the islands, the last one of these, is that of the whole.
const GRAVITY: [Status; 8] = [
    Status::Converged,
    Status::Inexact,
    Status::Stalled,
    Status::MaxIterations,
    Status::TimeLimit,
    Status::NotApplicable,
    Status::Unbounded,
    Status::NoSolution,
];

fn is_graver(status: Status, than: Status) -> bool {
    GRAVITY.iter().rev().take_while(|other| **other != than).any(|other| *other == status)
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
    one.settle(state, factor, &mut workspace.buffers.sweeper.candidates)
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
        let runs = |flaw: Flaw| flaw.unbounded;
        if !finite || approach.flaw().is_some_and(runs) {
            rows().for_each(|row| percussion[row] = 0.0);
            forgotten = true;
        }
    }
    forgotten
}

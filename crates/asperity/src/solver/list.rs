//! The islands of a problem one by one.
//!
//! Sweeps go over all islands where they are and solve most of them. What they leave is solved as a problem with the rows of
//! that island only, or in place where it is the only one.

use std::sync::atomic::{AtomicBool, Ordering};

use super::gauss_seidel::{Iterate, Past, Plan, Swept, Task};
use super::island::{Buffers, Given, Islands, Subproblem};
use super::measure::approach::Approach;
use super::measure::natural_residual::{Measured, Residual, is_worse};
use super::measure::phase::phase_of;
use super::measure::stop::{Measure, Stop};
use super::report::{Ended, Findings, Method, SolveReport, Stage, Status, flaw_status};
use super::settings::Solver;
use crate::contact::{Members, Memory};
use crate::threads::Threads;

/// Contacts that are worth a second thread: what sweeps leave takes some tens of microseconds per contact.
const WORTHWHILE: usize = 64;

/// An island that is being solved, with its number.
type Work = (usize, Box<Subproblem>);

/// The islands of a problem, and what is kept of them from one solve to the next.
#[derive(Debug, Clone, Default)]
pub(super) struct List {
    /// The islands that sweeps have left once.
    own: Vec<Option<Box<Subproblem>>>,
    /// Those that are being solved.
    work: Vec<Work>,
    /// What sweeps have come to, and what they have left.
    swept: Vec<Swept>,
    left: Vec<usize>,
    /// How islands ended.
    pub(super) reports: Vec<SolveReport>,
}

impl List {
    /// The operator of the problem has other entries.
    pub(super) fn refresh(&mut self) {
        self.own.iter_mut().flatten().for_each(|own| own.stale = true);
    }

    /// Solves all islands; how the whole has ended. What a sweep over the only contact has come to is not found anew.
    pub(super) fn solve(
        &mut self,
        solver: &Solver,
        task: &Task<'_>,
        iterate: &mut Iterate<'_>,
        buffers: &mut Buffers,
        only: Option<Swept>,
    ) -> SolveReport {
        let Task { problem, stop, .. } = *task;
        let count = buffers.sweeper.islands().count();
        self.reports.clear();
        self.swept.clear();
        let plan = plan(solver, &stop);
        if let Some(plan) = plan {
            match only {
                Some(swept) if stop.early() => self.swept.push(swept.given_up()),
                Some(swept) => self.swept.push(swept),
                None => buffers.sweeper.solve_islands(task, iterate, plan, &mut self.swept),
            }
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
            let islands = buffers.sweeper.islands();
            self.left.sort_unstable_by_key(|&island| (islands.of(island).len(), island));
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
            let Iterate { percussion, velocity, states, ambiguous, .. } = iterate;
            let measured = Measured { problem, percussion, velocity };
            for (island, report) in self.reports.iter_mut().enumerate() {
                if report.status != Status::TimeLimit {
                    continue;
                }
                let contacts = buffers.sweeper.islands().of(island);
                // Contacts that were not looked at keep their states.
                for &i in contacts.iter().filter(|_| island < self.swept.len()) {
                    let (phase, slip) = phase_of(&measured, i);
                    states[i] = task.history[i].after(phase, slip);
                }
                // Who has cancelled does not wait for a search of all contacts.
                contacts.iter().for_each(|&i| ambiguous[i] = false);
                *report = graded(*report, stop, &measured, (contacts, ambiguous));
            }
        }
        self.whole(task, iterate)
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
        let Iterate { percussion, velocity, states, ambiguous, .. } = &*iterate;
        let given = Given { problem, start, history, states, ambiguous, percussion, velocity };
        solve_all(solver, (&mut self.work, &self.swept), task, given);
        // What is said of them does not depend on the order in which they were solved.
        self.work.sort_by_key(|(island, _)| *island);
        let mut waits = false;
        let mut work = std::mem::take(&mut self.work);
        for (island, own) in work.drain(..) {
            match own.end(problem, iterate, first_stages) {
                Some(report) => self.put(island, report),
                None => {
                    self.reports[island].status = Status::TimeLimit;
                    waits = true;
                }
            }
            self.own[island] = Some(own);
        }
        self.work = work;
        // Products of the whole may round in another order, and a problem of one contact has another scale.
        problem.velocity(iterate.percussion, iterate.velocity);
        let Iterate { percussion, velocity, .. } = &*iterate;
        let measured = Measured { problem, percussion, velocity };
        for &island in &self.left {
            let residual = task.stop.residual_of(&measured, islands.of(island));
            self.reports[island].measure_again(residual, task.stop.tolerance);
        }
        waits
    }

    /// After a round with a smaller tolerance: an island that has passed that of the user is solved, and one that does not pass
    /// it any more goes back to what was there before.
    pub(super) fn keep(
        &mut self,
        before: &Before,
        task: &Task<'_>,
        iterate: &mut Iterate<'_>,
        islands: &Members,
    ) {
        for (island, (report, old)) in self.reports.iter_mut().zip(&before.reports).enumerate() {
            let iterations = report.iterations + old.iterations;
            if report.status == Status::NoSolution {
                *report = SolveReport { iterations, ..*report };
            } else if report.residual <= task.stop.tolerance {
                let ambiguous = report.ambiguous || old.ambiguous;
                *report = SolveReport { status: old.status, iterations, ambiguous, ..*report };
            } else {
                *report = SolveReport { iterations, ..*old };
                for &i in islands.of(island) {
                    let rows = task.problem.contacts()[i].rows();
                    let Before { memory, velocity, ambiguous, .. } = before;
                    iterate.percussion[rows.clone()]
                        .copy_from_slice(&memory.percussion[rows.clone()]);
                    iterate.velocity[rows.clone()].copy_from_slice(&velocity[rows]);
                    iterate.states[i] = memory.states[i];
                    iterate.ambiguous[i] = ambiguous[i];
                }
            }
        }
    }

    /// The report on all islands: the gravest status of them is that of the whole.
    pub(super) fn whole(&self, task: &Task<'_>, iterate: &Iterate<'_>) -> SolveReport {
        let Task { problem, stop, .. } = *task;
        let nothing = Residual { value: 0.0, worst_contact: 0 };
        let solved = SolveReport::new(Ended::Done, 0, nothing, Findings::default(), 0.0);
        let mut worst = self.reports.first().copied().unwrap_or(solved);
        let mut residual = Residual { value: worst.residual, worst_contact: worst.worst_contact };
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
            if worst.status == Status::Converged && !(residual.value <= stop.tolerance) {
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
            iterations: iterate.stages.iter().map(|stage| stage.iterations).sum(),
            residual: residual.value,
            worst_contact,
            ambiguous: iterate.ambiguous.contains(&true),
        }
    }

    /// How every island was solved; of a problem that one sweep has solved they are measured now.
    pub(super) fn islands(
        &self,
        members: &Members,
        whole: &SolveReport,
        stop: Stop<'_>,
        measured: &Measured<'_>,
        ambiguous: &[bool],
    ) -> Islands {
        let mut reports = self.reports.clone();
        if reports.len() != members.count() {
            let report = |island: usize| match members.count() {
                1 => *whole,
                _ => graded(*whole, stop, measured, (members.of(island), ambiguous)),
            };
            reports = (0..members.count()).map(report).collect();
        }
        Islands { members: members.clone(), reports }
    }
}

/// What islands have come to before a round with a smaller tolerance.
pub(super) struct Before {
    memory: Memory,
    velocity: Vec<f64>,
    ambiguous: Vec<bool>,
    reports: Vec<SolveReport>,
}

impl Before {
    pub(super) fn of(iterate: &Iterate<'_>, reports: &[SolveReport]) -> Self {
        let Iterate { percussion, velocity, states, ambiguous, .. } = iterate;
        let memory = Memory { percussion: percussion.to_vec(), states: states.to_vec() };
        let (velocity, ambiguous) = (velocity.to_vec(), ambiguous.to_vec());
        Self { memory, velocity, ambiguous, reports: reports.to_vec() }
    }
}

/// The sweeps over all islands that a solver begins with.
fn plan(solver: &Solver, stop: &Stop<'_>) -> Option<Plan> {
    match *solver {
        Solver::Auto { .. } => Some(Plan::trial(stop)),
        Solver::Exact { max_sweeps } => Some(Plan::exact(stop, max_sweeps)),
        _ => None,
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
    (contacts, ambiguous): (&[usize], &[bool]),
) -> SolveReport {
    let residual = stop.residual_of(measured, contacts);
    let Residual { value, worst_contact } = residual;
    let approach = Approach::of(measured, contacts.iter().copied(), stop.tolerance);
    let (status, worst_contact) = match approach.flaw() {
        _ if !(value <= stop.tolerance) => (ended.status, worst_contact),
        Some(flaw) => (flaw_status(flaw), flaw.contact),
        None => (Status::Converged, worst_contact),
    };
    let ambiguous = contacts.iter().any(|&i| ambiguous[i]);
    let mut report = SolveReport { status, worst_contact, ambiguous, ..ended };
    // Where the whole is solved by its measure, that does not see what is left here.
    report.measure_again(residual, stop.tolerance);
    report
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

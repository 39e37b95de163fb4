//! Islands: contacts that influence each other, directly or by others, and nothing else.
//!
//! Every island is a problem of its own: it has its own scaling, goes through its own phases and ends by itself. Sweeps
//! solve most islands where they are ([`Sweeper::solve_islands`]); what they leave is solved by the other methods as a
//! problem with the rows of that island only. What an island does depends on no other, to the bit, so that islands may be
//! solved side by side by any number of threads. Only where each of them is solved, but not the whole by the global
//! measure, do all go on together.

use std::sync::atomic::{AtomicBool, Ordering};

use super::infeasibility::{Case, CaseState, Infeasibility};
use super::measure::natural_residual::{Measured, Residual, is_worse, residual_of};
use super::measure::stop::{Measure, Stop};
use super::method::{Iterate, Plan, Sweeper, Swept, Task, Threads};
use super::report::{Ended, Findings, Method, SolveReport, Stage, Status};
use crate::contact::{ContactProblem, Members, Memory, Part, put, take};

/// Contacts that are worth a second thread: what sweeps leave takes some tens of microseconds per contact.
const WORTHWHILE: usize = 64;

/// The residual of an island that was not looked at.
const UNKNOWN: Residual = Residual { value: f64::INFINITY, worst_contact: 0 };

/// How every island of a problem was solved.
///
/// ```
/// use asperity::contact::{ContactProblem, NormalForce};
/// use asperity::law::FrictionLaw;
/// use asperity::nalgebra::DMatrix;
/// use asperity::solver::{Solver, Status, Stop};
///
/// // The first and the third contact touch the same body.
/// let mut delassus = DMatrix::identity(3, 3);
/// (delassus[(0, 2)], delassus[(2, 0)]) = (0.5, 0.5);
/// let law = FrictionLaw::<1>::isotropic(0.5)?;
/// let contacts = vec![(law.into(), NormalForce::Prescribed(2.0)); 3];
/// let problem = ContactProblem::new(delassus, vec![3.0, 0.2, 0.1], contacts)?;
/// let solution = problem.solve(&Solver::default(), Stop::default());
/// let islands: Vec<&[usize]> = solution.islands.iter().map(|island| island.contacts).collect();
/// assert_eq!(islands, [&[0, 2][..], &[1]]);
/// assert!(solution.islands.iter().all(|island| island.report.status == Status::Converged));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Islands {
    members: Members,
    reports: Vec<SolveReport>,
}

/// Contacts that influence each other, directly or by others, and how they were solved together.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Island<'a> {
    /// The contacts, ascending.
    pub contacts: &'a [usize],
    /// How the solver ended there. Without iterations the percussions of before had solved the problem already.
    pub report: SolveReport,
}

impl Islands {
    /// Number of islands.
    pub fn len(&self) -> usize {
        self.reports.len()
    }

    /// Whether there are no contacts at all.
    pub fn is_empty(&self) -> bool {
        self.reports.is_empty()
    }

    /// The islands, in the order of their first contacts.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Island<'_>> {
        let island = |(number, report): (usize, &SolveReport)| Island {
            contacts: self.members.of(number),
            report: *report,
        };
        self.reports.iter().enumerate().map(island)
    }
}

/// Buffers in which an island is solved as a problem of its own.
pub(super) trait Buffers: Default {
    /// Makes them fit a problem.
    fn prepare(&mut self, problem: &ContactProblem);

    /// The operator of the problem has other entries.
    fn refresh(&mut self, problem: &ContactProblem);

    /// What was found at the last solve besides percussions and states.
    fn found(&self) -> Found<'_>;
}

/// What was found besides percussions and states.
pub(super) struct Found<'a> {
    pub(super) velocity: &'a [f64],
    pub(super) ambiguous: &'a [bool],
    pub(super) stages: &'a [Stage],
    pub(super) infeasibility: Option<&'a Infeasibility>,
}

/// An island to be solved from what was remembered `before`; `memory` receives what is remembered next.
pub(super) struct Unsolved<'a, B> {
    pub(super) problem: &'a ContactProblem,
    pub(super) before: &'a Memory,
    pub(super) memory: &'a mut Memory,
    pub(super) buffers: &'a mut B,
}

/// An island that sweeps have left, as a problem of its own, and its solution.
#[derive(Debug, Clone)]
struct Own<B> {
    part: Part,
    /// Whether the entries of its operator are those of another step.
    stale: bool,
    before: Memory,
    memory: Memory,
    buffers: B,
    report: Option<SolveReport>,
}

impl<B: Buffers> Own<B> {
    fn new(part: Part) -> Self {
        let problem = part.problem();
        let memory = Memory::new(problem.rows(), problem.contacts().len());
        let mut buffers = B::default();
        buffers.prepare(problem);
        Self { part, stale: false, before: memory.clone(), memory, buffers, report: None }
    }

    /// What is needed to solve it.
    fn unsolved(&mut self) -> Unsolved<'_, B> {
        let Self { part, before, memory, buffers, .. } = self;
        Unsolved { problem: part.problem(), before, memory, buffers }
    }

    /// Takes over what the island is given in this solve.
    fn begin(&mut self, task: &Task<'_>, percussion: &[f64]) {
        let Self { part, before, buffers, .. } = self;
        if std::mem::take(&mut self.stale) {
            part.copy_operator(task.problem);
            buffers.refresh(part.problem());
        }
        part.copy_velocities(task.problem);
        take(part.rows(), percussion, &mut before.percussion);
        take(part.contacts(), task.history, &mut before.states);
        self.report = None;
    }

    /// Hands over what was found.
    fn end(&self, iterate: &mut Iterate<'_>) {
        let Self { part, memory, buffers, .. } = self;
        let found = buffers.found();
        put(part.rows(), &memory.percussion, iterate.percussion);
        put(part.rows(), found.velocity, iterate.velocity);
        put(part.contacts(), &memory.states, iterate.states);
        put(part.contacts(), found.ambiguous, iterate.ambiguous);
        merge(found.stages, iterate.stages);
    }

    /// The proof that there is no solution, said of the whole problem.
    fn infeasibility(&self, whole: &ContactProblem) -> Option<Infeasibility> {
        let proof = self.buffers.found().infeasibility?;
        let Infeasibility { kind, contact, direction, cases, .. } = proof;
        let spread = |direction: &[f64]| {
            let mut out = vec![0.0; whole.rows()];
            put(self.part.rows(), direction, &mut out);
            out
        };
        let cases = cases.iter().map(|case| {
            let mut states = vec![CaseState::Any; whole.contacts().len()];
            put(self.part.contacts(), &case.states, &mut states);
            Case { states, direction: spread(&case.direction) }
        });
        Some(Infeasibility {
            kind: *kind,
            contact: self.part.contacts()[*contact],
            direction: spread(direction),
            cases: cases.collect(),
            closing_velocity: proof.closing_velocity,
            residual: proof.residual,
        })
    }
}

/// What is kept of islands from one solve to the next.
#[derive(Debug, Clone, Default)]
pub(super) struct Parts<B> {
    /// The islands that sweeps have left once.
    own: Vec<Option<Box<Own<B>>>>,
    /// Those of the islands that are being solved.
    work: Vec<Box<Own<B>>>,
    /// Those that they left in the last solve.
    left: Vec<usize>,
    /// What sweeps have come to, and how islands ended.
    pub(super) swept: Vec<Swept>,
    pub(super) reports: Vec<SolveReport>,
}

impl<B> Parts<B> {
    /// Forgets the islands of another problem.
    pub(super) fn reset(&mut self) {
        self.own.clear();
        self.reports.clear();
    }

    /// Forgets how islands ended in another solve.
    pub(super) fn forget_reports(&mut self) {
        self.reports.clear();
    }

    /// The sweeps of [`Solver::Exact`], island by island; what all of them have come to.
    pub(super) fn sweep(
        &mut self,
        task: &Task<'_>,
        iterate: &mut Iterate<'_>,
        sweeper: &mut Sweeper,
        max_sweeps: usize,
    ) -> Swept {
        let plan = Plan::exact(&task.stop, max_sweeps);
        sweeper.solve_islands(task, iterate, plan, &mut self.swept);
        self.report_sweeps(task.stop.tolerance);
        self.swept.iter().fold(Swept::NOTHING, |all, swept| all.and(*swept))
    }

    /// How sweeps ended, island by island.
    fn report_sweeps(&mut self, tolerance: f64) {
        let report = |swept: &Swept| {
            let findings = Findings { ambiguous: swept.ambiguous, ..Findings::default() };
            SolveReport::new(swept.ended, swept.sweeps, swept.residual(), findings, tolerance)
        };
        self.reports.clear();
        self.reports.extend(self.swept.iter().map(report));
    }

    /// The island that has kept the whole from being solved ended as the whole did: proofs come after sweeps.
    pub(super) fn correct(&mut self, members: &Members, whole: &SolveReport) {
        if whole.status == Status::Converged {
            return;
        }
        let worst =
            |island: &usize| members.of(*island).binary_search(&whole.worst_contact).is_ok();
        if let Some(island) = (0..self.reports.len()).find(worst) {
            let report = &mut self.reports[island];
            (report.status, report.worst_contact) = (whole.status, whole.worst_contact);
        }
    }

    /// The entries of the operator are other ones.
    pub(super) fn refresh(&mut self) {
        self.own.iter_mut().flatten().for_each(|own| own.stale = true);
    }

    /// How every island was solved, with what is known of the whole where nothing is known of them.
    pub(super) fn islands(
        &self,
        members: &Members,
        whole: &SolveReport,
        tolerance: f64,
        residual: impl Fn(&[usize]) -> Residual,
    ) -> Islands {
        let mut reports = self.reports.clone();
        if reports.len() != members.count() {
            reports.clear();
            reports.extend((0..members.count()).map(|island| {
                if members.count() == 1 {
                    return *whole;
                }
                let Residual { value, worst_contact } = residual(members.of(island));
                let of_one = matches!(whole.status, Status::NoSolution | Status::Unbounded);
                let own = members.of(island).binary_search(&whole.worst_contact).is_ok();
                let status = match value <= tolerance {
                    // What is said of one island says nothing of others.
                    _ if of_one && own => whole.status,
                    true => Status::Converged,
                    false if of_one => Status::Stalled,
                    false => whole.status,
                };
                SolveReport { status, residual: value, worst_contact, ..*whole }
            }));
        }
        Islands { members: members.clone(), reports }
    }
}

impl<B: Buffers + Send> Parts<B> {
    /// Solves a problem of several islands, one by one; `None` where each of them is solved, but not the whole by its
    /// measure. What sweeps leave is given to `solve`, together with the number of threads that it may use itself.
    pub(super) fn solve(
        &mut self,
        task: &Task<'_>,
        iterate: &mut Iterate<'_>,
        sweeper: &mut Sweeper,
        threads: usize,
        solve: impl Fn(Unsolved<'_, B>, Stop<'_>, usize) -> SolveReport + Sync,
    ) -> Option<SolveReport> {
        let Task { problem, stop, .. } = *task;
        let count = sweeper.islands().count();
        let sweeps = stop.measure == Measure::Contact;
        self.swept.clear();
        if sweeps {
            sweeper.solve_islands(task, iterate, Plan::trial(&stop), &mut self.swept);
        } else {
            self.swept.resize(count, Swept::NOTHING);
        }
        self.report_sweeps(stop.tolerance);
        let Parts { own, work, left, swept, reports } = self;
        left.clear();
        let mut together = Swept::NOTHING;
        for (island, (swept, report)) in swept.iter().zip(&*reports).enumerate() {
            // Which of several solutions continues the states of contacts, the first that is found does not tell.
            let alone = sweeper.islands().of(island).len() == 1;
            let decided = sweeps && (alone || !swept.ambiguous);
            if !(decided && swept.is_clear() && report.residual <= stop.tolerance) {
                left.push(island);
            }
            together = together.and(*swept);
        }
        if sweeps {
            let residual = together.residual();
            iterate.stages.push(Stage::of(Method::GaussSeidel, together.sweeps, residual));
        }
        // Those that the time did not suffice for are measured at the end.
        let unvisited =
            SolveReport::new(Ended::TimeLimit, 0, UNKNOWN, Findings::default(), stop.tolerance);
        reports.resize(count, unvisited);
        own.resize_with(count, || None);
        for &island in &*left {
            let make = || Box::new(Own::new(Part::new(problem, sweeper.islands().of(island))));
            let mut own = own[island].take().unwrap_or_else(make);
            own.begin(task, iterate.percussion);
            work.push(own);
        }
        solve_all(work, task, threads, solve);
        let mut left_over = swept.len() < count;
        for (solved, &island) in work.drain(..).zip(&*left) {
            let report = &mut reports[island];
            if let Some(found) = solved.report {
                solved.end(iterate);
                if iterate.infeasibility.is_none() {
                    *iterate.infeasibility = solved.infeasibility(problem);
                }
                let worst_contact = solved.part.contacts()[found.worst_contact];
                let iterations = report.iterations + found.iterations;
                *report = SolveReport { worst_contact, iterations, ..found };
            } else {
                // Its turn has not come: it keeps the percussions that sweeps have led to.
                report.status = Status::TimeLimit;
                left_over = true;
            }
            own[island] = Some(solved);
        }
        if left_over {
            grade_unsolved(task, iterate, sweeper.islands(), reports);
        }
        // Velocities of islands that were solved are those of their percussions.
        let known = left_over || left.len() == count;
        let whole = whole(task, iterate, reports, known);
        if whole.is_none() {
            // What follows changes all of them.
            reports.clear();
        }
        whole
    }
}

/// Solves islands as problems of their own, side by side where that is worth it.
fn solve_all<B: Buffers + Send>(
    work: &mut [Box<Own<B>>],
    task: &Task<'_>,
    threads: usize,
    solve: impl Fn(Unsolved<'_, B>, Stop<'_>, usize) -> SolveReport + Sync,
) {
    let contacts: usize = work.iter().map(|own| own.part.contacts().len()).sum();
    let several = work.len() > 1 && contacts >= WORTHWHILE;
    let Stop { tolerance, measure, deadline, .. } = task.stop;
    let given_up = AtomicBool::new(false);
    let share = |own: &mut Box<Own<B>>| {
        let cancelled = || given_up.load(Ordering::Relaxed);
        let stop = Stop { tolerance, measure, deadline, cancelled: Some(&cancelled) };
        own.report = Some(solve(own.unsolved(), stop, 1));
    };
    let ask = || {
        if task.stop.early() {
            given_up.store(true, Ordering::Relaxed);
        }
    };
    if several && Threads::of(threads).share(work, share, ask) {
        return;
    }
    for own in work {
        if task.stop.early() {
            break;
        }
        own.report = Some(solve(own.unsolved(), task.stop, threads));
    }
}

/// Measures the islands that the time did not suffice for.
#[cold]
fn grade_unsolved(
    task: &Task<'_>,
    iterate: &mut Iterate<'_>,
    members: &Members,
    reports: &mut [SolveReport],
) {
    iterate.measure(task);
    let Iterate { percussion, velocity, .. } = iterate;
    let measured = Measured { problem: task.problem, percussion, velocity };
    for (island, report) in reports.iter_mut().enumerate() {
        if report.status == Status::TimeLimit {
            let contacts = members.of(island).iter().copied();
            let Residual { value, worst_contact } = residual_of(&measured, contacts);
            let status =
                if value <= task.stop.tolerance { Status::Converged } else { report.status };
            *report = SolveReport { status, residual: value, worst_contact, ..*report };
        }
    }
}

/// The report on all islands; `None` where each of them is solved, but not the whole by its measure.
fn whole(
    task: &Task<'_>,
    iterate: &mut Iterate<'_>,
    reports: &[SolveReport],
    known: bool,
) -> Option<SolveReport> {
    let stop = task.stop;
    let ambiguous = iterate.ambiguous.contains(&true);
    let mut worst = reports[0];
    let mut residual = Residual { value: f64::NEG_INFINITY, worst_contact: 0 };
    for report in reports {
        if rank(report.status) > rank(worst.status) {
            worst = *report;
        }
        if is_worse(report.residual, residual.value) {
            residual = Residual { value: report.residual, worst_contact: report.worst_contact };
        }
    }
    if stop.measure == Measure::Global {
        residual = if known {
            stop.residual(task.problem, iterate.percussion, iterate.velocity)
        } else {
            iterate.measure(task)
        };
        let decided = matches!(worst.status, Status::NoSolution | Status::Unbounded);
        if !decided && residual.value <= stop.tolerance {
            worst.status = Status::Converged;
        } else if worst.status == Status::Converged {
            return None;
        }
    }
    let iterations = iterate.stages.iter().map(|stage| stage.iterations).sum();
    let proven = iterate.infeasibility.as_ref().map(|proof| proof.contact);
    let worst_contact = match worst.status {
        Status::Converged => residual.worst_contact,
        Status::NoSolution => proven.unwrap_or(worst.worst_contact),
        _ => worst.worst_contact,
    };
    Some(SolveReport {
        status: worst.status,
        iterations,
        residual: residual.value,
        worst_contact,
        ambiguous,
    })
}

/// Of several islands that with the largest number says how the whole has ended.
fn rank(status: Status) -> u8 {
    match status {
        Status::Converged => 0,
        Status::Inexact => 1,
        Status::Stalled => 2,
        Status::MaxIterations => 3,
        Status::TimeLimit => 4,
        Status::NotApplicable => 5,
        Status::Unbounded => 6,
        Status::NoSolution => 7,
    }
}

/// Puts what an island went through beside what others did: the most iterations count, and all factorisations.
fn merge(own: &[Stage], all: &mut Vec<Stage>) {
    let mut place = 0;
    for stage in own {
        let same = all[place..].iter().position(|other| other.method == stage.method);
        let Some(next) = same else {
            all.insert(place, *stage);
            place += 1;
            continue;
        };
        let other = &mut all[place + next];
        other.iterations = other.iterations.max(stage.iterations);
        other.factorizations += stage.factorizations;
        other.residual =
            if is_worse(stage.residual, other.residual) { stage.residual } else { other.residual };
        place += next + 1;
    }
}

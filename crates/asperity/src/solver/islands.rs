//! Islands: contacts that influence each other, directly or by others, and nothing else.
//!
//! Every island is a problem of its own: it has its own scaling, goes through its own phases and ends by itself. Sweeps
//! solve most islands where they are ([`Sweeper::solve_islands`]); what they leave is solved by the other methods as a
//! problem with the rows of that island only. What an island does depends on no other, to the bit, so that islands may be
//! solved side by side by any number of threads. Only where each of them is solved, but not the whole by the global
//! measure, do all go on together. By the global measure islands of small percussions are left as sweeps leave them once
//! the measure of the whole is small.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use super::infeasible::Infeasibility;
use super::measure::approach::{Approach, Flaw};
use super::measure::natural_map::{Scale, Squares, map_of, own_squares};
use super::measure::natural_residual::{Measured, Residual, is_worse, residual_of};
use super::measure::phase::phase_of;
use super::measure::stop::{Measure, Stop};
use super::method::{Iterate, Past, Plan, Sweeper, Swept, Task};
use super::report::{Ended, Findings, Method, SolveReport, Stage, Status, flaw_status};
use crate::contact::{ContactProblem, ContactState, Members, Memory, Part, put, take};
use crate::threads::Threads;

/// Contacts that are worth a second thread: what sweeps leave takes some tens of microseconds per contact.
const WORTHWHILE: usize = 64;

/// Solves without use after which the problem of an island is forgotten, which takes some kilobytes per contact: islands
/// that sweeps leave now and then keep their analysis.
const KEPT: u8 = 32;

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
    /// How the solver ended there, by the measure of this island alone: where the whole is solved by the global measure, an
    /// island of small percussions may be left as stalled. Without iterations nothing was done there:
    /// the percussions of before had solved it already, or its turn had not come, as its status tells.
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
pub(super) trait Buffers: Default + Send {
    /// Makes them fit a problem.
    fn prepare(&mut self, problem: &ContactProblem);

    /// The operator of the problem has other entries.
    fn refresh(&mut self, problem: &ContactProblem);

    /// The velocities of the percussions that a solve starts from, or of those that it has found.
    fn velocity_mut(&mut self) -> &mut [f64];

    /// Whether they keep nothing of a problem that is dear to find again: no analysis of its pattern.
    fn are_soon_prepared(problem: &ContactProblem) -> bool;

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
    pub(super) past: Past,
    pub(super) memory: &'a mut Memory,
    pub(super) buffers: &'a mut B,
}

/// What islands are given in a solve: what sweeps have left of the whole.
#[derive(Clone, Copy)]
struct Given<'a> {
    problem: &'a ContactProblem,
    history: &'a [ContactState],
    percussion: &'a [f64],
    velocity: &'a [f64],
    swept: &'a [Swept],
}

/// An island that sweeps have left, as a problem of its own, and its solution.
#[derive(Debug, Clone)]
struct OwnProblem<B> {
    part: Part,
    /// Whether the entries of its operator are those of another step.
    stale: bool,
    /// Solves since it was left.
    unused: u8,
    before: Memory,
    past: Past,
    memory: Memory,
    buffers: B,
    /// Whether the buffers are those of another island.
    foreign: bool,
    /// What was found besides percussions and states, as in [`Found`]: the buffers may go on to another island.
    velocity: Vec<f64>,
    ambiguous: Vec<bool>,
    stages: Vec<Stage>,
    infeasibility: Option<Infeasibility>,
    report: Option<SolveReport>,
}

impl<B: Buffers> OwnProblem<B> {
    fn new(whole: &ContactProblem, contacts: &[usize]) -> Self {
        let part = Part::new(whole, contacts);
        let memory = Memory::new(part.problem().rows(), contacts.len());
        let mut buffers = B::default();
        buffers.prepare(part.problem());
        let before = memory.clone();
        Self {
            velocity: vec![0.0; part.problem().rows()],
            ambiguous: vec![false; contacts.len()],
            part,
            stale: false,
            unused: 0,
            before,
            past: Past::Unswept,
            memory,
            buffers,
            foreign: false,
            stages: Vec::new(),
            infeasibility: None,
            report: None,
        }
    }

    /// Takes the buffers of the island that was solved last, which are in the cache of the processor, where its own ones would
    /// have to be prepared anew, too.
    fn take_buffers(&mut self, last: &mut Self) {
        let soon = |own: &Self| B::are_soon_prepared(own.part.problem());
        if self.stale && soon(self) && soon(last) {
            std::mem::swap(&mut self.buffers, &mut last.buffers);
            (self.foreign, last.foreign) = (true, true);
        }
    }

    /// Keeps what was found, which the buffers still hold.
    fn keep(&mut self) {
        let Found { velocity, ambiguous, stages, infeasibility } = self.buffers.found();
        self.velocity.copy_from_slice(velocity);
        self.ambiguous.copy_from_slice(ambiguous);
        self.stages.clear();
        self.stages.extend_from_slice(stages);
        self.infeasibility = infeasibility.cloned();
    }

    /// Takes over what the island, of this number, is given in this solve. It is solved at once, while its data are at hand.
    fn begin(&mut self, island: usize, given: Given<'_>) {
        let Given { problem, history, percussion, velocity, swept } = given;
        let Self { part, before, buffers, .. } = self;
        let (stale, foreign) = (std::mem::take(&mut self.stale), std::mem::take(&mut self.foreign));
        if stale {
            part.copy_operator(problem);
        }
        match (foreign, stale) {
            (true, _) => buffers.prepare(part.problem()),
            (false, true) => buffers.refresh(part.problem()),
            (false, false) => {}
        }
        part.copy_velocities(problem);
        take(part.rows(), percussion, &mut before.percussion);
        take(part.rows(), velocity, buffers.velocity_mut());
        take(part.contacts(), history, &mut before.states);
        self.past = if swept[island].stuck { Past::Stuck } else { Past::Swept };
    }

    /// What is needed to solve it.
    fn unsolved(&mut self) -> Unsolved<'_, B> {
        let Self { part, before, past, memory, buffers, .. } = self;
        Unsolved { problem: part.problem(), before, past: *past, memory, buffers }
    }

    /// Squares of what is left, with the prox parameter of the whole.
    fn squares(&self, rho: f64) -> Squares {
        let (problem, percussion) = (self.part.problem(), &self.memory.percussion[..]);
        let measured = Measured { problem, percussion, velocity: &self.velocity };
        Squares::of(&measured, 0..problem.contacts().len(), rho)
    }

    /// Hands over what was found; the first stages are those of all islands together.
    fn end(&self, iterate: &mut Iterate<'_>, first_stages: usize) {
        let Self { part, memory, velocity, ambiguous, stages, .. } = self;
        put(part.rows(), &memory.percussion, iterate.percussion);
        put(part.rows(), velocity, iterate.velocity);
        put(part.contacts(), &memory.states, iterate.states);
        put(part.contacts(), ambiguous, iterate.ambiguous);
        merge(stages, iterate.stages, first_stages);
    }

    /// The proof that there is no solution, said of the whole problem.
    fn infeasibility(&self, whole: &ContactProblem) -> Option<Infeasibility> {
        let proof = self.infeasibility.as_ref()?;
        let Infeasibility { kind, contact, direction, .. } = proof;
        let spread = |direction: &[f64]| {
            let mut out = vec![0.0; whole.rows()];
            put(self.part.rows(), direction, &mut out);
            out
        };
        Some(Infeasibility {
            kind: *kind,
            contact: self.part.contacts()[*contact],
            direction: spread(direction),
            closing_velocity: proof.closing_velocity,
            residual: proof.residual,
        })
    }
}

/// What islands leave of the measure of the whole, in the order in which they are solved: as soon as it is small, the
/// others need not be solved. Which ones these are does not depend on threads.
#[derive(Debug, Clone, Default)]
struct Tally {
    /// Square of the measure that will do.
    goal: f64,
    scale: Scale,
    /// What the islands from each place on leave before they are solved.
    rest: Vec<Squares>,
    /// What those that were solved leave, and the sum of that at the first places, up to the first that was not, and of what
    /// sweeps have solved.
    found: Vec<Option<Squares>>,
    sum: Squares,
    solved: usize,
    /// Places whose islands are solved in any case.
    always: usize,
}

impl Tally {
    /// Puts the islands that sweeps have `left` in the order in which they are solved: first those with a small residual,
    /// of which something else has to be found out, then the largest ones, by `max(‖P‖, ρ‖b‖)`.
    fn begin(
        measured: &Measured<'_>,
        stop: &Stop<'_>,
        (islands, reports): (&Members, &[SolveReport]),
        left: &mut [usize],
    ) -> Self {
        let problem = measured.problem;
        let (goal, scale) = (0.5 * stop.tolerance, Scale::of(problem));
        let small = |island: usize| reports[island].residual <= stop.tolerance;
        let mut sizes = vec![None; islands.count()];
        for &island in &*left {
            sizes[island] = Some(map_of(measured, islands.of(island)).1);
        }
        let size = |island: usize| sizes[island].unwrap_or(0.0);
        let squares =
            |island: usize| Squares::of(measured, islands.of(island).iter().copied(), scale.rho);
        let solved = (0..islands.count()).filter(|&island| sizes[island].is_none());
        let sum = solved.fold(Squares::default(), |sum, island| sum.and(squares(island)));
        left.sort_by(|&one, &other| {
            small(other).cmp(&small(one)).then(size(other).total_cmp(&size(one)))
        });
        let mut rest = vec![Squares::default(); left.len() + 1];
        for (place, &island) in left.iter().enumerate().rev() {
            // A light island makes the prox parameter of the whole so small that the velocities of heavy ones do not count.
            let (own, _) = own_squares(measured, islands.of(island));
            rest[place] = rest[place + 1].and(squares(island).or_worse(own));
        }
        Self {
            goal: goal * goal,
            scale,
            rest,
            found: vec![None; left.len()],
            sum,
            solved: 0,
            always: left.iter().take_while(|&&island| small(island)).count(),
        }
    }

    /// Whether the islands that follow those that were solved need not be solved.
    fn is_enough(&self) -> bool {
        let left = self.sum.and(self.rest[self.solved]);
        self.solved >= self.always && left.relative(self.scale.loads.powi(2)) <= self.goal
    }

    /// Takes in an island that was solved.
    fn put(&mut self, place: usize, squares: Squares) {
        self.found[place] = Some(squares);
        while !self.is_enough()
            && let Some(Some(squares)) = self.found.get(self.solved)
        {
            self.sum = self.sum.and(*squares);
            self.solved += 1;
        }
    }
}

/// An island that is being solved, with its number.
type Work<B> = (usize, Box<OwnProblem<B>>);

/// What is kept of islands from one solve to the next.
#[derive(Debug, Clone, Default)]
pub(super) struct Parts<B> {
    /// The islands that sweeps have left once.
    own: Vec<Option<Box<OwnProblem<B>>>>,
    /// Those that are being solved, with their numbers.
    work: Vec<Work<B>>,
    /// What sweeps have come to, what they have left, and how islands ended, if they were solved one by one.
    swept: Vec<Swept>,
    left: Vec<usize>,
    reports: Vec<SolveReport>,
}

impl<B: Buffers> Parts<B> {
    /// Forgets the islands of another problem.
    pub(super) fn reset(&mut self) {
        self.own.clear();
        self.reports.clear();
    }

    /// Number of islands that are kept as problems of their own.
    #[cfg(test)]
    pub(super) fn kept(&self) -> usize {
        self.own.iter().flatten().count()
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
        self.sweep_with(task, iterate, sweeper, plan)
    }

    /// Sweeps, and how they ended, island by island; what all of them have come to.
    fn sweep_with(
        &mut self,
        task: &Task<'_>,
        iterate: &mut Iterate<'_>,
        sweeper: &mut Sweeper,
        plan: Plan,
    ) -> Swept {
        sweeper.solve_islands(task, iterate, plan, &mut self.swept);
        let report = |swept: &Swept| {
            let findings = Findings { ambiguous: swept.ambiguous, ..Findings::default() };
            let residual = swept.residual();
            SolveReport::new(swept.ended, swept.sweeps, residual, findings, task.stop.tolerance)
        };
        self.reports.clear();
        self.reports.extend(self.swept.iter().map(report));
        self.swept.iter().fold(Swept::NOTHING, |all, swept| all.and(*swept))
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
        stop: Stop<'_>,
        measured: &Measured<'_>,
    ) -> Islands {
        let mut reports = self.reports.clone();
        if reports.len() != members.count() {
            let of_one = matches!(whole.status, Status::NoSolution | Status::Unbounded);
            let report = |island: usize| {
                let own = members.of(island);
                let is_worst = own.binary_search(&whole.worst_contact).is_ok();
                match (members.count(), of_one) {
                    (1, _) => *whole,
                    (_, true) if is_worst => {
                        let Residual { value, .. } = stop.residual_of(measured, own);
                        SolveReport { residual: value, ..*whole }
                    }
                    // What is said of one island says nothing of others.
                    (_, true) => {
                        let left = SolveReport { status: Status::Stalled, ..*whole };
                        graded(left, stop, measured, own)
                    }
                    _ => graded(*whole, stop, measured, own),
                }
            };
            reports.clear();
            reports.extend((0..members.count()).map(report));
        }
        Islands { members: members.clone(), reports }
    }

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
        self.sweep_and_leave(task, iterate, sweeper);
        let islands = sweeper.islands();
        let Parts { own, work, swept, left, reports } = self;
        let (visited, count) = (reports.len(), islands.count());
        // Those that the time does not suffice for are measured at the end.
        let unsolved =
            SolveReport::new(Ended::TimeLimit, 0, UNKNOWN, Findings::default(), stop.tolerance);
        reports.resize(count, unsolved);
        // Where time has ended the sweeps, none of those that are left is solved, and all are measured at the end.
        let cut = visited < count || swept.iter().any(|swept| swept.ended == Ended::TimeLimit);
        let counts = stop.measure == Measure::Global && !cut && !left.is_empty();
        let mut tally = counts.then(|| {
            let Iterate { percussion, velocity, .. } = &*iterate;
            let measured = Measured { problem, percussion, velocity };
            Tally::begin(&measured, &stop, (islands, reports), left)
        });
        own.resize_with(count, || None);
        for kept in own.iter_mut() {
            kept.iter_mut().for_each(|own| own.unused += 1);
            kept.take_if(|own| own.unused > KEPT);
        }
        let mut needed = 0;
        if tally.as_ref().is_none_or(|tally| !tally.is_enough()) {
            for &island in &*left {
                let make = || Box::new(OwnProblem::new(problem, islands.of(island)));
                let mut own = own[island].take().unwrap_or_else(make);
                (own.unused, own.report) = (0, None);
                work.push((island, own));
            }
            let Iterate { percussion, velocity, .. } = &*iterate;
            let history = task.history;
            let given = Given { problem, history, percussion, velocity, swept };
            needed = solve_all(work, (task, given), threads, tally.as_mut(), solve);
        }
        // Others keep what sweeps have led to, also where another thread has solved them meanwhile.
        let enough = needed < left.len();
        work.iter_mut().skip(needed).for_each(|(_, own)| own.report = None);
        let mut left_over = cut;
        for &island in &*left {
            let status = if enough { Status::Stalled } else { Status::TimeLimit };
            reports[island].status = status;
        }
        // What is told of them does not depend on the order in which they were solved.
        work.sort_by_key(|(island, _)| *island);
        for (island, solved) in work.drain(..) {
            if let Some(found) = solved.report {
                solved.end(iterate, 1);
                if iterate.infeasibility.is_none() {
                    *iterate.infeasibility = solved.infeasibility(problem);
                }
                let report = &mut reports[island];
                let worst_contact = solved.part.contacts()[found.worst_contact];
                let iterations = report.iterations + found.iterations;
                *report = SolveReport { worst_contact, iterations, ..found };
            } else if !enough {
                left_over = true;
            }
            own[island] = Some(solved);
        }
        if enough {
            let Iterate { percussion, velocity, .. } = &*iterate;
            let measured = Measured { problem, percussion, velocity };
            // They are solved in the order of the list; sweeps have not looked for the worst contact of those that are not.
            for &island in &left[needed..] {
                let worst = residual_of(&measured, islands.of(island).iter().copied());
                reports[island].worst_contact = worst.worst_contact;
            }
        }
        if left_over {
            problem.velocity(iterate.percussion, iterate.velocity);
            let Iterate { percussion, velocity, states, .. } = iterate;
            let measured = Measured { problem, percussion, velocity };
            for (island, report) in reports.iter_mut().enumerate() {
                if report.status != Status::TimeLimit {
                    continue;
                }
                let contacts = islands.of(island);
                for &i in contacts {
                    let (phase, slip) = phase_of(&measured, i);
                    states[i] = task.history[i].after(phase, slip);
                }
                *report = graded(*report, stop, &measured, contacts);
            }
        }
        let whole = whole(task, iterate, islands, reports);
        if whole.is_none() {
            // What follows changes all of them.
            reports.clear();
        }
        whole
    }

    /// Sweeps, and the islands that they have left.
    fn sweep_and_leave(
        &mut self,
        task: &Task<'_>,
        iterate: &mut Iterate<'_>,
        sweeper: &mut Sweeper,
    ) {
        let together = self.sweep_with(task, iterate, sweeper, Plan::trial(&task.stop));
        iterate.stages.push(Stage::of(Method::GaussSeidel, together.sweeps, together.residual()));
        let swept = self.swept.iter().zip(&self.reports).enumerate();
        let left = swept.filter(|(island, (swept, report))| {
            // Which of several solutions continues the states of contacts, the first that is found does not tell.
            let alone = sweeper.islands().of(*island).len() == 1;
            let decided = alone || !swept.ambiguous;
            !(decided && swept.is_clear() && report.residual <= task.stop.tolerance)
        });
        self.left.clear();
        self.left.extend(left.map(|(island, _)| island));
        if task.stop.deadline.is_some() {
            // A large one that takes all the time would leave many small ones unsolved.
            self.left.sort_by_key(|&island| sweeper.islands().of(island).len());
        }
    }
}

/// Solves islands as problems of their own, side by side where that is worth it; the number of those that count.
fn solve_all<B: Buffers>(
    work: &mut [Work<B>],
    (task, given): (&Task<'_>, Given<'_>),
    threads: usize,
    tally: Option<&mut Tally>,
    solve: impl Fn(Unsolved<'_, B>, Stop<'_>, usize) -> SolveReport + Sync,
) -> usize {
    let count = work.len();
    let contacts: usize = work.iter().map(|(_, own)| own.part.contacts().len()).sum();
    let Stop { tolerance, measure, deadline, .. } = task.stop;
    let tally = tally.map(Mutex::new);
    let lock = || tally.as_ref().and_then(|tally| tally.lock().ok());
    let is_enough = || lock().is_some_and(|tally| tally.is_enough());
    let solve = |place: usize, (island, own): &mut Work<B>, stop: Stop<'_>, threads: usize| {
        own.begin(*island, given);
        own.report = Some(solve(own.unsolved(), stop, threads));
        own.keep();
        if let Some(rho) = lock().map(|tally| tally.scale.rho) {
            let squares = own.squares(rho);
            lock().into_iter().for_each(|mut tally| tally.put(place, squares));
        }
    };
    let given_up = AtomicBool::new(false);
    let share = |(place, work): &mut (usize, &mut Work<B>)| {
        let cancelled = || given_up.load(Ordering::Relaxed);
        if cancelled() {
            return;
        }
        let stop = Stop { tolerance, measure, deadline, cancelled: Some(&cancelled) };
        solve(*place, work, stop, 1);
    };
    let ask = || {
        if task.stop.early() || is_enough() {
            given_up.store(true, Ordering::Relaxed);
        }
    };
    let mut shared = false;
    if count > 1 && contacts >= WORTHWHILE {
        let pool = Threads::of(threads);
        if pool.is_there() {
            let mut numbered: Vec<_> = work.iter_mut().enumerate().collect();
            shared = pool.share(&mut numbered, share, ask);
        }
    }
    if !shared {
        let mut last: Option<&mut Work<B>> = None;
        for (place, work) in work.iter_mut().enumerate() {
            if task.stop.early() || is_enough() {
                break;
            }
            if let Some((_, last)) = last {
                work.1.take_buffers(last);
            }
            solve(place, work, task.stop, threads);
            last = Some(work);
        }
    }
    match lock() {
        Some(tally) if tally.is_enough() => tally.solved,
        _ => count,
    }
}

/// The report on an island that was not solved by itself: what its own measure says of it, else how it ended.
fn graded(
    ended: SolveReport,
    stop: Stop<'_>,
    measured: &Measured<'_>,
    contacts: &[usize],
) -> SolveReport {
    let Residual { value, worst_contact } = stop.residual_of(measured, contacts);
    let (status, worst_contact) = if value > stop.tolerance || value.is_nan() {
        // Where the whole is solved by its measure, that does not see what is left here.
        let converged = ended.status == Status::Converged;
        (if converged { Status::Stalled } else { ended.status }, worst_contact)
    } else if let Some(flaw) = flaw(measured, contacts, stop) {
        (flaw_status(flaw), flaw.contact)
    } else {
        (Status::Converged, worst_contact)
    };
    SolveReport { status, residual: value, worst_contact, ..ended }
}

/// Why the percussions of an island are no solution however small their residual is.
fn flaw(measured: &Measured<'_>, contacts: &[usize], stop: Stop<'_>) -> Option<Flaw> {
    Approach::of(measured, contacts.iter().copied(), stop.tolerance).flaw()
}

/// The report on all islands; `None` where each of them is solved, but not the whole by its measure.
fn whole(
    task: &Task<'_>,
    iterate: &mut Iterate<'_>,
    islands: &Members,
    reports: &[SolveReport],
) -> Option<SolveReport> {
    let stop = task.stop;
    let ambiguous = iterate.ambiguous.contains(&true);
    let mut worst = reports[0];
    let mut residual = Residual { value: f64::NEG_INFINITY, worst_contact: 0 };
    for report in reports {
        if is_graver(report.status, worst.status) {
            worst = *report;
        }
        if is_worse(report.residual, residual.value) {
            residual = Residual { value: report.residual, worst_contact: report.worst_contact };
        }
    }
    if stop.measure == Measure::Global {
        let Iterate { percussion, velocity, .. } = iterate;
        let measured = Measured { problem: task.problem, percussion, velocity };
        residual = stop.residual(task.problem, percussion, velocity);
        let small = residual.value <= stop.tolerance;
        if small && worst.status != Status::NoSolution {
            // However an island has ended, it matters only where its percussions run away.
            let unsolved = (0..reports.len()).filter(|&i| reports[i].status != Status::Converged);
            let mut flaws = unsolved.filter_map(|island| flaw(&measured, islands.of(island), stop));
            (worst.status, worst.worst_contact) = match flaws.next() {
                Some(flaw) => (flaw_status(flaw), flaw.contact),
                None => (Status::Converged, residual.worst_contact),
            };
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

/// Puts what an island went through beside what others did, after the stages of all islands together: the most iterations
/// count, and all factorisations.
fn merge(own: &[Stage], all: &mut Vec<Stage>, mut place: usize) {
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

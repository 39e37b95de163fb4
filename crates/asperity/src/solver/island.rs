//! Islands: contacts that influence each other, directly or by others, and nothing else.
//!
//! Every island is a problem of its own: it has its own scaling, goes through its own steps and ends by itself. What is found
//! there depends on no other island, to the bit, so that islands may be solved side by side by any number of threads.

use super::cascade::Methods;
use super::findings;
use super::gauss_seidel::{Iterate, Past, Reached, Sweeper, Swept, Task, mark_ambiguous};
use super::infeasible::{Case, Infeasibility};
use super::measure::natural_residual::is_worse;
use super::method::{Order, ProxIteration};
use super::report::{Method, SolveReport, Stage};
use super::settings::Solver;
use crate::contact::{ContactProblem, ContactRows, ContactState, Members, Memory, Part, put, take};

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
    pub(super) members: Members,
    pub(super) reports: Vec<SolveReport>,
}

/// Contacts that influence each other, directly or by others, and how they were solved together.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Island<'a> {
    /// The contacts, ascending.
    pub contacts: &'a [usize],
    /// How the solver ended there, by the measure of this island alone, whatever others did. Without iterations nothing was
    /// done there: the percussions of before had solved it already, or its turn had not come, as its status says.
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

/// What methods need besides the percussions.
#[derive(Debug, Clone, Default)]
pub(super) struct Buffers {
    pub(super) sweeper: Sweeper,
    pub(super) methods: Option<Box<Methods>>,
    /// Percussions of a prox iteration.
    next: Vec<f64>,
    /// What was done for one island.
    stages: Vec<Stage>,
}

impl Buffers {
    /// Makes them fit a problem.
    pub(super) fn prepare(&mut self, problem: &ContactProblem) {
        self.sweeper.prepare(problem);
        self.forget_operator();
    }

    /// The operator of the problem has other entries.
    pub(super) fn refresh(&mut self, problem: &ContactProblem) {
        self.sweeper.refresh(problem);
        self.forget_operator();
    }

    fn forget_operator(&mut self) {
        if let Some(methods) = &mut self.methods {
            methods.reset();
        }
    }

    /// Solves the only island of a problem from the percussions of the iterate, to which sweeps have led, if any were made.
    pub(super) fn solve(
        &mut self,
        solver: &Solver,
        mut task: Task<'_>,
        iterate: &mut Iterate<'_>,
        swept: Option<&Swept>,
    ) -> SolveReport {
        let mut stages = std::mem::take(&mut self.stages);
        stages.clear();
        let report = {
            let Iterate { percussion, velocity, states, ambiguous, infeasibility, .. } = iterate;
            let stages = &mut stages;
            let own = Iterate { percussion, velocity, states, ambiguous, stages, infeasibility };
            task.past = swept.map_or(Past::Unswept, Swept::past);
            self.solve_recorded(solver, task, own, swept)
        };
        merge(&stages, iterate.stages, usize::from(swept.is_some()));
        self.stages = stages;
        report
    }

    fn solve_recorded(
        &mut self,
        solver: &Solver,
        task: Task<'_>,
        mut iterate: Iterate<'_>,
        swept: Option<&Swept>,
    ) -> SolveReport {
        let (problem, stop) = (task.problem, task.stop);
        // With drilling friction the search of one contact is not complete: other methods may find what it has missed.
        let drills = |rows: &ContactRows| rows.law.dimension() == 3;
        let complete = problem.contacts().len() == 1 && !problem.contacts().iter().any(drills);
        let ends = match solver {
            Solver::Exact { .. } => true,
            Solver::Auto { .. } => complete,
            _ => false,
        };
        let reached = match swept {
            Some(swept) if ends => {
                let residual = iterate.measure(&task);
                let ended = (0, swept.ended);
                Reached::of(&task, &iterate, ended, residual)
            }
            _ => {
                iterate.states.copy_from_slice(task.history);
                let reached = self.run(solver, &task, &mut iterate);
                iterate.states.copy_from_slice(task.history);
                iterate.classify(problem);
                reached
            }
        };
        let mut findings = findings::judge(&task, &reached, &mut iterate);
        let Reached { iterations, ended, residual, .. } = reached;
        // Who has cancelled does not wait for a search of all contacts.
        let left = residual.value > stop.tolerance && stop.early();
        if left || problem.delassus().is_matrix_free() {
            iterate.ambiguous.fill(false);
        } else if !(complete && ends && swept.is_some()) {
            // A sweep marks contacts before the last ones have moved.
            mark_ambiguous(&task, &mut iterate, &mut self.sweeper);
        }
        findings.ambiguous = iterate.ambiguous.contains(&true);
        if matches!(solver, Solver::ProxJacobi { .. } | Solver::ProxGaussSeidel { .. }) {
            iterate.stages.push(Stage::of(Method::Prox, iterations, residual));
        }
        SolveReport::new(ended, iterations, residual, findings, stop.tolerance)
    }

    /// Runs the method of a solver.
    fn run(&mut self, solver: &Solver, task: &Task<'_>, iterate: &mut Iterate<'_>) -> Reached {
        let Self { sweeper, methods, .. } = self;
        let mut single = |method, max_iterations| {
            let methods = methods.get_or_insert_default();
            methods.single(*task, iterate.reborrow(), sweeper, method, max_iterations)
        };
        let (order, step, max_iterations) = match *solver {
            Solver::Auto { steps, .. } => {
                let methods = methods.get_or_insert_default();
                return methods.automatic(*task, iterate.reborrow(), sweeper, steps);
            }
            Solver::SemismoothNewton { max_iterations } => {
                return single(Method::Newton, max_iterations);
            }
            Solver::InteriorPoint { max_iterations } => {
                return single(Method::InteriorPoint, max_iterations);
            }
            Solver::Admm { max_iterations } => return single(Method::Admm, max_iterations),
            Solver::ProximalPoint { max_iterations } => {
                return single(Method::ProximalPoint, max_iterations);
            }
            Solver::ProxJacobi { step, max_iterations } => (Order::Jacobi, step, max_iterations),
            Solver::ProxGaussSeidel { step, max_iterations } => {
                (Order::GaussSeidel, step, max_iterations)
            }
            // Its sweeps have been made.
            Solver::Exact { .. } => (Order::GaussSeidel, super::method::ProxStep::Adaptive, 0),
        };
        let iteration = ProxIteration { order, step, max_iterations };
        let ended = iteration.solve(task, iterate, &mut self.next);
        let residual = iterate.measure(task);
        Reached::of(task, iterate, ended, residual)
    }
}

/// What islands are given: percussions of the whole to which sweeps have led.
#[derive(Clone, Copy)]
pub(super) struct Given<'a> {
    pub(super) problem: &'a ContactProblem,
    pub(super) start: &'a [f64],
    pub(super) history: &'a [ContactState],
    pub(super) states: &'a [ContactState],
    pub(super) ambiguous: &'a [bool],
    pub(super) percussion: &'a [f64],
    pub(super) velocity: &'a [f64],
}

/// One of several islands as a problem of its own, and its solution.
#[derive(Debug, Clone)]
pub(super) struct Subproblem {
    part: Part,
    /// Whether the entries of its operator are those of another step.
    pub(super) stale: bool,
    /// What was remembered before the solve.
    before: Memory,
    memory: Memory,
    velocity: Vec<f64>,
    ambiguous: Vec<bool>,
    stages: Vec<Stage>,
    infeasibility: Option<Infeasibility>,
    buffers: Buffers,
    /// How it ended, if it was solved.
    pub(super) report: Option<SolveReport>,
}

impl Subproblem {
    pub(super) fn new(whole: &ContactProblem, contacts: &[usize]) -> Self {
        let part = Part::new(whole, contacts);
        let (rows, count) = (part.problem().rows(), contacts.len());
        let mut buffers = Buffers::default();
        buffers.prepare(part.problem());
        Self {
            part,
            stale: false,
            before: Memory::new(rows, count),
            memory: Memory::new(rows, count),
            velocity: vec![0.0; rows],
            ambiguous: vec![false; count],
            stages: Vec::new(),
            infeasibility: None,
            buffers,
            report: None,
        }
    }

    /// Number of contacts.
    pub(super) fn len(&self) -> usize {
        self.part.contacts().len()
    }

    /// Solves it from what the whole has come to.
    pub(super) fn solve(
        &mut self,
        solver: &Solver,
        task: Task<'_>,
        given: Given<'_>,
        swept: Option<&Swept>,
    ) {
        let Self { part, before, memory, velocity, ambiguous, buffers, .. } = self;
        if std::mem::take(&mut self.stale) {
            part.copy_operator(given.problem);
            buffers.refresh(part.problem());
        }
        part.copy_velocities(given.problem);
        take(part.rows(), given.percussion, &mut memory.percussion);
        take(part.rows(), given.velocity, velocity);
        take(part.rows(), given.start, &mut before.percussion);
        take(part.contacts(), given.history, &mut before.states);
        take(part.contacts(), given.states, &mut memory.states);
        take(part.contacts(), given.ambiguous, ambiguous);
        self.infeasibility = None;
        self.stages.clear();
        let mut iterate = Iterate {
            percussion: &mut memory.percussion,
            velocity,
            states: &mut memory.states,
            ambiguous,
            stages: &mut self.stages,
            infeasibility: &mut self.infeasibility,
        };
        let (start, history) = (&before.percussion[..], &before.states[..]);
        let task = Task { problem: part.problem(), start, history, ..task };
        let swept = swept.map(|swept| swept.within(part.contacts()));
        self.report = Some(buffers.solve(solver, task, &mut iterate, swept.as_ref()));
    }

    /// Hands over what was found and returns how it ended; the first stages are those of all islands together.
    pub(super) fn end(
        &self,
        whole: &ContactProblem,
        iterate: &mut Iterate<'_>,
        first_stages: usize,
    ) -> Option<SolveReport> {
        let report = self.report?;
        let Self { part, memory, velocity, ambiguous, stages, .. } = self;
        put(part.rows(), &memory.percussion, iterate.percussion);
        put(part.rows(), velocity, iterate.velocity);
        put(part.contacts(), &memory.states, iterate.states);
        put(part.contacts(), ambiguous, iterate.ambiguous);
        merge(stages, iterate.stages, first_stages);
        if iterate.infeasibility.is_none() {
            *iterate.infeasibility = self.infeasibility(whole);
        }
        Some(SolveReport { worst_contact: part.contacts()[report.worst_contact], ..report })
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
        let case = |case: &Case| match case {
            Case::Divided(contact) => Case::Divided(self.part.contacts()[*contact]),
            Case::Empty(direction) => Case::Empty(spread(direction)),
        };
        Some(Infeasibility {
            kind: *kind,
            contact: self.part.contacts()[*contact],
            direction: spread(direction),
            closing_velocity: proof.closing_velocity,
            residual: proof.residual,
            cases: proof.cases.iter().map(case).collect(),
        })
    }
}

/// Puts the stages of an island beside those of others, after the stages of all islands together: the most iterations count,
/// and all factorisations.
fn merge(own: &[Stage], all: &mut Vec<Stage>, mut place: usize) {
    for stage in own {
        let place_of_same = all.iter().skip(place).position(|other| other.method == stage.method);
        let Some(next) = place_of_same else {
            all.insert(place.min(all.len()), *stage);
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

//! A contact problem of some contacts of a system, and how it is solved.

use crate::contact::{
    BlockMatrix, ContactProblem, ContactRows, ContactState, Memory, NormalForce, Phase,
};
use crate::integrator::event::dynamics::{ContactVariables, Dynamics, ROWS};
use crate::integrator::event::outcome::{Outcome, Stagnation};
use crate::integrator::event::resolution::{NOTHING, SOLVED};
use crate::integrator::event::state::EvaluationError;
use crate::integrator::observer::Observer;
use crate::solver::{self, Given, Shares, Solver, Status, Stop, Unsolvable, Workspace};
use crate::vectors::{dot, largest, norm};

/// Sweeps suffice for the few contacts that meet at an event; where they stagnate, other methods take over. Where
/// normal forces are shared, sweeps mostly stagnate and come last.
const SOLVER: Solver = Solver::Exact { max_sweeps: 500 };
const FALLBACK: Solver = Solver::AUTO;
const TOLERANCE: f64 = 1e-12;
/// The tolerance does not decide between stick and slip of contacts that share nearly the largest load that friction can
/// hold: where the share δ of the load is left, forces on the boundaries of the reservoirs may point √δ away from the
/// common slip and balance but for accelerations of the tolerance over √δ. Newton's method makes these forces as accurate
/// as rounding allows.
const POLISH: Solver = Solver::SemismoothNewton { max_iterations: 8 };
/// Acceleration over the load that may be none: at the tolerance this is what is left of it where δ is 1e-12.
const MAY_BE_AT_REST: f64 = 1e-6;
/// Velocity that contacts may keep against their laws, over the largest load. Residuals are relative to percussions: where
/// these cancel each other, rounding leaves bodies that penetrate each other. Columns of three bodies that bear one of 10⁸
/// times their mass exceed this limit, those of five and 10⁷ do not.
const AGAINST_THE_LAWS: f64 = 1e-5;

/// What is asked of contacts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Question {
    /// What they do next, by their laws.
    WhatNext,
    /// Whether all can stick on.
    WhetherStickGoesOn,
}

/// The outcome of a contact problem.
#[derive(Debug)]
pub(crate) enum Decision {
    /// It is solved.
    Made {
        /// Whether some contact had several solutions.
        ambiguous: bool,
    },
    /// The motion ends here: there is no solution, none has been found, or nobody waits for it.
    Ended(Outcome),
}

/// What the solver needs to know besides the problem.
pub(crate) struct Solving<'s, 'o> {
    /// What all contacts of the system did before.
    pub(crate) memory: &'s [ContactState],
    pub(crate) observer: &'s Observer<'o, f64>,
    /// Time in s.
    pub(crate) t: f64,
}

/// A solved contact problem.
pub(crate) struct Solved {
    pub(crate) ambiguous: bool,
    /// Percussions or forces, and what the contacts do.
    pub(crate) found: Memory,
    /// Relative velocities or accelerations.
    pub(crate) velocity: Vec<f64>,
}

/// Contacts of a contact problem, with their rows and the accelerations by unit forces along these.
pub(crate) struct Participants {
    pub(crate) contacts: Vec<usize>,
    pub(crate) rows: Vec<usize>,
    pub(crate) responses: Vec<f64>,
    /// What the sharing of normal forces adds to the accelerations along the rows, row by row; empty if none is shared.
    shared: Vec<f64>,
}

impl Participants {
    /// Contacts that are the only ones with forces.
    pub(crate) fn alone(dynamics: &Dynamics<'_>, contacts: Vec<usize>) -> Self {
        let rows: Vec<usize> = contacts.iter().flat_map(|&i| dynamics.rows_of(i)).collect();
        let responses = rows.iter().flat_map(|&row| dynamics.response(row)).copied().collect();
        Self { contacts, rows, responses, shared: Vec::new() }
    }

    /// Contacts among slipping ones that stay closed, and the normal forces of these in answer to unit forces along the rows.
    pub(crate) fn constrained(
        dynamics: &mut Dynamics<'_>,
        contacts: Vec<usize>,
    ) -> (Self, Vec<f64>) {
        let mut participants = Self::alone(dynamics, contacts);
        let mut answers = Vec::new();
        let responses = participants.responses.chunks_exact_mut(dynamics.n);
        for (&row, response) in participants.rows.iter().zip(responses) {
            dynamics.constrain(response, Some(row));
            answers.extend_from_slice(dynamics.constraint_forces());
        }
        if !dynamics.sharing.is_empty() {
            let (rows, slipping) = (&participants.rows, dynamics.constrained_rows());
            let count = slipping.len();
            let entry = |k: usize, l: usize| {
                dynamics.sharing.entry(rows[k], rows[l])
                    + dynamics.sharing.product(rows[k], slipping, &answers[l * count..][..count])
            };
            let places = (0..rows.len()).flat_map(|k| (0..rows.len()).map(move |l| (k, l)));
            participants.shared = places.map(|(k, l)| entry(k, l)).collect();
        }
        (participants, answers)
    }

    /// Contacts that the slipping ones hold in all directions already: their mobility is rounding, and must give no force.
    pub(crate) fn immobile(&self, dynamics: &Dynamics<'_>) -> Vec<usize> {
        let moves = |(&row, response): (&usize, &[f64])| {
            let left = dot(dynamics.row(row), response);
            left.abs() > NOTHING * dot(dynamics.row(row), dynamics.response(row))
        };
        let rows = self.rows.iter().zip(self.responses.chunks_exact(dynamics.n));
        let mobile: Vec<usize> =
            rows.filter(|&pair| moves(pair)).map(|(row, _)| row / ROWS).collect();
        self.contacts.iter().copied().filter(|i| !mobile.contains(i)).collect()
    }

    /// The contact problem with this load, `normal_force` being what is given of it.
    pub(crate) fn problem(
        &self,
        dynamics: &mut Dynamics<'_>,
        load: &[f64],
        question: Question,
        normal_force: impl Fn(&ContactVariables) -> Option<f64>,
    ) -> Result<ContactProblem, EvaluationError> {
        self.contacts.iter().try_for_each(|&i| dynamics.check_rows(i))?;
        let contacts: Vec<_> = self
            .contacts
            .iter()
            .map(|&i| {
                let law = match question {
                    Question::WhatNext => dynamics.law(i).clone(),
                    Question::WhetherStickGoesOn => dynamics.law_of_stick(i).clone(),
                };
                (law, normal_force(&dynamics.contacts[i]).into())
            })
            .collect();
        let dynamics = &*dynamics;
        let response = |j: usize| &self.responses[j * dynamics.n..(j + 1) * dynamics.n];
        let sizes: Vec<usize> =
            self.contacts.iter().map(|&i| dynamics.rows_of(i).count()).collect();
        let shared = |i: usize, j: usize| self.shared.get(i * self.rows.len() + j).unwrap_or(&0.0);
        let delassus = BlockMatrix::full(&sizes, |i, j| {
            dot(dynamics.row(self.rows[i]), response(j)) + shared(i, j)
        });
        let mut problem = ContactProblem::assemble(contacts, delassus.into());
        problem.free_velocity_mut().copy_from_slice(load);
        Ok(problem)
    }

    /// Solves the contact problem of these contacts.
    pub(crate) fn solve(
        &self,
        problem: &ContactProblem,
        Solving { memory, observer, t }: &Solving<'_, '_>,
    ) -> Result<Solved, Outcome> {
        let mut start = Memory::new(problem.rows(), self.contacts.len());
        start.states = self.states(memory);
        if self.contacts.is_empty() {
            return Ok(Solved { ambiguous: false, found: start, velocity: Vec::new() });
        }
        let cancelled = || observer.asks_to_stop(*t);
        let stop = Stop { cancelled: Some(&cancelled), ..Stop::at(TOLERANCE) };
        let mut outcome = Outcome::Interrupted;
        let solvers = if self.shared.is_empty() { [SOLVER, FALLBACK] } else { [FALLBACK, SOLVER] };
        for solver in solvers {
            let (mut workspace, mut found) = (Workspace::default(), start.clone());
            let report = solver.solve(problem, stop, &mut found, &mut workspace);
            // Where percussions run away, or a proof excludes a solution, a small residual says nothing.
            let ended = matches!(report.status, Status::Stalled | Status::Inexact);
            let at_rounding = ended && report.residual < SOLVED;
            if report.status == Status::Converged || at_rounding {
                let (ambiguous, velocity) = (report.ambiguous, workspace.velocity);
                let solved = Solved { ambiguous, found, velocity };
                let against = goes_against_its_law(problem, &solved);
                let polished = Self::polished(problem, &solved, report.residual, against.is_some());
                match (polished, against) {
                    (Some(polished), _) => return Ok(polished),
                    (None, None) => return Ok(solved),
                    (None, Some(k)) => {
                        outcome = Outcome::unsolved(self.contacts[k]);
                        continue;
                    }
                }
            }
            if observer.has_asked_to_stop() {
                return Err(Outcome::Interrupted);
            }
            let contact = self.contacts[report.worst_contact];
            outcome = match report.status {
                Status::NoSolution => {
                    let unsolvable = workspace.infeasibility.map(|infeasibility| {
                        let (problem, contacts) = (problem.clone(), self.contacts.clone());
                        Box::new(Unsolvable { problem, contacts, infeasibility })
                    });
                    Outcome::NoSolution { contact, unsolvable }
                }
                Status::Unbounded => {
                    Outcome::Stagnated { cause: Stagnation::Unbounded, contact: Some(contact) }
                }
                _ => Outcome::unsolved(contact),
            };
        }
        Err(outcome)
    }

    /// The solution with percussions of equal compliance, where the problem leaves them open.
    pub(crate) fn shared(
        &self,
        dynamics: &Dynamics<'_>,
        problem: &ContactProblem,
        mut solved: Solved,
        solving: &Solving<'_, '_>,
    ) -> Solved {
        let mut workspace = Workspace::default();
        workspace.prepare(problem);
        let (stop, history) = (Stop::at(TOLERANCE), self.states(solving.memory));
        let report = solver::grade(problem, stop, &solved.found, &mut workspace);
        let by_place = |row: &usize| dynamics.contacts[row / ROWS].by_place;
        let by_place: Vec<f64> = self.rows.iter().map(by_place).collect();
        let given = Given { report: &report, history: &history, by_place: Some(&by_place) };
        let found = &mut solved.found;
        if Shares::default().find(problem, stop, &given, found, &mut workspace).is_some() {
            solved.velocity = workspace.velocity;
        }
        solved
    }

    /// What the contacts did before.
    fn states(&self, memory: &[ContactState]) -> Vec<ContactState> {
        self.contacts.iter().map(|&i| memory[i]).collect()
    }

    /// A better solution by Newton's method, if it is `asked` for or several contacts may be at rest.
    fn polished(
        problem: &ContactProblem,
        solved: &Solved,
        residual: f64,
        asked: bool,
    ) -> Option<Solved> {
        let largest_load = largest(problem.free_velocity());
        let may_rest = |rows: &ContactRows| {
            let own = norm(&solved.velocity[rows.offset..rows.offset + rows.len()]);
            own > 0.0 && own <= MAY_BE_AT_REST * largest_load
        };
        let contacts = problem.contacts();
        if !asked && (contacts.len() < 2 || !contacts.iter().any(may_rest)) {
            return None;
        }
        let (mut workspace, mut found) = (Workspace::default(), solved.found.clone());
        let report = POLISH.solve(problem, Stop::at(f64::EPSILON), &mut found, &mut workspace);
        let polished = Solved { ambiguous: solved.ambiguous, found, velocity: workspace.velocity };
        let better = report.residual < residual || asked && report.residual < SOLVED;
        (better && goes_against_its_law(problem, &polished).is_none()).then_some(polished)
    }
}

/// The contact that goes against its law most, faster than rounding of the loads explains: that approaches, presses and
/// moves away, sticks and moves, or whose friction drives it. Drilling, in another unit, is left out.
fn goes_against_its_law(problem: &ContactProblem, solved: &Solved) -> Option<usize> {
    let planar = |rows: &ContactRows| {
        let tangential = rows.tangential_rows();
        tangential.start..tangential.end.min(tangential.start + 2)
    };
    let loads = problem
        .contacts()
        .iter()
        .map(|rows| largest(&problem.free_velocity()[rows.offset..planar(rows).end]));
    let allowed = AGAINST_THE_LAWS * loads.fold(0.0, f64::max);
    let xi = |row: usize| solved.velocity[row] + problem.restitution()[row];
    let percussion = &solved.found.percussion;
    let speed = |(rows, state): (&ContactRows, &ContactState)| {
        let normal = match rows.normal {
            NormalForce::Prescribed(_) => 0.0,
            NormalForce::Unilateral if state.phase == Phase::Open => f64::min(0.0, xi(rows.offset)),
            NormalForce::Unilateral => xi(rows.offset),
        };
        let along = match state.phase {
            Phase::Stick => planar(rows).map(xi).fold(0.0, f64::hypot),
            Phase::Slip if rows.tangential_rows().len() < 3 => {
                let driven: f64 = planar(rows).map(|row| percussion[row] * xi(row)).sum();
                let friction = planar(rows).map(|row| percussion[row]).fold(0.0, f64::hypot);
                if driven > 0.0 { driven / friction } else { 0.0 }
            }
            _ => 0.0,
        };
        f64::max(normal.abs(), along)
    };
    let speeds = problem.contacts().iter().zip(&solved.found.states).map(speed);
    let worst = speeds.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
    worst.filter(|(_, speed)| *speed > allowed).map(|(k, _)| k)
}

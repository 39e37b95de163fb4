//! What contacts do next: the contact problem on the level of accelerations, and that of impacts.
//!
//! `γ̇ = Gλ + b` has the structure of `γ_E = G P + b`: forces take the place of percussions, accelerations that
//! of velocities, and the house's solver with its selection rule decides.

use nalgebra::DMatrix;

use crate::contact::{
    ContactProblem, ContactRows, ContactState, Delassus, Memory, NormalForce, Phase,
};
use crate::integrator::event::contact_problem::participants::{Part, constrained};
use crate::integrator::event::dynamics::contact_variables::{FieldError, ROWS, State, Touch};
use crate::integrator::event::dynamics::inverse::Inverse;
use crate::integrator::event::dynamics::sliding_force;
use crate::integrator::event::dynamics::{Field, add, dot};
use crate::integrator::event::observer::Poll;
use crate::integrator::event::{Cause, Outcome};
use crate::solver::{Solver, Status, Stop, Unsolvable, Workspace};

/// Sweeps suffice for the few contacts that meet at an event; where they stagnate, other methods take over.
const SOLVER: Solver = Solver::Exact { max_sweeps: 500 };
const FALLBACK: Solver = Solver::Auto { interior_point: true, threads: 1 };
const TOLERANCE: f64 = 1e-12;
/// Residual that counts as solved where rounding leaves no better one and the solver has come to its end.
const ROUNDED: f64 = 1e-9;
/// Relative distance from the boundary of a reservoir that counts as none.
const BOUNDARY: f64 = 1e-6;
/// Slip acceleration over the load that counts as none.
const AT_REST: f64 = 1e-11;

/// The outcome of a contact problem.
#[derive(Debug)]
pub(crate) enum Decision {
    /// Solved; whether some contact had several solutions.
    Made {
        /// Whether it was a choice.
        ambiguous: bool,
    },
    /// The motion ends here: there is no solution, none has been found, or nobody waits for it.
    Ended(Outcome),
}

/// Decides on the contacts that rest, `memory` being what all did before. Afterwards the field holds the
/// accelerations, the modes and for contacts that begin to slip γ̇ in place of γ.
pub(crate) fn decide(
    field: &mut Field<'_>,
    state: &State,
    memory: &[ContactState],
    poll: &Poll<'_>,
) -> Result<Decision, FieldError> {
    // A slipping contact that the others lift opens, and all decide again.
    loop {
        field.touches.iter_mut().filter(|t| t.resting).for_each(|t| t.mode = Phase::Open);
        field.evaluate(state.t, &state.q, &state.u, false)?;
        let normals: Vec<usize> = field.unknown().iter().map(|row| row / ROWS).collect();
        let mut pressing = if normals.is_empty() { vec![] } else { field.solution.clone() };
        let contacts = (0..field.touches.len()).filter(|&i| field.touches[i].resting).collect();
        let (mut part, mut answers) = constrained(field, contacts);
        let held = part.held(field);
        if !held.is_empty() {
            part.contacts.retain(|i| !held.contains(i));
            (part, answers) = constrained(field, part.contacts);
        }
        let load: Vec<f64> =
            part.rows.iter().map(|&row| field.rate(row, &field.acceleration)).collect();
        let problem = problem(field, &part, load, |touch| touch.prescribed)?;
        let (decision, remembered, velocity) = solve(&part, &problem, memory, (poll, state.t));
        let Decision::Made { .. } = decision else { return Ok(decision) };
        for (k, force) in remembered.percussion.iter().enumerate() {
            add(&mut field.acceleration, *force, &part.responses[k * field.n..][..field.n]);
            add(&mut pressing, *force, &answers[k * normals.len()..][..normals.len()]);
        }
        let lifted = pressing.iter().position(|&force| force < 0.0);
        if let Some(k) = lifted {
            field.touches[normals[k]].mode = Phase::Open;
            continue;
        }
        for (&i, force) in normals.iter().zip(&pressing) {
            // Evaluated without the contacts that have been decided on.
            let touch = &mut field.touches[i];
            (touch.normal_force, touch.force) = (*force, touch.sliding.map(|f| f * force));
        }
        for &i in &held {
            let touch = &mut field.touches[i];
            (touch.mode, touch.resting, touch.tolerated) = (Phase::Stick, false, 0.0);
            (touch.force, touch.slip) = ([0.0; 3], [0.0; 3]);
            touch.normal_force = touch.prescribed.unwrap_or(0.0);
        }
        keep(field, &part, &problem, &remembered, &velocity);
        hold_at_limit(field, &part, &problem, &velocity);
        return Ok(decision);
    }
}

fn problem(
    field: &Field<'_>,
    part: &Part,
    load: Vec<f64>,
    normal_force: impl Fn(&Touch) -> Option<f64>,
) -> Result<ContactProblem, FieldError> {
    part.contacts.iter().try_for_each(|&i| field.check_rows(i))?;
    let (n, size) = (field.n, part.rows.len());
    let delassus = DMatrix::from_fn(size, size, |i, j| {
        dot(field.row(part.rows[i]), &part.responses[j * n..(j + 1) * n])
    });
    let mut offset = 0;
    let contacts: Vec<ContactRows> = part
        .contacts
        .iter()
        .map(|&i| {
            let normal = match normal_force(&field.touches[i]) {
                Some(force) => NormalForce::Prescribed(force),
                None => NormalForce::Unilateral,
            };
            let rows = ContactRows { law: field.law(i).clone(), normal, offset };
            offset += rows.len();
            rows
        })
        .collect();
    let rho = vec![0.0; contacts.len()];
    let mut problem = ContactProblem {
        delassus: Delassus::Dense(delassus),
        restitution: vec![0.0; size],
        free_velocity: load,
        contacts,
        rho,
    };
    problem.update_rho();
    Ok(problem)
}

/// Solves a contact problem: the decision, the percussions and what came of the contacts, the velocities.
fn solve(
    part: &Part,
    problem: &ContactProblem,
    memory: &[ContactState],
    (poll, t): (&Poll<'_>, f64),
) -> (Decision, Memory, Vec<f64>) {
    let mut start = Memory::new(problem.rows(), part.contacts.len());
    start.states = part.contacts.iter().map(|&i| memory[i]).collect();
    if part.contacts.is_empty() {
        return (Decision::Made { ambiguous: false }, start, Vec::new());
    }
    let cancelled = || poll.stops(t);
    let stop = Stop { cancelled: Some(&cancelled), ..Stop::at(TOLERANCE) };
    let mut outcome = Outcome::Interrupted;
    for solver in [SOLVER, FALLBACK] {
        let (mut workspace, mut found) = (Workspace::default(), start.clone());
        workspace.prepare(problem);
        let report = solver.solve(problem, stop, &mut found, &mut workspace);
        // Where percussions run away, or a proof excludes a solution, a small residual says nothing.
        let ended = matches!(report.status, Status::Stalled | Status::Inexact);
        let at_rounding = ended && report.residual < ROUNDED;
        if report.status == Status::Converged || at_rounding {
            let decision = Decision::Made { ambiguous: report.ambiguous };
            return (decision, found, workspace.velocity);
        }
        if poll.stopped() {
            return (Decision::Ended(Outcome::Interrupted), start, Vec::new());
        }
        let contact = part.contacts[report.worst_contact];
        outcome = match report.status {
            Status::NoSolution => {
                let unsolvable = workspace.infeasibility.map(|infeasibility| {
                    let (problem, contacts) = (problem.clone(), part.contacts.clone());
                    Box::new(Unsolvable { problem, contacts, infeasibility })
                });
                Outcome::NoSolution { contact, unsolvable }
            }
            _ => Outcome::Stuck { cause: Cause::Unsolved, contact: Some(contact) },
        };
    }
    (Decision::Ended(outcome), start, Vec::new())
}

/// Modes, forces and slip accelerations of the contacts that have been decided on.
fn keep(
    field: &mut Field<'_>,
    part: &Part,
    problem: &ContactProblem,
    found: &Memory,
    velocity: &[f64],
) {
    for (k, (&i, rows)) in part.contacts.iter().zip(&problem.contacts).enumerate() {
        let touch = &mut field.touches[i];
        (touch.mode, touch.resting) = (found.states[k].phase, false);
        touch.tolerated = 0.0;
        touch.normal_force = match rows.normal {
            NormalForce::Prescribed(force) => force,
            NormalForce::Unilateral => found.percussion[rows.offset],
        };
        for (r, row) in (rows.tangent()..rows.offset + rows.len()).enumerate() {
            touch.force[r] = found.percussion[row];
            touch.slip[r] = velocity[row];
        }
        if touch.mode == Phase::Slip && touch.normal_force > 0.0 {
            touch.sliding = touch.force.map(|f| f / touch.normal_force);
            field.touches[i].resistance = field.resistance(i);
        }
    }
}

/// Contacts that begin to slip or to open by rounding only stick: the others prevent it, the load is just what
/// friction can hold, or other contacts carry all of it.
fn hold_at_limit(
    field: &mut Field<'_>,
    part: &Part,
    problem: &ContactProblem,
    accelerations: &[f64],
) {
    let load = problem.free_velocity.iter().fold(0.0, |m: f64, b| m.max(b.abs()));
    for (&i, rows) in part.contacts.iter().zip(&problem.contacts) {
        let touch = &mut field.touches[i];
        let own = &accelerations[rows.offset..rows.offset + rows.len()];
        let rests = own.iter().map(|x| x * x).sum::<f64>().sqrt() <= AT_REST * load;
        let may_stick = touch.mode == Phase::Slip || touch.prescribed.is_none();
        if rests && may_stick {
            touch.mode = Phase::Stick;
            touch.slip = [0.0; 3];
        }
    }
}

/// What an impact is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Blow {
    /// Newton's law with the contacts' restitution.
    Restitution,
    /// Without restitution, where a bounce would be too small to be followed.
    Dead,
}

/// The impact of unilateral contacts: velocities jump. The contacts' new normal velocities are in `after`.
pub(crate) fn strike(
    field: &mut Field<'_>,
    state: &mut State,
    (contacts, blow): (Vec<usize>, Blow),
    memory: &[ContactState],
    after: &mut Vec<f64>,
    poll: &Poll<'_>,
) -> Result<Decision, FieldError> {
    let n = field.n;
    field.kinematics(state.t, &state.q, &state.u)?;
    let rows: Vec<usize> = contacts.iter().flat_map(|&i| field.rows_of(i)).collect();
    let responses = rows.iter().flat_map(|row| &field.response[row * n..(row + 1) * n]).copied();
    let part = Part { responses: responses.collect(), rows, contacts };
    let before: Vec<f64> =
        part.rows.iter().map(|&row| dot(field.row(row), &state.u) + field.chi[row]).collect();
    let mut problem = problem(field, &part, before.clone(), |_| None)?;
    let laws = field.system.contacts();
    for (rows, &i) in problem.contacts.iter().zip(&part.contacts) {
        let own = rows.offset..rows.offset + rows.len();
        if blow == Blow::Dead {
            continue;
        }
        let coefficients = std::iter::once(laws[i].normal_restitution)
            .chain(std::iter::repeat(laws[i].tangential_restitution));
        for (row, e) in own.zip(coefficients) {
            problem.restitution[row] = e * before[row];
        }
    }
    let (decision, found, velocity) = solve(&part, &problem, memory, (poll, state.t));
    let Decision::Made { .. } = decision else { return Ok(decision) };
    for (percussion, response) in found.percussion.iter().zip(part.responses.chunks_exact(n)) {
        add(&mut state.u, *percussion, response);
    }
    after.clear();
    after.extend(problem.contacts.iter().map(|rows| velocity[rows.offset]));
    Ok(decision)
}

/// Painlevé's impact without collision: the percussions that stop the slip of closed contacts without a normal
/// motion; false if the laws do not allow them.
pub(crate) fn stop(
    field: &mut Field<'_>,
    state: &mut State,
    contacts: &[usize],
) -> Result<bool, FieldError> {
    let n = field.n;
    field.kinematics(state.t, &state.q, &state.u)?;
    let rows: Vec<usize> = contacts.iter().flat_map(|&i| field.rows_of(i)).collect();
    let response = |row: usize| &field.response[row * n..(row + 1) * n];
    let mut inverse = Inverse::default();
    inverse.of(rows.len(), |i, j| dot(field.row(rows[i]), response(rows[j])));
    let slip = |&row: &usize| {
        if row % ROWS == 0 { 0.0 } else { -dot(field.row(row), &state.u) - field.chi[row] }
    };
    let mut percussion: Vec<f64> = rows.iter().map(slip).collect();
    inverse.apply(&mut percussion);
    let mut first = 0;
    for &i in contacts {
        let own = &percussion[first..first + 1 + field.touches[i].p];
        let mut tangent = [0.0; 3];
        tangent[..own.len() - 1].copy_from_slice(&own[1..]);
        // With the resistance at zero the percussion lies on the boundary of the reservoir.
        if sliding_force::gauge(field.law(i), &tangent) > (1.0 + BOUNDARY) * own[0] {
            return Ok(false);
        }
        first += own.len();
    }
    for (percussion, &row) in percussion.iter().zip(&rows) {
        add(&mut state.u, *percussion, response(row));
    }
    Ok(true)
}

impl Field<'_> {
    /// Takes slip and approach out of contacts that have none, which rounding and differences bring in.
    pub(crate) fn project(&mut self, state: &mut State) -> Result<(), FieldError> {
        self.kinematics(state.t, &state.q, &state.u)?;
        let n = self.n;
        let mut rows: Vec<usize> = Vec::new();
        for (i, touch) in self.touches.iter().enumerate() {
            match (touch.mode, touch.prescribed) {
                (Phase::Stick, _) => rows.extend(self.rows_of(i)),
                (Phase::Slip, None) => rows.push(ROWS * i),
                _ => {}
            }
        }
        if rows.is_empty() {
            return Ok(());
        }
        let mut inverse = Inverse::default();
        let response = |row: usize| &self.response[row * n..(row + 1) * n];
        inverse.of(rows.len(), |i, j| dot(self.row(rows[i]), response(rows[j])));
        let speed = |&row: &usize| -dot(self.row(row), &state.u) - self.chi[row];
        let mut defects: Vec<f64> = rows.iter().map(speed).collect();
        inverse.apply(&mut defects);
        let gap = |&row: &usize| if row % ROWS == 0 { -self.touches[row / ROWS].gap } else { 0.0 };
        let mut gaps: Vec<f64> = rows.iter().map(gap).collect();
        inverse.apply(&mut gaps);
        for ((row, velocity), gap) in rows.iter().zip(&defects).zip(&gaps) {
            add(&mut state.u, *velocity, response(*row));
            add(&mut state.q, *gap, response(*row));
        }
        Ok(())
    }
}

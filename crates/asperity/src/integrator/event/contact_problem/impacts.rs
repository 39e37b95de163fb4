//! Impacts: velocities jump by percussions.

use std::iter::{once, repeat_n};

use crate::integrator::event::contact_problem::problem::{
    Decision, Participants, Question, Solving,
};
use crate::integrator::event::dynamics::{ConstraintMatrix, Dynamics, ROWS};
use crate::integrator::event::state::{EvaluationError, State};
use crate::vectors::{add, norm};

/// Relative distance from the boundary of a reservoir that counts as none.
const BOUNDARY: f64 = 1e-6;

/// What happens to relative velocities in an impact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ImpactLaw {
    /// Newton's law with the contacts' restitution.
    Newton,
    /// Without restitution, where a bounce would be too small to be followed.
    Plastic,
    /// All normal velocities vanish, also of contacts that others would throw up too low to be followed.
    Closing,
}

/// Solves the impact of unilateral contacts: velocities of the state jump; the new normal velocities are left in `after`.
pub(crate) fn collide(
    dynamics: &mut Dynamics<'_>,
    state: &mut State,
    contacts: &[usize],
    law: ImpactLaw,
    after: &mut Vec<f64>,
    solving: &Solving<'_, '_>,
) -> Result<Decision, EvaluationError> {
    dynamics.kinematics(state.t, &state.q, &state.u)?;
    if law == ImpactLaw::Closing {
        close(dynamics, state, contacts);
        after.fill(0.0);
        return Ok(Decision::Made { ambiguous: false });
    }
    let participants = Participants::alone(dynamics, contacts.to_vec());
    let before: Vec<f64> =
        participants.rows.iter().map(|&row| dynamics.velocity(row, &state.u)).collect();
    let mut problem = participants.problem(dynamics, &before, Question::WhatNext, |_| None)?;
    let laws = dynamics.system.contacts();
    if law == ImpactLaw::Newton {
        let coefficients = contacts.iter().flat_map(|&i| {
            let tangential = repeat_n(laws[i].tangential_restitution(), dynamics.contacts[i].p);
            once(laws[i].normal_restitution()).chain(tangential)
        });
        let terms = problem.restitution_mut().iter_mut().zip(coefficients).zip(&before);
        terms.for_each(|((term, e), before)| *term = e * before);
    }
    let solved = match participants.solve(&problem, solving) {
        Ok(solved) => participants.shared(dynamics, &problem, solved, solving),
        Err(outcome) => return Ok(Decision::Ended(outcome)),
    };
    let responses = participants.responses.chunks_exact(dynamics.n);
    for (percussion, response) in solved.found.percussion.iter().zip(responses) {
        add(&mut state.u, *percussion, response);
    }
    account_for_percussions(dynamics, &participants, &solved.found.percussion);
    after.clear();
    after.extend(problem.contacts().iter().map(|rows| solved.velocity[rows.offset]));
    Ok(Decision::Made { ambiguous: solved.ambiguous })
}

/// The end of a sequence of impacts, which leaves no normal velocities of contacts, nor slips that are not larger than
/// these were: friction takes them out as the impacts do the others. The kinematics of the state have been evaluated.
fn close(dynamics: &Dynamics<'_>, state: &mut State, contacts: &[usize]) {
    let approach = |&i: &usize| dynamics.velocity(ROWS * i, &state.u).abs();
    let fastest = contacts.iter().map(approach).fold(0.0, f64::max);
    let stops = |i: usize| norm(&dynamics.contacts[i].slip) <= fastest;
    let rows_of =
        |&i: &usize| ROWS * i..=ROWS * i + if stops(i) { dynamics.contacts[i].p } else { 0 };
    let rows: Vec<usize> = contacts.iter().flat_map(rows_of).collect();
    let mut matrix = ConstraintMatrix::default();
    dynamics.factor_mobility(&rows, &mut matrix);
    let mut percussions: Vec<f64> =
        rows.iter().map(|&row| -dynamics.velocity(row, &state.u)).collect();
    matrix.solve(&mut percussions);
    for (percussion, &row) in percussions.iter().zip(&rows) {
        add(&mut state.u, *percussion, dynamics.response(row));
    }
}

/// Percussions that balance, as in a flat impact, leave rounding in slips: a share of the velocities that each gives alone.
fn account_for_percussions(
    dynamics: &mut Dynamics<'_>,
    participants: &Participants,
    percussion: &[f64],
) {
    let n = dynamics.n;
    for &i in &participants.contacts {
        let change = |row: usize| {
            let row = dynamics.row(row);
            let parts =
                |response: &[f64]| row.iter().zip(response).map(|(w, r)| (w * r).abs()).sum();
            let responses = participants.responses.chunks_exact(n).map(parts);
            responses.zip(percussion).map(|(size, p): (f64, _)| size * p.abs()).sum::<f64>()
        };
        let rows = ROWS * i + 1..=ROWS * i + dynamics.contacts[i].p;
        let size = rows.map(change).fold(0.0, f64::hypot);
        dynamics.contacts[i].creep = dynamics.contacts[i].creep.max(size);
    }
}

/// Painlevé's impact without collision: the percussions that stop the slip of closed contacts without a normal
/// motion; false if the laws do not allow them.
pub(crate) fn stop_slip(
    dynamics: &mut Dynamics<'_>,
    state: &mut State,
    contacts: &[usize],
) -> Result<bool, EvaluationError> {
    dynamics.kinematics(state.t, &state.q, &state.u)?;
    let rows: Vec<usize> = contacts.iter().flat_map(|&i| dynamics.rows_of(i)).collect();
    let mut matrix = ConstraintMatrix::default();
    dynamics.factor_mobility(&rows, &mut matrix);
    let slip = |&row: &usize| if row % ROWS == 0 { 0.0 } else { -dynamics.velocity(row, &state.u) };
    let mut percussion: Vec<f64> = rows.iter().map(slip).collect();
    matrix.solve(&mut percussion);
    let mut first = 0;
    for &i in contacts {
        let own = &percussion[first..first + 1 + dynamics.contacts[i].p];
        let mut tangent = [0.0; 3];
        tangent[..own.len() - 1].copy_from_slice(&own[1..]);
        // With the resistance at zero the percussion lies on the boundary of the reservoir.
        if dynamics.law(i).gauge(&tangent.map(|f| -f)) > (1.0 + BOUNDARY) * own[0] {
            return Ok(false);
        }
        first += own.len();
    }
    for (percussion, &row) in percussion.iter().zip(&rows) {
        add(&mut state.u, *percussion, dynamics.response(row));
    }
    Ok(true)
}

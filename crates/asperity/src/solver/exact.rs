//! Block Gauss–Seidel whose one-contact solve is exact.

use std::time::Instant;

use asperity_set::Vector;

use super::local::{Block, Local, LocalSolution, Selection};
use super::report::Ended;
use super::{Stop, Workspace, line, natural_residual, plane};
use crate::contact::{ContactProblem, ContactRows, ContactState, Memory, NormalForce, Phase};
use crate::law::Law;

/// Sweeps until the natural residual is below the tolerance.
pub(super) fn solve(
    problem: &ContactProblem,
    stop: Stop,
    max_sweeps: usize,
    memory: &Memory,
    workspace: &mut Workspace,
) -> (usize, Ended) {
    if problem.contacts.len() == 1 {
        let ended = match sweep(problem, memory, workspace) {
            Some(contact) => Ended::NoSolution(contact),
            None => Ended::Done,
        };
        return (1, ended);
    }
    // Contacts without a solution may find one when the others have moved.
    let mut stuck = None;
    for sweeps in 1..=max_sweeps {
        stuck = sweep(problem, memory, workspace);
        problem.velocity(&workspace.percussion, &mut workspace.velocity);
        let residual = natural_residual(problem, &workspace.percussion, &workspace.velocity);
        if residual.value <= 0.1 * stop.tolerance || residual.value <= 4.0 * f64::EPSILON {
            return (sweeps, Ended::Done);
        }
        if stop.deadline.is_some_and(|deadline| Instant::now() >= deadline) {
            return (sweeps, Ended::TimeLimit);
        }
    }
    (max_sweeps, stuck.map_or(Ended::MaxIterations, Ended::NoSolution))
}

/// One sweep; the last contact that had no solution.
fn sweep(problem: &ContactProblem, memory: &Memory, workspace: &mut Workspace) -> Option<usize> {
    let mut stuck = None;
    for (i, rows) in problem.contacts.iter().enumerate() {
        let state = &memory.states[i];
        let Workspace { percussion, blocks, planar, ambiguous, states, .. } = &mut *workspace;
        let found = match &rows.law {
            Law::One(law) => {
                let local = Local::new(law, problem, rows, &blocks[i], percussion);
                let found = line::solve(&local, state);
                found.map(|found| store(rows, &found, percussion, state, &mut states[i]))
            }
            Law::Two(law) => {
                let local = Local::new(law, problem, rows, &blocks[i], percussion);
                let guess = || guess(state, &states[i], &local.b_t);
                let found = plane::solve(&local, state, guess, planar);
                found.map(|found| store(rows, &found, percussion, state, &mut states[i]))
            }
            // Refused where problems are made.
            Law::Three(_) => None,
        };
        match found {
            Some(several) => ambiguous[i] = several,
            None => stuck = Some(i),
        }
    }
    stuck
}

/// Where Newton's method starts: the slip velocity extrapolated, else the last one, else the free one.
#[inline]
fn guess(history: &ContactState, state: &ContactState, free: &Vector<2>) -> Vector<2> {
    let planar = |v: &[f64; 3]| Vector::<2>::new(v[0], v[1]);
    let last = planar(&state.direction);
    // Only in the first sweep is the last slip that of the step before.
    if history.known == 0 || state.direction != history.direction {
        return if last.amax() == 0.0 { *free } else { last };
    }
    let [one, two] = [planar(&history.earlier[0]), planar(&history.earlier[1])];
    let ahead = if history.known == 1 { last * 2.0 - one } else { (last - one) * 3.0 + two };
    // Where the slip ceases, extrapolation would turn it round.
    if ahead.dot(&last) > 0.5 * last.norm_squared() { ahead } else { last }
}

/// Keeps a solution; whether there were others.
fn store<const P: usize>(
    rows: &ContactRows,
    found: &Selection<P>,
    percussion: &mut [f64],
    history: &ContactState,
    state: &mut ContactState,
) -> bool {
    let solution = &found.solution;
    if rows.normal == NormalForce::Unilateral {
        percussion[rows.offset] = solution.normal;
    }
    state.phase = solution.phase;
    for j in 0..P {
        percussion[rows.tangent() + j] = solution.tangent[j];
    }
    state.known = 0;
    if solution.phase == Phase::Slip {
        for j in 0..P {
            state.direction[j] = solution.slip[j];
        }
        if history.phase == Phase::Slip {
            state.earlier = [history.direction, history.earlier[0]];
            state.known = (history.known + 1).min(2);
        }
    }
    found.ambiguous
}

/// Marks the contacts that have more than one solution with the others held.
pub(super) fn mark_ambiguous(problem: &ContactProblem, memory: &Memory, workspace: &mut Workspace) {
    for (i, rows) in problem.contacts.iter().enumerate() {
        let Workspace { percussion, blocks, planar, ambiguous, .. } = workspace;
        let state = &memory.states[i];
        ambiguous[i] = match &rows.law {
            Law::One(law) => {
                let local = Local::new(law, problem, rows, &blocks[i], percussion);
                line::solve(&local, state).is_some_and(|s| s.ambiguous)
            }
            Law::Two(law) => {
                let local = Local::new(law, problem, rows, &blocks[i], percussion);
                let guess = || guess(state, state, &local.b_t);
                plane::solve(&local, state, guess, planar).is_some_and(|s| s.ambiguous)
            }
            Law::Three(_) => false,
        };
    }
}

/// All solutions of one contact with the others held, on a line with a zero second component.
pub(super) fn all_solutions(
    problem: &ContactProblem,
    contact: usize,
    percussion: &[f64],
) -> Vec<LocalSolution<2>> {
    let rows = &problem.contacts[contact];
    let block = Block::new(problem, rows);
    let mut out = Vec::new();
    match &rows.law {
        Law::One(law) => {
            let local = Local::new(law, problem, rows, &block, percussion);
            out.extend(line::solutions(&local).into_iter().flatten().map(|s| LocalSolution {
                phase: s.phase,
                normal: s.normal,
                tangent: Vector::<2>::new(s.tangent[0], 0.0),
                slip: Vector::<2>::new(s.slip[0], 0.0),
                degenerate: s.degenerate,
            }));
        }
        Law::Two(law) => {
            let local = Local::new(law, problem, rows, &block, percussion);
            plane::solutions(&local, &mut out);
        }
        Law::Three(_) => {}
    }
    out
}

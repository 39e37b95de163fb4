//! Block Gauss–Seidel whose one-contact solve is exact.

use asperity_set::Vector;

use super::block::Block;
use super::local::{Local, LocalSolution, Selection};
use super::report::Ended;
use super::{Stop, Workspace, line, plane, space};
use crate::contact::{ContactProblem, ContactRows, ContactState, Memory, NormalForce};
use crate::law::Law;

/// Sweeps until the natural residual is below the tolerance.
pub(super) fn solve(
    problem: &ContactProblem,
    stop: Stop<'_>,
    max_sweeps: usize,
    memory: &Memory,
    workspace: &mut Workspace,
) -> (usize, Ended) {
    let mut stuck = sweep(problem, memory, workspace, true);
    if problem.is_uncoupled() {
        return (1, stuck.map_or(Ended::Done, Ended::NoSolution));
    }
    for sweeps in 1..=max_sweeps {
        problem.velocity(&workspace.percussion, &mut workspace.velocity);
        let residual = stop.residual(problem, &workspace.percussion, &workspace.velocity);
        if residual.value <= 0.1 * stop.tolerance || residual.value <= 4.0 * f64::EPSILON {
            return (sweeps, Ended::Done);
        }
        if stop.early() {
            return (sweeps, Ended::TimeLimit);
        }
        if sweeps < max_sweeps {
            // Contacts without a solution may find one when the others have moved.
            stuck = sweep(problem, memory, workspace, false);
        }
    }
    (max_sweeps, stuck.map_or(Ended::MaxIterations, Ended::NoSolution))
}

/// One sweep; the last contact that had no solution.
///
/// The states before the step, in `memory`, decide between several solutions; Newton's method starts
/// from them in the first sweep and from the last sweep's slip in later ones.
fn sweep(
    problem: &ContactProblem,
    memory: &Memory,
    workspace: &mut Workspace,
    first: bool,
) -> Option<usize> {
    let mut stuck = None;
    for (i, rows) in problem.contacts.iter().enumerate() {
        let history = &memory.states[i];
        let Workspace { percussion, blocks, planar, ambiguous, states, .. } = &mut *workspace;
        let found = match &rows.law {
            Law::One(law) => {
                let local = Local::new(law, problem, i, &blocks[i], percussion);
                let found = line::solve(&local, history);
                found.map(|found| store(rows, &found, percussion, history, &mut states[i]))
            }
            Law::Two(law) => {
                let local = Local::new(law, problem, i, &blocks[i], percussion);
                let guess = || start(if first { history.ahead() } else { states[i].slip }, &local);
                let found = plane::solve(&local, history, guess, planar);
                found.map(|found| store(rows, &found, percussion, history, &mut states[i]))
            }
            Law::Three(law) => {
                let own = rows.offset..rows.offset + rows.len();
                let held = problem.contact_velocity(i, percussion, false);
                let start = &percussion[own.clone()];
                space::solve(problem, i, law, (&held, start), history).map(|found| {
                    let len = own.len();
                    percussion[own].copy_from_slice(&found.percussion[..len]);
                    states[i] = history.after(found.phase, found.slip);
                    false
                })
            }
        };
        ambiguous[i] = found == Some(true);
        if found.is_none() {
            stuck = Some(i);
            states[i] = *history;
        }
    }
    stuck
}

/// A start of Newton's method: a slip velocity, or the free velocity if the contact has never slipped.
#[inline]
pub(super) fn start(slip: [f64; 3], local: &Local<'_, 2>) -> Vector<2> {
    let slip = Vector::<2>::new(slip[0], slip[1]);
    if slip.amax() == 0.0 { local.b_t } else { slip }
}

/// Keeps a solution; whether there were others.
#[inline]
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
    let mut slip = [0.0; 3];
    for j in 0..P {
        percussion[rows.tangent() + j] = solution.tangent[j];
        slip[j] = solution.slip[j];
    }
    *state = history.after(solution.phase, slip);
    found.ambiguous
}

/// Marks the contacts that have more than one solution with the others held.
pub(super) fn mark_ambiguous(problem: &ContactProblem, memory: &Memory, workspace: &mut Workspace) {
    for (i, rows) in problem.contacts.iter().enumerate() {
        let Workspace { percussion, blocks, planar, ambiguous, .. } = workspace;
        let state = &memory.states[i];
        ambiguous[i] = match &rows.law {
            Law::One(law) => {
                let local = Local::new(law, problem, i, &blocks[i], percussion);
                line::solve(&local, state).is_some_and(|s| s.ambiguous)
            }
            Law::Two(law) => {
                let local = Local::new(law, problem, i, &blocks[i], percussion);
                let guess = || start(state.ahead(), &local);
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
    let block = Block::new(problem, contact);
    let mut out = Vec::new();
    match &rows.law {
        Law::One(law) => {
            let local = Local::new(law, problem, contact, &block, percussion);
            out.extend(line::solutions(&local).into_iter().flatten().map(|s| LocalSolution {
                phase: s.phase,
                normal: s.normal,
                tangent: Vector::<2>::new(s.tangent[0], 0.0),
                slip: Vector::<2>::new(s.slip[0], 0.0),
                degenerate: s.degenerate,
            }));
        }
        Law::Two(law) => {
            let local = Local::new(law, problem, contact, &block, percussion);
            plane::solutions(&local, &mut out);
        }
        Law::Three(_) => {}
    }
    out
}

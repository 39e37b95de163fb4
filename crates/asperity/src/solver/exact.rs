//! Block Gauss–Seidel whose one-contact solve is exact.

use std::ops::Range;

use asperity_set::Vector;
use rayon::prelude::*;

use super::block::Block;
use super::local::{Local, LocalSolution, Selection};
use super::report::Ended;
use super::threads::{self, Threads};
use super::{Stop, Workspace, line, plane, space};
use crate::contact::{ContactProblem, ContactRows, ContactState, Memory};
use crate::law::Law;

/// Sweeps until the natural residual is below the tolerance.
pub(super) fn solve(
    problem: &ContactProblem,
    stop: Stop<'_>,
    (max_sweeps, threads): (usize, &Threads),
    memory: &Memory,
    workspace: &mut Workspace,
) -> (usize, Ended) {
    if problem.is_uncoupled() {
        let stuck = uncoupled(problem, threads, memory, workspace);
        return (1, stuck.map_or(Ended::Done, Ended::Stuck));
    }
    sweep(problem, memory, workspace, true);
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
            sweep(problem, memory, workspace, false);
        }
    }
    (max_sweeps, Ended::MaxIterations)
}

/// One sweep; the last contact that had no solution.
///
/// The states before the step, in `memory`, decide between several solutions; Newton's method starts
/// from them in the first sweep and from the last sweep's slip in later ones.
pub(super) fn sweep(
    problem: &ContactProblem,
    memory: &Memory,
    workspace: &mut Workspace,
    first: bool,
) -> Option<usize> {
    let mut stuck = None;
    let Workspace { percussion, blocks, planar, ambiguous, states, .. } = &mut *workspace;
    for (i, rows) in problem.contacts.iter().enumerate() {
        let history = &memory.states[i];
        let slip = if first { history.ahead() } else { states[i].slip };
        let held = problem.contact_velocity(i, percussion, false);
        let own = Own {
            percussion: &mut percussion[rows.offset..rows.offset + rows.len()],
            state: &mut states[i],
            ambiguous: &mut ambiguous[i],
        };
        if !one_contact((problem, i, &blocks[i]), &held, (history, slip), own, planar) {
            stuck = Some(i);
        }
    }
    stuck
}

/// Solves contacts that do not meet, side by side.
fn uncoupled(
    problem: &ContactProblem,
    threads: &Threads,
    memory: &Memory,
    workspace: &mut Workspace,
) -> Option<usize> {
    let Workspace { percussion, blocks, planar, ambiguous, states, .. } = &mut *workspace;
    let all = Part {
        contacts: 0..problem.contacts.len(),
        percussion: &mut *percussion,
        states: &mut *states,
        ambiguous: &mut *ambiguous,
    };
    if threads.serve(problem.contacts.len()) {
        return threads.run(|| all.solve_in_halves(problem, memory, blocks));
    }
    all.solve(problem, memory, blocks, planar)
}

/// A run of contacts with what belongs to them.
struct Part<'a> {
    contacts: Range<usize>,
    percussion: &'a mut [f64],
    states: &'a mut [ContactState],
    ambiguous: &'a mut [bool],
}

impl Part<'_> {
    /// The last contact without a solution. The order of contacts does not matter, nor who solves them.
    fn solve_in_halves(
        self,
        problem: &ContactProblem,
        memory: &Memory,
        blocks: &[Block],
    ) -> Option<usize> {
        let Self { contacts, percussion, states, ambiguous } = self;
        if contacts.len() <= threads::LEAF {
            let part = Part { contacts, percussion, states, ambiguous };
            return part.solve(problem, memory, blocks, &mut Vec::new());
        }
        let half = contacts.len() / 2;
        let middle = contacts.start + half;
        let row = problem.contacts[middle].offset - problem.contacts[contacts.start].offset;
        let (percussion, other) = percussion.split_at_mut(row);
        let (states, other_states) = states.split_at_mut(half);
        let (ambiguous, other_ambiguous) = ambiguous.split_at_mut(half);
        let left = Part { contacts: contacts.start..middle, percussion, states, ambiguous };
        let right = Part {
            contacts: middle..contacts.end,
            percussion: other,
            states: other_states,
            ambiguous: other_ambiguous,
        };
        let (left, right) = rayon::join(
            || left.solve_in_halves(problem, memory, blocks),
            || right.solve_in_halves(problem, memory, blocks),
        );
        right.or(left)
    }

    #[inline(always)]
    fn solve(
        self,
        problem: &ContactProblem,
        memory: &Memory,
        blocks: &[Block],
        planar: &mut Vec<LocalSolution<2>>,
    ) -> Option<usize> {
        let Self { contacts, mut percussion, states, ambiguous } = self;
        let mut stuck = None;
        for ((i, state), ambiguous) in contacts.zip(states).zip(ambiguous) {
            let history = &memory.states[i];
            let held = problem.load(i);
            let (own, rest) =
                std::mem::take(&mut percussion).split_at_mut(problem.contacts[i].len());
            percussion = rest;
            let own = Own { percussion: own, state, ambiguous };
            let at = (problem, i, &blocks[i]);
            if !one_contact(at, &held, (history, history.ahead()), own, planar) {
                stuck = Some(i);
            }
        }
        stuck
    }
}

/// What the solve of one contact changes.
struct Own<'a> {
    percussion: &'a mut [f64],
    state: &'a mut ContactState,
    ambiguous: &'a mut bool,
}

/// Solves one contact with the velocities `held` that the others leave it, from a slip velocity; false if
/// there is no solution.
#[inline(always)]
fn one_contact(
    (problem, i, block): (&ContactProblem, usize, &Block),
    held: &[f64; 4],
    (history, slip): (&ContactState, [f64; 3]),
    own: Own<'_>,
    planar: &mut Vec<LocalSolution<2>>,
) -> bool {
    let rows = &problem.contacts[i];
    let Own { percussion, state, ambiguous } = own;
    let found = match &rows.law {
        Law::One(law) => line::solve(&Local::from_held(law, rows, block, held), history)
            .map(|found| store(rows, &found, percussion, history, state)),
        Law::Two(law) => {
            let local = Local::from_held(law, rows, block, held);
            plane::solve(&local, history, || start(slip, &local), planar)
                .map(|found| store(rows, &found, percussion, history, state))
        }
        Law::Three(law) => {
            space::solve(problem, i, law, (held, percussion), history).map(|found| {
                let len = percussion.len();
                percussion.copy_from_slice(&found.percussion[..len]);
                *state = history.after(found.phase, found.slip);
                false
            })
        }
    };
    *ambiguous = found == Some(true);
    if found.is_none() {
        *state = *history;
    }
    found.is_some()
}

/// A start of Newton's method: a slip velocity, or the free velocity if the contact has never slipped.
#[inline]
pub(super) fn start(slip: [f64; 3], local: &Local<'_, 2>) -> Vector<2> {
    let slip = Vector::<2>::new(slip[0], slip[1]);
    if slip.amax() == 0.0 { local.b_t } else { slip }
}

/// Keeps a solution on the contact's own rows; whether there were others.
#[inline]
fn store<const P: usize>(
    rows: &ContactRows,
    found: &Selection<P>,
    percussion: &mut [f64],
    history: &ContactState,
    state: &mut ContactState,
) -> bool {
    let solution = &found.solution;
    let first = rows.normal_rows();
    if first == 1 {
        percussion[0] = solution.normal;
    }
    let mut slip = [0.0; 3];
    for j in 0..P {
        percussion[first + j] = solution.tangent[j];
        slip[j] = solution.slip[j];
    }
    *state = history.after(solution.phase, slip);
    found.ambiguous
}

/// Marks the contacts that have more than one solution with the others held.
pub(super) fn mark_ambiguous(
    problem: &ContactProblem,
    threads: &Threads,
    memory: &Memory,
    workspace: &mut Workspace,
) {
    let Workspace { percussion, blocks, planar, ambiguous, .. } = workspace;
    let (percussion, blocks) = (&percussion[..], &blocks[..]);
    let mark = |i: usize, planar: &mut Vec<LocalSolution<2>>| {
        is_ambiguous((problem, i, &blocks[i]), percussion, &memory.states[i], planar)
    };
    if threads.serve(ambiguous.len()) {
        threads.run(|| {
            ambiguous.par_chunks_mut(threads::LEAF).enumerate().for_each(|(chunk, part)| {
                let mut planar = Vec::new();
                for (k, flag) in part.iter_mut().enumerate() {
                    *flag = mark(chunk * threads::LEAF + k, &mut planar);
                }
            });
        });
        return;
    }
    for (i, flag) in ambiguous.iter_mut().enumerate() {
        *flag = mark(i, planar);
    }
}

fn is_ambiguous(
    (problem, i, block): (&ContactProblem, usize, &Block),
    percussion: &[f64],
    state: &ContactState,
    planar: &mut Vec<LocalSolution<2>>,
) -> bool {
    match &problem.contacts[i].law {
        Law::One(law) => {
            let local = Local::new(law, problem, i, block, percussion);
            line::solve(&local, state).is_some_and(|s| s.ambiguous)
        }
        Law::Two(law) => {
            let local = Local::new(law, problem, i, block, percussion);
            let guess = || start(state.ahead(), &local);
            plane::solve(&local, state, guess, planar).is_some_and(|s| s.ambiguous)
        }
        Law::Three(_) => false,
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

/// Whether a contact certainly has no solution with the percussions of the others held.
pub(super) fn proves_no_solution(
    problem: &ContactProblem,
    contact: usize,
    percussion: &[f64],
) -> bool {
    let listed = problem.contacts[contact].law.dimension() < 3;
    listed && all_solutions(problem, contact, percussion).is_empty()
}

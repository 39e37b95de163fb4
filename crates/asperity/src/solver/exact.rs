//! Block Gauss–Seidel whose one-contact solve is exact.

use std::ops::Range;

use asperity_set::Vector;
use rayon::prelude::*;

use super::block::Block;
use super::effort::Effort;
use super::local::{Local, LocalSolution, Selection};
use super::plane::Rising;
use super::report::Ended;
use super::threads::{self, Threads};
use super::{Stop, Workspace, line, plane, space};
use crate::contact::{ContactProblem, ContactRows, ContactState, Memory, Phase};
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
        let stuck = match uncoupled(problem, stop, threads, memory, workspace) {
            Ok(stuck) => stuck,
            Err(Interrupted) => return (1, Ended::TimeLimit),
        };
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

/// Whether it is proven that a contact has no solution, the percussions of the others held.
///
/// With `x = −P_T/P_N` the certificate consists of three parts, each with a relative margin of 10⁻⁹, so that
/// neither rounding nor data known to nine digits can turn it round:
///
/// - the contact cannot open: `b_N < 0`;
/// - it cannot stick: the only percussions with `GP + b = 0` pull, `P_N < 0`, or are outside, `k_C(x) > 1`;
/// - it cannot slip: all along bdry *D* the slip velocity `v(x)` is not along the normal, `F = n × v ≠ 0`, or is
///   against it, or the normal force would pull, `g_NN − G_NT x < 0`. For `p = 1` these are two
///   points, for `p = 2` the boundary is covered by pieces over each of which one of the three holds.
///
/// A block whose Schur complement has lost digits proves nothing, nor does a search that finds nothing in
/// `p = 3`: there are contacts without a solution for which this is false.
pub(super) fn proves_no_solution(
    problem: &ContactProblem,
    contact: usize,
    percussion: &[f64],
) -> bool {
    if problem.delassus().is_matrix_free() {
        return false;
    }
    let block = Block::new(problem, contact);
    match &problem.contacts()[contact].law {
        Law::One(law) => {
            line::proves_no_solution(&Local::new(law, problem, contact, &block, percussion))
        }
        Law::Two(law) => {
            plane::proves_no_solution(&Local::new(law, problem, contact, &block, percussion))
        }
        Law::Three(_) => false,
    }
}

/// A solution of one contact in which speed and factor agree.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Settled {
    pub(crate) factor: f64,
    pub(crate) state: ContactState,
    /// Normal percussion.
    pub(crate) normal: f64,
    /// Tangential percussions, to be multiplied by the factor.
    pub(crate) tangent: [f64; 2],
    /// Whether there are others.
    pub(crate) ambiguous: bool,
}

/// The solution with a factor of the speed at the end that continues `state`, the percussions of the other
/// contacts held; `None` where there is none, and for `p = 3`.
#[cold]
pub(crate) fn settle(
    problem: &ContactProblem,
    contact: usize,
    percussion: &[f64],
    state: &ContactState,
    factor: &Rising<'_>,
    workspace: &mut Workspace,
) -> Option<Settled> {
    if problem.delassus().is_matrix_free() {
        return None;
    }
    let block = Block::new(problem, contact);
    match &problem.contacts()[contact].law {
        Law::One(law) => {
            let local = Local::new(law, problem, contact, &block, percussion);
            let all = &mut workspace.linear;
            plane::solutions_on_a_line(&local, factor, all);
            Settled::new(&local, all, state, factor)
        }
        Law::Two(law) => {
            let local = Local::new(law, problem, contact, &block, percussion);
            let all = &mut workspace.planar;
            plane::rising_solutions(&local, factor, all);
            Settled::new(&local, all, state, factor)
        }
        Law::Three(_) => None,
    }
}

impl Settled {
    fn new<const P: usize>(
        local: &Local<'_, P>,
        all: &[LocalSolution<P>],
        state: &ContactState,
        factor: &Rising<'_>,
    ) -> Option<Self> {
        let found = local.select(all, state)?;
        let speed = if found.phase == Phase::Slip { found.slip.norm() } else { 0.0 };
        let (mut tangent, mut slip) = ([0.0; 2], [0.0; 3]);
        tangent[..P].copy_from_slice(found.tangent.as_slice());
        slip[..P].copy_from_slice(found.slip.as_slice());
        Some(Self {
            factor: factor.falling + factor.rate.rising(speed),
            state: ContactState::new(found.phase, slip),
            normal: found.normal,
            tangent,
            ambiguous: all.len() > 1,
        })
    }
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
    let Workspace { percussion, blocks, planar, ambiguous, states, efforts, .. } = &mut *workspace;
    for (i, rows) in problem.contacts().iter().enumerate() {
        let history = &memory.states[i];
        let slip = if first { history.ahead() } else { states[i].slip };
        let held = problem.contact_velocity(i, percussion, false);
        let own = Own {
            percussion: &mut percussion[rows.rows()],
            state: &mut states[i],
            ambiguous: &mut ambiguous[i],
            effort: &mut efforts[i],
        };
        if !one_contact((problem, i, &blocks[i]), &held, (history, slip), own, planar) {
            stuck = Some(i);
        }
    }
    stuck
}

/// Velocities below this part of those without percussions are what rounding leaves of them.
const ROUNDING: f64 = 1e-14;

/// Contacts between two looks at the clock, where all are gone through: some milliseconds at the most.
const BATCH: usize = 8 * threads::LEAF;

/// The stop has ended the work early.
struct Interrupted;

/// Solves contacts that do not meet, side by side; the last one for which there was no solution.
#[inline]
fn uncoupled(
    problem: &ContactProblem,
    stop: Stop<'_>,
    threads: &Threads,
    memory: &Memory,
    workspace: &mut Workspace,
) -> Result<Option<usize>, Interrupted> {
    let Workspace { percussion, blocks, planar, ambiguous, states, .. } = &mut *workspace;
    let mut rest = Part {
        contacts: 0..problem.contacts().len(),
        percussion: &mut *percussion,
        states: &mut *states,
        ambiguous: &mut *ambiguous,
    };
    let mut stuck = None;
    while rest.contacts.len() > BATCH {
        let (batch, after) = rest.split(problem, BATCH);
        rest = after;
        stuck = batch.run(problem, threads, memory, blocks, planar).or(stuck);
        if stop.early() {
            rest.states.copy_from_slice(&memory.states[rest.contacts]);
            return Err(Interrupted);
        }
    }
    Ok(rest.run(problem, threads, memory, blocks, planar).or(stuck))
}

/// A run of contacts with what belongs to them.
struct Part<'a> {
    contacts: Range<usize>,
    percussion: &'a mut [f64],
    states: &'a mut [ContactState],
    ambiguous: &'a mut [bool],
}

impl<'a> Part<'a> {
    /// The first `count` contacts and the others.
    fn split(self, problem: &ContactProblem, count: usize) -> (Self, Self) {
        let Self { contacts, percussion, states, ambiguous } = self;
        let middle = contacts.start + count;
        let row = problem.contacts()[middle].offset - problem.contacts()[contacts.start].offset;
        let (percussion, other_percussion) = percussion.split_at_mut(row);
        let (states, other_states) = states.split_at_mut(count);
        let (ambiguous, other_ambiguous) = ambiguous.split_at_mut(count);
        let first = Self { contacts: contacts.start..middle, percussion, states, ambiguous };
        let others = Self {
            contacts: middle..contacts.end,
            percussion: other_percussion,
            states: other_states,
            ambiguous: other_ambiguous,
        };
        (first, others)
    }

    #[inline(always)]
    fn run(
        self,
        problem: &ContactProblem,
        threads: &Threads,
        memory: &Memory,
        blocks: &[Block],
        planar: &mut Vec<LocalSolution<2>>,
    ) -> Option<usize> {
        if threads.serve(self.contacts.len()) {
            return threads.run(|| self.solve_in_halves(problem, memory, blocks));
        }
        self.solve(problem, memory, blocks, planar)
    }

    /// The last contact without a solution. The order of contacts does not matter, nor who solves them.
    fn solve_in_halves(
        self,
        problem: &ContactProblem,
        memory: &Memory,
        blocks: &[Block],
    ) -> Option<usize> {
        if self.contacts.len() <= threads::LEAF {
            return self.solve(problem, memory, blocks, &mut Vec::new());
        }
        let half = self.contacts.len() / 2;
        let (left, right) = self.split(problem, half);
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
                std::mem::take(&mut percussion).split_at_mut(problem.contacts()[i].len());
            percussion = rest;
            let effort = &mut Effort::alone();
            let own = Own { percussion: own, state, ambiguous, effort };
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
    effort: &'a mut Effort,
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
    let rows = &problem.contacts()[i];
    let Own { percussion, state, ambiguous, effort } = own;
    let found = match &rows.law {
        Law::One(law) => line::solve(&Local::from_held(law, rows, block, held), history, effort)
            .map(|found| store(rows, &found, percussion, history, state)),
        Law::Two(law) => {
            let local = Local::from_held(law, rows, block, held);
            plane::solve(&local, history, || start(slip, &local), (planar, effort))
                .map(|found| store(rows, &found, percussion, history, state))
        }
        Law::Three(law) => {
            space::solve(problem, i, law, (held, percussion), history, effort).map(|found| {
                let len = percussion.len();
                percussion.copy_from_slice(&found.percussion[..len]);
                *state = history.after(found.phase, found.slip);
                found.degenerate
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

/// Marks the contacts that have more than one solution with the others held; once the stop asks to end,
/// the contacts that are left are not looked at any more.
pub(super) fn mark_ambiguous(
    problem: &ContactProblem,
    stop: Stop<'_>,
    threads: &Threads,
    memory: &Memory,
    workspace: &mut Workspace,
) {
    let Workspace { percussion, blocks, planar, ambiguous, .. } = workspace;
    let (percussion, blocks) = (&percussion[..], &blocks[..]);
    let mark = |i: usize, planar: &mut Vec<LocalSolution<2>>| {
        is_ambiguous((problem, i, &blocks[i]), percussion, &memory.states[i], planar)
    };
    let mut first = 0;
    for batch in ambiguous.chunks_mut(BATCH) {
        let count = batch.len();
        if first > 0 && stop.early() {
            batch.fill(false);
        } else if threads.serve(count) {
            threads.run(|| {
                batch.par_chunks_mut(threads::LEAF).enumerate().for_each(|(chunk, part)| {
                    let mut planar = Vec::new();
                    for (k, flag) in part.iter_mut().enumerate() {
                        *flag = mark(first + chunk * threads::LEAF + k, &mut planar);
                    }
                });
            });
        } else {
            for (k, flag) in batch.iter_mut().enumerate() {
                *flag = mark(first + k, planar);
            }
        }
        first += count;
    }
}

fn is_ambiguous(
    (problem, i, block): (&ContactProblem, usize, &Block),
    percussion: &[f64],
    state: &ContactState,
    planar: &mut Vec<LocalSolution<2>>,
) -> bool {
    // A redundant foot that the others stop has nothing to do: to search with what rounding has left of its load
    // would find anything or nothing.
    let held = problem.contact_velocity(i, percussion, false);
    let size = |velocity: [f64; 4]| velocity.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    if size(held) <= ROUNDING * size(problem.load(i)) {
        return false;
    }
    match &problem.contacts()[i].law {
        Law::One(law) => {
            let local = Local::new(law, problem, i, block, percussion);
            line::solve(&local, state, &mut Effort::none()).is_some_and(|s| s.ambiguous)
        }
        Law::Two(law) => {
            let local = Local::new(law, problem, i, block, percussion);
            let guess = || start(state.ahead(), &local);
            plane::solve(&local, state, guess, (planar, &mut Effort::none()))
                .is_some_and(|s| s.ambiguous)
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
    let rows = &problem.contacts()[contact];
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

//! Block Gauss–Seidel: contact after contact is solved with the percussions of the others held.
//!
//! One sweep serves two ends. [`Solver::Exact`](crate::solver::Solver::Exact) asks every contact for the solution that
//! the selection rule takes, and whether there are others. Within [`Solver::Auto`](crate::solver::Solver::Auto) sweeps are
//! followed by other methods and by further sweeps: the first solution that is found will do, without the proof that it
//! is the only one, which is made once at the end ([`mark_ambiguous`]).

use std::ops::Range;

use super::task::{Iterate, Task};
use super::threads;
use crate::contact::{ContactProblem, ContactState, Phase};
use crate::solver::measure::alone::{OwnMeasure, measure_alone};
use crate::solver::measure::natural_residual::Residual;
use crate::solver::one_contact::block::Block;
use crate::solver::one_contact::effort::Effort;
use crate::solver::one_contact::solve::{Candidates, Found, OneContact, Policy, Start};
use crate::solver::report::Ended;

/// Contacts between two looks at the clock, where all are gone through: some milliseconds at the most.
const BATCH: usize = 8 * threads::LEAF;

/// Prepared blocks and buffers.
#[derive(Debug, Clone, Default)]
pub(crate) struct Sweeper {
    /// Diagonal blocks of `G`.
    blocks: Vec<Block>,
    /// What is left of the work on contacts in sweeps.
    efforts: Vec<Effort>,
    pub(crate) candidates: Candidates,
}

impl Sweeper {
    /// Prepares the blocks of a problem.
    pub(crate) fn prepare(&mut self, problem: &ContactProblem) {
        let contacts = problem.contacts().len();
        self.efforts.resize(contacts, Effort::in_sweeps());
        self.blocks.clear();
        self.blocks.extend((0..contacts).map(|contact| Block::new(problem, contact)));
    }

    /// Number of contacts that are prepared.
    #[inline]
    pub(crate) fn contacts(&self) -> usize {
        self.blocks.len()
    }

    /// Begins a solve: all the work is left.
    pub(crate) fn renew_efforts(&mut self) {
        self.efforts.fill(Effort::in_sweeps());
    }

    /// Sweeps until the natural residual is below the tolerance; their number, why they ended and the residual.
    pub(crate) fn solve(
        &mut self,
        task: &Task<'_>,
        iterate: &mut Iterate<'_>,
        max_sweeps: usize,
    ) -> (usize, Ended, Residual) {
        let goal = f64::max(0.1 * task.stop.tolerance, 4.0 * f64::EPSILON);
        let mut sweeps = 0;
        loop {
            // Contacts without a solution may find one when the others have moved.
            self.sweep(task, iterate, Policy::Prove, sweeps == 0);
            sweeps += 1;
            let residual = iterate.measure(task);
            if residual.value <= goal {
                return (sweeps, Ended::Done, residual);
            }
            if task.stop.early() {
                return (sweeps, Ended::TimeLimit, residual);
            }
            if sweeps >= max_sweeps {
                return (sweeps, Ended::MaxIterations, residual);
            }
        }
    }

    /// One sweep; the last contact that had no solution.
    ///
    /// The states before the step decide between several solutions; Newton's method starts from them in the first
    /// sweep and from the last sweep's slip in later ones.
    pub(crate) fn sweep(
        &mut self,
        task: &Task<'_>,
        iterate: &mut Iterate<'_>,
        policy: Policy,
        first: bool,
    ) -> Option<usize> {
        let (problem, mut stuck) = (task.problem, None);
        for (i, rows) in problem.contacts().iter().enumerate() {
            let (history, block) = (&task.history[i], &self.blocks[i]);
            let state = &mut iterate.states[i];
            let held = problem.contact_velocity(i, iterate.percussion, false);
            let percussion = &mut iterate.percussion[rows.rows()];
            if policy == Policy::FirstFound && block.pressed && held[0] >= 0.0 {
                percussion.fill(0.0);
                state.phase = Phase::Open;
                continue;
            }
            let slip = (!first).then_some(state.slip);
            let contact = OneContact { problem, contact: i, block, held };
            let (candidates, effort) = (&mut self.candidates, &mut self.efforts[i]);
            let start = Start { history, slip };
            let found = contact.solve(policy, start, percussion, candidates, effort);
            if found.is_none() {
                stuck = Some(i);
            }
            match (policy, found) {
                (Policy::Prove, found) => {
                    record(found, history, state, &mut iterate.ambiguous[i]);
                }
                (Policy::FirstFound, Some(found)) => {
                    (state.phase, state.slip) = (found.phase, found.slip);
                }
                (Policy::FirstFound, None) => {}
            }
        }
        stuck
    }

    /// Solves and measures contacts that do not influence each other, side by side: one sweep is enough.
    #[inline]
    pub(crate) fn solve_uncoupled(&mut self, task: &Task<'_>, iterate: &mut Iterate<'_>) -> Swept {
        let Self { blocks, candidates, .. } = self;
        let Iterate { percussion, velocity, states, ambiguous, .. } = iterate;
        // The belt and the disk of many a model: one contact needs no batches.
        if let ([_], [block], [state], [ambiguous]) =
            (task.problem.contacts(), &blocks[..], &mut **states, &mut **ambiguous)
        {
            let contact = OneContact::alone(task.problem, 0, block);
            let own = Own { percussion, velocity, state, ambiguous };
            return solve_alone(contact, &task.history[0], own, candidates);
        }
        let mut rest = Uncoupled {
            contacts: 0..task.problem.contacts().len(),
            percussion,
            velocity,
            states,
            ambiguous,
        };
        let mut swept = Swept::NOTHING;
        while rest.contacts.len() > BATCH {
            let (batch, after) = rest.split(task.problem, BATCH);
            rest = after;
            swept = swept.and(batch.run(task, blocks, candidates));
            if task.stop.early() {
                rest.states.copy_from_slice(&task.history[rest.contacts]);
                return Swept { ended: Ended::TimeLimit, ..swept };
            }
        }
        swept.and(rest.run(task, blocks, candidates))
    }
}

/// What has come of a sweep over contacts that do not influence each other.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Swept {
    /// Done, or stuck at the last contact without a solution.
    pub(crate) ended: Ended,
    /// Square of the largest relative defect, negative without contacts, and the first contact that has it.
    defect: f64,
    worst_contact: usize,
    /// Whether percussions may have grown.
    pub(crate) may_grow: bool,
    /// Whether a contact has several solutions.
    pub(crate) ambiguous: bool,
}

impl Swept {
    /// Of no contacts.
    const NOTHING: Self = Self {
        ended: Ended::Done,
        defect: -1.0,
        worst_contact: 0,
        may_grow: false,
        ambiguous: false,
    };

    /// With contacts that come later.
    #[inline(always)]
    fn and(self, later: Self) -> Self {
        // Not-a-number counts as the worst of all.
        let worse = !(later.defect <= self.defect);
        let worst = if worse { later } else { self };
        Self {
            ended: if later.ended == Ended::Done { self.ended } else { later.ended },
            defect: worst.defect,
            worst_contact: worst.worst_contact,
            may_grow: self.may_grow || later.may_grow,
            ambiguous: self.ambiguous || later.ambiguous,
        }
    }

    /// The natural residual, where all contacts were visited.
    #[inline(always)]
    pub(crate) fn residual(&self) -> Residual {
        let value = if self.defect < 0.0 { 0.0 } else { self.defect.sqrt() };
        Residual { value, worst_contact: self.worst_contact }
    }
}

/// The state of a contact after its solution; the state before where there is none.
#[inline(always)]
fn record(
    found: Option<Found>,
    history: &ContactState,
    state: &mut ContactState,
    ambiguous: &mut bool,
) {
    match found {
        Some(found) => state.follow(history, found.phase, found.slip),
        None => *state = *history,
    }
    *ambiguous = found.is_some_and(|found| found.ambiguous);
}

/// What belongs to one contact.
struct Own<'a> {
    percussion: &'a mut [f64],
    velocity: &'a mut [f64],
    state: &'a mut ContactState,
    ambiguous: &'a mut bool,
}

/// Solves and measures a contact that no other influences.
#[inline(always)]
fn solve_alone(
    contact: OneContact<'_>,
    history: &ContactState,
    own: Own<'_>,
    candidates: &mut Candidates,
) -> Swept {
    let Own { percussion, velocity, state, ambiguous } = own;
    let (start, effort) = (Start { history, slip: None }, &mut Effort::alone());
    let found = contact.solve(Policy::Prove, start, percussion, candidates, effort);
    record(found, history, state, ambiguous);
    let OneContact { problem, contact: number, .. } = contact;
    let OwnMeasure { defect, may_grow } = measure_alone(problem, number, percussion, velocity);
    let ended = if found.is_some() { Ended::Done } else { Ended::Stuck(number) };
    Swept { ended, defect, worst_contact: number, may_grow, ambiguous: *ambiguous }
}

/// Contacts that do not influence each other, in a row, with what belongs to them.
struct Uncoupled<'a> {
    contacts: Range<usize>,
    percussion: &'a mut [f64],
    velocity: &'a mut [f64],
    states: &'a mut [ContactState],
    ambiguous: &'a mut [bool],
}

impl<'a> Uncoupled<'a> {
    /// The first `count` contacts and the others.
    fn split(self, problem: &ContactProblem, count: usize) -> (Self, Self) {
        let Self { contacts, percussion, velocity, states, ambiguous } = self;
        let middle = contacts.start + count;
        let row = problem.contacts()[middle].offset - problem.contacts()[contacts.start].offset;
        let (percussion, other_percussion) = percussion.split_at_mut(row);
        let (velocity, other_velocity) = velocity.split_at_mut(row);
        let (states, other_states) = states.split_at_mut(count);
        let (ambiguous, other_ambiguous) = ambiguous.split_at_mut(count);
        let (first, second) = (contacts.start..middle, middle..contacts.end);
        let first = Self { contacts: first, percussion, velocity, states, ambiguous };
        let others = Self {
            contacts: second,
            percussion: other_percussion,
            velocity: other_velocity,
            states: other_states,
            ambiguous: other_ambiguous,
        };
        (first, others)
    }

    #[inline(always)]
    fn run(self, task: &Task<'_>, blocks: &[Block], candidates: &mut Candidates) -> Swept {
        if task.threads.serve(self.contacts.len()) {
            let (problem, history) = (task.problem, task.history);
            return task.threads.run(|| self.solve_in_halves(problem, history, blocks));
        }
        self.solve(task.problem, task.history, blocks, candidates)
    }

    /// The order of contacts does not matter, nor who solves them.
    fn solve_in_halves(
        self,
        problem: &ContactProblem,
        history: &[ContactState],
        blocks: &[Block],
    ) -> Swept {
        if self.contacts.len() <= threads::LEAF {
            return self.solve(problem, history, blocks, &mut Candidates::default());
        }
        let half = self.contacts.len() / 2;
        let (left, right) = self.split(problem, half);
        let (left, right) = threads::join(
            || left.solve_in_halves(problem, history, blocks),
            || right.solve_in_halves(problem, history, blocks),
        );
        left.and(right)
    }

    #[inline(always)]
    fn solve(
        self,
        problem: &ContactProblem,
        history: &[ContactState],
        blocks: &[Block],
        candidates: &mut Candidates,
    ) -> Swept {
        let Self { contacts, mut percussion, mut velocity, states, ambiguous } = self;
        let mut swept = Swept::NOTHING;
        for ((i, state), ambiguous) in contacts.zip(states).zip(ambiguous) {
            let len = problem.contacts()[i].len();
            let (own, rest) = std::mem::take(&mut percussion).split_at_mut(len);
            let (own_velocity, rest_velocity) = std::mem::take(&mut velocity).split_at_mut(len);
            (percussion, velocity) = (rest, rest_velocity);
            let contact = OneContact::alone(problem, i, &blocks[i]);
            let own = Own { percussion: own, velocity: own_velocity, state, ambiguous };
            swept = swept.and(solve_alone(contact, &history[i], own, candidates));
        }
        swept
    }
}

/// Marks the contacts that have more than one solution with the others held; once the stop asks to end,
/// the contacts that are left are not looked at any more.
pub(crate) fn mark_ambiguous(task: &Task<'_>, iterate: &mut Iterate<'_>, sweeper: &mut Sweeper) {
    let Sweeper { blocks, candidates, .. } = sweeper;
    let Iterate { percussion, ambiguous, .. } = iterate;
    let (blocks, percussion) = (&blocks[..], &percussion[..]);
    let (problem, history, threads) = (task.problem, task.history, task.threads);
    let mark = |i: usize, candidates: &mut Candidates| {
        OneContact::new(problem, i, &blocks[i], percussion).is_ambiguous(&history[i], candidates)
    };
    let mut first = 0;
    for batch in ambiguous.chunks_mut(BATCH) {
        let count = batch.len();
        if first > 0 && task.stop.early() {
            batch.fill(false);
        } else if threads.serve(count) {
            threads.run(|| {
                threads::each(first, batch, &|i, flag, candidates| *flag = mark(i, candidates));
            });
        } else {
            for (k, flag) in batch.iter_mut().enumerate() {
                *flag = mark(first + k, candidates);
            }
        }
        first += count;
    }
}

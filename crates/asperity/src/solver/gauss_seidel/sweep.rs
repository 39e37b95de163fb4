//! Block Gauss–Seidel: contact after contact is solved with the percussions of the others held.
//!
//! One sweep serves two ends. [`Solver::Exact`](crate::solver::Solver::Exact) asks every contact for the solution that
//! the selection rule takes, and whether there are others. Within [`Solver::Auto`](crate::solver::Solver::Auto) sweeps are
//! followed by other methods and by further sweeps: the first solution that is found will do, without the proof that it
//! is the only one, which is made once at the end ([`mark_ambiguous`]).

use std::ops::Range;

use super::islands::Plan;
use super::swept::Swept;
use super::task::{Iterate, Task};
use super::visitor::{BATCH, Visitor, record};
use crate::contact::{Components, ContactProblem, ContactState, Members};
use crate::solver::measure::own::{OwnMeasure, measure_alone};
use crate::solver::one_contact::block::Block;
use crate::solver::one_contact::solve::{Candidates, OneContact, Policy, Start};
use crate::solver::report::Ended;
use crate::threads;

/// Prepared blocks and buffers.
#[derive(Debug, Clone, Default)]
pub(crate) struct Sweeper {
    /// Diagonal blocks of `G`.
    blocks: Vec<Block>,
    /// Contacts that influence each other, directly or by others.
    islands: Members,
    pub(crate) candidates: Candidates,
}

impl Sweeper {
    /// Prepares the blocks of a problem.
    pub(crate) fn prepare(&mut self, problem: &ContactProblem) {
        let contacts = problem.contacts().len();
        let mut connected = Components::default();
        connected.separate(contacts);
        for i in 0..contacts {
            problem.delassus().blocks().neighbours(i).iter().for_each(|&j| connected.join(i, j));
        }
        // Which contacts a matrix-free operator connects is not known.
        if problem.delassus().is_matrix_free() {
            (0..contacts).for_each(|i| connected.join(0, i));
        }
        self.islands.update(&mut connected);
        self.refresh(problem);
    }

    /// Prepares the blocks of a problem whose operator has other entries than before.
    pub(crate) fn refresh(&mut self, problem: &ContactProblem) {
        let contacts = problem.contacts().len();
        self.blocks.clear();
        self.blocks.extend((0..contacts).map(|contact| Block::new(problem, contact)));
    }

    /// Number of contacts that are prepared.
    #[inline]
    pub(crate) fn contacts(&self) -> usize {
        self.blocks.len()
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
        let Self { blocks, candidates, .. } = self;
        let mut visitor = Visitor { blocks, candidates };
        visitor.visit_all(task, iterate, policy, first, 0..task.problem.contacts().len())
    }

    /// The islands of the problem.
    #[inline]
    pub(crate) fn islands(&self) -> &Members {
        &self.islands
    }

    /// Sweeps island by island; `swept` receives what they have come to, of fewer islands if the stop has ended it early.
    /// Afterwards velocities belong to the percussions and states to what the contacts do, and contacts are marked as
    /// ambiguous.
    pub(crate) fn solve_islands(
        &mut self,
        task: &Task<'_>,
        iterate: &mut Iterate<'_>,
        plan: Plan,
        swept: &mut Vec<Swept>,
    ) {
        let Self { blocks, islands, candidates, .. } = self;
        let mut visitor = Visitor { blocks, candidates };
        visitor.solve_islands(task, iterate, plan, islands, swept);
    }

    /// Solves and measures the only contact of a problem.
    #[inline(always)]
    pub(crate) fn solve_only(
        &mut self,
        problem: &ContactProblem,
        history: &ContactState,
        own: Own<'_>,
    ) -> Swept {
        let contact = OneContact::alone(problem, 0, &self.blocks[0]);
        solve_alone(contact, history, own, &mut self.candidates)
    }

    /// Solves and measures contacts that do not influence each other, side by side: one sweep is enough.
    pub(crate) fn solve_uncoupled(&mut self, task: &Task<'_>, iterate: &mut Iterate<'_>) -> Swept {
        let Self { blocks, candidates, .. } = self;
        let Iterate { percussion, velocity, states, ambiguous, .. } = iterate;
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

/// What belongs to one contact.
pub(crate) struct Own<'a> {
    pub(crate) percussion: &'a mut [f64],
    pub(crate) velocity: &'a mut [f64],
    pub(crate) state: &'a mut ContactState,
    pub(crate) ambiguous: &'a mut bool,
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
    let start = Start { history, slip: None };
    let found = contact.solve(Policy::Prove, start, percussion, candidates);
    record(found, history, state, ambiguous);
    let OneContact { problem, contact: number, .. } = contact;
    let OwnMeasure { defect, may_be_flawed, .. } =
        measure_alone(problem, number, percussion, velocity);
    let ended = if found.is_some() { Ended::Done } else { Ended::Stuck(number) };
    let may_grow = may_be_flawed;
    let stuck = found.is_none();
    let (worst_contact, ambiguous) = (number, *ambiguous);
    Swept { sweeps: 1, ended, defect, worst_contact, stuck, may_grow, ambiguous, alone: true }
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

/// Marks the contacts that have more than one solution with the others held; the velocities of the iterate are those of its
/// percussions. Once the stop asks to end, the contacts that are left are not looked at any more.
pub(crate) fn mark_ambiguous(task: &Task<'_>, iterate: &mut Iterate<'_>, sweeper: &mut Sweeper) {
    let Sweeper { blocks, candidates, .. } = sweeper;
    let Iterate { percussion, velocity, ambiguous, .. } = iterate;
    let (blocks, moved) = (&blocks[..], (&percussion[..], &velocity[..]));
    let (problem, history, threads) = (task.problem, task.history, task.threads);
    let mark = |i: usize, candidates: &mut Candidates| {
        OneContact::within(problem, i, &blocks[i], moved).is_ambiguous(&history[i], candidates)
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

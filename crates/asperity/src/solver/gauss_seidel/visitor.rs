//! A visit to one contact: it is solved with the percussions of the others held.

use super::task::{Iterate, Task};
use crate::contact::{ContactProblem, ContactState, Phase};
use crate::solver::one_contact::block::Block;
use crate::solver::one_contact::solve::{Candidates, Found, OneContact, Policy, Start};
use crate::threads;

/// Contacts between two looks at the clock, where all are gone through: some milliseconds at the most.
pub(super) const BATCH: usize = 8 * threads::LEAF;

/// What a sweep counts for between two looks at the clock: the number of its contacts, or as much as asks for a look where laws
/// are not isotropic, of which a visit may take milliseconds.
pub(crate) fn untimed_visits(
    problem: &ContactProblem,
    mut contacts: impl ExactSizeIterator<Item = usize>,
) -> usize {
    let count = contacts.len();
    let is_quick = |i: usize| problem.contacts()[i].law.isotropic_coefficient().is_some();
    if contacts.all(is_quick) { count } else { threads::LEAF }
}

/// Who visits contacts: prepared blocks and buffers.
pub(super) struct Visitor<'a> {
    pub(super) blocks: &'a [Block],
    pub(super) candidates: &'a mut Candidates,
}

impl Visitor<'_> {
    /// Visits contacts in this order; the last one that had no solution.
    pub(super) fn visit_all(
        &mut self,
        task: &Task<'_>,
        iterate: &mut Iterate<'_>,
        policy: Policy,
        first: bool,
        contacts: impl Iterator<Item = usize>,
    ) -> Option<usize> {
        let visitor = self;
        pulp::Arch::new().dispatch(Visits { visitor, task, iterate, policy, first, contacts })
    }

    /// Solves a contact with the percussions of the others held; whether there is a solution.
    #[inline(always)]
    fn visit(
        &mut self,
        task: &Task<'_>,
        iterate: &mut Iterate<'_>,
        policy: Policy,
        first: bool,
        i: usize,
    ) -> bool {
        let (problem, history, block) = (task.problem, &task.history[i], &self.blocks[i]);
        let state = &mut iterate.states[i];
        let held = problem.contact_velocity(i, iterate.percussion, false);
        let percussion = &mut iterate.percussion[problem.contacts()[i].rows()];
        let contact = OneContact { problem, contact: i, block, held };
        let candidates = &mut *self.candidates;
        if policy == Policy::Prove {
            let start = Start { history, slip: (!first).then_some(state.slip) };
            let found = contact.solve(policy, start, percussion, candidates);
            record(found, history, state, &mut iterate.ambiguous[i]);
            return found.is_some();
        }
        let found = first_found(contact, (history, state, first), percussion, candidates);
        if let Some(found) = found {
            (state.phase, state.slip) = (found.phase, found.slip);
        }
        found.is_some()
    }

    /// Whether a contact has more than one solution with the percussions of the others held; the velocities of the iterate
    /// are those of its percussions.
    #[inline]
    pub(super) fn is_ambiguous(
        &mut self,
        task: &Task<'_>,
        iterate: &Iterate<'_>,
        contact: usize,
    ) -> bool {
        let moved = (&*iterate.percussion, &*iterate.velocity);
        let one = OneContact::within(task.problem, contact, &self.blocks[contact], moved);
        one.is_ambiguous(&task.history[contact], self.candidates)
    }
}

/// A call of [`Visitor::visit_all`] that the compiler copies into every set of instructions: one contact waits for the
/// percussions of the one before, which the newer ones read faster. Multiplications and additions stay apart, with the same
/// bits in all of them.
struct Visits<'v, 'a, 'b, 'c, I> {
    visitor: &'v mut Visitor<'a>,
    task: &'v Task<'b>,
    iterate: &'v mut Iterate<'c>,
    policy: Policy,
    first: bool,
    contacts: I,
}

impl<I: Iterator<Item = usize>> pulp::NullaryFnOnce for Visits<'_, '_, '_, '_, I> {
    type Output = Option<usize>;

    #[inline(always)]
    fn call(self) -> Option<usize> {
        let Self { visitor, task, iterate, policy, first, contacts } = self;
        let mut stuck = None;
        for i in contacts {
            if !visitor.visit(task, iterate, policy, first, i) {
                stuck = Some(i);
            }
        }
        stuck
    }
}

/// The first solution of a contact that is found, from its state before the step and, but for the `first` sweep, from that
/// of the last sweep.
#[inline(always)]
pub(super) fn first_found(
    contact: OneContact<'_>,
    (history, last, first): (&ContactState, &ContactState, bool),
    percussion: &mut [f64],
    candidates: &mut Candidates,
) -> Option<Found> {
    if contact.block.normal_dominates && contact.held[0] >= 0.0 {
        percussion.fill(0.0);
        return Some(Found { phase: Phase::Open, slip: last.slip, ambiguous: false });
    }
    let start = Start { history, slip: (!first).then_some(last.slip) };
    contact.solve(Policy::FirstFound, start, percussion, candidates)
}

/// The state of a contact after its solution; the state before where there is none.
#[inline(always)]
pub(super) fn record(
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

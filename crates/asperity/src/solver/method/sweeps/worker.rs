//! Islands that several threads sweep side by side. An island's contacts are not one after the other in memory: every
//! thread works in copies of its own, from which what it has found is put back at the end.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use super::island_sweeps::Plan;
use super::swept::Swept;
use super::visitor::Visitor;
use crate::contact::{ContactProblem, ContactState, Members};
use crate::solver::measure::stop::Stop;
use crate::solver::method::task::{Iterate, Task};
use crate::solver::one_contact::block::Block;
use crate::solver::one_contact::solve::Candidates;
use crate::threads::Threads;

/// What one thread changes.
#[derive(Debug, Clone, Default)]
pub(super) struct Worker {
    percussion: Vec<f64>,
    velocity: Vec<f64>,
    states: Vec<ContactState>,
    ambiguous: Vec<bool>,
    candidates: Candidates,
    brought: Vec<f64>,
    /// The islands that it has swept, and what they have come to.
    islands: Vec<usize>,
    swept: Vec<Swept>,
}

/// Sweeps islands, of which every thread takes the next one; `swept` receives what they have come to, of fewer islands if
/// the stop has ended it early.
pub(super) fn solve_side_by_side(
    (workers, visitor): (&mut Vec<Worker>, Visitor<'_>),
    islands: &Members,
    task: &Task<'_>,
    iterate: &mut Iterate<'_>,
    plan: Plan,
    swept: &mut Vec<Swept>,
) {
    let Visitor { blocks, .. } = visitor;
    let Task { problem, stop, history, threads, past, within_another } = *task;
    let Stop { tolerance, measure, deadline, .. } = stop;
    workers.resize_with(threads.count(), Worker::default);
    workers.iter_mut().for_each(|worker| worker.begin(iterate));
    let (next, given_up) = (AtomicUsize::new(0), AtomicBool::new(false));
    let work = |worker: &mut Worker| {
        let cancelled = || given_up.load(Ordering::Relaxed);
        let stop = Stop { tolerance, measure, deadline, cancelled: Some(&cancelled) };
        let threads = Threads::NONE;
        let own = Task { problem, stop, history, threads, past, within_another };
        worker.sweep(&own, plan, blocks, (islands, &next));
    };
    threads.share(workers, work, || {
        if stop.early() {
            given_up.store(true, Ordering::Relaxed);
        }
    });
    // Whoever takes an island says what has become of it: none is left out before the last one.
    swept.resize(next.into_inner().min(islands.count()), Swept::NOTHING);
    for worker in workers {
        worker.end(problem, iterate, (islands, swept));
    }
}

impl Worker {
    /// Takes over where sweeps start from.
    fn begin(&mut self, from: &Iterate<'_>) {
        copy(from.percussion, &mut self.percussion);
        copy(from.velocity, &mut self.velocity);
        copy(from.states, &mut self.states);
        copy(from.ambiguous, &mut self.ambiguous);
        self.islands.clear();
        self.swept.clear();
    }

    /// Sweeps the next island until there is none, or the stop has ended it early.
    fn sweep(
        &mut self,
        task: &Task<'_>,
        plan: Plan,
        blocks: &[Block],
        (members, next): (&Members, &AtomicUsize),
    ) {
        let Self { percussion, velocity, states, ambiguous, .. } = self;
        let Self { candidates, brought, islands, swept, .. } = self;
        let (stages, infeasibility) = (&mut Vec::new(), &mut None);
        let mut iterate =
            Iterate { percussion, velocity, states, ambiguous, stages, infeasibility };
        let take = || {
            // One that is taken is looked at, but none is taken once the work is to end.
            let island = (!task.stop.early()).then(|| next.fetch_add(1, Ordering::Relaxed));
            let island = island.filter(|island| *island < members.count())?;
            islands.push(island);
            Some(island)
        };
        let numbers = std::iter::from_fn(take);
        Visitor { blocks, candidates, brought }.solve_in_turn(
            task,
            &mut iterate,
            plan,
            (members, numbers),
            |own| swept.push(own),
        );
    }

    /// Puts back what was found.
    fn end(
        &self,
        problem: &ContactProblem,
        iterate: &mut Iterate<'_>,
        (members, swept): (&Members, &mut [Swept]),
    ) {
        for (&island, own) in self.islands.iter().zip(&self.swept) {
            swept[island] = *own;
            for &i in members.of(island) {
                let rows = problem.contacts()[i].rows();
                iterate.percussion[rows.clone()].copy_from_slice(&self.percussion[rows.clone()]);
                iterate.velocity[rows.clone()].copy_from_slice(&self.velocity[rows]);
                iterate.states[i] = self.states[i];
                iterate.ambiguous[i] = self.ambiguous[i];
            }
        }
    }
}

/// Makes `to` equal `from`, whose size it may not have.
fn copy<T: Copy>(from: &[T], to: &mut Vec<T>) {
    to.clear();
    to.extend_from_slice(from);
}

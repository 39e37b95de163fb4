//! Threads that share the members of an ensemble.

use std::ops::{ControlFlow, Range};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

/// How often the observer is asked: a person who interrupts an ensemble does not notice the delay.
const ASK_EVERY: Duration = Duration::from_millis(50);

/// Chunks per thread: members may take very different times, and the last chunk of one thread is what others wait for.
const CHUNKS_PER_THREAD: usize = 32;

/// Most members of a chunk: handing over so many results costs nothing beside computing them.
const LARGEST_CHUNK: usize = 1024;

/// Whether the runs in progress are to end.
#[derive(Debug, Default)]
pub(super) struct Stop(AtomicBool);

impl Stop {
    /// Asks all runs to end.
    pub(super) fn ask(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether they are to end.
    pub(super) fn is_asked(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// The same as the answer of an observer of one run.
    pub(super) fn answer(&self) -> ControlFlow<()> {
        if self.is_asked() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// How many threads serve for an ensemble: as many as the machine has, unless told otherwise, and not more than members.
pub(super) fn threads(given: Option<usize>, members: usize) -> usize {
    let available = || thread::available_parallelism().map_or(1, |n| n.get());
    given.unwrap_or_else(available).clamp(1, members.max(1))
}

/// Computes chunks of members in threads, and hands what comes out to `place` in the calling thread, in any order.
///
/// Every thread works with what `worker` makes for it, and takes the next chunk when it is done with one, so that a run
/// that ends early frees it. `observer(done, count)` is called about every 50 ms in the calling thread; where it breaks,
/// `stop` is asked, and chunks that nobody has begun are left out.
pub(super) fn share<T: Send, F: FnMut(Range<usize>) -> T>(
    count: usize,
    threads: usize,
    stop: &Stop,
    worker: impl Fn() -> F + Sync,
    mut place: impl FnMut(Range<usize>, T),
    observer: &mut dyn FnMut(usize, usize) -> ControlFlow<()>,
) {
    let chunk = (count / (CHUNKS_PER_THREAD * threads)).clamp(1, LARGEST_CHUNK);
    let next = AtomicUsize::new(0);
    let (sender, receiver) = sync_channel(2 * threads);
    thread::scope(|scope| {
        for _ in 0..threads {
            let (sender, next, worker) = (sender.clone(), &next, &worker);
            scope.spawn(move || {
                let mut work = worker();
                loop {
                    let first = next.fetch_add(chunk, Ordering::Relaxed);
                    if first >= count || stop.is_asked() {
                        return;
                    }
                    let members = first..count.min(first + chunk);
                    let done = work(members.clone());
                    if sender.send((members, done)).is_err() {
                        return;
                    }
                }
            });
        }
        drop(sender);
        let (mut asked, mut done) = (Instant::now(), 0);
        loop {
            match receiver.recv_timeout(ASK_EVERY) {
                Ok((members, result)) => {
                    done += members.len();
                    place(members, result);
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return,
            }
            if asked.elapsed() >= ASK_EVERY && !stop.is_asked() {
                if observer(done, count).is_break() {
                    stop.ask();
                }
                asked = Instant::now();
            }
        }
    });
}

#[cfg(test)]
mod tests;

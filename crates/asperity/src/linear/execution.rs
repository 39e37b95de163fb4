//! Who works on a factorisation, and whether somebody still waits for it.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::threads::Threads;

/// Operations that are worth several threads: a few milliseconds.
pub(super) const WORTHWHILE: f64 = 3e7;

/// Operations between two questions: some milliseconds.
const BETWEEN: f64 = 1e7;

/// How a factorisation is executed.
#[derive(Clone, Copy)]
pub(crate) struct Execution<'a> {
    /// Threads that take part where fronts are large.
    pub(crate) threads: &'a Threads,
    /// Whether nobody waits for it any longer.
    pub(crate) given_up: &'a dyn Fn() -> bool,
}

impl Execution<'_> {
    /// Runs a factorisation of so many operations, among threads where that pays and they are free; false if it failed.
    pub(super) fn run<F: FnMut(&mut Work<'_>) -> bool + Send>(
        self,
        operations: f64,
        factor: F,
    ) -> bool {
        let Self { threads, given_up } = self;
        let mut job = (factor, false);
        if operations >= WORTHWHILE
            && let Some(_claim) = threads.claim()
        {
            // What asks whether somebody waits may not leave this thread.
            let over = AtomicBool::new(given_up());
            let shared = |(factor, done): &mut (F, bool)| {
                let given_up = || over.load(Ordering::Relaxed);
                *done = factor(&mut Work { shared: true, given_up: &given_up, operations: 0.0 });
            };
            let ask = || over.store(given_up(), Ordering::Relaxed);
            threads.share(std::slice::from_mut(&mut job), shared, ask);
        } else {
            job.1 = (job.0)(&mut Work { shared: false, given_up, operations: 0.0 });
        }
        job.1
    }
}

/// A factorisation under way.
pub(super) struct Work<'a> {
    /// Whether it goes on in a pool of threads.
    pub(super) shared: bool,
    given_up: &'a dyn Fn() -> bool,
    /// Operations since it was last asked whether somebody waits.
    operations: f64,
}

impl Work<'_> {
    /// Of one thread, to the end.
    pub(super) const ALONE: Work<'static> =
        Work { shared: false, given_up: &|| false, operations: 0.0 };

    /// Whether nobody waits any longer, after so many more operations; asked now and then.
    #[inline]
    pub(super) fn is_given_up(&mut self, operations: usize) -> bool {
        self.operations += operations as f64;
        if self.operations < BETWEEN {
            return false;
        }
        self.operations = 0.0;
        (self.given_up)()
    }
}

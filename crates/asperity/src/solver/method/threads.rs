//! Threads for loops over contacts that do not influence each other.
//!
//! Every contact is computed by itself, whoever computes it, and nothing is summed across threads: results are
//! the same to the bit for any number of threads.

use std::sync::{Arc, Mutex};

use rayon::{ThreadPool, ThreadPoolBuilder};

/// Contacts that one thread takes at a time.
pub(crate) const LEAF: usize = 512;

/// Pools of this process, by their number of threads; a forked child must not use its parent's.
static POOLS: Mutex<Vec<(u32, usize, Arc<ThreadPool>)>> = Mutex::new(Vec::new());

/// A pool, or none for one thread.
#[derive(Debug, Clone, Default)]
pub(crate) struct Threads(Option<Arc<ThreadPool>>);

impl Threads {
    /// No other threads.
    pub(crate) const NONE: &'static Self = &Self(None);

    /// At most `count` threads for so many contacts, not more than the machine has.
    pub(crate) fn new(count: usize, contacts: usize) -> Self {
        if count <= 1 || contacts <= LEAF {
            return Self(None);
        }
        let available = std::thread::available_parallelism().map_or(1, |n| n.get());
        let count = count.min(available.max(4));
        let process = std::process::id();
        let Ok(mut pools) = POOLS.lock() else { return Self(None) };
        pools.retain(|(id, ..)| *id == process);
        if let Some((_, _, pool)) = pools.iter().find(|(_, threads, _)| *threads == count) {
            return Self(Some(pool.clone()));
        }
        let Ok(pool) = ThreadPoolBuilder::new().num_threads(count).build() else {
            return Self(None);
        };
        let pool = Arc::new(pool);
        pools.push((process, count, pool.clone()));
        Self(Some(pool))
    }

    /// Whether so many contacts are worth several threads.
    #[inline]
    pub(crate) fn serve(&self, contacts: usize) -> bool {
        self.0.is_some() && contacts > LEAF
    }

    /// Runs `work` in the pool.
    pub(crate) fn run<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        match &self.0 {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }
}

//! Threads for what does not depend on each other: contacts and islands; without the feature `parallel` there are none.
//!
//! Each of them is computed by itself, whoever computes it, and nothing is summed across threads: results are the same to
//! the bit for any number of threads.

/// Contacts that one thread takes at a time.
pub(crate) const LEAF: usize = 512;

/// A pool, or none for one thread.
#[derive(Debug, Clone, Default)]
pub(crate) struct Threads(Option<pool::Pool>);

impl Threads {
    /// No other threads.
    pub(crate) const NONE: &'static Self = &Self(None);

    /// At most `count` threads for loops over so many contacts, not more than the machine has.
    pub(crate) fn new(count: usize, contacts: usize) -> Self {
        if contacts <= LEAF { Self(None) } else { Self::of(count) }
    }

    /// At most `count` threads, not more than the machine has, or four.
    pub(crate) fn of(count: usize) -> Self {
        if count <= 1 {
            return Self(None);
        }
        let available = std::thread::available_parallelism().map_or(1, |n| n.get());
        Self(pool::of_this_process(count.min(available.max(4))))
    }

    /// Whether so many contacts are worth several threads.
    #[inline]
    pub(crate) fn serve(&self, contacts: usize) -> bool {
        self.0.is_some() && contacts > LEAF
    }

    /// Runs `work` in the pool.
    pub(crate) fn run<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        match &self.0 {
            Some(pool) => pool::install(pool, work),
            None => work(),
        }
    }

    /// Calls `work` with all items, one by one in the pool, while this thread calls `meanwhile` every few
    /// milliseconds; false if there is no pool, and nothing was done.
    pub(crate) fn share<T: Send>(
        &self,
        items: &mut [T],
        work: impl Fn(&mut T) + Sync,
        meanwhile: impl Fn(),
    ) -> bool {
        let Some(pool) = &self.0 else { return false };
        pool::share(pool, items, work, meanwhile);
        true
    }
}

pub(crate) use pool::join;

/// Calls `work` with the number and the flag of every contact, and with buffers that each thread makes for itself.
pub(crate) fn each<B: Default>(
    first: usize,
    flags: &mut [bool],
    work: &(impl Fn(usize, &mut bool, &mut B) + Sync),
) {
    if flags.len() <= LEAF {
        let mut buffers = B::default();
        for (k, flag) in flags.iter_mut().enumerate() {
            work(first + k, flag, &mut buffers);
        }
        return;
    }
    let half = flags.len() / 2;
    let (left, right) = flags.split_at_mut(half);
    join(|| each(first, left, work), || each(first + half, right, work));
}

#[cfg(feature = "parallel")]
mod pool {
    use std::sync::{Arc, Mutex, mpsc};
    use std::time::Duration;

    pub(crate) use rayon::join;
    use rayon::{ThreadPool, ThreadPoolBuilder};

    pub(super) type Pool = Arc<ThreadPool>;

    /// How often a thread that waits for others looks after something else.
    const PATIENCE: Duration = Duration::from_millis(5);

    /// Pools of this process, by their number of threads; a forked child must not use its parent's.
    static POOLS: Mutex<Vec<(u32, usize, Pool)>> = Mutex::new(Vec::new());

    /// The pool of so many threads, if the system has them to give.
    pub(super) fn of_this_process(count: usize) -> Option<Pool> {
        let process = std::process::id();
        let mut pools = POOLS.lock().ok()?;
        pools.retain(|(id, ..)| *id == process);
        if let Some((_, _, pool)) = pools.iter().find(|(_, threads, _)| *threads == count) {
            return Some(pool.clone());
        }
        let pool = Arc::new(ThreadPoolBuilder::new().num_threads(count).build().ok()?);
        pools.push((process, count, pool.clone()));
        Some(pool)
    }

    pub(super) fn install<T: Send>(pool: &Pool, work: impl FnOnce() -> T + Send) -> T {
        pool.install(work)
    }

    pub(super) fn share<T: Send>(
        pool: &Pool,
        items: &mut [T],
        work: impl Fn(&mut T) + Sync,
        meanwhile: impl Fn(),
    ) {
        let (under_way, done) = mpsc::channel::<()>();
        pool.in_place_scope(|scope| {
            let work = &work;
            for item in items {
                let own = under_way.clone();
                scope.spawn(move |_| {
                    work(item);
                    drop(own);
                });
            }
            drop(under_way);
            // Nothing is ever sent: the channel closes when the last one is done.
            while done.recv_timeout(PATIENCE) == Err(mpsc::RecvTimeoutError::Timeout) {
                meanwhile();
            }
        });
    }
}

#[cfg(not(feature = "parallel"))]
mod pool {
    /// There is none.
    pub(super) type Pool = std::convert::Infallible;

    pub(super) fn of_this_process(_count: usize) -> Option<Pool> {
        None
    }

    pub(super) fn install<T>(pool: &Pool, _work: impl FnOnce() -> T) -> T {
        match *pool {}
    }

    pub(super) fn share<T>(
        pool: &Pool,
        _items: &mut [T],
        _work: impl Fn(&mut T),
        _meanwhile: impl Fn(),
    ) {
        match *pool {}
    }

    /// Both answers, one after the other.
    pub(crate) fn join<T>(left: impl FnOnce() -> T, right: impl FnOnce() -> T) -> (T, T) {
        (left(), right())
    }
}

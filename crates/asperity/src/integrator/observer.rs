//! Whether to go on: the observer is asked from time to time, between steps, within them and within contact problems.

use std::cell::{Cell, RefCell};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// How often the observer is asked: a person who interrupts a run does not notice the delay.
const ASK_EVERY: Duration = Duration::from_millis(50);

/// Most steps between two looks at the clock, whose cost is negligible among so many.
pub(crate) const MOST_UNSEEN: u32 = 64;

/// The observer, which is told how far the run is, when it was asked last and whether it has asked to stop.
pub(crate) struct Observer<'a, T> {
    function: RefCell<&'a mut dyn FnMut(T) -> ControlFlow<()>>,
    asked: Cell<Instant>,
    interrupted: Cell<bool>,
    /// Steps until the clock is read again, and how many they were after the last reading.
    countdown: Cell<u32>,
    interval: Cell<u32>,
    read: Cell<Instant>,
}

impl<'a, T> Observer<'a, T> {
    pub(crate) fn new(function: &'a mut dyn FnMut(T) -> ControlFlow<()>) -> Self {
        let now = Instant::now();
        Self {
            function: RefCell::new(function),
            asked: Cell::new(now),
            interrupted: Cell::new(false),
            countdown: Cell::new(1),
            interval: Cell::new(1),
            read: Cell::new(now),
        }
    }

    /// Whether the observer wants to stop; it is asked if the last time is some while ago.
    #[cold]
    pub(crate) fn asks_to_stop(&self, progress: T) -> bool {
        self.read.set(Instant::now());
        let waited = self.read.get().duration_since(self.asked.get());
        if !self.interrupted.get() && waited >= ASK_EVERY {
            let stop = (self.function.borrow_mut())(progress).is_break();
            self.interrupted.set(stop);
            self.asked.set(Instant::now());
        }
        self.interrupted.get()
    }

    /// The same after a step that may be so short that a look at the clock would be a part of its cost.
    #[inline]
    pub(crate) fn asks_to_stop_after_step(&self, progress: T) -> bool {
        self.countdown.set(self.countdown.get() - 1);
        if self.countdown.get() > 0 {
            return self.interrupted.get();
        }
        let before = self.read.get();
        let stops = self.asks_to_stop(progress);
        // The steps since the last reading tell how many fit between two.
        let quick = self.read.get().duration_since(before) < ASK_EVERY / 8;
        let interval = self.interval.get();
        self.interval.set(if quick {
            (2 * interval).min(MOST_UNSEEN)
        } else {
            (interval / 2).max(1)
        });
        self.countdown.set(self.interval.get());
        stops
    }

    /// Whether the observer has asked to stop.
    pub(crate) fn has_asked_to_stop(&self) -> bool {
        self.interrupted.get()
    }
}

//! Whether to go on: the observer is asked from time to time, within steps and within contact problems too.

use std::cell::{Cell, RefCell};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

const POLL_EVERY: Duration = Duration::from_millis(50);

/// The observer, when it was asked last and whether it has asked to stop.
pub(crate) struct Poll<'a> {
    observer: RefCell<&'a mut dyn FnMut(f64) -> ControlFlow<()>>,
    asked: Cell<Instant>,
    interrupted: Cell<bool>,
}

impl<'a> Poll<'a> {
    pub(crate) fn new(observer: &'a mut dyn FnMut(f64) -> ControlFlow<()>) -> Self {
        Self {
            observer: RefCell::new(observer),
            asked: Cell::new(Instant::now()),
            interrupted: Cell::new(false),
        }
    }

    /// Whether the observer wants to stop; it is asked if the last time is some while ago.
    pub(crate) fn stops(&self, t: f64) -> bool {
        if !self.interrupted.get()
            && self.asked.get().elapsed() >= POLL_EVERY
            // An observer that asks for a solution itself is not asked again meanwhile.
            && let Ok(mut observer) = self.observer.try_borrow_mut()
        {
            self.interrupted.set(observer(t).is_break());
            self.asked.set(Instant::now());
        }
        self.interrupted.get()
    }

    /// Whether the observer has asked to stop.
    pub(crate) fn stopped(&self) -> bool {
        self.interrupted.get()
    }
}

//! Whether to go on: the observer is asked from time to time, within steps and within contact problems too.

use std::cell::{Cell, RefCell};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// How often the observer is asked: a person who interrupts a run does not notice the delay.
const ASK_EVERY: Duration = Duration::from_millis(50);

/// The observer, when it was asked last and whether it has asked to stop.
pub(crate) struct Observer<'a> {
    function: RefCell<&'a mut dyn FnMut(f64) -> ControlFlow<()>>,
    asked: Cell<Instant>,
    interrupted: Cell<bool>,
}

impl<'a> Observer<'a> {
    pub(crate) fn new(function: &'a mut dyn FnMut(f64) -> ControlFlow<()>) -> Self {
        Self {
            function: RefCell::new(function),
            asked: Cell::new(Instant::now()),
            interrupted: Cell::new(false),
        }
    }

    /// Whether the observer wants to stop; it is asked if the last time is some while ago.
    pub(crate) fn asks_to_stop(&self, t: f64) -> bool {
        if !self.interrupted.get()
            && self.asked.get().elapsed() >= ASK_EVERY
            // An observer that asks for a solution itself is not asked again meanwhile.
            && let Ok(mut function) = self.function.try_borrow_mut()
        {
            self.interrupted.set(function(t).is_break());
            self.asked.set(Instant::now());
        }
        self.interrupted.get()
    }

    /// Whether the observer has asked to stop.
    pub(crate) fn has_asked_to_stop(&self) -> bool {
        self.interrupted.get()
    }
}

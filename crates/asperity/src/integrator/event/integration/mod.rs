//! The loop over steps and events.

pub(crate) mod detection;
pub(crate) mod impact;
pub(crate) mod sampling;
pub(crate) mod time_loop;
pub(crate) mod transition;

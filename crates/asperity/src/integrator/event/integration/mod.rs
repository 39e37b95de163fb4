//! The integration from event to event: steps, detection and location of events, and what is done at them.
//!
//! | file | concept |
//! |---|---|
//! | `variables.rs` | everything that changes during an integration |
//! | `attempt.rs` | attempts of steps, and states inside them |
//! | `sampling.rs` | what is kept of the motion |
//! | `closing.rs` | gaps that close within a step, found by bounds on their second derivatives |
//! | `detection.rs`, `location.rs` | event functions along a step; the time of the first event |
//! | `decision.rs` | the modes after an event |
//! | `release.rs`, `impact.rs`, `transition.rs` | stick that ends, impacts, all other events |
//! | `breaks.rs` | times at which functions of time are not smooth |
//! | `start.rs` | the beginning of the motion |
//! | `time_loop.rs` | steps one after another |
//! | `parts.rs` | parts of a system that nothing connects, each with steps of its own, as one motion |

mod attempt;
mod breaks;
mod closing;
mod decision;
mod detection;
mod impact;
mod location;
mod parts;
mod release;
mod sampling;
mod start;
mod time_loop;
mod transition;
mod variables;

pub(crate) use parts::run;

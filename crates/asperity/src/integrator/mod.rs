//! How motions are computed from equations of motion and contact laws.
//!
//! | file | concept |
//! |---|---|
//! | `midpoint/` | Moreau's time stepping, steps of one length |
//! | `event/` | from event to event, to the accuracy that is asked for |
//! | `samples.rs` | what both integrators return: states, slips and forces over time |
//! | `observer.rs` | asks now and then whether to go on |
//! | `options.rs` | what options of integrators are checked for |

#[cfg(feature = "serde")]
pub mod data;
pub mod event;
pub mod midpoint;
#[cfg(feature = "serde")]
pub(crate) mod numbers;
pub(crate) mod observer;
pub(crate) mod options;
pub(crate) mod samples;

pub use samples::{ContactSample, Samples, StateSample};

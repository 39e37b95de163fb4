//! How motions are computed from equations of motion and contact laws.
//!
//! | file | concept |
//! |---|---|
//! | `event/` | from event to event, to the accuracy that is asked for |
//! | `options.rs` | what options of integrators are checked for |

pub mod event;
mod options;

pub use options::OptionsError;

//! The one-step contact problem as data.

mod memory;
mod problem;

pub use memory::{ContactState, Memory, Phase};
pub use problem::{ContactProblem, ContactRows, NormalForce, ProblemError};

//! The one-step contact problem as data.

mod components;
#[cfg(feature = "serde")]
pub mod data;
mod delassus;
mod error;
mod memory;
mod problem;

pub(crate) use components::Components;
pub use delassus::{BlockMatrix, Csr, Delassus, DelassusOperator, Factored, MatrixFree};
pub use error::ProblemError;
pub use memory::{ContactState, Memory, Phase};
pub use problem::{ContactProblem, ContactRows, NormalForce};

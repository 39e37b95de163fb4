//! The one-step contact problem as data.

mod components;
#[cfg(feature = "serde")]
pub mod data;
mod delassus;
mod memory;
mod part;
mod problem;

pub(crate) use components::{Components, Members};
pub use delassus::{
    BlockMatrix, Csr, Delassus, DelassusOperator, Factored, IntoDelassus, MatrixFree,
};
pub use memory::{ContactState, Memory, Phase};
pub(crate) use part::{Part, put, take};
pub(crate) use problem::LARGEST;
pub use problem::{ContactProblem, ContactRows, NormalForce};

//! The files of the library that its linear algebra stands on.

#[path = "../../crates/asperity/src/contact/delassus/blocks.rs"]
mod blocks;
#[path = "../../crates/asperity/src/contact/delassus/csr.rs"]
mod csr;
#[path = "../../crates/asperity/src/contact/error.rs"]
mod error;

pub use blocks::BlockMatrix;
pub use csr::Csr;
pub use error::ProblemError;

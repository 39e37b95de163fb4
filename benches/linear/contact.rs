//! The files of the library that its linear algebra stands on.

#[path = "../../crates/asperity/src/contact/delassus/blocks.rs"]
mod blocks;
#[path = "../../crates/asperity/src/contact/components.rs"]
mod components;
#[path = "../../crates/asperity/src/contact/delassus/csr.rs"]
mod csr;

pub use blocks::BlockMatrix;
pub(crate) use components::{Components, Members};
pub use csr::Csr;

//! Numerics of vectors and functions: small products, roots, periodic curves, polarity, boundaries of planar sets.

mod boundary;
mod cyclic;
pub(crate) mod periodic_curve;
pub(crate) mod polarity;
pub(crate) mod root;
pub(crate) mod scaling;
pub(crate) mod vectors;

pub use boundary::{Arc, BoundaryPoint, Side};
pub use cyclic::Cyclic;
pub use vectors::directions;

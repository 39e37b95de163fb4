//! The equations that sliding fulfils: the prox step, the natural map of a contact, how far both are from holding, and
//! cones in which they are simple.

pub(super) mod inclusion;
pub(super) mod lorentz;
pub(super) mod natural_map;
mod prox_step;

pub(crate) use natural_map::{ContactMatrix, ContactPoint, ContactVector, Derivatives, Rho};

//! Friction laws: a force reservoir, a direction set, and what follows from the pair.

mod ambiguity;
mod answers;
mod boundary;
mod classify;
#[cfg(feature = "serde")]
pub mod data;
mod error;
mod extended;
mod flow;
mod lorentz;
mod natural_map;
mod node;
mod prox_step;
mod rate;
mod table;

pub use answers::Law;
pub(crate) use answers::{Components, Friction, ProxParameter, inclusion_defect};
pub(crate) use boundary::BoundaryPiece;
pub use error::LawError;
pub use extended::FrictionLaw;
pub(crate) use extended::Walk;
pub use flow::{FlowReport, FlowSets, flow_sets};
pub(crate) use natural_map::{
    ContactMatrix, ContactPoint, ContactVector, Derivatives, Rho, map as natural_map,
};
pub(crate) use node::Node;
pub use rate::{Fall, Stribeck};
pub(crate) use table::{Bounds, COARSE, Cell, Columns, WalkTable};

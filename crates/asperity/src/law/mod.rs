//! Friction laws: a force reservoir, a direction set, and what follows from the pair.

mod answers;
mod bounds;
mod classify;
mod contact_equation;
#[cfg(feature = "serde")]
pub mod data;
mod error;
mod extended;
mod flow;
mod rate;
mod walk_table;

pub use answers::Law;
pub(crate) use answers::{Components, Friction, ProxParameter, inclusion_defect};
pub(crate) use bounds::Bounds;
pub(crate) use contact_equation::natural_map::map as natural_map;
pub(crate) use contact_equation::{ContactMatrix, ContactPoint, ContactVector, Derivatives, Rho};
pub use error::LawError;
pub use extended::FrictionLaw;
pub(crate) use extended::Walk;
pub use flow::{FlowReport, FlowSets, flow_sets};
pub use rate::{Fall, Stribeck};
pub(crate) use walk_table::{AmbiguousLoads, COARSE, Cell, Columns, Node, WalkTable};

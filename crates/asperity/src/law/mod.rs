//! Friction laws: a force reservoir, a direction set, and what follows from the pair.

mod ambiguity;
mod any;
mod classify;
mod error;
mod extended;
mod flow;
mod rate;
mod table;

pub use any::Law;
pub use error::LawError;
pub use extended::FrictionLaw;
pub(crate) use extended::Walk;
pub use flow::{FlowReport, FlowSets, flow_sets};
pub use rate::{Fall, Stribeck};
pub(crate) use table::{COARSE, Cell, Node, WalkTable};

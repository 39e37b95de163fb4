//! Sets and the questions to them.

pub mod any_star;
pub mod batch;
pub mod cones;
pub mod set;

//! Collocation steps.

pub(crate) mod dense_output;
pub(crate) mod direction_points;
pub(crate) mod growth;
pub(crate) mod initial_step;
pub(crate) mod lu;
pub(crate) mod step;
pub(crate) mod step_size;

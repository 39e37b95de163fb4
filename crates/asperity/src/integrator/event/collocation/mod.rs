//! Steps by collocation, of order nine: their stages, their errors and their lengths.

pub(crate) mod dense_output;
pub(crate) mod direction_points;
pub(crate) mod error_estimate;
pub(crate) mod growth;
pub(crate) mod initial_step;
pub(crate) mod newton;
pub(crate) mod radau;
pub(crate) mod step;
pub(crate) mod step_size;

pub(crate) use dense_output::{DenseOutput, PLACES};
pub(crate) use initial_step::initial_step;
pub(crate) use newton::{NewtonGoal, SlidingStart};
pub(crate) use radau::{STAGES, Tableau, lagrange_at};
pub(crate) use step::Step;
pub(crate) use step_size::{Accuracy, StepSize, slip_rate};

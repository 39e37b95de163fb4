//! Steps by collocation, of order nine: their stages, their errors and their lengths.

mod dense_output;
mod direction_points;
mod error_estimate;
mod growth;
mod initial_step;
mod newton;
mod radau;
mod step;
mod step_size;

pub(crate) use dense_output::{DenseOutput, PLACES};
pub(crate) use initial_step::initial_step;
pub(crate) use newton::{NewtonGoal, SlidingStart};
pub(crate) use radau::{STAGES, Tableau, lagrange_at};
pub(crate) use step::Step;
pub(crate) use step_size::{Accuracy, StepSize, slip_rate};

//! Contact problems, their solvers and solutions.

pub mod delassus;
pub mod outcome;
pub mod problem;
pub mod solver;
pub mod stepper;
pub mod tree_stepper;

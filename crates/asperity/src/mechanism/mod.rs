//! Contacts among the joints, limits and dry joints of a mechanism.
//!
//! Engines of multibody dynamics have rows that a [`ContactProblem`](crate::contact::ContactProblem) has not, and hand over all of
//! them in every step: [`ContactStepper`] keeps what one step can use of the step before.
//!
//! | rows | file | what becomes of them |
//! |---|---|---|
//! | all, in the order of their keys | `arranged.rs`, `trees.rs` | blocks of `G` between items that influence each other |
//! | bilateral | `joints.rs` | eliminated, by least squares where loops repeat them |
//! | of contacts that nothing moves in some directions | `freedom.rs` | left out, with the law in the directions that are left |
//! | without friction, of a projection | `closing.rs` | their active set, where it is soon found |
//! | all others | `layout.rs` | a contact problem, which `stepper.rs` solves step after step |
//!
//! `tree_stepper.rs` makes the rows of a step from the Jacobian and the mass matrix of an engine.

mod arranged;
mod closing;
mod freedom;
mod joints;
mod layout;
mod stepper;
mod tree_stepper;
mod trees;

pub use arranged::{Mobility, Rows, StepRows};
pub use stepper::ContactStepper;
pub use tree_stepper::{
    Axis, Closing, Jacobian, Listed, TreeStepper, Turn, Unilateral, pyramid_edges,
};
pub use trees::{TreeFactor, TreeRows};

use crate::argument::{ArgumentError, refuse};

/// Part of a row's mobility `G_ii` below which rounding may have made all of it: of rows that joints hold, and of directions in
/// which the bodies of a contact cannot move.
const ROUNDED: f64 = 1e-12;

/// Part of the velocities that joints have to take out which may be left: loops repeat rows, and drift makes them differ.
const DRIFT: f64 = 1e-6;

/// Refuses an item, by its number.
fn refuse_item<T>(item: usize, message: &str) -> Result<T, ArgumentError> {
    refuse("items", format!("of item {item} {message}"))
}

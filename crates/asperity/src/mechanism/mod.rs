//! Contacts among the joints, limits and dry joints of a mechanism.
//!
//! Engines of multibody dynamics have rows that a [`ContactProblem`](crate::contact::ContactProblem) has not, and hand over all of
//! them in every step: [`ContactStepper`] keeps what one step can use of the step before.
//!
//! | rows | file | what becomes of them |
//! |---|---|---|
//! | bilateral | `joints.rs` | eliminated, by least squares where loops repeat them |
//! | of contacts that nothing moves in some directions | `freedom.rs` | left out, with the law in the directions that are left |
//! | all others | `layout.rs` | a contact problem, which `stepper.rs` solves step after step |

mod freedom;
mod joints;
mod layout;
mod stepper;

pub use stepper::{ContactStepper, Rows, StepRows};

use crate::argument::{ArgumentError, refuse};

/// Part of a row's mobility `G_ii` below which rounding may have made all of it: of rows that joints hold, and of directions in
/// which the bodies of a contact cannot move.
const ROUNDED: f64 = 1e-12;

/// Refuses an item, by its number.
fn refuse_item<T>(item: usize, message: &str) -> Result<T, ArgumentError> {
    refuse("items", format!("of item {item} {message}"))
}

//! Proofs that a problem has no solution, which can be checked without a solver.

mod balance;
mod cases;
mod closing;
mod nonnegative;
mod one_contact;
mod proof;

pub(crate) use cases::prove_by_cases;
pub(crate) use closing::prove_closing;
pub(crate) use one_contact::prove_one_contact;
pub use proof::{Case, Infeasibility, InfeasibilityKind, Unsolvable};

//! Proofs that a problem has no solution, which can be checked without a solver.

mod balance;
mod closing;
mod nonnegative;
mod one_contact;
mod proof;

pub(crate) use closing::prove_closing;
pub(crate) use one_contact::prove_one_contact;
pub use proof::{Infeasibility, InfeasibilityKind, Unsolvable};

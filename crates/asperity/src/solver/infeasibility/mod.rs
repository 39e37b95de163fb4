//! Proofs that a problem has no solution, which can be checked without a solver.

mod cases;
mod closing;
mod nonnegative;
mod one_contact;
mod proof;

pub(crate) use cases::{ByCases, search_cases};
pub(crate) use closing::prove_closing;
pub(crate) use one_contact::prove_one_contact;
pub use proof::{Case, CaseState, Infeasibility, InfeasibilityKind, Unsolvable};

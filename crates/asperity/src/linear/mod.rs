//! Linear algebra of the contact solvers: an unsymmetric sparse LU factorisation on a symmetric pattern of small
//! blocks, and least squares with small dense matrices of any rank ([`LeastNorm`]).
//!
//! Matrices `A + B G` of Newton's method are small (10² to 10⁴ rows), nearly the same from one iteration to
//! the next and always of the same pattern: the analysis is done once ([`Symbolic`]), the rest without
//! allocation ([`Numeric`]). Rows are exchanged within the pivots of a front only.

mod dense;
mod dense_lu;
mod least_norm;
mod numeric;
mod order;
mod symbolic;
#[cfg(test)]
mod tests;

pub(crate) use dense_lu::DenseLu;
pub(crate) use least_norm::LeastNorm;
pub(crate) use numeric::Numeric;
pub(crate) use symbolic::Symbolic;

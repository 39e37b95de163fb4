//! Linear algebra of the contact solvers: an unsymmetric sparse LU factorisation on a symmetric pattern of small
//! blocks, and least squares with small dense matrices of any rank ([`LeastNorm`]).
//!
//! Matrices `A + B G` of Newton's method are small (10² to 10⁴ rows), nearly the same from one iteration to
//! the next and always of the same pattern: the analysis is done once ([`Symbolic`]), the rest without
//! allocation ([`Numeric`]). Rows are exchanged within the pivots of a front only.
//!
//! Why not one of the sparse LU factorisations that exist: they take scalars in compressed columns, so that blocks would
//! be taken apart for every matrix, order columns without symmetry of the pattern, and allocate in every factorisation.
//! Here entries go from blocks into dense fronts, whose order and sizes are known. What is given up is pivoting across
//! fronts: blocks on the diagonal are `A_ii + B_ii G_ii` and no small ones, and whoever asks looks at the residual of
//! what comes out. Without the feature `sparse` matrices are factored densely (`unordered.rs`). `tests.rs` compares what is left over with a dense factorisation, also for badly scaled matrices.

mod dense;
mod dense_lu;
mod least_norm;
#[cfg(feature = "sparse")]
mod numeric;
#[cfg(feature = "sparse")]
mod order;
#[cfg(feature = "sparse")]
mod symbolic;
#[cfg(test)]
mod tests;
#[cfg(not(feature = "sparse"))]
mod unordered;

pub(crate) use dense_lu::DenseLu;
pub(crate) use least_norm::LeastNorm;
#[cfg(feature = "sparse")]
pub(crate) use numeric::Numeric;
#[cfg(feature = "sparse")]
pub(crate) use symbolic::Symbolic;
#[cfg(not(feature = "sparse"))]
pub(crate) use unordered::{Numeric, Symbolic};

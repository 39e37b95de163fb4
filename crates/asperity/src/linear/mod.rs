//! Linear algebra of the contact solvers: an unsymmetric sparse LU factorisation on a symmetric pattern of small
//! blocks, LDLᵀ where it is symmetric, and least squares with small dense matrices of any rank ([`LeastNorm`]).
//!
//! Where the matrix is symmetric and taken as positive definite ([`Kind::Definite`]), as among the bodies of a standing
//! structure, the factorisation is LDLᵀ, without exchanges and with half of the operations.
//!
//! Matrices `A + B G` of Newton's method are small (10² to 10⁴ rows), nearly the same from one iteration to
//! the next and always of the same pattern: the analysis is done once ([`Symbolic`]), the rest without
//! allocation ([`Numeric`]). Rows are exchanged within the pivots of a front only.
//!
//! Why not one of the sparse LU factorisations that exist: here entries go from blocks of a known, symmetric pattern
//! into dense fronts; a minimum-degree ordering of that pattern holds, as rows are exchanged within fronts only, while
//! theirs must do for all exchanges that may come; and nothing is allocated when a matrix is factored again.
//! `benches/linear` (`make linear`) measures the gain over faer.
//!
//! Pivoting across fronts is given up: the diagonal blocks `A_ii + B_ii G_ii` are not small, and callers check the residual
//! of the solution. Where only the regularisation makes a matrix regular, LU and LDLᵀ leave componentwise backward errors
//! of up to 1e-7. Newton's method needs no refinement; the interior point method refines (`solver/method/interior.rs`).

mod block_lu;
mod dense;
mod dense_lu;
mod least_norm;
mod numeric;
mod order;
mod symbolic;
#[cfg(test)]
mod tests;

/// What is known of a matrix before it is factored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Kind {
    /// Nothing.
    #[default]
    General,
    /// It is symmetric, and taken as positive definite: the factorisation fails where it is not.
    Definite,
}

pub(crate) use block_lu::BlockLu;
pub(crate) use dense_lu::DenseLu;
pub(crate) use least_norm::LeastNorm;
pub(crate) use numeric::Numeric;
pub(crate) use symbolic::Symbolic;

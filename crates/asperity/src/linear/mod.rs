//! Linear algebra of the contact solvers: an unsymmetric sparse LU factorisation on a symmetric pattern of small
//! blocks, LDLᵀ where it is symmetric, and least squares with small dense matrices of any rank ([`LeastNorm`]).
//!
//! Where the matrix is symmetric and taken as positive definite ([`Kind::Definite`]), as among the bodies of what stands, the
//! factorisation is LDLᵀ, without exchanges and with half of the operations.
//!
//! Matrices `A + B G` of Newton's method are small (10² to 10⁴ rows), nearly the same from one iteration to
//! the next and always of the same pattern: the analysis is done once ([`Symbolic`]), the rest without
//! allocation ([`Numeric`]). Rows are exchanged within the pivots of a front only. Several threads share the columns of
//! large fronts.
//!
//! Why not one of the sparse LU factorisations that exist: here entries go from blocks of a known, symmetric pattern
//! into dense fronts; a minimum-degree ordering of that pattern holds, as rows are exchanged within fronts only, while
//! theirs must do for all exchanges that may come; and nothing is allocated when a matrix is factored again.
//! `benches/linear` (`make linear`) measures what that gains over faer 0.24 on one thread, the matrices those
//! of 35 contact problems of other engines at their solutions. faer's time over the time here, as geometric mean
//! (least, largest):
//!
//! | rows | matrices | analysis | factorisation | solution |
//! |---|---|---|---|---|
//! | 3 to 72 | 11 | 1.7 (0.5, 4.0) | 2.7 (1.9, 3.8) | 1.1 (0.5, 1.5) |
//! | 132 to 888 | 17 | 4.8 (3.0, 8.7) | 3.3 (2.5, 4.1) | 1.2 (0.4, 1.7) |
//! | 1068 to 21 006 | 7 | 3.6 (2.7, 7.0) | 4.0 (2.7, 5.3) | 1.6 (0.5, 2.5) |
//!
//! faer is faster where it substitutes in the sparsest matrices, such as those of spheres, and where it analyses
//! matrices of one contact, in half a microsecond. Dense matrices of up to 60 rows ([`DenseLu`]) take it 1.2 (0.7, 1.4)
//! times as long: those of 27 and 33 rows less, smaller ones more.
//!
//! What is given up is pivoting across fronts: blocks on the diagonal are `A_ii + B_ii G_ii` and no small ones, and
//! whoever asks looks at the residual of what comes out. On the same matrices the largest componentwise backward error
//! is 8e-8 here and 8e-7 with faer, both of the wall of 3373 contacts, whose matrix is singular but for the
//! regularisation; on single matrices faer's is up to two hundred times smaller (3e-15), or nine hundred times larger.
//! Steps of Newton's method need no more digits: on the stored problems what a step leaves of `F` is at most 4e-6 of it, but
//! for single steps of the two largest (1e-2 and 5e-5), and one refinement with the same factors, of every step or where
//! more than 1e-8 was left, changed the number of factorisations of one of 23 problems, by one. So there is none but where the
//! interior point method follows what was expected to stand (`solver/method/interior.rs`).
//!
//! LDLᵀ is measured on the eight matrices of what stands that the library factors among the bodies, of 174 to 1650 rows, beside
//! faer's LLᵀ or LDLᵀ, whichever is faster: 3.6 (2.9, 4.5) for the analysis, 1.6 (1.2, 1.7) for the factorisation and 1.4
//! (1.2, 2.4) for a solution. LU of the same matrices takes 1.5 (1.0, 1.8) times as long to be found. Where their regularisation
//! alone makes them regular, both leave backward errors of up to 1e-7.
//!
//! Without the feature `sparse` matrices are factored densely (`unordered.rs`). `tests.rs` compares what is left over
//! with a dense factorisation, also for badly scaled matrices.

mod block_lu;
mod dense;
mod dense_lu;
mod execution;
mod least_norm;
#[cfg(feature = "sparse")]
mod numeric;
#[cfg(feature = "sparse")]
mod order;
mod padded_lu;
#[cfg(feature = "sparse")]
mod symbolic;
#[cfg(test)]
mod tests;
#[cfg(not(feature = "sparse"))]
mod unordered;

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
pub(crate) use execution::Execution;
pub(crate) use least_norm::LeastNorm;
#[cfg(feature = "sparse")]
pub(crate) use numeric::Numeric;
pub(crate) use padded_lu::PaddedLu;
#[cfg(feature = "sparse")]
pub(crate) use symbolic::Symbolic;
#[cfg(not(feature = "sparse"))]
pub(crate) use unordered::{Numeric, Symbolic};

//! Least squares of least norm with a small dense matrix of any rank.
//!
//! The complete orthogonal decomposition `A Π = Q₁ Tᵀ Zᵀ` of \[LawsonHanson1974\] chapters 3 and 14: a QR decomposition with
//! exchange of columns tells the rank, one of its rows then gives the solution of least norm,
//! `A⁺ = Π Z T⁻ᵀ Q₁ᵀ`. Reflections alone, no iteration: the singular values of nalgebra 0.35 are wrong for matrices
//! of rank one with five and more equal rows, which redundant contacts have.

use nalgebra::{DMatrix, DVector, Dyn, PermutationSequence};

/// A matrix ready to be solved with.
#[derive(Debug, Clone)]
pub(crate) struct LeastNorm {
    /// `Q₁`, an orthonormal basis of the range.
    range: DMatrix<f64>,
    /// `T`, upper triangular.
    triangle: DMatrix<f64>,
    /// `Z`, an orthonormal basis of the rows, in the order of exchanged columns.
    rows: DMatrix<f64>,
    columns: PermutationSequence<Dyn>,
}

impl LeastNorm {
    /// Parts of the matrix below `threshold` times the largest count as zero; `None` if it is not finite.
    pub(crate) fn new(matrix: DMatrix<f64>, threshold: f64) -> Option<Self> {
        if !matrix.iter().all(|entry| entry.is_finite()) {
            return None;
        }
        let columns = matrix.ncols();
        let decomposed = matrix.col_piv_qr();
        let upper = decomposed.r();
        let pivots = (0..upper.nrows()).map(|k| upper[(k, k)].abs());
        let largest = pivots.clone().fold(0.0, f64::max);
        let rank = pivots.take_while(|pivot| *pivot > threshold * largest).count();
        let range = decomposed.q().columns(0, rank).into_owned();
        let rows = upper.rows(0, rank).transpose().qr();
        let (rows, triangle) = match rank {
            0 => (DMatrix::zeros(columns, 0), DMatrix::zeros(0, 0)),
            _ => (rows.q(), rows.r()),
        };
        Some(Self { range, triangle, rows, columns: decomposed.p().clone() })
    }

    /// An orthonormal basis of the range, column by column.
    pub(crate) fn range(&self) -> &DMatrix<f64> {
        &self.range
    }

    /// The smallest `x` with the least `‖A x − b‖`.
    pub(crate) fn solve(&self, b: &DVector<f64>) -> DVector<f64> {
        let mut inner = self.range.tr_mul(b);
        self.triangle.tr_solve_upper_triangular_mut(&mut inner);
        let mut x = &self.rows * inner;
        self.columns.inv_permute_rows(&mut x);
        x
    }
}

#[cfg(test)]
mod tests;

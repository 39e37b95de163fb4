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
mod tests {
    use super::*;

    /// A matrix of given rank, with rows or columns repeated as redundant contacts have them.
    fn matrix(rows: usize, columns: usize, rank: usize, repeated: bool) -> DMatrix<f64> {
        let entry = |i: usize, j: usize, k: usize| ((3 * i + 5 * j + 7 * k) as f64 * 0.7).sin();
        let left =
            DMatrix::from_fn(rows, rank, |i, j| entry(if repeated { i % 2 } else { i }, j, 1));
        let right = DMatrix::from_fn(rank, columns, |i, j| entry(i, j, 2));
        left * right
    }

    /// The four conditions of Penrose make the pseudo-inverse unique.
    #[test]
    fn the_solution_is_that_of_the_pseudo_inverse() {
        for (rows, columns) in [(1, 1), (2, 5), (5, 2), (5, 5), (7, 7), (11, 11), (12, 9)] {
            for rank in 0..=rows.min(columns) {
                for repeated in [false, true] {
                    let a = matrix(rows, columns, rank, repeated);
                    let factors = LeastNorm::new(a.clone(), 1e-11).unwrap();
                    let unit = |i| DVector::from_fn(rows, |j, _| f64::from(u8::from(i == j)));
                    let solved: Vec<_> = (0..rows).map(|i| factors.solve(&unit(i))).collect();
                    let inverse = DMatrix::from_columns(&solved);
                    let (range, kernel) = (&a * &inverse, &inverse * &a);
                    let scale = a.amax() * inverse.amax();
                    assert!((&range * &a - &a).amax() <= 1e-12 * (1.0 + scale) * a.amax());
                    assert!(
                        (&kernel * &inverse - &inverse).amax()
                            <= 1e-12 * (1.0 + scale) * inverse.amax()
                    );
                    assert!((&range - range.transpose()).amax() <= 1e-12 * (1.0 + scale));
                    assert!((&kernel - kernel.transpose()).amax() <= 1e-12 * (1.0 + scale));
                }
            }
        }
    }

    /// Equal entries: the sum of squares is least where all have the same share.
    #[test]
    fn equal_contacts_have_equal_shares() {
        for n in 1..40 {
            let factors = LeastNorm::new(DMatrix::from_element(n, n, 0.7), 1e-10).unwrap();
            let x = factors.solve(&DVector::from_element(n, 1.4));
            assert!(x.iter().all(|v| (v * n as f64 - 2.0).abs() < 1e-13), "{n}: {x}");
        }
    }
}

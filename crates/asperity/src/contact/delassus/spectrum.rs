//! Extreme eigenvalues of Delassus operators, estimated.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::Delassus;

/// Lanczos steps.
const STEPS: usize = 80;

impl Delassus {
    /// Estimates of the smallest and the largest eigenvalue of `½(G + Gᵀ)`, from Lanczos' method with full
    /// orthogonalisation.
    ///
    /// The largest is good to many digits, the smallest is an upper bound that is good where the spectrum is
    /// not wide; a matrix-free operator is taken as symmetric.
    pub fn spectrum(&self) -> (f64, f64) {
        let rows = self.rows();
        let steps = rows.min(STEPS);
        if steps == 0 {
            return (0.0, 0.0);
        }
        let mut basis: Vec<DVector<f64>> = Vec::with_capacity(steps);
        let (mut diagonal, mut beside) = (Vec::new(), Vec::new());
        // Any start that no eigenvector is likely to be orthogonal to.
        let mut next =
            DVector::from_fn(rows, |i, _| 1.0 + 0.5 * (i as f64 * 1.618).sin()).normalize();
        let mut largest = 0.0_f64;
        for _ in 0..steps {
            let mut image = self.symmetric_product(&next);
            diagonal.push(next.dot(&image));
            basis.push(next);
            // Twice is enough.
            for _ in 0..2 {
                for q in &basis {
                    image -= q * q.dot(&image);
                }
            }
            let norm = image.norm();
            largest = largest.max(norm).max(diagonal[diagonal.len() - 1].abs());
            if norm <= 1e-13 * largest {
                break;
            }
            beside.push(norm);
            next = image / norm;
        }
        let n = diagonal.len();
        let tridiagonal = DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
            0 => diagonal[i],
            1 => beside[i.min(j)],
            _ => 0.0,
        });
        let found = SymmetricEigen::new(tridiagonal).eigenvalues;
        (found.min(), found.max())
    }

    fn symmetric_product(&self, x: &DVector<f64>) -> DVector<f64> {
        let mut out = DVector::zeros(x.len());
        self.apply(x.as_slice(), out.as_mut_slice());
        let mut transposed = DVector::zeros(x.len());
        match self {
            Self::Dense(g) => transposed = g.tr_mul(x),
            Self::MatrixFree(..) => return out,
            _ => {
                if let Some(blocks) = self.blocks() {
                    blocks.add_transposed(x.as_slice(), transposed.as_mut_slice());
                }
            }
        }
        (out + transposed) * 0.5
    }
}

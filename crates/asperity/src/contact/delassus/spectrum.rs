//! Extreme eigenvalues of Delassus operators, estimated.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::Delassus;
use crate::argument::ArgumentError;
use crate::vectors;

/// Lanczos steps.
const STEPS: usize = 80;

impl Delassus {
    /// Estimates of the smallest and the largest eigenvalue of `½(G + Gᵀ)`, from Lanczos' method with full
    /// orthogonalisation.
    ///
    /// The largest is good to many digits, the smallest is an upper bound that is good where the spectrum is
    /// not wide; a matrix-free operator is taken as symmetric. An error where an eigenvalue is beyond all numbers.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] if the products of a matrix-free operator are not finite.
    pub fn spectrum(&self) -> Result<(f64, f64), ArgumentError> {
        let rows = self.rows();
        let steps = rows.min(STEPS);
        if steps == 0 {
            return Ok((0.0, 0.0));
        }
        let mut basis: Vec<DVector<f64>> = Vec::with_capacity(steps);
        let (mut diagonal, mut beside) = (Vec::new(), Vec::new());
        // Any start that no eigenvector is likely to be orthogonal to.
        let mut next =
            DVector::from_fn(rows, |i, _| 1.0 + 0.5 * (i as f64 * 1.618).sin()).normalize();
        // In units in which the squares of products are numbers, too.
        let unit = match self.symmetric_product(&next, 1.0).amax() {
            size if size > 0.0 && size.is_finite() => size,
            _ => vectors::largest(self.blocks().values()).max(f64::MIN_POSITIVE),
        };
        let mut largest = 0.0_f64;
        for _ in 0..steps {
            let mut image = self.symmetric_product(&next, unit);
            diagonal.push(next.dot(&image));
            basis.push(next);
            // Orthogonalised twice, vectors are orthogonal to rounding.
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
        let beyond = |value| {
            let allowed = "so small that its eigenvalues are finite";
            Err(ArgumentError::number("delassus", allowed, value))
        };
        if let Some(&value) = diagonal.iter().chain(&beside).find(|value| !value.is_finite()) {
            return beyond(value * unit);
        }
        let found = SymmetricEigen::new(tridiagonal).eigenvalues;
        let (low, high) = (found.min() * unit, found.max() * unit);
        match low.is_finite() && high.is_finite() {
            true => Ok((low, high)),
            false => beyond(high.max(-low)),
        }
    }

    /// `½(G + Gᵀ) x` in a unit.
    fn symmetric_product(&self, x: &DVector<f64>, unit: f64) -> DVector<f64> {
        let x = x / unit;
        let mut out = DVector::zeros(x.len());
        self.apply(x.as_slice(), out.as_mut_slice());
        if self.is_matrix_free() {
            return out;
        }
        let mut transposed = DVector::zeros(x.len());
        self.blocks().add_transposed(x.as_slice(), transposed.as_mut_slice());
        out * 0.5 + transposed * 0.5
    }
}

//! Matrices `WᵀM⁻¹W` of constraints, which are singular where contacts are statically indeterminate.

use nalgebra::{DMatrix, DVector};

use crate::linear::{DenseLu, LeastNorm};

/// Pivot over the largest entry that counts as zero. Differences along the motion and the masses' range leave about
/// as much of redundant rows.
const SINGULAR: f64 = 1e-11;
/// Share of the largest part of a singular matrix below which its parts count as zero.
const RANK: f64 = 1e-10;

/// A factored matrix.
#[derive(Debug, Default)]
pub(crate) struct ConstraintMatrix {
    lu: DenseLu,
    /// Whether solutions are those of least squares and least norm.
    pub(crate) singular: bool,
    least_norm: Option<LeastNorm>,
}

impl ConstraintMatrix {
    /// Factors the matrix with these entries. Where it is singular, statically indeterminate contacts share the forces
    /// so that the sum of squares is smallest.
    pub(crate) fn factor(&mut self, size: usize, entry: impl Fn(usize, usize) -> f64) {
        for (k, value) in self.lu.begin(size).iter_mut().enumerate() {
            *value = entry(k / size, k % size);
        }
        self.singular = !self.lu.factor(if size == 1 { 0.0 } else { SINGULAR });
        if self.singular {
            self.least_norm = LeastNorm::new(DMatrix::from_fn(size, size, entry), RANK);
        }
    }

    /// `values ← matrix⁻¹ values`. A matrix whose entries are not numbers has no solution.
    pub(crate) fn solve(&self, values: &mut [f64]) {
        if !self.singular {
            self.lu.solve(values);
            return;
        }
        match &self.least_norm {
            Some(factors) => {
                let solution = factors.solve(&DVector::from_column_slice(values));
                values.copy_from_slice(solution.as_slice());
            }
            None => values.fill(f64::NAN),
        }
    }
}

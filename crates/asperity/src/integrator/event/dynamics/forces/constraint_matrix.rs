//! Matrices `WᵀM⁻¹W` of constraints, which are singular where contacts are statically indeterminate.

use nalgebra::{DMatrix, DVector};

use crate::linear::{BlockLu, LeastNorm};
use crate::solver::SINGULAR;

/// A factored matrix.
#[derive(Debug, Default)]
pub(crate) struct ConstraintMatrix {
    lu: BlockLu,
    /// Whether solutions are those of least squares and least norm, in some of the parts that are connected.
    pub(crate) singular: bool,
    singular_parts: Vec<SingularPart>,
}

/// Rows that are connected, and whose matrix is singular.
#[derive(Debug)]
struct SingularPart {
    rows: Vec<usize>,
    least_norm: Option<LeastNorm>,
}

impl ConstraintMatrix {
    /// Factors the matrix with these entries. Where it is singular, contacts share the forces with the least sum of squares.
    pub(crate) fn factor(&mut self, size: usize, entry: impl Fn(usize, usize) -> f64) {
        for (k, value) in self.lu.begin(size).iter_mut().enumerate() {
            *value = entry(k / size, k % size);
        }
        let parts = &mut self.singular_parts;
        parts.clear();
        // Where an edge nearly rests along a row, several small pivots share what one of a singular matrix shows.
        self.lu.factor_parts(SINGULAR.sqrt(), |entries, rows| {
            let entry = |i: usize, j: usize| entries[rows[i] * size + rows[j]];
            let part = DMatrix::from_fn(rows.len(), rows.len(), entry);
            let least_norm = LeastNorm::new(part, SINGULAR);
            let regular = |factors: &LeastNorm| factors.range().ncols() == rows.len();
            if !least_norm.as_ref().is_some_and(regular) {
                parts.push(SingularPart { rows: rows.to_vec(), least_norm });
            }
        });
        self.singular = !parts.is_empty();
    }

    /// `values ← matrix⁻¹ values`. A matrix whose entries are not numbers has no solution.
    pub(crate) fn solve(&mut self, values: &mut [f64]) {
        let right = |part: &SingularPart| {
            DVector::from_iterator(part.rows.len(), part.rows.iter().map(|&i| values[i]))
        };
        let found: Vec<Option<DVector<f64>>> = self
            .singular_parts
            .iter()
            .map(|part| part.least_norm.as_ref().map(|factors| factors.solve(&right(part))))
            .collect();
        self.lu.solve(values);
        for (part, found) in self.singular_parts.iter().zip(found) {
            for (k, &i) in part.rows.iter().enumerate() {
                values[i] = found.as_ref().map_or(f64::NAN, |found| found[k]);
            }
        }
    }
}

//! What takes the place of the sparse factorisation without the feature `sparse`: the whole matrix as one dense front.

use super::{DenseLu, Execution, Kind};
use crate::contact::BlockMatrix;

/// Most rows that are factored: the matrix of so many takes 128 MB.
const MOST_ROWS: usize = 4000;

/// The size of a matrix.
#[derive(Debug, Clone, Default)]
pub(crate) struct Symbolic {
    rows: usize,
    /// Floating-point operations of a factorisation.
    pub(crate) operations: f64,
}

impl Symbolic {
    /// For any matrix.
    pub(crate) fn new(matrix: &BlockMatrix) -> Self {
        let rows = matrix.rows();
        Self { rows, operations: DenseLu::operations(rows) }
    }
}

/// The factors of a matrix.
#[derive(Debug, Clone, Default)]
pub(crate) struct Numeric {
    lu: DenseLu,
}

impl Numeric {
    /// Buffers for a matrix of this size.
    pub(crate) fn reserve(&mut self, symbolic: &Symbolic) {
        if symbolic.rows <= MOST_ROWS {
            self.lu.begin(symbolic.rows);
        }
    }

    /// Factors a matrix of any kind; false if a pivot vanishes, the matrix is too large, or the factorisation is given up.
    pub(crate) fn factor(
        &mut self,
        symbolic: &Symbolic,
        (matrix, _): (&BlockMatrix, Kind),
        execution: Execution<'_>,
    ) -> bool {
        let n = symbolic.rows;
        if n > MOST_ROWS || (execution.given_up)() {
            return false;
        }
        let (entries, offsets) = (self.lu.begin(n), matrix.offsets());
        for i in 0..matrix.contacts() {
            for (j, block) in matrix.row(i) {
                for (a, row) in block.chunks_exact(matrix.size(j)).enumerate() {
                    let start = (offsets[i] + a) * n + offsets[j];
                    entries[start..start + row.len()].copy_from_slice(row);
                }
            }
        }
        execution.run(symbolic.operations, |work| self.lu.factor_by(work, 0.0))
    }

    /// `x ← A⁻¹ x`.
    pub(crate) fn solve(&mut self, _symbolic: &Symbolic, x: &mut [f64]) {
        // What is not finite is for the caller to see.
        let _ = self.lu.solve(x);
    }
}

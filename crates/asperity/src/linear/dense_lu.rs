//! LU factorisation of small dense matrices, with room that is kept for the next one.
//!
//! Matrices are filled row by row, while [`eliminate`] works column by column: it is the transpose that is factored,
//! `P Aᵀ = L U`, and `A x = b` reads `Uᵀ Lᵀ P x = b`.

use super::Kind;
use super::dense::{DenseFront, Packed, Patience, eliminate};
use crate::vectors::{dot, largest};

/// A factored matrix.
#[derive(Debug, Clone, Default)]
pub(crate) struct DenseLu {
    size: usize,
    /// The matrix, row by row; then column by column `L` with unit diagonal below, `U` on and above the diagonal.
    entries: Vec<f64>,
    swaps: Vec<usize>,
    packed: Packed,
    /// The largest size that there is room for.
    reserved: usize,
}

impl DenseLu {
    /// Floating-point operations of a factorisation.
    pub(crate) fn operations(size: usize) -> f64 {
        2.0 / 3.0 * (size as f64).powi(3)
    }

    /// A matrix of zeros, row by row, to be filled before [`factor`](Self::factor) is called.
    pub(crate) fn begin(&mut self, size: usize) -> &mut [f64] {
        self.size = size;
        self.entries.clear();
        self.entries.resize(size * size, 0.0);
        &mut self.entries
    }

    /// Gaussian elimination with exchanges; false if a pivot is not larger than `threshold` times the largest entry.
    pub(crate) fn factor(&mut self, threshold: f64) -> bool {
        let n = self.size;
        // Elimination that stops early leaves swaps as they were, which may be those of a larger matrix.
        self.swaps.clear();
        self.swaps.resize(n, 0);
        if n > self.reserved {
            self.packed.reserve(n);
            self.reserved = n;
        }
        let largest = largest(&self.entries);
        let (entries, swaps) = (&mut self.entries[..], &mut self.swaps[..]);
        let front = DenseFront { entries, size: n, pivots: n, swaps, kind: Kind::General };
        eliminate(front, &mut self.packed, &mut Patience::new(&|| false))
            && (0..n).all(|k| self.entries[k * n + k].abs() > threshold * largest)
    }

    /// `values ← matrix⁻¹ values`; false if the result is not finite.
    pub(crate) fn solve(&self, values: &mut [f64]) -> bool {
        let columns = self.entries.chunks_exact(self.size.max(1)).enumerate();
        for (k, column) in columns.clone() {
            values[k] = (values[k] - dot(&column[..k], values)) / column[k];
        }
        for (k, column) in columns.rev() {
            values[k] -= dot(&column[k + 1..], &values[k + 1..]);
        }
        for (k, &swap) in self.swaps.iter().enumerate().rev() {
            values.swap(k, swap);
        }
        values.iter().all(|x| x.is_finite())
    }
}

#[cfg(test)]
mod tests;

//! LU factorisation of small dense matrices with scratch that is kept.

/// A factored matrix, row by row: `L` with unit diagonal below, `U` on and above the diagonal.
#[derive(Debug, Clone, Default)]
pub(crate) struct DenseLu {
    size: usize,
    entries: Vec<f64>,
    swaps: Vec<usize>,
}

impl DenseLu {
    /// Room for a matrix of this size, row by row, filled with zeros, to be filled in before
    /// [`factor`](Self::factor).
    pub(crate) fn begin(&mut self, size: usize) -> &mut [f64] {
        self.size = size;
        self.entries.clear();
        self.entries.resize(size * size, 0.0);
        &mut self.entries
    }

    /// Gaussian elimination with row exchanges; false if the matrix is singular.
    pub(crate) fn factor(&mut self) -> bool {
        let (n, matrix) = (self.size, &mut self.entries);
        self.swaps.clear();
        for k in 0..n {
            let size = |i: &usize| matrix[i * n + k].abs();
            let pivot = (k..n).max_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or(k);
            self.swaps.push(pivot);
            if pivot != k {
                let (upper, lower) = matrix.split_at_mut(pivot * n);
                upper[k * n..(k + 1) * n].swap_with_slice(&mut lower[..n]);
            }
            let (upper, lower) = matrix.split_at_mut((k + 1) * n);
            let top = &upper[k * n + k..];
            let reciprocal = 1.0 / top[0];
            if !reciprocal.is_finite() {
                return false;
            }
            for row in lower.chunks_exact_mut(n) {
                let factor = row[k] * reciprocal;
                row[k] = factor;
                if factor != 0.0 {
                    for (entry, top) in row[k + 1..].iter_mut().zip(&top[1..]) {
                        *entry -= factor * top;
                    }
                }
            }
        }
        true
    }

    /// `values ← matrix⁻¹ values`; false if the result is not finite.
    pub(crate) fn solve(&self, values: &mut [f64]) -> bool {
        let n = self.size;
        for (k, &pivot) in self.swaps.iter().enumerate() {
            values.swap(k, pivot);
        }
        for k in 0..n {
            let row = &self.entries[k * n..];
            for j in 0..k {
                values[k] -= row[j] * values[j];
            }
        }
        for k in (0..n).rev() {
            let row = &self.entries[k * n..(k + 1) * n];
            let sum: f64 = row[k + 1..].iter().zip(&values[k + 1..]).map(|(m, x)| m * x).sum();
            values[k] = (values[k] - sum) / row[k];
        }
        values.iter().all(|x| x.is_finite())
    }
}

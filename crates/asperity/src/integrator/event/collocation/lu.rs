//! Small dense linear systems in place.

/// Gaussian elimination with row exchanges: `right ← matrix⁻¹ right`, the matrix row by row; false if it is
/// singular.
pub(crate) fn solve(matrix: &mut [f64], right: &mut [f64]) -> bool {
    let n = right.len();
    for k in 0..n {
        let size = |i: &usize| matrix[i * n + k].abs();
        let pivot = (k..n).max_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or(k);
        if pivot != k {
            let (upper, lower) = matrix.split_at_mut(pivot * n);
            upper[k * n + k..(k + 1) * n].swap_with_slice(&mut lower[k..n]);
            right.swap(k, pivot);
        }
        let (upper, lower) = matrix.split_at_mut((k + 1) * n);
        let top = &upper[k * n + k..];
        let reciprocal = 1.0 / top[0];
        if !reciprocal.is_finite() {
            return false;
        }
        let (known, rest) = right.split_at_mut(k + 1);
        for (row, value) in lower.chunks_exact_mut(n).zip(rest) {
            let factor = row[k] * reciprocal;
            if factor != 0.0 {
                for (entry, top) in row[k..].iter_mut().zip(top) {
                    *entry -= factor * top;
                }
                *value -= factor * known[k];
            }
        }
    }
    for k in (0..n).rev() {
        let row = &matrix[k * n..(k + 1) * n];
        let sum: f64 = row[k + 1..].iter().zip(&right[k + 1..]).map(|(m, x)| m * x).sum();
        right[k] = (right[k] - sum) / row[k];
    }
    right.iter().all(|x| x.is_finite())
}

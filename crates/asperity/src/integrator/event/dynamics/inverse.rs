//! Inverse of a small matrix, the pseudo-inverse if it is singular.

use nalgebra::{DMatrix, DVector};

use crate::linear::LeastNorm;

/// Relative size of a pivot that counts as zero.
const SINGULAR: f64 = 1e-11;

/// The inverse, row by row.
#[derive(Debug, Clone, Default)]
pub(crate) struct Inverse {
    size: usize,
    /// Whether it is a pseudo-inverse.
    pub(crate) singular: bool,
    entries: Vec<f64>,
    work: Vec<f64>,
    product: Vec<f64>,
}

impl Inverse {
    /// Of the matrix with these entries. Statically indeterminate contacts make it singular: they share the
    /// forces so that the sum of squares is smallest.
    pub(crate) fn of(&mut self, size: usize, entry: impl Fn(usize, usize) -> f64) {
        (self.size, self.singular) = (size, false);
        if size == 1 {
            self.entries.clear();
            self.entries.push(1.0 / entry(0, 0));
            return;
        }
        self.work.clear();
        self.work.extend((0..size * size).map(|k| entry(k / size, k % size)));
        self.entries.clear();
        self.entries.resize(size * size, 0.0);
        self.singular = !self.eliminate();
        if self.singular {
            // Without an inverse there are no forces: entries that are not numbers have none.
            self.entries.fill(f64::NAN);
            let matrix = DMatrix::from_fn(size, size, &entry);
            if let Some(factors) = LeastNorm::new(matrix, 1e-10) {
                for column in 0..size {
                    let unit = DVector::from_fn(size, |i, _| f64::from(u8::from(i == column)));
                    for (row, value) in factors.solve(&unit).iter().enumerate() {
                        self.entries[row * size + column] = *value;
                    }
                }
            }
        }
    }

    /// Gauss–Jordan elimination with row exchanges; false if a pivot vanishes.
    fn eliminate(&mut self) -> bool {
        let n = self.size;
        let (a, b) = (&mut self.work, &mut self.entries);
        let largest = a.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        for k in 0..n {
            b[k * n + k] = 1.0;
        }
        for k in 0..n {
            let size = |i: &usize| a[i * n + k].abs();
            let pivot = (k..n).max_by(|x, y| size(x).total_cmp(&size(y))).unwrap_or(k);
            // The comparison also turns away NaN.
            if !(a[pivot * n + k].abs() > SINGULAR * largest) {
                return false;
            }
            for j in 0..n {
                a.swap(k * n + j, pivot * n + j);
                b.swap(k * n + j, pivot * n + j);
            }
            let reciprocal = 1.0 / a[k * n + k];
            for j in 0..n {
                a[k * n + j] *= reciprocal;
                b[k * n + j] *= reciprocal;
            }
            for i in (0..n).filter(|&i| i != k) {
                let factor = a[i * n + k];
                for j in 0..n {
                    a[i * n + j] -= factor * a[k * n + j];
                    b[i * n + j] -= factor * b[k * n + j];
                }
            }
        }
        true
    }

    /// `values ← inverse values`.
    pub(crate) fn apply(&mut self, values: &mut [f64]) {
        self.product.clear();
        self.product.extend_from_slice(values);
        if values.is_empty() {
            return;
        }
        for (value, row) in values.iter_mut().zip(self.entries.chunks_exact(self.size)) {
            *value = row.iter().zip(&self.product).map(|(m, x)| m * x).sum();
        }
    }
}

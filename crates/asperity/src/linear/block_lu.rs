//! LU factorisation of a small dense matrix, part by part where its entries connect nothing with each other.

use super::DenseLu;
use crate::contact::{Components, Members};

/// A factored matrix, whose parts are those that entries other than zero connect.
#[derive(Debug, Clone, Default)]
pub(crate) struct BlockLu {
    size: usize,
    /// The matrix, row by row.
    entries: Vec<f64>,
    components: Components,
    /// The rows of the parts.
    members: Members,
    parts: Vec<DenseLu>,
    scratch: Vec<f64>,
}

impl BlockLu {
    /// A matrix of zeros, row by row, to be filled before [`factor`](Self::factor) is called.
    pub(crate) fn begin(&mut self, size: usize) -> &mut [f64] {
        self.size = size;
        self.entries.clear();
        self.entries.resize(size * size, 0.0);
        &mut self.entries
    }

    /// Factors all parts; false if a pivot is not larger than `threshold` times the largest entry of its part.
    pub(crate) fn factor(&mut self, threshold: f64) -> bool {
        self.factor_parts(threshold, |_, _| {})
    }

    /// As [`factor`](Self::factor), and tells the rows of every part that fails.
    pub(crate) fn factor_parts(
        &mut self,
        threshold: f64,
        mut failed: impl FnMut(&[f64], &[usize]),
    ) -> bool {
        self.find_parts();
        let mut regular = true;
        for part in 0..self.members.count() {
            let rows = self.members.of(part);
            let lu = &mut self.parts[part];
            let target = lu.begin(rows.len());
            for (target, &i) in target.chunks_exact_mut(rows.len()).zip(rows) {
                for (target, &j) in target.iter_mut().zip(rows) {
                    *target = self.entries[i * self.size + j];
                }
            }
            // Of a single row what is not zero is a pivot.
            if !lu.factor(if rows.len() == 1 { 0.0 } else { threshold }) {
                regular = false;
                failed(&self.entries, rows);
            }
        }
        regular
    }

    fn find_parts(&mut self) {
        let n = self.size;
        self.components.separate(n);
        for (i, row) in self.entries.chunks_exact(n.max(1)).enumerate() {
            for (j, entry) in row.iter().enumerate() {
                if *entry != 0.0 && i != j {
                    self.components.join(i, j);
                }
            }
        }
        self.members.update(&mut self.components);
        if self.parts.len() < self.members.count() {
            self.parts.resize(self.members.count(), DenseLu::default());
        }
    }

    /// `values ← matrix⁻¹ values`; false if the result is not finite.
    pub(crate) fn solve(&mut self, values: &mut [f64]) -> bool {
        if self.members.count() == 1 {
            return self.parts[0].solve(values);
        }
        let mut finite = true;
        for part in 0..self.members.count() {
            let rows = self.members.of(part);
            self.scratch.clear();
            self.scratch.extend(rows.iter().map(|&i| values[i]));
            finite &= self.parts[part].solve(&mut self.scratch);
            for (&i, value) in rows.iter().zip(&self.scratch) {
                values[i] = *value;
            }
        }
        finite
    }
}

#[cfg(test)]
mod tests;

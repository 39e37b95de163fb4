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
mod tests {
    use super::*;

    #[test]
    fn parts_that_nothing_connects_are_solved_as_the_whole_matrix_is() {
        let (n, mut blocks, mut whole) = (23, BlockLu::default(), DenseLu::default());
        for parts in [1, 2, 5, 23] {
            let entry = |i: usize, j: usize| match (i % parts == j % parts, i == j) {
                (false, _) => 0.0,
                (true, same) => (f64::from(u8::from(same)) * 9.0) + ((3 * i + 5 * j) as f64).sin(),
            };
            for matrix in [blocks.begin(n), whole.begin(n)] {
                for (k, value) in matrix.iter_mut().enumerate() {
                    *value = entry(k / n, k % n);
                }
            }
            let mut x: Vec<f64> = (0..n).map(|i| (i as f64).cos()).collect();
            let mut y = x.clone();
            assert!(blocks.factor(1e-11) && whole.factor(1e-11));
            assert!(blocks.solve(&mut x) && whole.solve(&mut y));
            assert_eq!(blocks.members.count(), parts);
            assert!(x.iter().zip(&y).all(|(x, y)| (x - y).abs() < 1e-14), "{parts}");
        }
    }

    #[test]
    fn the_rows_of_singular_parts_are_told() {
        let mut lu = BlockLu::default();
        lu.begin(4).copy_from_slice(&[
            1.0, 0.0, 1.0, 0.0, // rows 0 and 2 are the same
            0.0, 1e-30, 0.0, 0.0, //
            1.0, 0.0, 1.0, 0.0, //
            0.0, 0.0, 0.0, 0.0,
        ]);
        let mut failed = Vec::new();
        assert!(!lu.factor_parts(1e-11, |_, rows| failed.push(rows.to_vec())));
        assert_eq!(failed, [vec![0, 2], vec![3]]);
    }
}

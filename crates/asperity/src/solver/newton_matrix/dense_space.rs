//! `A + B G` as one dense matrix: of few rows it is factored before its pattern could be analysed.

use super::contact_space::multiply;
use crate::contact::ContactProblem;
use crate::law::ContactMatrix;
use crate::linear::DenseLu;

/// Elimination among all rows, whatever entries vanish.
#[derive(Debug, Clone, Default)]
pub(super) struct DenseSpace {
    lu: DenseLu,
}

impl DenseSpace {
    /// Factors `A + B G`; false if that failed.
    pub(super) fn factor(
        &mut self,
        problem: &ContactProblem,
        a: &[ContactMatrix],
        b: &[ContactMatrix],
    ) -> bool {
        let g = problem.delassus().blocks();
        let n = problem.rows();
        let entries = self.lu.begin(n);
        for (i, (contact, (a, b))) in problem.contacts().iter().zip(a.iter().zip(b)).enumerate() {
            let (first, size) = (contact.offset, contact.len());
            for (j, block) in g.row(i) {
                let (column, columns) = (g.offsets()[j], block.len() / size);
                let mut product = [0.0; 16];
                let product = &mut product[..block.len()];
                multiply(b, block, size, product);
                for (r, product) in product.chunks_exact(columns).enumerate() {
                    let row = &mut entries[(first + r) * n + column..][..columns];
                    row.copy_from_slice(product);
                }
            }
            for r in 0..size {
                let row = &mut entries[(first + r) * n + first..][..size];
                row.iter_mut().enumerate().for_each(|(c, value)| *value += a[(r, c)]);
            }
        }
        self.lu.factor(0.0)
    }

    /// `g ← (A + B G)⁻¹ g`; numbers that are not finite where there is no inverse.
    pub(super) fn solve(&self, g: &mut [f64]) {
        // What is not finite is for the caller to see.
        let _ = self.lu.solve(g);
    }
}

//! `A + B G` as it stands, eliminated among the rows of the contacts.

use crate::contact::{BlockMatrix, ContactProblem};
use crate::law::ContactMatrix;
use crate::linear::{Kind, Numeric, Symbolic};

/// Elimination among the rows of the contacts.
#[derive(Debug, Clone, Default)]
pub(super) struct ContactSpace {
    matrix: BlockMatrix,
    /// Block of `matrix` for every block of `G`, counted within the block row.
    places: Vec<usize>,
    pub(super) symbolic: Symbolic,
    pub(super) numeric: Numeric,
}

impl ContactSpace {
    pub(super) fn prepare(&mut self, problem: &ContactProblem) {
        let g = problem.delassus().blocks();
        let n = g.contacts();
        let mut neighbours: Vec<Vec<usize>> = (0..n).map(|i| g.neighbours(i).to_vec()).collect();
        for i in 0..n {
            for &j in g.neighbours(i) {
                if g.neighbours(j).binary_search(&i).is_err() {
                    neighbours[j].push(i);
                }
            }
        }
        for list in &mut neighbours {
            list.sort_unstable();
        }
        let sizes: Vec<usize> = (0..n).map(|i| g.size(i)).collect();
        self.matrix.reset(&sizes, neighbours.iter().map(|list| list.iter().copied()));
        self.places.clear();
        for (i, list) in neighbours.iter().enumerate() {
            let place = |j: &usize| list.partition_point(|other| other < j);
            self.places.extend(g.neighbours(i).iter().map(place));
        }
        self.symbolic = Symbolic::new(&self.matrix);
    }

    pub(super) fn factor(
        &mut self,
        problem: &ContactProblem,
        a: &[ContactMatrix],
        b: &[ContactMatrix],
        given_up: &dyn Fn() -> bool,
    ) -> bool {
        let g = problem.delassus().blocks();
        self.matrix.values_mut().fill(0.0);
        let mut block = 0;
        for (i, (a, b)) in a.iter().zip(b).enumerate() {
            let size = g.size(i);
            for (j, entries) in g.row(i) {
                let (_, out) = self.matrix.block_mut(i, self.places[block]);
                block += 1;
                multiply(b, entries, size, out);
                if i == j {
                    for r in 0..size {
                        for c in 0..size {
                            out[r * size + c] += a[(r, c)];
                        }
                    }
                }
            }
        }
        self.numeric.factor(&self.symbolic, (&self.matrix, Kind::General), given_up)
    }
}

/// `out ← B G_ij`, row-major.
#[inline]
pub(super) fn multiply(b: &ContactMatrix, g: &[f64], size: usize, out: &mut [f64]) {
    if let (Ok(g), Ok(out)) = (<&[f64; 9]>::try_from(g), <&mut [f64; 9]>::try_from(&mut *out)) {
        for r in 0..3 {
            for c in 0..3 {
                out[3 * r + c] = b[(r, 0)] * g[c] + b[(r, 1)] * g[3 + c] + b[(r, 2)] * g[6 + c];
            }
        }
        return;
    }
    let columns = g.len() / size;
    for (r, out) in out.chunks_exact_mut(columns).enumerate() {
        for (k, row) in g.chunks_exact(columns).enumerate() {
            for (value, g) in out.iter_mut().zip(row) {
                *value += b[(r, k)] * g;
            }
        }
    }
}

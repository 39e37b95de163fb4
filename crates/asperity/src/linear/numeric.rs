//! Multifrontal LU factorisation (\[DuffReid1983\]) with the pattern known.

use super::Symbolic;
use super::dense::{self, Packed};
use super::execution::{Execution, Work};
use super::symbolic::Front;
use crate::contact::BlockMatrix;

/// Factors of a matrix and all buffers to make them again.
#[derive(Debug, Clone, Default)]
pub(crate) struct Numeric {
    /// Of every front the eliminated columns, column-major, then the rows of `U` beyond them, transposed.
    factors: Vec<f64>,
    places: Vec<usize>,
    /// Row exchanges within the pivot rows of the fronts, counted from the first of them.
    swaps: Vec<usize>,
    front: Vec<f64>,
    /// Contribution blocks that wait for their parents, a stack.
    stack: Vec<f64>,
    packed: Packed,
    permuted: Vec<f64>,
    local: Vec<f64>,
}

impl Numeric {
    /// Buffers for this pattern.
    pub(crate) fn reserve(&mut self, symbolic: &Symbolic) {
        self.places.clear();
        let mut place = 0;
        for Front { pivots, size, .. } in &symbolic.fronts {
            self.places.push(place);
            place += pivots * size + pivots * (size - pivots);
        }
        let rows = symbolic.position.len();
        self.factors.resize(place, 0.0);
        self.swaps.resize(rows, 0);
        self.front.resize(symbolic.largest * symbolic.largest, 0.0);
        self.stack.resize(symbolic.waiting, 0.0);
        self.packed.reserve(symbolic.largest);
        self.permuted.resize(rows, 0.0);
        self.local.resize(symbolic.largest, 0.0);
    }

    /// Factors a matrix with the pattern of `symbolic`; false if a pivot vanishes, or if it is given up, which is asked every
    /// few milliseconds. Threads change nothing in what comes out.
    pub(crate) fn factor(
        &mut self,
        symbolic: &Symbolic,
        matrix: &BlockMatrix,
        execution: Execution<'_>,
    ) -> bool {
        execution.run(symbolic.operations, |work| self.factor_fronts(symbolic, matrix, work))
    }

    fn factor_fronts(
        &mut self,
        symbolic: &Symbolic,
        matrix: &BlockMatrix,
        work: &mut Work<'_>,
    ) -> bool {
        let mut top = 0;
        for (s, front) in symbolic.fronts.iter().enumerate() {
            let (size, pivots) = (front.size, front.pivots);
            let dense = &mut self.front[..size * size];
            dense.fill(0.0);
            for p in &front.placements {
                let block = matrix.block(p.block, p.rows * p.columns);
                for (a, row) in block.chunks_exact(p.columns).enumerate() {
                    for (b, value) in row.iter().enumerate() {
                        dense[(p.column + b) * size + p.row + a] = *value;
                    }
                }
            }
            for &child in front.children.iter().rev() {
                let into = &symbolic.fronts[child].into_parent;
                let len = into.len();
                top -= len * len;
                add_child(dense, size, into, &self.stack[top..top + len * len]);
            }
            let swaps = &mut self.swaps[front.first..front.first + pivots];
            if !dense::eliminate(dense, size, pivots, swaps, &mut self.packed, work) {
                return false;
            }
            let rest = size - pivots;
            let own = &mut self.factors[self.places[s]..];
            own[..pivots * size].copy_from_slice(&dense[..pivots * size]);
            for (j, column) in dense[pivots * size..].chunks_exact(size).enumerate() {
                let at = pivots * size + j * pivots;
                own[at..at + pivots].copy_from_slice(&column[..pivots]);
                self.stack[top + j * rest..top + (j + 1) * rest].copy_from_slice(&column[pivots..]);
            }
            top += rest * rest;
        }
        true
    }

    /// `x ← A⁻¹ x`.
    pub(crate) fn solve(&mut self, symbolic: &Symbolic, x: &mut [f64]) {
        for (value, &at) in x.iter().zip(&symbolic.position) {
            self.permuted[at] = *value;
        }
        for (s, front) in symbolic.fronts.iter().enumerate() {
            self.forward(s, front);
        }
        for (s, front) in symbolic.fronts.iter().enumerate().rev() {
            self.backward(s, front);
        }
        for (value, &at) in x.iter_mut().zip(&symbolic.position) {
            *value = self.permuted[at];
        }
    }

    fn forward(&mut self, s: usize, front: &Front) {
        let Front { pivots, first, size, rows, .. } = front;
        let columns = &self.factors[self.places[s]..self.places[s] + pivots * size];
        let own = &mut self.permuted[*first..first + pivots];
        for (c, &swap) in self.swaps[*first..first + pivots].iter().enumerate() {
            own.swap(c, swap);
        }
        let local = &mut self.local[..*size];
        local[..*pivots].copy_from_slice(own);
        local[*pivots..].fill(0.0);
        for (c, column) in columns.chunks_exact(*size).enumerate() {
            let y = local[c];
            for (value, l) in local[c + 1..].iter_mut().zip(&column[c + 1..]) {
                *value -= l * y;
            }
        }
        own.copy_from_slice(&local[..*pivots]);
        for (&row, value) in rows.iter().zip(&local[*pivots..]) {
            self.permuted[row] += value;
        }
    }

    fn backward(&mut self, s: usize, front: &Front) {
        let Front { pivots, first, size, rows, .. } = front;
        let (columns, beyond) = self.factors[self.places[s]..].split_at(pivots * size);
        let local = &mut self.local[..*pivots];
        local.copy_from_slice(&self.permuted[*first..first + pivots]);
        for (&row, column) in rows.iter().zip(beyond.chunks_exact(*pivots)) {
            let y = self.permuted[row];
            for (value, u) in local.iter_mut().zip(column) {
                *value -= u * y;
            }
        }
        for (c, column) in columns.chunks_exact(*size).enumerate().rev() {
            local[c] /= column[c];
            let y = local[c];
            for (value, u) in local[..c].iter_mut().zip(column) {
                *value -= u * y;
            }
        }
        self.permuted[*first..first + pivots].copy_from_slice(local);
    }
}

/// Adds a child's contribution block.
fn add_child(dense: &mut [f64], size: usize, into: &[usize], block: &[f64]) {
    for (&j, column) in into.iter().zip(block.chunks_exact(into.len())) {
        let out = &mut dense[j * size..(j + 1) * size];
        for (&i, value) in into.iter().zip(column) {
            out[i] += value;
        }
    }
}

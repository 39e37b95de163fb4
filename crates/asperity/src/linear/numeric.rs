//! Multifrontal factorisation (\[DuffReid1983\]) with the pattern known: LU, or LDLᵀ of a definite matrix, with half of the
//! operations.

use super::dense::{self, DenseFront, Packed, Patience};
use super::symbolic::Front;
use super::{Kind, Symbolic};
use crate::contact::BlockMatrix;
use crate::vectors::sum_in_lanes;

/// Factors of a matrix and all buffers to make them again.
#[derive(Debug, Clone, Default)]
pub(crate) struct Numeric {
    /// The eliminated columns of every front, column-major.
    factors: Vec<f64>,
    /// Of a general matrix the rows of `U` beyond them, transposed.
    beyond: Vec<f64>,
    /// What was factored last.
    kind: Kind,
    places: Vec<Place>,
    /// Row exchanges within the pivot rows of the fronts, counted from the first of them.
    swaps: Vec<usize>,
    front: Vec<f64>,
    /// Contribution blocks that wait for their parents, a stack.
    stack: Vec<f64>,
    packed: Packed,
    permuted: Vec<f64>,
    local: Vec<f64>,
}

/// Where the entries of a front begin.
#[derive(Debug, Clone, Copy)]
struct Place {
    factors: usize,
    beyond: usize,
}

impl Numeric {
    /// Buffers for this pattern.
    pub(crate) fn reserve(&mut self, symbolic: &Symbolic) {
        self.places.clear();
        let mut next = Place { factors: 0, beyond: 0 };
        for Front { pivots, size, .. } in &symbolic.fronts {
            self.places.push(next);
            next.factors += pivots * size;
            next.beyond += pivots * (size - pivots);
        }
        let rows = symbolic.position.len();
        self.factors.resize(next.factors, 0.0);
        self.beyond.clear();
        self.swaps.resize(rows, 0);
        self.front.resize(symbolic.largest * symbolic.largest, 0.0);
        self.stack.resize(symbolic.waiting, 0.0);
        self.packed.reserve(symbolic.largest);
        self.permuted.resize(rows, 0.0);
        self.local.resize(symbolic.largest, 0.0);
    }

    /// Factors a matrix with the pattern of `symbolic`; false if a pivot vanishes, or is not positive in a definite matrix, or if
    /// it is `given_up`, which is asked every few milliseconds.
    pub(crate) fn factor(
        &mut self,
        symbolic: &Symbolic,
        (matrix, kind): (&BlockMatrix, Kind),
        given_up: &dyn Fn() -> bool,
    ) -> bool {
        self.kind = kind;
        if kind == Kind::General && self.beyond.is_empty() {
            let entries =
                symbolic.fronts.iter().map(|front| front.pivots * (front.size - front.pivots));
            self.beyond.resize(entries.sum(), 0.0);
        }
        let mut patience = Patience::new(given_up);
        let mut top = 0;
        for (s, front) in symbolic.fronts.iter().enumerate() {
            let (size, pivots) = (front.size, front.pivots);
            let (dense, kind) = (&mut self.front[..size * size], self.kind);
            // Of a definite matrix nothing above the diagonal is needed.
            let from = |diagonal: usize| match kind {
                Kind::General => 0,
                Kind::Definite => diagonal,
            };
            for (j, column) in dense.chunks_exact_mut(size).enumerate() {
                column[from(j)..].fill(0.0);
            }
            for p in &front.placements {
                if p.row < from(p.column) {
                    continue;
                }
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
                let block = &self.stack[top..top + len * len];
                for ((k, &j), column) in into.iter().enumerate().zip(block.chunks_exact(len)) {
                    let out = &mut dense[j * size..(j + 1) * size];
                    for (&i, value) in into[from(k)..].iter().zip(&column[from(k)..]) {
                        out[i] += value;
                    }
                }
            }
            let swaps = &mut self.swaps[front.first..front.first + pivots];
            let eliminated = DenseFront { entries: &mut *dense, size, pivots, swaps, kind };
            if !dense::eliminate(eliminated, &mut self.packed, &mut patience) {
                return false;
            }
            let rest = size - pivots;
            let place = self.places[s];
            self.factors[place.factors..][..pivots * size].copy_from_slice(&dense[..pivots * size]);
            let waiting = &mut self.stack[top..top + rest * rest];
            for (j, column) in dense[pivots * size..].chunks_exact(size).enumerate() {
                if kind == Kind::General {
                    let row = &mut self.beyond[place.beyond + j * pivots..][..pivots];
                    row.copy_from_slice(&column[..pivots]);
                }
                let (first, end) = (j * rest + from(j), (j + 1) * rest);
                waiting[first..end].copy_from_slice(&column[pivots + from(j)..]);
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
            match self.kind {
                Kind::General => self.backward(s, front),
                Kind::Definite => self.backward_definite(s, front),
            }
        }
        for (value, &at) in x.iter_mut().zip(&symbolic.position) {
            *value = self.permuted[at];
        }
    }

    fn forward(&mut self, s: usize, front: &Front) {
        let Front { pivots, first, size, rows, .. } = front;
        let columns = &self.factors[self.places[s].factors..][..pivots * size];
        let own = &mut self.permuted[*first..first + pivots];
        if self.kind == Kind::General {
            for (c, &swap) in self.swaps[*first..first + pivots].iter().enumerate() {
                own.swap(c, swap);
            }
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
        let columns = &self.factors[self.places[s].factors..][..pivots * size];
        let beyond = &self.beyond[self.places[s].beyond..];
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

    /// Backward substitution with `DLᵀ`.
    fn backward_definite(&mut self, s: usize, front: &Front) {
        let Front { pivots, first, size, rows, .. } = front;
        let columns = &self.factors[self.places[s].factors..][..pivots * size];
        let local = &mut self.local[..*size];
        local[..*pivots].copy_from_slice(&self.permuted[*first..first + pivots]);
        for (value, &row) in local[*pivots..].iter_mut().zip(rows) {
            *value = self.permuted[row];
        }
        for (c, column) in columns.chunks_exact(*size).enumerate().rev() {
            local[c] = local[c] / column[c]
                - sum_in_lanes(&column[c + 1..], &local[c + 1..], |l, x| l * x);
        }
        self.permuted[*first..first + pivots].copy_from_slice(&local[..*pivots]);
    }
}

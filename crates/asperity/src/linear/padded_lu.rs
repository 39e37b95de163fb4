//! LU factorisation of the smallest dense matrices, in columns that fill whole registers.
//!
//! The tiles of `dense.rs` pay from some fifty rows on. Below, loops over what is left of a column below its pivot are
//! so short that most of it would be done number by number: here every column ends in zeros up to a multiple of
//! [`LANES`], and so do multipliers above their pivots, so that all loops go over whole groups of lanes.
//!
//! Matrices are filled row by row, while elimination works column by column: as in `dense_lu.rs` it is the transpose
//! that is factored. Rows are exchanged in what is left of the matrix only, step by step.

/// Numbers that are worked on together.
const LANES: usize = 8;

type Lanes = [f64; LANES];

/// A factored matrix.
#[derive(Debug, Clone, Default)]
pub(crate) struct PaddedLu {
    size: usize,
    /// Groups of lanes in a column.
    groups: usize,
    /// The matrix, row by row; then column by column `U` on and above the diagonal.
    entries: Vec<Lanes>,
    /// The multipliers of every step, below its pivot.
    multipliers: Vec<Lanes>,
    /// The row that was exchanged with that of the step.
    swaps: Vec<usize>,
}

impl PaddedLu {
    /// Floating-point operations of a factorisation.
    pub(crate) fn operations(size: usize) -> f64 {
        2.0 / 3.0 * (size as f64).powi(3)
    }

    /// A matrix of zeros, to be filled with [`row_mut`](Self::row_mut) before [`factor`](Self::factor) is called.
    pub(crate) fn begin(&mut self, size: usize) {
        self.size = size;
        self.groups = size.div_ceil(LANES);
        self.entries.clear();
        self.entries.resize(size * self.groups, [0.0; LANES]);
        self.multipliers.resize(size * self.groups, [0.0; LANES]);
        self.swaps.resize(size, 0);
    }

    /// A row of the matrix.
    #[inline]
    pub(crate) fn row_mut(&mut self, row: usize) -> &mut [f64] {
        let first = row * self.groups;
        &mut self.entries[first..first + self.groups].as_flattened_mut()[..self.size]
    }

    /// Gaussian elimination with exchanges; false if a pivot vanishes.
    pub(crate) fn factor(&mut self) -> bool {
        pulp::Arch::new().dispatch(Elimination(self))
    }

    #[inline(always)]
    fn eliminate(&mut self) -> bool {
        let Self { size, groups, ref mut entries, ref mut multipliers, ref mut swaps } = *self;
        for step in 0..size {
            let (before, after) = entries.split_at_mut((step + 1) * groups);
            let column = before[step * groups..].as_flattened_mut();
            let (mut best, mut largest) = (step, column[step].abs());
            for (row, value) in column[..size].iter().enumerate().skip(step + 1) {
                if value.abs() > largest {
                    (best, largest) = (row, value.abs());
                }
            }
            // The comparison also turns away what is not a number.
            if !(largest > 0.0) {
                return false;
            }
            swaps[step] = best;
            if best != step {
                // At once and only where rows are exchanged: reading a group right after writing one of its numbers stalls.
                column.swap(step, best);
                for other in after.chunks_exact_mut(groups) {
                    other.as_flattened_mut().swap(step, best);
                }
            }
            let reciprocal = 1.0 / column[step];
            let first = (step + 1) / LANES;
            let own = &mut multipliers[step * groups..(step + 1) * groups];
            for (to, from) in own[first..].iter_mut().zip(&column.as_chunks().0[first..]) {
                *to = scaled(from, reciprocal);
            }
            let whole = own.as_flattened_mut();
            let above = (first * LANES).min(whole.len());
            whole[above..(step + 1).max(above)].fill(0.0);
            let own = &own[first..];
            for other in after.chunks_exact_mut(groups) {
                let factor = -other.as_flattened()[step];
                for (to, l) in other[first..].iter_mut().zip(own) {
                    add(to, factor, l);
                }
            }
        }
        true
    }

    /// `values ← matrix⁻¹ values`.
    pub(crate) fn solve(&self, values: &mut [f64]) {
        let columns = self.entries.chunks_exact(self.groups.max(1)).enumerate();
        for (k, column) in columns {
            let column = column.as_flattened();
            let sum: f64 = column[..k].iter().zip(&*values).map(|(u, x)| u * x).sum();
            values[k] = (values[k] - sum) / column[k];
        }
        let columns = self.multipliers.chunks_exact(self.groups.max(1)).enumerate();
        for (k, column) in columns.take(self.size).rev() {
            let below = &column.as_flattened()[k + 1..self.size];
            let sum: f64 = below.iter().zip(&values[k + 1..]).map(|(l, x)| l * x).sum();
            values[k] -= sum;
            values.swap(k, self.swaps[k]);
        }
    }
}

/// A call of [`PaddedLu::eliminate`] that the compiler copies into every set of instructions.
struct Elimination<'a>(&'a mut PaddedLu);

impl pulp::NullaryFnOnce for Elimination<'_> {
    type Output = bool;

    #[inline(always)]
    fn call(self) -> bool {
        self.0.eliminate()
    }
}

#[inline(always)]
fn scaled(from: &Lanes, factor: f64) -> Lanes {
    let mut to = *from;
    to.iter_mut().for_each(|value| *value *= factor);
    to
}

#[inline(always)]
fn add(to: &mut Lanes, factor: f64, values: &Lanes) {
    for (to, value) in to.iter_mut().zip(values) {
        *to += factor * value;
    }
}

#[cfg(test)]
mod tests;

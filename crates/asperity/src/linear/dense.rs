//! Partial elimination of a dense front, the place where all the time goes.

use std::ops::Range;

use super::Kind;

/// Columns of a panel.
const PANEL: usize = 16;
/// Rows and columns of a tile that stays in registers.
const ROWS: usize = 8;
const COLUMNS: usize = 4;
/// Operations between two questions whether somebody waits for the factors: some milliseconds.
const BETWEEN: usize = 10_000_000;

/// Buffers of [`eliminate`].
#[derive(Debug, Clone, Default)]
pub(super) struct Packed {
    left: Vec<f64>,
}

impl Packed {
    /// Room for fronts of `size` rows.
    pub(super) fn reserve(&mut self, size: usize) {
        self.left.resize((size + ROWS) * PANEL, 0.0);
    }
}

/// A column-major front of `size` rows, of which the first `pivots` columns are eliminated.
pub(super) struct DenseFront<'a> {
    pub(super) entries: &'a mut [f64],
    pub(super) size: usize,
    pub(super) pivots: usize,
    /// Row exchanges, which a definite front needs none of.
    pub(super) swaps: &'a mut [usize],
    pub(super) kind: Kind,
}

/// Asks now and then whether nobody waits for the factors any longer.
pub(super) struct Patience<'a> {
    given_up: &'a dyn Fn() -> bool,
    /// Operations since it was last asked.
    operations: usize,
}

impl<'a> Patience<'a> {
    pub(super) fn new(given_up: &'a dyn Fn() -> bool) -> Self {
        Self { given_up, operations: 0 }
    }

    /// The answer after so many more operations.
    #[inline]
    fn ends(&mut self, operations: usize) -> bool {
        self.operations += operations;
        if self.operations < BETWEEN {
            return false;
        }
        self.operations = 0;
        (self.given_up)()
    }
}

/// Elimination; false if a pivot vanishes, or is not positive in a definite front, or if nobody waits for it any longer.
///
/// `LU` of a general front, rows exchanged within the pivot rows only: afterwards it holds `L` (unit diagonal) below and `U` above
/// the diagonal of the eliminated part, and the Schur complement of the rest. `LDLᵀ` of a definite one, of which the lower
/// triangle is read and holds `L` below and `D` on the diagonal afterwards; what is above is left undefined.
pub(super) fn eliminate(
    front: DenseFront<'_>,
    packed: &mut Packed,
    patience: &mut Patience<'_>,
) -> bool {
    pulp::Arch::new().dispatch(Elimination { front, packed, patience })
}

/// A call of [`eliminate`] that the compiler copies into every set of instructions.
struct Elimination<'a, 'b> {
    front: DenseFront<'a>,
    packed: &'a mut Packed,
    patience: &'a mut Patience<'b>,
}

impl pulp::NullaryFnOnce for Elimination<'_, '_> {
    type Output = bool;

    #[inline(always)]
    fn call(self) -> bool {
        let Self { front, packed, patience } = self;
        if fused() {
            eliminate_with::<true>(front, packed, patience)
        } else {
            eliminate_with::<false>(front, packed, patience)
        }
    }
}

/// Whether multiplication and addition are one instruction where `pulp` dispatches to.
#[inline(always)]
fn fused() -> bool {
    #[cfg(target_arch = "x86_64")]
    return std::arch::is_x86_feature_detected!("fma");
    #[cfg(not(target_arch = "x86_64"))]
    return cfg!(target_arch = "aarch64");
}

#[inline(always)]
fn eliminate_with<const FMA: bool>(
    front: DenseFront<'_>,
    packed: &mut Packed,
    patience: &mut Patience<'_>,
) -> bool {
    let DenseFront { entries, size, pivots, swaps, kind } = front;
    let mut start = 0;
    while start < pivots {
        let end = (start + PANEL).min(pivots);
        match kind {
            Kind::General => {
                if !panel::<FMA>(entries, size, pivots, start..end, swaps) {
                    return false;
                }
                exchange(entries, size, start..end, swaps);
            }
            Kind::Definite => {
                if !definite_panel::<FMA>(entries, size, start..end) {
                    return false;
                }
            }
        }
        update::<FMA>(entries, size, (start..end, kind), packed);
        let rest = size - start;
        if patience.ends(2 * (end - start) * rest * rest) {
            return false;
        }
        start = end;
    }
    true
}

/// Eliminates the columns of a panel in the panel alone.
#[inline(always)]
fn panel<const FMA: bool>(
    front: &mut [f64],
    size: usize,
    pivots: usize,
    columns: Range<usize>,
    swaps: &mut [usize],
) -> bool {
    let Range { start, end } = columns;
    for c in start..end {
        let column = &mut front[c * size..(c + 1) * size];
        let (mut best, mut largest) = (c, column[c].abs());
        for (r, value) in column.iter().enumerate().take(pivots).skip(c + 1) {
            if value.abs() > largest {
                (best, largest) = (r, value.abs());
            }
        }
        swaps[c] = best;
        if !(largest > 0.0) {
            return false;
        }
        if best != c {
            for j in start..end {
                front.swap(j * size + c, j * size + best);
            }
        }
        let (left, right) = front.split_at_mut((c + 1) * size);
        let column = &mut left[c * size..];
        let reciprocal = 1.0 / column[c];
        for value in &mut column[c + 1..] {
            *value *= reciprocal;
        }
        let below = &column[c + 1..];
        for other in right[..(end - c - 1) * size].chunks_exact_mut(size) {
            let factor = -other[c];
            for (value, l) in other[c + 1..].iter_mut().zip(below) {
                *value = add::<FMA>(*l, factor, *value);
            }
        }
    }
    true
}

/// The same of a definite front, without exchanges: `U = DLᵀ`.
#[inline(always)]
fn definite_panel<const FMA: bool>(front: &mut [f64], size: usize, columns: Range<usize>) -> bool {
    let Range { start, end } = columns;
    for c in start..end {
        let (left, right) = front.split_at_mut((c + 1) * size);
        let column = &mut left[c * size..];
        // The comparison also turns away NaN.
        if !(column[c] > 0.0) {
            return false;
        }
        let mut above = [0.0; PANEL];
        above[..end - c - 1].copy_from_slice(&column[c + 1..end]);
        let reciprocal = 1.0 / column[c];
        for value in &mut column[c + 1..] {
            *value *= reciprocal;
        }
        let others = right[..(end - c - 1) * size].chunks_exact_mut(size);
        for ((k, other), u) in others.enumerate().zip(above) {
            let first = c + 1 + k;
            for (value, l) in other[first..].iter_mut().zip(&column[first..]) {
                *value = add::<FMA>(*l, -u, *value);
            }
        }
    }
    true
}

/// Exchanges the rows of a panel's pivots in all other columns.
#[inline(always)]
fn exchange(front: &mut [f64], size: usize, columns: Range<usize>, swaps: &[usize]) {
    let Range { start, end } = columns;
    for (j, column) in front.chunks_exact_mut(size).enumerate() {
        if j < start || j >= end {
            for (c, &swap) in swaps.iter().enumerate().take(end).skip(start) {
                column.swap(c, swap);
            }
        }
    }
}

/// Rows of `U` to the right of a panel, and the Schur complement below them.
#[inline(always)]
fn update<const FMA: bool>(
    front: &mut [f64],
    size: usize,
    (columns, kind): (Range<usize>, Kind),
    packed: &mut Packed,
) {
    let Range { start, end } = columns;
    let depth = end - start;
    let (left, right) = front.split_at_mut(end * size);
    let rest = size - end;
    if right.is_empty() {
        return;
    }
    let panel = &left[start * size..];
    let tiles = rest / ROWS;
    for (tile, out) in packed.left.chunks_exact_mut(ROWS * depth).take(tiles).enumerate() {
        let first = end + tile * ROWS;
        for (column, out) in panel.chunks_exact(size).zip(out.chunks_exact_mut(ROWS)) {
            out.copy_from_slice(&column[first..first + ROWS]);
        }
    }
    let panel = Panel { entries: panel, size, start, end, packed: &packed.left };
    match kind {
        Kind::General => panel.update_general::<FMA>(right),
        Kind::Definite => panel.update_definite::<FMA>(right, end),
    }
}

/// Eliminated columns, and all that the columns right of them need to know.
#[derive(Clone, Copy)]
struct Panel<'a> {
    entries: &'a [f64],
    size: usize,
    start: usize,
    end: usize,
    /// The rows below, tile by tile.
    packed: &'a [f64],
}

impl Panel<'_> {
    /// The lower triangle of the Schur complement in the columns from `first` on: rows of `U` are `DLᵀ`.
    #[inline(always)]
    fn update_definite<const FMA: bool>(self, right: &mut [f64], first: usize) {
        let Self { entries: panel, size, start, end, packed, .. } = self;
        let (depth, tiles) = (end - start, (size - end) / ROWS);
        let mut above = [[0.0; COLUMNS]; PANEL];
        for (group, columns) in right.chunks_mut(COLUMNS * size).enumerate() {
            let first = first + group * COLUMNS;
            for ((p, row), column) in above.iter_mut().enumerate().zip(panel.chunks_exact(size)) {
                let last = size.min(first + COLUMNS);
                for (value, l) in row.iter_mut().zip(&column[first..last]) {
                    *value = column[start + p] * l;
                }
            }
            let above = &above[..depth];
            if columns.len() == COLUMNS * size {
                // From the tile on that the diagonal passes through.
                let skipped = (first - end) / ROWS;
                let (top, packed) = (end + skipped * ROWS, &packed[skipped * ROWS * depth..]);
                tiled::<FMA>(columns, size, top, tiles - skipped, above, packed);
                rows_left_over::<FMA>(columns, size, end + tiles * ROWS, panel, above);
            } else {
                rows_left_over::<FMA>(columns, size, first, panel, above);
            }
        }
    }

    /// Rows of `U`, and the Schur complement of a general front.
    #[inline(always)]
    fn update_general<const FMA: bool>(self, right: &mut [f64]) {
        let Self { entries: panel, size, start, end, packed, .. } = self;
        let (depth, tiles) = (end - start, (size - end) / ROWS);
        let mut above = [[0.0; COLUMNS]; PANEL];
        for columns in right.chunks_mut(COLUMNS * size) {
            for (b, column) in columns.chunks_exact(size).enumerate() {
                for (row, value) in above.iter_mut().zip(&column[start..end]) {
                    row[b] = *value;
                }
            }
            // All columns of the tile at once.
            for p in 0..depth {
                let (done, below) = above[..depth].split_at_mut(p + 1);
                let l = &panel[p * size + start + p + 1..p * size + end];
                for (row, l) in below.iter_mut().zip(l) {
                    for (value, u) in row.iter_mut().zip(&done[p]) {
                        *value = add::<FMA>(-*l, *u, *value);
                    }
                }
            }
            for (b, column) in columns.chunks_exact_mut(size).enumerate() {
                for (row, value) in above.iter().zip(&mut column[start..end]) {
                    *value = row[b];
                }
            }
            let above = &above[..depth];
            if columns.len() == COLUMNS * size {
                tiled::<FMA>(columns, size, end, tiles, above, packed);
                rows_left_over::<FMA>(columns, size, end + tiles * ROWS, panel, above);
            } else {
                rows_left_over::<FMA>(columns, size, end, panel, above);
            }
        }
    }
}

/// `C ← C − L U` for the full tiles of four columns.
#[inline(always)]
fn tiled<const FMA: bool>(
    columns: &mut [f64],
    size: usize,
    first: usize,
    tiles: usize,
    above: &[[f64; COLUMNS]],
    left: &[f64],
) {
    let mut split = columns.chunks_exact_mut(size);
    let (Some(c0), Some(c1), Some(c2), Some(c3)) =
        (split.next(), split.next(), split.next(), split.next())
    else {
        return;
    };
    let end = first + tiles * ROWS;
    let outs = c0[first..end]
        .chunks_exact_mut(ROWS)
        .zip(c1[first..end].chunks_exact_mut(ROWS))
        .zip(c2[first..end].chunks_exact_mut(ROWS))
        .zip(c3[first..end].chunks_exact_mut(ROWS));
    for ((((o0, o1), o2), o3), l) in outs.zip(left.chunks_exact(ROWS * above.len())) {
        let mut sum = [[0.0; ROWS]; COLUMNS];
        for (l, u) in l.chunks_exact(ROWS).zip(above) {
            for (sum, u) in sum.iter_mut().zip(u) {
                for (value, l) in sum.iter_mut().zip(l) {
                    *value = add::<FMA>(*l, *u, *value);
                }
            }
        }
        for (out, sum) in [o0, o1, o2, o3].into_iter().zip(&sum) {
            for (value, s) in out.iter_mut().zip(sum) {
                *value -= s;
            }
        }
    }
}

/// The same for rows and columns that fill no tile.
#[inline(always)]
fn rows_left_over<const FMA: bool>(
    columns: &mut [f64],
    size: usize,
    first: usize,
    panel: &[f64],
    above: &[[f64; COLUMNS]],
) {
    for (b, column) in columns.chunks_exact_mut(size).enumerate() {
        for (l, u) in panel.chunks_exact(size).zip(above) {
            for (value, l) in column[first..].iter_mut().zip(&l[first..]) {
                *value = add::<FMA>(*l, -u[b], *value);
            }
        }
    }
}

/// `a b + c`.
#[inline(always)]
fn add<const FMA: bool>(a: f64, b: f64, c: f64) -> f64 {
    if FMA { a.mul_add(b, c) } else { a * b + c }
}

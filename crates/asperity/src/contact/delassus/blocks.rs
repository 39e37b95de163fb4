//! Sparse Delassus operators: one block row per contact.

use std::ops::Range;

use nalgebra::DMatrix;

use super::Csr;
use crate::argument::{ArgumentError, length, refuse};
use crate::vectors::prefetch;

/// Entries ahead of a block that are prefetched: 64 blocks of nine, for matrices that are larger than the cache.
const AHEAD: usize = 576;

/// Number of rows of contacts with `sizes` rows each.
pub(super) fn rows_of(sizes: &[usize]) -> Result<usize, ArgumentError> {
    if sizes.iter().any(|size| !(1..=4).contains(size)) {
        let message = "must have 1 to 4 rows per contact";
        return refuse("delassus", message);
    }
    Ok(sizes.iter().sum())
}

/// Refuses matrices that have not a row and a column per row of the contacts.
fn check_shape(sizes: &[usize], shape: (usize, usize)) -> Result<(), ArgumentError> {
    let rows = rows_of(sizes)?;
    let got = if shape.0 == rows { shape.1 } else { shape.0 };
    length("delassus", rows, got)
}

/// A sparse matrix of dense blocks `G_ij`, compressed by block rows, one per contact.
///
/// A block has as many rows as contact `i` and as many columns as contact `j`, row-major. Diagonal blocks
/// are always there.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BlockMatrix {
    /// First row of every contact, and the number of rows.
    offsets: Vec<usize>,
    /// First block of every block row, and the number of blocks.
    starts: Vec<usize>,
    /// Block column and place among the values of every block.
    columns: Vec<usize>,
    places: Vec<usize>,
    /// Diagonal block of every block row.
    diagonal: Vec<usize>,
    values: Vec<f64>,
    /// Whether all contacts have three rows, as those in the plane have.
    in_threes: bool,
}

impl BlockMatrix {
    /// Zeros where contact `i` and the contacts `neighbours[i]`, ascending, meet; contacts have `sizes` rows.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] if a contact has not 1 to 4 rows, or if the lists are not one per contact, ascending
    /// and of contacts that there are.
    pub fn from_pattern(sizes: &[usize], neighbours: &[Vec<usize>]) -> Result<Self, ArgumentError> {
        if sizes.len() != neighbours.len() {
            return refuse("delassus", "must have one list of neighbours per contact");
        }
        rows_of(sizes)?;
        let ascending = |list: &Vec<usize>| list.windows(2).all(|pair| pair[0] < pair[1]);
        let within = |list: &Vec<usize>| list.iter().all(|&j| j < sizes.len());
        if !neighbours.iter().all(|list| ascending(list) && within(list)) {
            return refuse("delassus", "must have neighbours that ascend and are contacts");
        }
        Ok(Self::with_pattern(sizes, neighbours))
    }

    /// The same without checks, for blocks of any size.
    pub(crate) fn with_pattern(sizes: &[usize], neighbours: &[Vec<usize>]) -> Self {
        let mut matrix = Self::default();
        // Missing diagonal blocks are added.
        let blocks = sizes.len() + neighbours.iter().map(Vec::len).sum::<usize>();
        matrix.columns.reserve_exact(blocks);
        matrix.places.reserve_exact(blocks);
        matrix.reset(sizes, neighbours.iter().map(|row| row.iter().copied()));
        matrix
    }

    /// A new pattern in the old buffers; missing diagonal blocks are added.
    pub(crate) fn reset<R: Iterator<Item = usize>>(
        &mut self,
        sizes: &[usize],
        neighbours: impl Iterator<Item = R>,
    ) {
        let Self { offsets, starts, columns, places, diagonal, values, in_threes } = self;
        for list in [&mut *offsets, starts, columns, places, diagonal] {
            list.clear();
        }
        *in_threes = sizes.iter().all(|&size| size == 3);
        offsets.push(0);
        for size in sizes {
            offsets.push(offsets[offsets.len() - 1] + size);
        }
        starts.push(0);
        let mut place = 0;
        for (i, row) in neighbours.enumerate() {
            let mut own = None;
            let mut add = |j: usize| {
                columns.push(j);
                places.push(place);
                place += sizes[i] * sizes[j];
                columns.len() - 1
            };
            for j in row {
                if j >= i && own.is_none() {
                    own = Some(add(i));
                }
                if j != i {
                    add(j);
                }
            }
            let own = own.unwrap_or_else(|| add(i));
            diagonal.push(own);
            starts.push(columns.len());
        }
        values.clear();
        values.resize(place, 0.0);
    }

    /// The blocks of a sparse matrix for contacts with `sizes` rows.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] if a contact has not 1 to 4 rows, or the matrix not the rows and columns of all contacts.
    pub fn from_csr(matrix: &Csr, sizes: &[usize]) -> Result<Self, ArgumentError> {
        check_shape(sizes, (matrix.rows(), matrix.columns()))?;
        let mut contact_of = Vec::with_capacity(matrix.rows());
        for (i, &size) in sizes.iter().enumerate() {
            contact_of.extend(std::iter::repeat_n(i, size));
        }
        let mut neighbours = vec![Vec::new(); sizes.len()];
        for (row, &i) in contact_of.iter().enumerate() {
            // Zeros that are kept do not connect contacts.
            let (columns, values) = matrix.row(row);
            let entries = columns.iter().zip(values).filter(|(_, value)| **value != 0.0);
            neighbours[i].extend(entries.map(|(&column, _)| contact_of[column]));
            neighbours[i].dedup();
        }
        for list in &mut neighbours {
            list.sort_unstable();
            list.dedup();
        }
        let mut blocks = Self::with_pattern(sizes, &neighbours);
        for (row, &i) in contact_of.iter().enumerate() {
            let (columns, values) = matrix.row(row);
            let mut k = blocks.starts[i];
            for (&column, value) in columns.iter().zip(values).filter(|(_, value)| **value != 0.0) {
                while blocks.columns[k] != contact_of[column] {
                    k += 1;
                }
                let j = blocks.columns[k];
                let at = (row - blocks.offsets[i]) * sizes[j] + column - blocks.offsets[j];
                blocks.values[blocks.places[k] + at] = *value;
            }
        }
        Ok(blocks)
    }

    /// The blocks of a dense matrix that are not zero, for contacts with `sizes` rows.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] if a contact has not 1 to 4 rows, or the matrix not the rows and columns of all contacts.
    pub fn from_dense(matrix: &DMatrix<f64>, sizes: &[usize]) -> Result<Self, ArgumentError> {
        check_shape(sizes, matrix.shape())?;
        // Contacts whose block is zero do not influence each other.
        let meets = |rows: Range<usize>, columns: Range<usize>| {
            let (first, shape) = ((rows.start, columns.start), (rows.len(), columns.len()));
            matrix.view(first, shape).iter().any(|&value| value != 0.0)
        };
        Ok(Self::filled(sizes, meets, |i, j| matrix[(i, j)]))
    }

    /// All blocks of the matrix with these entries; rows and columns are those of contacts with `sizes` rows.
    pub(crate) fn full(sizes: &[usize], entry: impl Fn(usize, usize) -> f64) -> Self {
        Self::filled(sizes, |_, _| true, entry)
    }

    /// The blocks, of these rows and columns, that `are_kept` of the matrix with these entries.
    fn filled(
        sizes: &[usize],
        are_kept: impl Fn(Range<usize>, Range<usize>) -> bool,
        entry: impl Fn(usize, usize) -> f64,
    ) -> Self {
        let mut places = Vec::with_capacity(sizes.len());
        let mut first = 0;
        for size in sizes {
            places.push(first..first + size);
            first += size;
        }
        let (places, are_kept) = (&places, &are_kept);
        let row = |rows: &Range<usize>| {
            let rows = rows.clone();
            let kept = move |&j: &usize| are_kept(rows.clone(), places[j].clone());
            (0..places.len()).filter(kept)
        };
        let mut blocks = Self::default();
        blocks.reset(sizes, places.iter().map(row));
        for (i, rows) in places.iter().enumerate() {
            for k in 0..blocks.neighbours(i).len() {
                let (j, block) = blocks.block_mut(i, k);
                let width = sizes[j];
                for (at, value) in block.iter_mut().enumerate() {
                    *value = entry(rows.start + at / width, places[j].start + at % width);
                }
            }
        }
        blocks
    }

    /// The blocks between some contacts, ascending.
    pub(crate) fn part(&self, contacts: &[usize]) -> Self {
        let place = |j: &usize| contacts.binary_search(j).ok();
        let sizes: Vec<usize> = contacts.iter().map(|&i| self.size(i)).collect();
        let mut part = Self::default();
        part.reset(&sizes, contacts.iter().map(|&i| self.neighbours(i).iter().filter_map(place)));
        let mut at = 0;
        for &i in contacts {
            for (_, block) in self.row(i).filter(|(j, _)| place(j).is_some()) {
                part.values[at..at + block.len()].copy_from_slice(block);
                at += block.len();
            }
        }
        part
    }

    /// Copies the entries of the blocks between some contacts, which meet no others, to a matrix that was made as their part.
    pub(crate) fn copy_part(&self, contacts: &[usize], part: &mut Self) {
        let mut at = 0;
        for &i in contacts {
            let row = &self.values[self.places_of_row(i)];
            part.values[at..at + row.len()].copy_from_slice(row);
            at += row.len();
        }
    }

    /// Where the entries of a block row are, of which the blocks follow each other.
    fn places_of_row(&self, i: usize) -> Range<usize> {
        let past = self.places.get(self.starts[i + 1]).copied().unwrap_or(self.values.len());
        self.places[self.starts[i]]..past
    }

    /// Number of entries of a block row.
    #[inline]
    pub(crate) fn entries_of(&self, i: usize) -> usize {
        self.places_of_row(i).len()
    }

    /// Number of block rows.
    pub fn contacts(&self) -> usize {
        self.diagonal.len()
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.offsets.last().copied().unwrap_or(0)
    }

    /// First row of every contact, and the number of rows.
    pub fn offsets(&self) -> &[usize] {
        &self.offsets
    }

    /// Number of rows of a contact.
    ///
    /// # Panics
    ///
    /// Like the other methods that are asked for one contact: if there is no such contact.
    #[inline]
    pub fn size(&self, i: usize) -> usize {
        self.offsets[i + 1] - self.offsets[i]
    }

    /// Block columns of a block row, ascending.
    pub fn neighbours(&self, i: usize) -> &[usize] {
        &self.columns[self.starts[i]..self.starts[i + 1]]
    }

    /// First block of every block row, and the block columns of all blocks.
    pub(crate) fn pattern(&self) -> (&[usize], &[usize]) {
        (&self.starts, &self.columns)
    }

    /// Entries of a block counted over all rows.
    #[inline]
    pub(crate) fn block(&self, k: usize, len: usize) -> &[f64] {
        &self.values[self.places[k]..self.places[k] + len]
    }

    /// The block of two contacts, if it is kept.
    pub(crate) fn between(&self, i: usize, j: usize) -> Option<&[f64]> {
        let k = self.starts[i] + self.neighbours(i).binary_search(&j).ok()?;
        Some(self.block(k, self.size(i) * self.size(j)))
    }

    /// Blocks of a block row: block column and entries.
    #[inline]
    pub fn row(&self, i: usize) -> impl Iterator<Item = (usize, &[f64])> {
        let size = self.size(i);
        (self.starts[i]..self.starts[i + 1]).map(move |k| {
            let j = self.columns[k];
            (j, &self.values[self.places[k]..self.places[k] + size * self.size(j)])
        })
    }

    /// The `k`-th block of a block row, to be changed.
    pub fn block_mut(&mut self, i: usize, k: usize) -> (usize, &mut [f64]) {
        let (k, size) = (self.starts[i] + k, self.size(i));
        let j = self.columns[k];
        let len = size * self.size(j);
        (j, &mut self.values[self.places[k]..self.places[k] + len])
    }

    /// Makes the `k`-th block of a block row the transpose of that of the same contacts in the other order, if this is kept.
    pub(crate) fn mirror(&mut self, i: usize, k: usize) {
        let own = self.starts[i] + k;
        let j = self.columns[own];
        let Ok(other) = self.neighbours(j).binary_search(&i) else { return };
        let (rows, columns) = (self.size(i), self.size(j));
        let (place, from) = (self.places[own], self.places[self.starts[j] + other]);
        for at in 0..rows * columns {
            self.values[place + at] = self.values[from + at % columns * rows + at / columns];
        }
    }

    /// The diagonal block of a contact.
    #[inline]
    pub fn diagonal(&self, i: usize) -> &[f64] {
        let own = self.diagonal[i];
        if self.in_threes {
            // Without a look at the place of the block, which is in the cache no more often than the block itself.
            return &self.values.as_chunks::<9>().0[own];
        }
        let (size, place) = (self.size(i), self.places[own]);
        &self.values[place..place + size * size]
    }

    /// All values, block after block.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// All values, to be changed.
    pub(crate) fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// Whether every two contacts meet.
    #[cfg(feature = "serde")]
    pub(crate) fn is_full(&self) -> bool {
        self.columns.len() == self.contacts() * self.contacts()
    }

    /// Whether no two contacts meet.
    pub fn is_block_diagonal(&self) -> bool {
        self.columns.len() == self.contacts()
    }

    /// Adds `Σ_j G_ij P_j` to the first entries of `sum`, without `j = i` unless `with_own`.
    #[inline(always)]
    pub(crate) fn add_row(&self, i: usize, percussion: &[f64], with_own: bool, sum: &mut [f64; 4]) {
        self.add_terms(i, percussion, with_own, sum, |g, p| g * p);
    }

    /// Adds `Σ_j |G_ij P_j|` to the first entries of `sum`.
    #[inline(always)]
    pub(crate) fn add_magnitudes(&self, i: usize, percussion: &[f64], sum: &mut [f64; 4]) {
        self.add_terms(i, percussion, true, sum, |g, p| (g * p).abs());
    }

    /// Both at once, to the bit, which takes one pass through the row.
    #[inline(always)]
    pub(crate) fn add_row_and_magnitudes(
        &self,
        i: usize,
        percussion: &[f64],
        sum: &mut [f64; 4],
        magnitudes: &mut [f64; 4],
    ) {
        if !self.in_threes {
            self.add_row(i, percussion, true, sum);
            self.add_magnitudes(i, percussion, magnitudes);
            return;
        }
        let own = self.starts[i]..self.starts[i + 1];
        let (blocks, percussions) = (self.values.as_chunks::<9>().0, percussion.as_chunks::<3>().0);
        let (mut sums, mut sizes) = ([sum[0], sum[1], sum[2]], [0.0; 3]);
        for (&j, g) in self.columns[own.clone()].iter().zip(&blocks[own]) {
            prefetch(g, AHEAD);
            let p = &percussions[j];
            for a in 0..3 {
                let terms = [g[3 * a] * p[0], g[3 * a + 1] * p[1], g[3 * a + 2] * p[2]];
                sums[a] += terms[0] + terms[1] + terms[2];
                sizes[a] += terms[0].abs() + terms[1].abs() + terms[2].abs();
            }
        }
        sum[..3].copy_from_slice(&sums);
        magnitudes.iter_mut().zip(sizes).for_each(|(all, own)| *all += own);
    }

    /// `Σ_j |G_ij P_j|` in the first row of a contact, to the bit that of [`add_magnitudes`](Self::add_magnitudes).
    #[inline(always)]
    pub(crate) fn first_magnitude(&self, i: usize, percussion: &[f64]) -> f64 {
        let own = self.starts[i]..self.starts[i + 1];
        if self.in_threes {
            let blocks = &self.values.as_chunks::<9>().0[own.clone()];
            let percussions = percussion.as_chunks::<3>().0;
            let of_block = |(&j, g): (&usize, &[f64; 9])| {
                prefetch(g, AHEAD);
                let p = &percussions[j];
                (g[0] * p[0]).abs() + (g[1] * p[1]).abs() + (g[2] * p[2]).abs()
            };
            return self.columns[own].iter().zip(blocks).map(of_block).sum();
        }
        let of_block = |(j, block): (usize, &[f64])| {
            let own = &percussion[self.offsets[j]..self.offsets[j + 1]];
            block.iter().zip(own).map(|(g, p)| (g * p).abs()).sum::<f64>()
        };
        self.row(i).map(of_block).sum()
    }

    #[inline(always)]
    fn add_terms(
        &self,
        i: usize,
        percussion: &[f64],
        with_own: bool,
        sum: &mut [f64; 4],
        term: impl Fn(f64, f64) -> f64,
    ) {
        if self.in_threes {
            self.add_terms_in_threes(i, percussion, with_own, sum, term);
        } else {
            self.add_terms_of_any_size(i, percussion, with_own, sum, term);
        }
    }

    /// Apart, so that sweeps over contacts of three rows, the bulk of all, are not compiled together with what they do not need.
    #[inline(never)]
    fn add_terms_of_any_size(
        &self,
        i: usize,
        percussion: &[f64],
        with_own: bool,
        sum: &mut [f64; 4],
        term: impl Fn(f64, f64) -> f64,
    ) {
        let size = self.size(i);
        for k in self.starts[i]..self.starts[i + 1] {
            let j = self.columns[k];
            if j == i && !with_own {
                continue;
            }
            let (first, place) = (self.offsets[j], self.places[k]);
            let columns = self.offsets[j + 1] - first;
            let block = &self.values[place..place + size * columns];
            let p = &percussion[first..first + columns];
            // Contacts in the plane, the bulk of all, with loops that the compiler unrolls.
            if let (Ok(g), Ok(p)) = (<&[f64; 9]>::try_from(block), <&[f64; 3]>::try_from(p)) {
                for a in 0..3 {
                    sum[a] +=
                        term(g[3 * a], p[0]) + term(g[3 * a + 1], p[1]) + term(g[3 * a + 2], p[2]);
                }
                continue;
            }
            for (value, row) in sum.iter_mut().zip(block.chunks_exact(columns)) {
                *value += row.iter().zip(p).map(|(g, p)| term(*g, *p)).sum::<f64>();
            }
        }
    }

    /// The same where all contacts have three rows, without a look at the place of every block.
    #[inline(always)]
    fn add_terms_in_threes(
        &self,
        i: usize,
        percussion: &[f64],
        with_own: bool,
        sum: &mut [f64; 4],
        term: impl Fn(f64, f64) -> f64,
    ) {
        let (first, own, past) = (self.starts[i], self.diagonal[i], self.starts[i + 1]);
        let mut sums = [sum[0], sum[1], sum[2]];
        if with_own {
            sums = self.add_blocks_of_nine(first..past, percussion, sums, term);
        } else {
            sums = self.add_blocks_of_nine(first..own, percussion, sums, &term);
            sums = self.add_blocks_of_nine(own + 1..past, percussion, sums, &term);
        }
        sum[..3].copy_from_slice(&sums);
    }

    /// Adds the terms of some blocks, counted over all rows, to sums that stay in registers.
    #[inline(always)]
    fn add_blocks_of_nine(
        &self,
        places: Range<usize>,
        percussion: &[f64],
        mut sums: [f64; 3],
        term: impl Fn(f64, f64) -> f64,
    ) -> [f64; 3] {
        let (blocks, percussions) = (self.values.as_chunks::<9>().0, percussion.as_chunks::<3>().0);
        for (&j, g) in self.columns[places.clone()].iter().zip(&blocks[places]) {
            prefetch(g, AHEAD);
            let p = &percussions[j];
            for a in 0..3 {
                sums[a] +=
                    term(g[3 * a], p[0]) + term(g[3 * a + 1], p[1]) + term(g[3 * a + 2], p[2]);
            }
        }
        sums
    }

    /// `velocity ← velocity + Gᵀ P`.
    pub(crate) fn add_transposed(&self, percussion: &[f64], velocity: &mut [f64]) {
        for i in 0..self.contacts() {
            let own = &percussion[self.offsets[i]..self.offsets[i + 1]];
            for (j, block) in self.row(i) {
                let out = &mut velocity[self.offsets[j]..self.offsets[j + 1]];
                for (p, row) in own.iter().zip(block.chunks_exact(out.len())) {
                    for (value, g) in out.iter_mut().zip(row) {
                        *value += g * p;
                    }
                }
            }
        }
    }

    /// `velocity ← G P`.
    pub(crate) fn apply(&self, percussion: &[f64], velocity: &mut [f64]) {
        debug_assert_eq!((percussion.len(), velocity.len()), (self.rows(), self.rows()));
        if self.in_threes {
            let velocities = velocity.as_chunks_mut::<3>().0;
            for (sums, own) in velocities.iter_mut().zip(self.starts.windows(2)) {
                let places = own[0]..own[1];
                *sums = self.add_blocks_of_nine(places, percussion, [0.0; 3], |g, p| g * p);
            }
            return;
        }
        for i in 0..self.contacts() {
            let mut sum = [0.0; 4];
            self.add_row(i, percussion, true, &mut sum);
            let own = self.offsets[i]..self.offsets[i + 1];
            let size = own.len();
            velocity[own].copy_from_slice(&sum[..size]);
        }
    }
}

//! `G` of mechanisms that are kinematic trees, by the factors of their mass matrix.
//!
//! `M = Lᵀ D L` with `L` unit lower triangular has entries in row `i` of `L` only for the ancestors of velocity `i`: those of the
//! joints between it and the root of its tree [Featherstone2005]. With `Y = Wᵀ L⁻¹ D^{-1/2}` is `G = Y Yᵀ`, and a row of `Y` has
//! entries for the trees only that its row of `Wᵀ` moves.

use std::ops::Range;

use crate::argument::{ArgumentError, length, refuse};

/// The factors of a mass matrix.
#[derive(Debug, Clone, Default)]
pub struct TreeFactor {
    /// Where the ancestors of every velocity begin, ascending, itself the last of them; and where the last ones end.
    starts: Vec<usize>,
    ancestors: Vec<usize>,
    /// First velocity of every tree, and the number of velocities; the tree of every velocity.
    firsts: Vec<usize>,
    trees: Vec<usize>,
    /// `L`, with `D` on its diagonal, and `D^{-1/2}`.
    values: Vec<f64>,
    scale: Vec<f64>,
}

impl TreeFactor {
    /// For mass matrices whose lower triangle has these entries, compressed by rows: columns ascend within a row and end with its
    /// diagonal; `trees` is the number of the tree of every velocity, ascending.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] if they are not, or rows have entries of other trees.
    pub fn new(
        starts: Vec<usize>,
        ancestors: Vec<usize>,
        trees: Vec<usize>,
    ) -> Result<Self, ArgumentError> {
        length("starts", trees.len() + 1, starts.len())?;
        if starts[0] != 0 || starts[trees.len()] != ancestors.len() {
            return refuse("starts", "must begin with 0 and end with the number of entries");
        }
        let mut firsts = Vec::new();
        for (i, (own, &tree)) in starts.windows(2).zip(&trees).enumerate() {
            if tree == firsts.len() {
                firsts.push(i);
            }
            let row = ancestors.get(own[0]..own[1]).unwrap_or_default();
            let ascends = row.windows(2).all(|pair| pair[0] < pair[1]) && row.last() == Some(&i);
            if tree + 1 != firsts.len() || !ascends || row[0] < firsts[tree] {
                return refuse("ancestors", "must ascend within a tree and end with the velocity");
            }
        }
        firsts.push(trees.len());
        let (values, scale) = (vec![0.0; ancestors.len()], vec![0.0; trees.len()]);
        Ok(Self { starts, ancestors, firsts, trees, values, scale })
    }

    /// Takes in `L`, with `D` in place of its diagonal.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] if the numbers are not as many as those of the mass matrix, or `D` is not positive.
    pub fn refill(&mut self, values: &[f64]) -> Result<(), ArgumentError> {
        length("factor", self.values.len(), values.len())?;
        self.values.copy_from_slice(values);
        for (scale, own) in self.scale.iter_mut().zip(self.starts.windows(2)) {
            *scale = values[own[1] - 1].sqrt().recip();
            if !(*scale > 0.0 && scale.is_finite()) {
                return refuse("factor", "must have a positive diagonal");
            }
        }
        Ok(())
    }

    /// Number of velocities.
    pub fn velocities(&self) -> usize {
        self.trees.len()
    }

    /// The ancestors of a velocity with their entries of `L`.
    fn row(&self, i: usize) -> impl Iterator<Item = (usize, f64)> {
        let own = self.starts[i]..self.starts[i + 1] - 1;
        self.ancestors[own.clone()].iter().copied().zip(self.values[own].iter().copied())
    }

    /// `x ← D^{-1/2} L^{-T} x` of some trees.
    fn divide(&self, velocities: Range<usize>, x: &mut [f64]) {
        for i in velocities.rev() {
            let value = x[i];
            if value != 0.0 {
                self.row(i).for_each(|(j, entry)| x[j] -= entry * value);
                x[i] = self.scale[i] * value;
            }
        }
    }

    /// `x ← M⁻¹ x`.
    pub fn solve(&self, x: &mut [f64]) {
        self.divide(0..x.len(), x);
        self.divide_transposed(x);
    }

    /// `xᵀ M x`.
    pub(super) fn square(&self, x: &[f64]) -> f64 {
        let along = |i: usize| x[i] + self.row(i).map(|(j, entry)| entry * x[j]).sum::<f64>();
        (0..x.len()).map(|i| (along(i) / self.scale[i]).powi(2)).sum()
    }

    /// `x ← L⁻¹ D^{-1/2} x`.
    fn divide_transposed(&self, x: &mut [f64]) {
        for i in 0..x.len() {
            let taken: f64 = self.row(i).map(|(j, entry)| entry * x[j]).sum();
            x[i] = self.scale[i] * x[i] - taken;
        }
    }
}

/// Rows of `Y`, with `G = Y Yᵀ`.
#[derive(Debug, Clone, Default)]
pub struct TreeRows {
    /// Where the trees of every row begin, ascending, and where the last ones end.
    starts: Vec<usize>,
    trees: Vec<usize>,
    /// Where the entries of every tree of every row begin, and the last ones end.
    places: Vec<usize>,
    values: Vec<f64>,
    /// A row that is being made.
    row: Vec<f64>,
    /// Number of trees.
    count: usize,
}

impl TreeRows {
    /// Removes all rows.
    pub fn clear(&mut self, factor: &TreeFactor) {
        let Self { starts, trees, places, values, row, count } = self;
        trees.clear();
        values.clear();
        for list in [starts, places] {
            list.clear();
            list.push(0);
        }
        row.resize(factor.velocities(), 0.0);
        *count = factor.firsts.len() - 1;
    }

    /// Adds the row of this row of `Wᵀ`, of which columns may occur again and again.
    pub fn push(&mut self, factor: &TreeFactor, direction: impl Iterator<Item = (usize, f64)>) {
        let Self { starts, trees, places, values, row, .. } = self;
        let first = trees.len();
        for (column, value) in direction.filter(|(_, value)| *value != 0.0) {
            row[column] += value;
            let tree = factor.trees[column];
            if !trees[first..].contains(&tree) {
                trees.push(tree);
            }
        }
        trees[first..].sort_unstable();
        for &tree in &trees[first..] {
            let own = factor.firsts[tree]..factor.firsts[tree + 1];
            factor.divide(own.clone(), row);
            values.extend_from_slice(&row[own.clone()]);
            row[own].fill(0.0);
            places.push(values.len());
        }
        starts.push(trees.len());
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// All entries.
    pub(super) fn values(&self) -> &[f64] {
        &self.values
    }

    /// Trees of a row with its entries.
    fn parts(&self, row: usize) -> impl Iterator<Item = (usize, &[f64])> {
        let own = self.starts[row]..self.starts[row + 1];
        own.map(|k| (self.trees[k], &self.values[self.places[k]..self.places[k + 1]]))
    }

    /// Entry of `G`.
    pub fn product(&self, i: usize, j: usize) -> f64 {
        let mut sum = 0.0;
        for (tree, own) in self.parts(i) {
            for (_, other) in self.parts(j).filter(|(same, _)| *same == tree) {
                sum += own.iter().zip(other).map(|(a, b)| a * b).sum::<f64>();
            }
        }
        sum
    }

    /// A block of `G`.
    pub(super) fn products(&self, rows: Range<usize>, columns: Range<usize>, block: &mut [f64]) {
        for (row, entries) in rows.zip(block.chunks_exact_mut(columns.len())) {
            for (column, entry) in columns.clone().zip(entries) {
                *entry = self.product(row, column);
            }
        }
    }

    /// Lists for every item, with these rows, the items that move one of its trees, ascending; with a buffer for those of each tree.
    pub(super) fn connect(
        &self,
        rows: impl Iterator<Item = Range<usize>> + Clone,
        items: &mut Vec<Vec<usize>>,
        lists: &mut [Vec<usize>],
    ) {
        items.iter_mut().for_each(Vec::clear);
        items.resize_with(self.count, Vec::new);
        let of = |rows: Range<usize>| &self.trees[self.starts[rows.start]..self.starts[rows.end]];
        for (item, rows) in rows.clone().enumerate() {
            for &tree in of(rows) {
                if items[tree].last() != Some(&item) {
                    items[tree].push(item);
                }
            }
        }
        for (list, rows) in lists.iter_mut().zip(rows) {
            let own = of(rows);
            for (k, &tree) in own.iter().enumerate() {
                if !own[..k].contains(&tree) {
                    list.extend_from_slice(&items[tree]);
                }
            }
            list.sort_unstable();
            list.dedup();
        }
    }

    /// `M⁻¹ W P` from percussions of the rows, in place of `change`.
    pub fn change(&self, factor: &TreeFactor, percussion: &[f64], change: &mut Vec<f64>) {
        change.clear();
        change.resize(factor.velocities(), 0.0);
        for (row, p) in percussion.iter().enumerate().filter(|(_, p)| **p != 0.0) {
            for (tree, own) in self.parts(row) {
                let all = &mut change[factor.firsts[tree]..factor.firsts[tree + 1]];
                all.iter_mut().zip(own).for_each(|(sum, value)| *sum += p * value);
            }
        }
        factor.divide_transposed(change);
    }
}

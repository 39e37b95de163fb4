//! The rows of a step in the order of their keys, with the blocks of `G` between items that influence each other.

use std::ops::Range;

use super::trees::TreeRows;
use super::{DRIFT, ROUNDED};
use crate::argument::{ArgumentError, Fault, length, not_negative, refuse};
use crate::contact::{BlockMatrix, Csr, LARGEST};
use crate::law::Law;

/// The rows of one item.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rows {
    /// A contact with the law of this number: the normal row, then those of the law.
    Contact(usize),
    /// One row with `0 ≤ P ⊥ ξ ≥ 0`: a contact without friction, or a limit of a joint.
    Frictionless,
    /// One row with `ξ = 0` and a percussion of any sign: a joint.
    Bilateral,
    /// One row of dry friction, `|P|` at most this bound in N s or N m s, against `ξ`.
    DryFriction(f64),
}

impl Rows {
    /// Their number, if there is the law of a contact.
    pub(super) fn count(self, laws: &[Law]) -> Option<usize> {
        match self {
            Self::Contact(law) => laws.get(law).map(|law| 1 + law.dimension()),
            _ => Some(1),
        }
    }
}

/// `G = Wᵀ M⁻¹ W`, by which percussions change velocities; symmetric.
#[derive(Debug, Clone, Copy)]
pub enum Mobility<'a> {
    /// Every entry, row by row.
    Dense(&'a [f64]),
    /// The entries that are not zero.
    Sparse(&'a Csr),
    /// `Y` with `G = Y Yᵀ`.
    Trees(&'a TreeRows),
}

/// The rows of a step, item after item.
#[derive(Debug, Clone, Copy)]
pub struct StepRows<'a> {
    /// `G`, by rows in the order of the items.
    pub delassus: Mobility<'a>,
    /// `b`, the velocities without percussions.
    pub free_velocity: &'a [f64],
    /// What the rows are.
    pub items: &'a [Rows],
    /// A number per item, each once, by which it is known again in the next step; by default its place.
    pub keys: Option<&'a [u64]>,
    /// By what the rows of friction of each item were multiplied, which multiplies its friction; by default nothing.
    pub factors: Option<&'a [f64]>,
}

/// The rows of a step whose items are sorted by their keys; buffers.
#[derive(Debug, Clone, Default)]
pub(super) struct Arranged {
    /// The item as listed, and what its rows are.
    pub(super) order: Vec<usize>,
    pub(super) items: Vec<Rows>,
    pub(super) keys: Vec<u64>,
    pub(super) free_velocity: Vec<f64>,
    pub(super) mobility: BlockMatrix,
    /// First rows of items as listed.
    firsts: Vec<usize>,
    /// Item here and row in it of the rows as listed.
    places: Vec<(usize, usize)>,
    sizes: Vec<usize>,
    neighbours: Vec<Vec<usize>>,
    /// Items that move each tree.
    movers: Vec<Vec<usize>>,
}

impl Arranged {
    /// Sorts and checks the rows of a step.
    pub(super) fn arrange(
        &mut self,
        rows: &StepRows<'_>,
        laws: &[Law],
    ) -> Result<(), ArgumentError> {
        let (count, all) = (rows.items.len(), rows.free_velocity.len());
        self.firsts.clear();
        let mut first = 0;
        for (item, kind) in rows.items.iter().enumerate() {
            if let Rows::DryFriction(bound) = *kind {
                not_negative("bounds", bound).map_err(|error| error.within("item", item))?;
            }
            self.firsts.push(first);
            first += match kind.count(laws) {
                Some(size) => size,
                None => {
                    let laws = laws.len();
                    let message = format!(
                        "item {item} must be the number of one of {laws} laws, or a kind of row"
                    );
                    return refuse("items", message);
                }
            };
        }
        if first != all {
            let message =
                format!("must have an entry for each of the {first} rows of items, has {all}");
            return Err(ArgumentError { argument: "free_velocity", message, fault: Fault::Size });
        }
        rows.factors.map_or(Ok(()), |factors| length("factors", count, factors.len()))?;
        check_size("free_velocity", rows.free_velocity)?;
        self.order.clear();
        self.order.extend(0..count);
        if let Some(keys) = rows.keys {
            length("keys", count, keys.len())?;
            self.order.sort_unstable_by_key(|&item| keys[item]);
            if let Some(pair) = self.order.windows(2).find(|pair| keys[pair[0]] == keys[pair[1]]) {
                let message =
                    format!("must differ, those of items {} and {} are the same", pair[0], pair[1]);
                return refuse("keys", message);
            }
        }
        let Self { order, items, keys, free_velocity, firsts, places, sizes, .. } = self;
        items.clear();
        items.extend(order.iter().map(|&item| rows.items[item]));
        keys.clear();
        keys.extend(order.iter().map(|&item| rows.keys.map_or(item as u64, |keys| keys[item])));
        sizes.clear();
        free_velocity.clear();
        places.resize(all, (0, 0));
        for (place, &item) in order.iter().enumerate() {
            let first = firsts[item];
            let past = firsts.get(item + 1).copied().unwrap_or(all);
            sizes.push(past - first);
            free_velocity.extend_from_slice(&rows.free_velocity[first..past]);
            (first..past).for_each(|row| places[row] = (place, row - first));
        }
        self.fill(rows.delassus)?;
        self.check(matches!(rows.delassus, Mobility::Trees(_)))
    }

    /// Finds the blocks and their entries.
    fn fill(&mut self, mobility: Mobility<'_>) -> Result<(), ArgumentError> {
        let Self { order, mobility: blocks, firsts, places, sizes, neighbours, movers, .. } = self;
        let (count, all) = (order.len(), places.len());
        if neighbours.len() < count {
            neighbours.resize_with(count, Vec::new);
        }
        let lists = &mut neighbours[..count];
        lists.iter_mut().for_each(Vec::clear);
        let rows = |place: usize| firsts[order[place]]..firsts[order[place]] + sizes[place];
        match mobility {
            Mobility::Dense(entries) => {
                length("delassus", all * all, entries.len())?;
                check_size("delassus", entries)?;
                for (place, list) in lists.iter_mut().enumerate() {
                    let meets = |other: &usize| {
                        let columns = rows(*other);
                        rows(place).any(|row| {
                            let own = &entries[row * all..(row + 1) * all][columns.clone()];
                            own.iter().any(|&value| value != 0.0)
                        })
                    };
                    list.extend((0..count).filter(meets));
                }
            }
            Mobility::Sparse(matrix) => {
                length("delassus", all, matrix.rows())?;
                length("delassus", all, matrix.columns())?;
                check_size("delassus", matrix.values())?;
                for (place, list) in lists.iter_mut().enumerate() {
                    for row in rows(place) {
                        list.extend(matrix.row(row).0.iter().map(|&column| places[column].0));
                    }
                    list.sort_unstable();
                    list.dedup();
                }
            }
            Mobility::Trees(own) => {
                length("delassus", all, own.rows())?;
                check_size("delassus", own.values())?;
                own.connect((0..count).map(rows), movers, lists);
            }
        }
        blocks.reset(sizes, lists.iter().map(|list| list.iter().copied()));
        match mobility {
            Mobility::Sparse(matrix) => {
                for row in 0..all {
                    let (place, offset) = places[row];
                    let (columns, values) = matrix.row(row);
                    for (&column, &value) in columns.iter().zip(values) {
                        let (other, at) = places[column];
                        let Ok(k) = blocks.neighbours(place).binary_search(&other) else {
                            continue;
                        };
                        blocks.block_mut(place, k).1[offset * sizes[other] + at] = value;
                    }
                }
            }
            Mobility::Dense(entries) => {
                for place in 0..count {
                    for k in 0..blocks.neighbours(place).len() {
                        let (other, block) = blocks.block_mut(place, k);
                        let columns = rows(other);
                        for (row, own) in rows(place).zip(block.chunks_exact_mut(sizes[other])) {
                            own.copy_from_slice(
                                &entries[row * all..(row + 1) * all][columns.clone()],
                            );
                        }
                    }
                }
            }
            Mobility::Trees(own) => {
                for place in 0..count {
                    for k in 0..blocks.neighbours(place).len() {
                        let (other, block) = blocks.block_mut(place, k);
                        if other >= place {
                            own.products(rows(place), rows(other), block);
                        } else {
                            blocks.mirror(place, k);
                        }
                    }
                }
            }
        }
        Ok(())
    }

    /// Refuses matrices that are those of no mechanism.
    fn check(&self, is_symmetric: bool) -> Result<(), ArgumentError> {
        for place in 0..self.items.len() {
            let size = self.sizes[place];
            if (0..size).any(|a| self.mobility.diagonal(place)[a * size + a] < 0.0) {
                return refuse("delassus", "must not be negative on its diagonal");
            }
        }
        if is_symmetric {
            return Ok(());
        }
        let rounding = || {
            let own = |place| (0..self.sizes[place]).map(move |a| self.own(place, a, a));
            ROUNDED * (0..self.items.len()).flat_map(own).fold(0.0, f64::max)
        };
        for place in 0..self.items.len() {
            for (other, block) in self.mobility.row(place) {
                let back = self.mobility.between(other, place);
                for (a, row) in block.chunks_exact(self.sizes[other]).enumerate() {
                    for (b, entry) in row.iter().enumerate() {
                        let reverse = back.map_or(0.0, |back| back[b * self.sizes[place] + a]);
                        if *entry == reverse {
                            continue;
                        }
                        let scale = (self.own(place, a, a) * self.own(other, b, b)).sqrt();
                        if (entry - reverse).abs() > DRIFT * scale + rounding() {
                            return refuse("delassus", "must be symmetric");
                        }
                    }
                }
            }
        }
        Ok(())
    }

    /// Number of rows.
    pub(super) fn len(&self) -> usize {
        self.free_velocity.len()
    }

    /// Rows of an item.
    pub(super) fn rows(&self, place: usize) -> Range<usize> {
        let offsets = self.mobility.offsets();
        offsets[place]..offsets[place + 1]
    }

    /// Entry of the own block of an item.
    pub(super) fn own(&self, place: usize, a: usize, b: usize) -> f64 {
        self.mobility.diagonal(place)[a * self.sizes[place] + b]
    }

    pub(super) fn largest_velocity(&self) -> f64 {
        self.free_velocity.iter().fold(0.0, |most, value| f64::max(most, value.abs()))
    }

    /// Values of items or rows in the order in which they are listed.
    pub(super) fn list_items<T: Copy>(&self, sorted: &[T], listed: &mut Vec<T>) {
        listed.clear();
        listed.extend_from_slice(sorted);
        self.order.iter().zip(sorted).for_each(|(&item, &value)| listed[item] = value);
    }

    pub(super) fn list_rows(&self, sorted: &[f64], listed: &mut Vec<f64>) {
        listed.clear();
        let offsets = self.mobility.offsets();
        listed.extend(self.places.iter().map(|&(place, at)| sorted[offsets[place] + at]));
    }
}

/// Refuses what cannot be squared.
fn check_size(argument: &'static str, values: &[f64]) -> Result<(), ArgumentError> {
    // Also what is not a number.
    if values.iter().any(|value| !(value.abs() <= LARGEST)) {
        return refuse(argument, "must be finite and at most 1e100");
    }
    Ok(())
}

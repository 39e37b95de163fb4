//! The contact problem that is left of a mechanism's rows: its contacts, and how their rows follow from those of the mechanism.

use std::ops::Range;

use super::freedom::Freedom;
use crate::contact::BlockMatrix;

/// Mobility, relative to that along the other direction, which is lent to a direction that nothing moves but that slides: slip has to
/// turn towards the force, and turns by so much.
const LENT: f64 = 1e-11;

/// How the friction of a contact is found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Friction {
    /// By the law of this number.
    Law(usize),
    /// There is none.
    Frictionless,
    /// Its percussion is bounded.
    Dry,
}

/// A contact of the problem that is left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Member {
    pub(super) item: usize,
    /// Its first row in the mechanism.
    pub(super) first: usize,
    /// Its number of directions of friction there.
    pub(super) dimension: usize,
    pub(super) friction: Friction,
    pub(super) freedom: Freedom,
}

impl Member {
    /// Its rows of friction in the mechanism.
    pub(super) fn friction_rows(&self) -> Range<usize> {
        self.first + 1..self.first + 1 + self.dimension
    }
}

/// A row of the problem: the sum of a row of the mechanism and the next one with these weights, or the row that a contact without
/// friction has to have, which nothing moves.
#[derive(Debug, Clone, Copy)]
pub(super) enum Row {
    Of { first: usize, weights: [f64; 2] },
    Idle { beside: usize },
}

/// Contacts, rows and blocks of the problem.
#[derive(Debug, Clone, Default)]
pub(super) struct Layout {
    pub(super) members: Vec<Member>,
    pub(super) rows: Vec<Row>,
    pub(super) sizes: Vec<usize>,
    /// Contacts that influence each other, ascending.
    neighbours: Vec<Vec<usize>>,
}

impl Layout {
    pub(super) fn clear(&mut self) {
        self.members.clear();
        self.rows.clear();
        self.sizes.clear();
    }

    /// Adds a contact, if anything moves it.
    pub(super) fn add(&mut self, member: Member) {
        let Member { first, dimension, friction, freedom, .. } = member;
        let before = self.rows.len();
        let row = |first| Row::Of { first, weights: [1.0, 0.0] };
        match (friction, freedom) {
            (_, Freedom::None) => return,
            (Friction::Dry, _) => self.rows.push(row(first)),
            (Friction::Frictionless, _) | (_, Freedom::Normal) => {
                self.rows.extend([row(first), Row::Idle { beside: first }]);
            }
            (_, Freedom::Line(weights)) => {
                self.rows.extend([row(first), Row::Of { first: first + 1, weights }]);
            }
            (_, Freedom::All | Freedom::Across(_)) => {
                self.rows.extend((first..=first + dimension).map(row))
            }
        }
        self.members.push(member);
        self.sizes.push(self.rows.len() - before);
    }

    /// Finds which contacts influence each other by entries of the mechanism.
    pub(super) fn connect(&mut self, entry: &impl Fn(usize, usize) -> f64) {
        let Self { rows, sizes, neighbours, .. } = self;
        neighbours.resize_with(sizes.len(), Vec::new);
        let mut start = 0;
        for (list, &size) in neighbours.iter_mut().zip(&*sizes) {
            list.clear();
            let own = &rows[start..start + size];
            start += size;
            let mut first = 0;
            for (j, &other) in sizes.iter().enumerate() {
                let columns = &rows[first..first + other];
                first += other;
                if own.iter().any(|a| columns.iter().any(|b| combined(*a, *b, entry) != 0.0)) {
                    list.push(j);
                }
            }
        }
    }

    /// Whether the problem of another one has the same laws and blocks.
    pub(super) fn fits(&self, other: &Self) -> bool {
        let alike = |a: &Member, b: &Member| (a.friction, a.freedom) == (b.friction, b.freedom);
        self.members.len() == other.members.len()
            && self.members.iter().zip(&other.members).all(|(a, b)| alike(a, b))
            && self.neighbours[..self.sizes.len()] == other.neighbours[..other.sizes.len()]
    }

    /// Blocks of zeros.
    pub(super) fn blocks(&self) -> BlockMatrix {
        BlockMatrix::with_pattern(&self.sizes, &self.neighbours)
    }

    /// Writes the entries into blocks of this pattern.
    pub(super) fn fill(&self, blocks: &mut BlockMatrix, entry: &impl Fn(usize, usize) -> f64) {
        for i in 0..self.sizes.len() {
            for k in 0..blocks.neighbours(i).len() {
                let (row, j) = (blocks.offsets()[i], blocks.neighbours(i)[k]);
                let (column, width) = (blocks.offsets()[j], blocks.size(j));
                let (_, block) = blocks.block_mut(i, k);
                for (at, value) in block.iter_mut().enumerate() {
                    let (a, b) = (row + at / width, column + at % width);
                    *value = match (self.rows[a], self.rows[b]) {
                        // Any mobility will do for a row that nothing moves.
                        (Row::Idle { beside }, Row::Idle { .. }) if a == b => entry(beside, beside),
                        (a, b) => combined(a, b, entry),
                    };
                }
                if let (true, Freedom::Across([x, y])) = (i == j, self.members[i].freedom) {
                    let lent = LENT * (block[4] + block[8]);
                    let [a, c, d] = [y * y, -x * y, x * x].map(|part| lent * part);
                    for (at, part) in [(4, a), (5, c), (7, c), (8, d)] {
                        block[at] += part;
                    }
                }
            }
        }
    }
}

/// The entry of two rows.
fn combined(a: Row, b: Row, entry: &impl Fn(usize, usize) -> f64) -> f64 {
    let (Row::Of { first: i, weights: v }, Row::Of { first: j, weights: w }) = (a, b) else {
        return 0.0;
    };
    let mut sum = 0.0;
    for (i, v) in (i..).zip(v).filter(|(_, v)| *v != 0.0) {
        for (j, w) in (j..).zip(w).filter(|(_, w)| *w != 0.0) {
            sum += v * w * entry(i, j);
        }
    }
    sum
}

impl Row {
    /// The value of the row from those of the mechanism.
    pub(super) fn of(self, values: impl Fn(usize) -> f64) -> f64 {
        match self {
            Self::Idle { .. } => 0.0,
            Self::Of { first, weights: [one, next] } => {
                one * values(first) + if next == 0.0 { 0.0 } else { next * values(first + 1) }
            }
        }
    }
}

//! The contact problem that is left of a mechanism's rows: its contacts, and how their rows follow from those of the mechanism.

use std::ops::Range;

use super::arranged::Arranged;
use super::freedom::Freedom;
use super::joints::Joints;
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
    /// Its place among the items.
    pub(super) place: usize,
    /// Its first row in the mechanism.
    pub(super) first: usize,
    /// Its number of directions of friction there.
    pub(super) dimension: usize,
    pub(super) friction: Friction,
    pub(super) freedom: Freedom,
    /// Whether joints influence it.
    pub(super) is_held: bool,
}

impl Member {
    /// Its rows of friction in the mechanism.
    pub(super) fn friction_rows(&self) -> Range<usize> {
        self.first + 1..self.first + 1 + self.dimension
    }
}

/// A row of the problem: the sum of a row of the mechanism and the next one with these weights.
#[derive(Debug, Clone, Copy)]
pub(super) struct Row {
    pub(super) first: usize,
    pub(super) weights: [f64; 2],
}

/// Contacts, rows and blocks of the problem.
#[derive(Debug, Clone, Default)]
pub(super) struct Layout {
    pub(super) members: Vec<Member>,
    pub(super) rows: Vec<Row>,
    pub(super) sizes: Vec<usize>,
    /// Contacts that influence each other, ascending.
    neighbours: Vec<Vec<usize>>,
    /// First row of every contact, and the contact of every item that is one.
    starts: Vec<usize>,
    contacts: Vec<Option<usize>>,
    /// Contacts that joints influence.
    held: Vec<usize>,
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
        let row = |first| Row { first, weights: [1.0, 0.0] };
        match (friction, freedom) {
            (_, Freedom::None) => return,
            (Friction::Dry | Friction::Frictionless, _) | (_, Freedom::Normal) => {
                self.rows.push(row(first));
            }
            (_, Freedom::Line(weights)) => {
                self.rows.extend([row(first), Row { first: first + 1, weights }]);
            }
            (_, Freedom::All | Freedom::Across(_)) => {
                self.rows.extend((first..=first + dimension).map(row))
            }
        }
        self.members.push(member);
        self.sizes.push(self.rows.len() - before);
    }

    /// Finds which contacts influence each other, among joints.
    pub(super) fn connect(&mut self, step: &Arranged, joints: &Joints) {
        let Self { members, rows, sizes, neighbours, starts, contacts, held } = self;
        contacts.clear();
        contacts.resize(step.items.len(), None);
        starts.clear();
        held.clear();
        let mut start = 0;
        for (i, (member, size)) in members.iter().zip(&*sizes).enumerate() {
            contacts[member.place] = Some(i);
            starts.push(start);
            start += size;
            if member.is_held {
                held.push(i);
            }
        }
        if neighbours.len() < members.len() {
            neighbours.resize_with(members.len(), Vec::new);
        }
        for (i, (member, list)) in members.iter().zip(&mut *neighbours).enumerate() {
            list.clear();
            list.extend(step.mobility.neighbours(member.place).iter().filter_map(|&k| contacts[k]));
            if member.is_held {
                list.extend(&*held);
                list.sort_unstable();
                list.dedup();
            }
            list.retain(|&j| {
                if let Some(block) = unchanged(step, member, &members[j]) {
                    return block.iter().any(|&value| value != 0.0);
                }
                let entry = entries(step, joints, member, &members[j]);
                let own = &rows[starts[i]..starts[i] + sizes[i]];
                let other = &rows[starts[j]..starts[j] + sizes[j]];
                own.iter().any(|a| other.iter().any(|b| combined(*a, *b, &entry) != 0.0))
            });
        }
    }

    /// Whether an item is one of the contacts.
    pub(super) fn moves(&self, place: usize) -> bool {
        self.contacts[place].is_some()
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
        BlockMatrix::with_pattern(&self.sizes, &self.neighbours[..self.sizes.len()])
    }

    /// Writes the entries into blocks of this pattern.
    pub(super) fn fill(&self, blocks: &mut BlockMatrix, step: &Arranged, joints: &Joints) {
        for (i, member) in self.members.iter().enumerate() {
            for k in 0..blocks.neighbours(i).len() {
                let (row, j) = (blocks.offsets()[i], blocks.neighbours(i)[k]);
                let (column, width) = (blocks.offsets()[j], blocks.size(j));
                let (_, block) = blocks.block_mut(i, k);
                if let Some(own) = unchanged(step, member, &self.members[j]) {
                    block.copy_from_slice(own);
                    continue;
                }
                let entry = entries(step, joints, member, &self.members[j]);
                for (at, value) in block.iter_mut().enumerate() {
                    let (a, b) = (row + at / width, column + at % width);
                    *value = combined(self.rows[a], self.rows[b], &entry);
                }
                if let (true, Freedom::Across([x, y])) = (i == j, member.freedom) {
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

/// The block of the mechanism between two contacts, where it is that of the problem, too.
fn unchanged<'a>(step: &'a Arranged, one: &Member, other: &Member) -> Option<&'a [f64]> {
    let keeps = |member: &Member| member.freedom == Freedom::All && !member.is_held;
    if keeps(one) && keeps(other) { step.mobility.between(one.place, other.place) } else { None }
}

/// Entries of the mechanism between rows of two contacts, with joints eliminated.
fn entries<'a>(
    step: &'a Arranged,
    joints: &'a Joints,
    one: &Member,
    other: &Member,
) -> impl Fn(usize, usize) -> f64 + 'a {
    let block = step.mobility.between(one.place, other.place);
    let (row, columns) = (one.first, step.rows(other.place));
    move |i, j| {
        let at = (i - row) * columns.len() + j - columns.start;
        block.map_or(0.0, |block| block[at]) - joints.entry(i, j)
    }
}

/// The entry of two rows.
fn combined(a: Row, b: Row, entry: impl Fn(usize, usize) -> f64) -> f64 {
    let mut sum = 0.0;
    for (i, v) in (a.first..).zip(a.weights).filter(|(_, v)| *v != 0.0) {
        for (j, w) in (b.first..).zip(b.weights).filter(|(_, w)| *w != 0.0) {
            sum += v * w * entry(i, j);
        }
    }
    sum
}

impl Row {
    /// The value of the row from those of the mechanism.
    pub(super) fn of(self, values: impl Fn(usize) -> f64) -> f64 {
        let Self { first, weights: [one, next] } = self;
        one * values(first) + if next == 0.0 { 0.0 } else { next * values(first + 1) }
    }
}

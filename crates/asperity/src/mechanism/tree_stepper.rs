//! Steps of kinematic trees: which limits and contacts close, and the velocities afterwards.

use super::ROUNDED;
use super::arranged::{Mobility, Rows, StepRows};
use super::closing;
use super::stepper::ContactStepper;
use super::trees::{TreeFactor, TreeRows};
use crate::argument::{ArgumentError, finite, length, refuse};
use crate::law::Law;
use crate::solver::{SolveReport, Solver, Stop};

/// Sine of the angle to the normal below which an axis has no direction on the surface.
const PARALLEL: f64 = 1e-6;

/// A limit or contact that an engine lists.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unilateral {
    /// Its first row, that of its gap, in the Jacobian of the engine.
    pub row: usize,
    /// Its rows in a step.
    pub rows: Rows,
    /// Those without drilling, its fourth row, where nothing turns the bodies about the normal; none if they are the same.
    pub flat: Option<Rows>,
    /// A number by which it is known again in the next step.
    pub key: u64,
    /// Of the velocity with which it closes, in [0, 1].
    pub restitution: f64,
}

/// What an engine lists, in the order of its rows.
#[derive(Debug, Clone, Default)]
pub struct Listed {
    /// Rows of equalities.
    pub bilateral: usize,
    /// Rows of dry joints, which follow.
    pub dry: usize,
    /// Limits and contacts.
    pub unilateral: Vec<Unilateral>,
}

/// The Jacobian of an engine, row by row.
#[derive(Debug, Clone, Copy)]
pub enum Jacobian<'a> {
    /// Every entry.
    Dense(&'a [f64]),
    /// The entries that are kept.
    Sparse {
        /// Number of entries of every row.
        counts: &'a [i32],
        /// The first of them.
        firsts: &'a [i32],
        /// Columns of the entries.
        columns: &'a [i32],
        /// The entries.
        values: &'a [f64],
    },
}

/// Writes the force of a contact, the normal part and those along the tangents, along the edges of a friction pyramid with these
/// coefficients: `f_N/2p ± f_k/2μ_k` along `n ± μ_k t_k`. A contact without friction has one edge.
pub fn pyramid_edges(force: &[f64], friction: impl Iterator<Item = f64>, edges: &mut [f64]) {
    if let (&[normal, ref along @ ..], [_, _, ..]) = (force, &*edges) {
        let share = normal / edges.len() as f64;
        for ((pair, part), mu) in edges.chunks_exact_mut(2).zip(along).zip(friction) {
            let across = 0.5 * part / mu;
            pair.copy_from_slice(&[share + across, share - across]);
        }
    } else {
        edges.copy_from_slice(&force[..edges.len()]);
    }
}

/// What carries the first axis of a law, and how.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    /// In the axes of what carries it.
    pub axis: [f64; 3],
    /// Whether the slip is that of the first of the pair.
    pub is_reversed: bool,
    /// Of the contact patch, in m.
    pub radius: f64,
}

/// Rows of a law by those of an engine: its axes in the tangents, and the length by which a turn is multiplied.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turn {
    axes: [[f64; 2]; 2],
    radius: f64,
    factor: f64,
}

impl Turn {
    /// Multiplies the friction of the law: its rows are longer by so much.
    pub fn scaled(self, factor: f64) -> Self {
        let axes = self.axes.map(|axis| axis.map(|part| factor * part));
        Self { axes, radius: factor * self.radius, factor: factor * self.factor }
    }
}

impl Axis {
    /// The axes `e₁`, which is the axis projected on the surface, and `e₂`, with a rotation matrix of what carries the axis and the
    /// tangents of the engine, row by row. Where the axis is parallel to the normal, the next one takes its place.
    pub fn turn(&self, rotation: &[f64; 9], tangents: &[f64; 6]) -> Turn {
        let largest = (0..3)
            .fold(0, |most, k| if self.axis[k].abs() > self.axis[most].abs() { k } else { most });
        let mut next = [0.0; 3];
        next[(largest + 1) % 3] = 1.0;
        let along = |axis: &[f64; 3]| {
            let turned: [f64; 3] =
                [0, 1, 2].map(|i| (0..3).map(|j| rotation[3 * i + j] * axis[j]).sum());
            [0, 3].map(|t| (0..3).map(|i| tangents[t + i] * turned[i]).sum::<f64>())
        };
        let mut direction = along(&self.axis);
        if direction[0].hypot(direction[1]) <= PARALLEL {
            direction = along(&next);
        }
        let length = direction[0].hypot(direction[1]);
        let [cos, sin] = direction.map(|part| part / length);
        let first = if self.is_reversed { [-cos, -sin] } else { [cos, sin] };
        Turn { axes: [first, [-sin, cos]], radius: self.radius, factor: 1.0 }
    }
}

/// A row of a step: the sum of one or two rows of the engine, and what is added to its velocity.
#[derive(Debug, Clone, Copy)]
struct StepRow {
    rows: [usize; 2],
    weights: [f64; 2],
    added: f64,
}

/// The settings of a step.
#[derive(Clone, Copy)]
pub struct Closing<'a> {
    /// The time in s in which a gap may close.
    pub time: f64,
    /// Part of the fastest approach with which what was left out may still close.
    pub exact: f64,
    /// When a solve ends.
    pub stop: Stop<'a>,
}

/// Solves the steps of a mechanism of kinematic trees by the Jacobian and the mass matrix of an engine.
///
/// Of the limits and contacts that are listed those take part that close faster than percussions can move the others, and those
/// that close nevertheless. What takes part is solved by a [`ContactStepper`].
#[derive(Debug, Clone)]
pub struct TreeStepper {
    stepper: ContactStepper,
    /// The factors of the mass matrix, to be refilled.
    pub factor: TreeFactor,
    listed: Listed,
    /// Of every limit and contact.
    gaps: Vec<f64>,
    turns: Vec<Option<Turn>>,
    /// Velocities of rows that come from outside the trees; none where nothing moves them.
    driven: Vec<f64>,
    bounds: Vec<f64>,
    jacobian: Rowwise,
    /// Velocities in m/s that are added to those of limits and contacts, those before, and a buffer.
    added: Vec<f64>,
    opening: Vec<f64>,
    /// What takes part, and whether that is known at this place.
    near: Vec<bool>,
    is_chosen: bool,
    items: Vec<Rows>,
    keys: Vec<u64>,
    factors: Vec<f64>,
    rows: Vec<StepRow>,
    directions: TreeRows,
    free: Vec<f64>,
    change: Vec<f64>,
    /// Velocities of the trees without percussions, and those of the last step.
    given: Vec<f64>,
    solved: Vec<f64>,
}

/// A sparse matrix, row by row.
#[derive(Debug, Clone, Default)]
struct Rowwise {
    starts: Vec<usize>,
    entries: Vec<(usize, f64)>,
}

impl Rowwise {
    fn row(&self, row: usize) -> &[(usize, f64)] {
        &self.entries[self.starts[row]..self.starts[row + 1]]
    }

    fn dot(&self, row: usize, x: &[f64]) -> f64 {
        self.row(row).iter().map(|&(column, value)| value * x[column]).sum()
    }
}

/// The velocity from outside the trees of a row.
fn part(driven: &[f64], row: usize) -> f64 {
    driven.get(row).copied().unwrap_or(0.0)
}

impl TreeStepper {
    /// A stepper that knows no rows yet.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] as [`ContactStepper::new`].
    pub fn new(laws: Vec<Law>, solver: Solver, factor: TreeFactor) -> Result<Self, ArgumentError> {
        Ok(Self {
            stepper: ContactStepper::new(laws, solver)?,
            factor,
            listed: Listed::default(),
            gaps: Vec::new(),
            turns: Vec::new(),
            driven: Vec::new(),
            bounds: Vec::new(),
            jacobian: Rowwise::default(),
            added: Vec::new(),
            opening: Vec::new(),
            near: Vec::new(),
            is_chosen: false,
            items: Vec::new(),
            keys: Vec::new(),
            factors: Vec::new(),
            rows: Vec::new(),
            directions: TreeRows::default(),
            free: Vec::new(),
            change: Vec::new(),
            given: Vec::new(),
            solved: Vec::new(),
        })
    }

    /// Takes in what the engine lists.
    pub fn list(&mut self, listed: Listed) {
        self.listed = listed;
    }

    /// Takes in the rows at a place: the Jacobian, gaps in m or rad and bounds in N s of dry joints.
    ///
    /// Of rows that nothing can move, gaps do not close.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] if they are not those of what is listed.
    pub fn place(
        &mut self,
        jacobian: Jacobian<'_>,
        gaps: impl Iterator<Item = f64>,
        bounds: impl Iterator<Item = f64>,
    ) -> Result<(), ArgumentError> {
        let Rowwise { starts, entries } = &mut self.jacobian;
        let velocities = self.factor.velocities();
        starts.clear();
        entries.clear();
        starts.push(0);
        let is_there = |entry: &(usize, f64)| entry.1 != 0.0;
        match jacobian {
            Jacobian::Dense(values) if velocities > 0 => {
                for row in values.chunks_exact(velocities) {
                    entries.extend(row.iter().copied().enumerate().filter(is_there));
                    starts.push(entries.len());
                }
            }
            Jacobian::Dense(_) => {}
            Jacobian::Sparse { counts, firsts, columns, values } => {
                for (&count, &first) in counts.iter().zip(firsts) {
                    let own = first as usize..first as usize + count as usize;
                    let (Some(columns), Some(values)) = (columns.get(own.clone()), values.get(own))
                    else {
                        return refuse("jacobian", "must have the entries of its rows");
                    };
                    let columns = columns.iter().map(|&column| column as usize);
                    entries.extend(columns.zip(values.iter().copied()).filter(is_there));
                    starts.push(entries.len());
                }
            }
        }
        if entries.iter().any(|&(column, _)| column >= velocities) {
            return refuse("jacobian", "must have a column per velocity");
        }
        let Listed { bilateral, dry, unilateral } = &self.listed;
        let laws = self.stepper.laws();
        let past = |u: &Unilateral| u.rows.count(laws).map_or(usize::MAX, |count| u.row + count);
        if unilateral.iter().map(past).fold(bilateral + dry, usize::max) >= starts.len() {
            return refuse("jacobian", "must have the rows of what is listed");
        }
        self.gaps.clear();
        let moves = |u: &Unilateral| starts[u.row] < starts[u.row + 1];
        let own = unilateral.iter().zip(gaps);
        self.gaps.extend(own.map(|(u, gap)| if moves(u) { gap } else { f64::INFINITY }));
        length("gaps", unilateral.len(), self.gaps.len())?;
        self.bounds.clear();
        self.bounds.extend(bounds.take(*dry));
        length("bounds", *dry, self.bounds.len())?;
        self.turns.clear();
        self.turns.resize(unilateral.len(), None);
        self.driven.clear();
        self.is_chosen = false;
        Ok(())
    }

    /// Turns the rows of a limit or contact at this place to the axes of its law.
    pub fn turn(&mut self, number: usize, turn: Turn) {
        self.turns[number] = Some(turn);
    }

    /// Adds velocities from outside the trees, as of surfaces or guided bodies, to all rows at this place.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] if they are not as many as the rows, or not finite.
    pub fn drive(&mut self, velocities: &[f64]) -> Result<(), ArgumentError> {
        length("velocities", self.jacobian.starts.len().saturating_sub(1), velocities.len())?;
        finite("velocities", velocities)?;
        self.driven.clear();
        self.driven.extend_from_slice(velocities);
        self.is_chosen = false;
        Ok(())
    }

    /// Takes in the velocities without percussions, by accelerations that forces cause at the velocities `at`; whether they and their
    /// squares are finite. With `damping`, `h` times that of the joints, which is part of the mass matrix, forces are those of `at` and
    /// damping those at the end of the step.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] if numbers are not as many as the velocities of the trees.
    pub fn accelerate(
        &mut self,
        acceleration: &[f64],
        before: &[f64],
        at: &[f64],
        h: f64,
        damping: Option<&[f64]>,
    ) -> Result<bool, ArgumentError> {
        let velocities = self.factor.velocities();
        for list in [acceleration, before, at].into_iter().chain(damping) {
            length("velocity", velocities, list.len())?;
        }
        let Self { given, change, factor, .. } = self;
        given.clear();
        given.extend(acceleration.iter().zip(before).map(|(a, v)| h * a + v));
        if let Some(damping) = damping {
            change.clear();
            change.extend(damping.iter().zip(at).zip(before).map(|((d, at), v)| d * (at - v)));
            factor.solve(change);
            given.iter_mut().zip(change).for_each(|(free, change)| *free += *change);
        }
        Ok(given.iter().map(|v| v * v).sum::<f64>().is_finite())
    }

    /// The velocities without percussions.
    pub fn free_velocity(&self) -> &[f64] {
        &self.given
    }

    /// Solves a step from the velocities without percussions; `None` if nothing takes part. What equalities have of the velocities
    /// `before` is reflected, and a part of those with which gaps would close, where there is restitution.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] as [`ContactStepper::step`], or if velocities are not finite, or not as many as those of the trees.
    pub fn step(
        &mut self,
        before: &[f64],
        closing: Closing<'_>,
    ) -> Result<Option<SolveReport>, ArgumentError> {
        length("free_velocity", self.factor.velocities(), self.given.len())?;
        length("velocity", self.factor.velocities(), before.len())?;
        finite("free_velocity", &self.given)?;
        self.solved.clone_from(&self.given);
        let free = std::mem::take(&mut self.given);
        let report = self.step_from(&free, before, closing);
        self.given = free;
        report
    }

    fn step_from(
        &mut self,
        free: &[f64],
        before: &[f64],
        closing: Closing<'_>,
    ) -> Result<Option<SolveReport>, ArgumentError> {
        let Closing { time, exact, stop } = closing;
        let Self { jacobian, listed, gaps, added, opening, driven, .. } = &mut *self;
        opening.clear();
        opening.extend(listed.unilateral.iter().zip(&*gaps).map(|(u, gap)| {
            let (opening, driven) = (gap.max(0.0) / time, part(driven, u.row));
            if u.restitution == 0.0 {
                return driven + opening;
            }
            let closing = jacobian.dot(u.row, before) + driven;
            driven + if closing + opening < 0.0 { u.restitution * closing } else { opening }
        }));
        if opening != added {
            std::mem::swap(opening, added);
            self.is_chosen = false;
        }
        let approach = |this: &Self, k: usize, velocity: &[f64]| {
            this.jacobian.dot(this.listed.unilateral[k].row, velocity) + this.added[k]
        };
        let count = self.listed.unilateral.len();
        // Percussions change velocities by about the largest of those with which items close.
        let fastest = -(0..count).map(|k| approach(self, k, free)).fold(0.0, f64::min);
        self.is_chosen &= self.near.len() == count;
        self.near.resize(count, false);
        for k in 0..count {
            let is_near = approach(self, k, free) < fastest;
            self.is_chosen &= is_near == self.near[k];
            self.near[k] = is_near;
        }
        loop {
            if !self.is_chosen {
                self.choose();
            }
            self.change.clear();
            if self.items.is_empty() {
                self.free.clear();
                self.change.extend_from_slice(free);
                return Ok(None);
            }
            let Self { jacobian, rows, listed, free: own, .. } = &mut *self;
            own.clear();
            own.extend(rows.iter().enumerate().map(|(i, row)| {
                let velocity = |k: usize| row.weights[k] * jacobian.dot(row.rows[k], free);
                let reflected = if i < listed.bilateral { jacobian.dot(i, before) } else { 0.0 };
                let second = if row.weights[1] == 0.0 { 0.0 } else { velocity(1) };
                velocity(0) + second + row.added + reflected
            }));
            let rows = StepRows {
                delassus: Mobility::Trees(&self.directions),
                free_velocity: &self.free,
                items: &self.items,
                keys: Some(&self.keys),
                factors: self.factors.iter().any(|&factor| factor != 1.0).then_some(&self.factors),
            };
            let report = self.stepper.step(&rows, stop)?;
            self.directions.change(&self.factor, self.stepper.percussion(), &mut self.change);
            self.change.iter_mut().zip(free).for_each(|(sum, free)| *sum += free);
            for k in 0..count {
                if !self.near[k] && approach(self, k, &self.change) < -exact * fastest {
                    (self.near[k], self.is_chosen) = (true, false);
                }
            }
            if self.is_chosen {
                return Ok(Some(report));
            }
        }
    }

    /// The least change of coordinates, in the mass matrix, after which rows hold that have these values before: those of
    /// equalities with `= 0`, others with `≥ 0`. None where these contradict each other: percussions that run away would move trees
    /// anywhere.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] as [`ContactStepper::step`].
    pub fn least_change(
        &mut self,
        rows: &[usize],
        before: &[f64],
        stop: Stop<'_>,
    ) -> Result<&[f64], ArgumentError> {
        let Self { directions, factor, jacobian, items, listed, .. } = self;
        directions.clear(factor);
        items.clear();
        for &row in rows {
            let is_joint = row < listed.bilateral;
            items.push(if is_joint { Rows::Bilateral } else { Rows::Frictionless });
            directions.push(factor, jacobian.row(row).iter().copied());
        }
        self.is_chosen = false;
        let direct = closing::percussions(&self.directions, &self.items, before, stop.tolerance);
        let percussion = match &direct {
            Some(percussion) => percussion,
            None => {
                let step = StepRows {
                    delassus: Mobility::Trees(&self.directions),
                    free_velocity: before,
                    items: &self.items,
                    keys: None,
                    factors: None,
                };
                self.stepper.forget();
                let report = self.stepper.step(&step, stop)?;
                if self.stepper.runs_away(&report) {
                    self.change.clear();
                    self.change.resize(self.factor.velocities(), 0.0);
                    return Ok(&self.change);
                }
                self.stepper.percussion()
            }
        };
        self.directions.change(&self.factor, percussion, &mut self.change);
        Ok(&self.change)
    }

    /// As [`least_change`](Self::least_change), of the equalities, with these values, and of the gaps below the `limit`.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] as [`ContactStepper::step`].
    pub fn close(
        &mut self,
        equalities: &[f64],
        limit: f64,
        stop: Stop<'_>,
    ) -> Result<&[f64], ArgumentError> {
        let own = self.listed.unilateral.iter().zip(&self.gaps).filter(|(_, gap)| **gap < limit);
        let (mut rows, mut before): (Vec<_>, Vec<_>) = own.map(|(u, gap)| (u.row, *gap)).unzip();
        rows.splice(..0, 0..self.listed.bilateral);
        before.splice(..0, equalities.iter().copied());
        self.least_change(&rows, &before, stop)
    }

    /// Forgets the steps before.
    pub fn forget(&mut self) {
        self.stepper.forget();
    }

    /// What takes part: equalities, dry joints, and the limits and contacts that are near.
    fn choose(&mut self) {
        let Self { listed, items, keys, factors, rows, directions, factor, jacobian, .. } = self;
        items.clear();
        keys.clear();
        factors.clear();
        rows.clear();
        let plain = |row: usize, added| StepRow { rows: [row; 2], weights: [1.0, 0.0], added };
        for row in 0..listed.bilateral + listed.dry {
            let dry = row.checked_sub(listed.bilateral);
            items.push(dry.map_or(Rows::Bilateral, |k| Rows::DryFriction(self.bounds[k])));
            keys.push(row as u64);
            factors.push(1.0);
            // Both halves of the step are driven.
            rows.push(plain(row, 2.0 * part(&self.driven, row)));
        }
        for (k, u) in listed.unilateral.iter().enumerate().filter(|(k, _)| self.near[*k]) {
            // Parts of joints' axes along the normal are of order one.
            let is_flat = || jacobian.row(u.row + 3).iter().all(|(_, part)| part.abs() <= ROUNDED);
            let own = u.flat.filter(|_| is_flat()).unwrap_or(u.rows);
            items.push(own);
            keys.push(u.key);
            factors.push(self.turns[k].map_or(1.0, |turn| turn.factor));
            rows.push(plain(u.row, self.added[k]));
            let surface = [1, 2, 3].map(|axis| part(&self.driven, u.row + axis));
            for axis in 0..own.count(self.stepper.laws()).unwrap_or(1) - 1 {
                rows.push(match self.turns[k] {
                    None => plain(u.row + 1 + axis, surface[axis]),
                    Some(Turn { axes, .. }) if axis < 2 => {
                        let weights = axes[axis];
                        let added = weights[0] * surface[0] + weights[1] * surface[1];
                        StepRow { rows: [u.row + 1, u.row + 2], weights, added }
                    }
                    Some(Turn { radius, .. }) => StepRow {
                        rows: [u.row + 3; 2],
                        weights: [radius, 0.0],
                        added: radius * surface[2],
                    },
                });
            }
        }
        directions.clear(factor);
        for row in &*rows {
            let term = |k: usize| {
                let scaled =
                    move |&(column, value): &(usize, f64)| (column, row.weights[k] * value);
                jacobian.row(row.rows[k]).iter().map(scaled)
            };
            directions.push(factor, term(0).chain(term(1)));
        }
        self.is_chosen = true;
    }

    /// Whether the last step was one from these velocities without percussions, up to a part of the largest of them.
    pub fn was_from(&self, part: f64) -> bool {
        let free = &self.given;
        let largest =
            |values: &mut dyn Iterator<Item = f64>| values.map(f64::abs).fold(0.0, f64::max);
        let change = largest(&mut free.iter().zip(&self.solved).map(|(new, old)| new - old));
        change <= part * largest(&mut free.iter().copied())
    }

    /// Whether the percussions of the last step do more work over the mean of the velocities `before` and after it than percussions
    /// can whose work over those after it is not positive; up to a part of what cancels in it.
    ///
    /// With the change w of velocities by forces, that u by percussions and `P·γ⁺ ≤ 0`, the work `½ P·(γ⁻ + γ⁺)` is at most
    /// `−½|u|² − ½ u·w ≤ ⅛|w|²` in the mass matrix. Rows that reflect do no work.
    pub fn gains_energy(&self, before: &[f64], part: f64) -> bool {
        let (mut work, mut size) = (0.0, 0.0);
        for (row, p) in self.percussions().into_iter().enumerate().filter(|(_, p)| *p != 0.0) {
            let [old, new] = [before, &self.change].map(|v| 0.5 * self.row_velocity(row, v));
            work += p * (old + new);
            size += p.abs() * (old.abs() + new.abs());
        }
        let change: Vec<f64> = self.solved.iter().zip(before).map(|(free, v)| free - v).collect();
        // The comparison also finds NaN.
        !(work <= self.factor.square(&change) / 8.0 + part * size)
    }

    /// What solved the last step.
    pub fn stepper(&self) -> &ContactStepper {
        &self.stepper
    }

    /// What takes part, and its velocities without percussions.
    pub fn items(&self) -> (&[Rows], &[u64], &[f64]) {
        (&self.items, &self.keys, &self.free)
    }

    /// The item that the last step was refused for.
    pub fn refused(&self) -> Option<usize> {
        self.stepper.refused()
    }

    /// Which limits and contacts took part in the last step.
    pub fn near(&self) -> &[bool] {
        &self.near
    }

    /// First rows of limits and contacts in the Jacobian of the engine.
    pub fn rows(&self) -> impl Iterator<Item = usize> {
        self.listed.unilateral.iter().map(|u| u.row)
    }

    /// Gaps of limits and contacts at this place.
    pub fn gaps(&self) -> &[f64] {
        &self.gaps
    }

    /// Entries of `G` of what takes part, row by row.
    pub fn delassus(&self) -> Vec<f64> {
        let rows = 0..self.directions.rows();
        let product = |i| rows.clone().map(move |j| self.directions.product(i, j));
        rows.clone().flat_map(product).collect()
    }

    /// Velocities after the last step.
    pub fn velocity(&self) -> &[f64] {
        &self.change
    }

    /// Percussions of all rows of the engine in the last step, in N s or N m s.
    pub fn percussions(&self) -> Vec<f64> {
        let mut all = vec![0.0; self.jacobian.starts.len().saturating_sub(1)];
        for (row, p) in self.rows.iter().zip(self.stepper.percussion()) {
            for (row, weight) in row.rows.iter().zip(row.weights).filter(|(_, w)| *w != 0.0) {
                all[*row] += weight * p;
            }
        }
        all
    }

    /// `W P` of percussions of all rows of the engine.
    pub fn generalised(&self, percussions: &[f64]) -> Vec<f64> {
        let mut all = vec![0.0; self.factor.velocities()];
        for (row, p) in percussions.iter().enumerate().filter(|(_, p)| **p != 0.0) {
            self.jacobian.row(row).iter().for_each(|&(column, value)| all[column] += value * p);
        }
        all
    }

    /// Velocity of a row of the engine with these velocities of the trees.
    pub fn row_velocity(&self, row: usize, velocities: &[f64]) -> f64 {
        self.jacobian.dot(row, velocities) + part(&self.driven, row)
    }

    /// Whether something can move a row of the engine.
    pub fn moves(&self, row: usize) -> bool {
        !self.jacobian.row(row).is_empty()
    }
}

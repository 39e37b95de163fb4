//! Step after step of a mechanism, with what one of them can use of the one before.

use std::collections::HashMap;
use std::mem;

use super::freedom::{self, Freedom};
use super::joints::{DRIFT, Joints, Mismatch};
use super::layout::{Friction, Layout, Member, Row};
use super::{ROUNDED, refuse_item};
use crate::argument::{ArgumentError, length, not_negative, refuse};
use crate::contact::{
    BlockMatrix, ContactProblem, ContactState, Delassus, LARGEST, Memory, NormalForce, Phase,
};
use crate::law::{FrictionLaw, Law};
use crate::solver::{Certificate, Given, Shares, SolveReport, Solver, Status, Stop, Workspace};

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

/// The rows of a step, item after item.
#[derive(Debug, Clone, Copy)]
pub struct StepRows<'a> {
    /// `G = Wᵀ M⁻¹ W`, row by row; symmetric.
    pub delassus: &'a [f64],
    /// `b`, the velocities without percussions.
    pub free_velocity: &'a [f64],
    /// What the rows are.
    pub items: &'a [Rows],
    /// A number per item, each once, by which it is known again in the next step; by default its place.
    pub keys: Option<&'a [u64]>,
}

impl StepRows<'_> {
    fn key(&self, item: usize) -> u64 {
        self.keys.map_or(item as u64, |keys| keys[item])
    }

    fn entry(&self, i: usize, j: usize) -> f64 {
        self.delassus[i * self.free_velocity.len() + j]
    }

    fn largest_velocity(&self) -> f64 {
        self.free_velocity.iter().fold(0.0, |most, value| f64::max(most, value.abs()))
    }
}

/// What an item remembers.
#[derive(Debug, Clone, Copy, Default)]
struct Remembered {
    percussion: [f64; 4],
    state: ContactState,
    freedom: Option<Freedom>,
}

/// Percussions, velocities and states of a step, as its rows and items.
#[derive(Debug, Clone, Default)]
struct Found {
    percussion: Vec<f64>,
    velocity: Vec<f64>,
    phases: Vec<Phase>,
    ambiguous: Vec<bool>,
    mismatch: f64,
}

/// Solves the contacts of a mechanism step after step, among its joints, limits and dry joints.
///
/// Percussions and phases start from those that the item with the same key had in the step before. Items are solved in the
/// order of their keys: percussions do not depend on the order in which an engine lists the contacts, unique or not. Contacts of one
/// body that slide in different directions share what they carry as if of equal compliance. Percussions of joints that loops repeat
/// are those of least weighted squares. Where the bodies of a contact cannot move in some direction, they stick
/// up to the friction of sliding in the direction that is left, and what is transmitted across it is that of sliding, too.
///
/// ```
/// use asperity::law::FrictionLaw;
/// use asperity::mechanism::{ContactStepper, Rows, StepRows};
/// use asperity::solver::{Solver, Status, Stop};
///
/// let law = FrictionLaw::<2>::isotropic(0.5)?;
/// let mut stepper = ContactStepper::new(vec![law.into()], Solver::default())?;
/// let unit = |i: usize| f64::from(i % 5 == 0);
/// let delassus: Vec<f64> = (0..16).map(unit).collect();
/// let rows = StepRows {
///     delassus: &delassus,
///     free_velocity: &[-1.0, 3.0, 4.0, 0.2],
///     items: &[Rows::Contact(0), Rows::Bilateral],
///     keys: None,
/// };
/// let report = stepper.step(&rows, Stop::default())?;
/// assert_eq!(report.status, Status::Converged);
/// let known = [1.0, -0.3, -0.4, -0.2];
/// assert!(stepper.percussion().iter().zip(known).all(|(p, k)| (p - k).abs() < 1e-12));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct ContactStepper {
    laws: Vec<Law>,
    /// Of the row that every contact of a problem has beside its normal one, and of dry friction.
    line: Law,
    solver: Solver,
    problem: ContactProblem,
    workspace: Workspace,
    memory: Memory,
    /// What the contacts did before the step.
    history: Vec<ContactState>,
    shares: Shares,
    joints: Joints,
    layout: Layout,
    /// That of the step before, to which the problem belongs, and buffers.
    earlier: Layout,
    remembered: HashMap<u64, Remembered>,
    order: Vec<usize>,
    firsts: Vec<usize>,
    /// All rows, item after item in the order of their keys.
    sequence: Vec<usize>,
    found: Found,
}

impl ContactStepper {
    /// A stepper that remembers nothing yet.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] if a law depends on the sliding speed.
    pub fn new(laws: Vec<Law>, solver: Solver) -> Result<Self, ArgumentError> {
        if laws.iter().any(|law| law.rate().is_some()) {
            return refuse("laws", "must not have a factor of the speed");
        }
        let line = FrictionLaw::<1>::isotropic(1.0)
            .map_err(|error| ArgumentError::new("laws", error.to_string()))?;
        Ok(Self {
            laws,
            line: line.into(),
            solver,
            problem: ContactProblem::assemble([], Delassus::Blocks(BlockMatrix::default())),
            workspace: Workspace::default(),
            memory: Memory::default(),
            history: Vec::new(),
            shares: Shares::default(),
            joints: Joints::default(),
            layout: Layout::default(),
            earlier: Layout::default(),
            remembered: HashMap::new(),
            order: Vec::new(),
            firsts: Vec::new(),
            sequence: Vec::new(),
            found: Found::default(),
        })
    }

    /// Solves a step.
    ///
    /// A status other than converged says that percussions are no solution: [`Status::NoSolution`] also where joints contradict each
    /// other by more than drift, with one of them as the worst contact of the report. Contacts in it are items.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] if numbers of rows, items and keys do not fit, a number is not finite or too large to be squared, a key
    /// occurs twice, a diagonal entry is negative, rows of joints are not symmetric, or a law with drilling has rows that nothing
    /// moves.
    pub fn step(
        &mut self,
        rows: &StepRows<'_>,
        stop: Stop<'_>,
    ) -> Result<SolveReport, ArgumentError> {
        self.arrange(rows)?;
        let joints = self.order.iter().filter(|&&i| rows.items[i] == Rows::Bilateral);
        self.joints.eliminate(joints.map(|&i| self.firsts[i]), rows.delassus, rows.free_velocity);
        self.lay_out(rows)?;
        self.fill(rows);
        self.recall(rows);
        let Self { solver, problem, memory, history, shares, workspace, .. } = self;
        history.clone_from(&memory.states);
        let mut report = solver.solve_prepared(problem, stop, memory, workspace);
        if report.status == Status::Converged {
            let given = Given { report: &report, history, by_place: None };
            let shared = shares.find(problem, stop, &given, memory, workspace);
            report = shared.unwrap_or(report);
        }
        self.expand(rows);
        self.keep(rows);
        report.worst_contact = self.item_of(report.worst_contact);
        let Mismatch { row, velocity, is_drift } = self.unresolved(rows);
        self.found.mismatch = velocity;
        if !is_drift {
            report.status = Status::NoSolution;
            report.worst_contact = self.firsts.iter().rposition(|&first| first <= row).unwrap_or(0);
        }
        Ok(report)
    }

    /// Forgets the steps before: the next one starts from no percussions.
    pub fn forget(&mut self) {
        self.remembered.clear();
    }

    /// Percussions in N s of the last step, row by row.
    pub fn percussion(&self) -> &[f64] {
        &self.found.percussion
    }

    /// Velocities `G P + b` in m/s after the last step, row by row.
    pub fn velocity(&self) -> &[f64] {
        &self.found.velocity
    }

    /// What every item did in the last step: joints stick, contacts that nothing can move are unknown.
    pub fn phases(&self) -> &[Phase] {
        &self.found.phases
    }

    /// Whether every item had several solutions in the last step, the others held.
    pub fn ambiguous(&self) -> &[bool] {
        &self.found.ambiguous
    }

    /// Largest velocity in m/s that is left in a bilateral row, or with which bodies approach each other that nothing can move.
    pub fn mismatch(&self) -> f64 {
        self.found.mismatch
    }

    /// What is left of the laws of the contacts in the last step, from its percussions alone.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] if percussions are not finite.
    pub fn certificate(&self) -> Result<Certificate, ArgumentError> {
        let mut certificate = Certificate::new(&self.problem, &self.memory.percussion)?;
        certificate.worst_contact = self.item_of(certificate.worst_contact);
        Ok(certificate)
    }

    fn item_of(&self, member: usize) -> usize {
        self.layout.members.get(member).map_or(0, |member| member.item)
    }

    /// Checks the rows; sorts items by their keys and finds their first rows.
    fn arrange(&mut self, rows: &StepRows<'_>) -> Result<(), ArgumentError> {
        let (count, all) = (rows.items.len(), rows.free_velocity.len());
        self.firsts.clear();
        let mut first = 0;
        for (item, kind) in rows.items.iter().enumerate() {
            self.firsts.push(first);
            first += match *kind {
                Rows::Contact(law) => match self.laws.get(law) {
                    Some(law) => 1 + law.dimension(),
                    None => {
                        return refuse_item(item, "must have the number of a law that there is");
                    }
                },
                Rows::DryFriction(bound) => {
                    not_negative("bounds", bound).map_err(|error| error.within("item", item))?;
                    1
                }
                Rows::Frictionless | Rows::Bilateral => 1,
            };
        }
        length("free_velocity", first, all)?;
        length("delassus", all * all, rows.delassus.len())?;
        let numbers = [("delassus", rows.delassus), ("free_velocity", rows.free_velocity)];
        for (argument, values) in numbers {
            // Also what is not a number.
            if values.iter().any(|value| !(value.abs() <= LARGEST)) {
                return refuse(argument, "must be finite and at most 1e100");
            }
        }
        if (0..all).any(|i| rows.entry(i, i) < 0.0) {
            return refuse("delassus", "must not be negative on its diagonal");
        }
        let joints = (0..count).filter(|&item| rows.items[item] == Rows::Bilateral);
        for i in joints.map(|item| self.firsts[item]) {
            let size = |j: usize| (rows.entry(i, i) * rows.entry(j, j)).sqrt();
            let differs = |j: usize| (rows.entry(i, j) - rows.entry(j, i)).abs() > DRIFT * size(j);
            if (0..all).any(differs) {
                return refuse("delassus", "must be symmetric in the rows of joints");
            }
        }
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
        let end = |item: usize| self.firsts.get(item + 1).copied().unwrap_or(all);
        self.sequence.clear();
        self.sequence.extend(self.order.iter().flat_map(|&item| self.firsts[item]..end(item)));
        Ok(())
    }

    /// Finds the contacts of the problem that is left, and which of them influence each other.
    fn lay_out(&mut self, rows: &StepRows<'_>) -> Result<(), ArgumentError> {
        let Self { laws, joints, layout, earlier, order, firsts, .. } = self;
        mem::swap(layout, earlier);
        layout.clear();
        for &item in &*order {
            let first = firsts[item];
            let own = |a: usize, b: usize| {
                let before = rows.entry(first + a, first + b);
                (before, before - joints.entry(first + a, first + b))
            };
            let (friction, dimension) = match rows.items[item] {
                Rows::Bilateral => continue,
                Rows::Contact(law) => (Friction::Law(law), laws[law].dimension()),
                Rows::Frictionless => (Friction::Frictionless, 0),
                Rows::DryFriction(_) => (Friction::Dry, 0),
            };
            let velocity = |a: usize| rows.free_velocity[first + a] - joints.velocity(first + a);
            let freedom =
                freedom::of_contact(item, dimension, own, velocity).inspect_err(|_| {
                    layout.clear();
                    earlier.clear();
                })?;
            layout.add(Member { item, first, dimension, friction, freedom });
        }
        layout.connect(&|i, j| rows.entry(i, j) - joints.entry(i, j));
        Ok(())
    }

    /// Brings the problem up to date: its contacts where they are others than before, its entries and velocities.
    fn fill(&mut self, rows: &StepRows<'_>) {
        let Self { laws, line, problem, workspace, shares, joints, layout, earlier, .. } = self;
        let entry = |i: usize, j: usize| rows.entry(i, j) - joints.entry(i, j);
        let is_new = !layout.fits(earlier) || problem.contacts().len() != layout.members.len();
        if is_new {
            let contacts = layout.members.iter().map(|member| {
                let normal = match member.friction {
                    Friction::Dry => NormalForce::Prescribed(0.0),
                    _ => NormalForce::Unilateral,
                };
                let law = match (member.friction, member.freedom) {
                    (Friction::Law(law), Freedom::All | Freedom::Across(_)) => laws[law].clone(),
                    (Friction::Law(law), Freedom::Line(along)) => {
                        freedom::along(&laws[law], along).unwrap_or_else(|| line.clone())
                    }
                    _ => line.clone(),
                };
                (law, normal)
            });
            *problem = ContactProblem::assemble(contacts, Delassus::Blocks(layout.blocks()));
        }
        problem.refill(|delassus| {
            if let Delassus::Blocks(blocks) = delassus {
                layout.fill(blocks, &entry);
            }
        });
        let free = |i: usize| rows.free_velocity[i] - joints.velocity(i);
        for (velocity, row) in problem.free_velocity_mut().iter_mut().zip(&layout.rows) {
            *velocity = row.of(free);
        }
        for (contact, member) in problem.contacts_mut().iter_mut().zip(&layout.members) {
            if let Rows::DryFriction(bound) = rows.items[member.item] {
                contact.normal = NormalForce::Prescribed(bound);
            }
        }
        if is_new {
            workspace.prepare(problem);
            *shares = Shares::default();
        } else {
            workspace.refresh(problem);
        }
    }

    /// Percussions and states of the items that were there in the step before.
    fn recall(&mut self, rows: &StepRows<'_>) {
        let Self { memory, remembered, layout, .. } = self;
        memory.percussion.clear();
        memory.states.clear();
        let mut own = &layout.rows[..];
        for (member, &size) in layout.members.iter().zip(&layout.sizes) {
            let known = remembered.get(&rows.key(member.item)).copied().unwrap_or_default();
            let (mine, others) = own.split_at(size);
            own = others;
            let value = |i: usize| known.percussion.get(i - member.first).copied().unwrap_or(0.0);
            memory.percussion.extend(mine.iter().map(|row| row.of(value)));
            // The slip of another direction says nothing.
            let same = known.freedom == Some(member.freedom);
            memory.states.push(if same { known.state } else { ContactState::default() });
        }
    }

    /// Percussions and velocities of all rows.
    fn expand(&mut self, rows: &StepRows<'_>) {
        let Self { laws, memory, workspace, joints, layout, found, sequence, .. } = self;
        let (count, all) = (rows.items.len(), rows.free_velocity.len());
        let Found { percussion, velocity, phases, ambiguous, mismatch } = found;
        percussion.clear();
        percussion.resize(all, 0.0);
        for (row, p) in layout.rows.iter().zip(&memory.percussion) {
            let Row::Of { first, weights } = *row else { continue };
            for (i, weight) in (first..).zip(weights).filter(|(_, weight)| *weight != 0.0) {
                percussion[i] = weight * p;
            }
        }
        for member in &layout.members {
            let Friction::Law(law) = member.friction else { continue };
            let own = member.friction_rows();
            // What is transmitted in directions that nothing moves follows from how the bodies slide, if they do.
            let along = |p: &[f64], e: [f64; 2]| p[own.start] * e[0] + p[own.start + 1] * e[1];
            let mut slip = [0.0; 3];
            match member.freedom {
                Freedom::Line(e) => {
                    let back = along(percussion, e);
                    slip[..2].copy_from_slice(&e.map(|e| -e * back));
                }
                Freedom::Normal => {
                    let free = |row: usize| rows.free_velocity[row] - joints.velocity(row);
                    let least = ROUNDED * rows.largest_velocity();
                    let moving =
                        own.clone().map(free).map(|v| if v.abs() > least { v } else { 0.0 });
                    slip.iter_mut().zip(moving).for_each(|(slip, v)| *slip = v);
                }
                _ => continue,
            }
            let Some(force) = laws[law].sliding(&slip[..own.len()]) else { continue };
            let size = match member.freedom {
                Freedom::Line(e) => along(percussion, e) / (force[0] * e[0] + force[1] * e[1]),
                _ => percussion[member.first],
            };
            own.zip(force).for_each(|(row, part)| percussion[row] = part * size);
        }
        let own = |member: &Member| member.first..member.friction_rows().end;
        joints.react(percussion, layout.members.iter().flat_map(own));
        velocity.clear();
        velocity.extend_from_slice(rows.free_velocity);
        for (i, velocity) in velocity.iter_mut().enumerate() {
            // Sums whose order is that of the keys, wherever a row is listed.
            *velocity += sequence.iter().map(|&j| rows.entry(i, j) * percussion[j]).sum::<f64>();
        }
        phases.clear();
        let known =
            |kind: &Rows| if *kind == Rows::Bilateral { Phase::Stick } else { Phase::Unknown };
        phases.extend(rows.items.iter().map(known));
        ambiguous.clear();
        ambiguous.resize(count, false);
        for (i, member) in layout.members.iter().enumerate() {
            phases[member.item] = memory.states[i].phase;
            ambiguous[member.item] = workspace.ambiguous()[i];
        }
        *mismatch = 0.0;
    }

    /// The largest velocity that is left where no percussion can change it.
    fn unresolved(&self, rows: &StepRows<'_>) -> Mismatch {
        let Found { percussion, velocity, .. } = &self.found;
        let mut worst =
            self.joints.mismatch(rows.delassus, rows.free_velocity, percussion, velocity);
        // A contact that moves has no phase either, where the solver came to no end.
        let moves = |item: usize| self.layout.members.iter().any(|member| member.item == item);
        let unmoved = |&item: &usize| self.found.phases[item] == Phase::Unknown && !moves(item);
        for item in (0..rows.items.len()).filter(unmoved) {
            let row = self.firsts[item];
            let closing =
                if matches!(rows.items[item], Rows::DryFriction(_)) { 0.0 } else { -velocity[row] };
            let size = match rows.items[item] {
                Rows::Contact(law) => 1 + self.laws[law].dimension().min(2),
                _ => 1,
            };
            let own =
                rows.free_velocity[row..row + size].iter().fold(0.0, |most, v| v.abs().max(most));
            let is_drift = closing <= f64::max(DRIFT * own, ROUNDED * rows.largest_velocity());
            if (!is_drift, closing) > (!worst.is_drift, worst.velocity) {
                worst = Mismatch { row, velocity: closing, is_drift };
            }
        }
        worst
    }

    /// Remembers the items of this step, and no others.
    fn keep(&mut self, rows: &StepRows<'_>) {
        let Self { memory, remembered, layout, found, .. } = self;
        remembered.clear();
        for (member, &state) in layout.members.iter().zip(&memory.states) {
            let freedom = Some(member.freedom);
            let mut own = Remembered { percussion: [0.0; 4], state, freedom };
            let rest = &found.percussion[member.first..];
            let count = rest.len().min(4);
            own.percussion[..count].copy_from_slice(&rest[..count]);
            remembered.insert(rows.key(member.item), own);
        }
    }
}

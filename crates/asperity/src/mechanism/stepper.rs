//! Step after step of a mechanism, with what one of them can use of the one before.

use std::collections::HashMap;
use std::mem;

use super::arranged::{Arranged, Rows, StepRows};
use super::freedom::{self, Freedom};
use super::joints::{Joints, Mismatch};
use super::layout::{Friction, Layout, Member};
use super::{DRIFT, ROUNDED};
use crate::argument::{ArgumentError, refuse};
use crate::contact::{
    BlockMatrix, ContactProblem, ContactState, Delassus, Memory, NormalForce, Phase,
};
use crate::law::{FrictionLaw, Law};
use crate::solver::{Certificate, Given, Shares, SolveReport, Solver, Status, Stop, Workspace};

/// Part of the largest velocity without percussions with which no contact moves that pushes.
const MOVES: f64 = 1e-2;

/// What an item remembers.
#[derive(Debug, Clone, Copy, Default)]
struct Remembered {
    percussion: [f64; 4],
    state: ContactState,
    freedom: Option<Freedom>,
}

/// Percussions, velocities and states of a step.
#[derive(Debug, Clone, Default)]
struct Found {
    percussion: Vec<f64>,
    velocity: Vec<f64>,
    phases: Vec<Phase>,
    ambiguous: Vec<bool>,
}

/// Solves the contacts of a mechanism step after step, among its joints, limits and dry joints.
///
/// Percussions and phases start from those that the item with the same key had in the step before. Items are solved in the
/// order of their keys: percussions do not depend on the order in which an engine lists the contacts, unique or not. Contacts of one
/// body, or up to 16 of several, that slide in different directions share what they carry as if of equal compliance. Percussions of joints that loops repeat
/// are those of least weighted squares; of links 10⁹ times as light as what they join `G` does not tell whether they do. Where the
/// bodies of a contact cannot move in some direction, they stick up to the friction of sliding in the direction that is left, and
/// what is transmitted across it is that of sliding, too.
///
/// ```
/// use asperity::law::FrictionLaw;
/// use asperity::mechanism::{ContactStepper, Mobility, Rows, StepRows};
/// use asperity::solver::{Solver, Status, Stop};
///
/// let law = FrictionLaw::<2>::isotropic(0.5)?;
/// let mut stepper = ContactStepper::new(vec![law.into()], Solver::default())?;
/// let unit = |i: usize| f64::from(i % 5 == 0);
/// let delassus: Vec<f64> = (0..16).map(unit).collect();
/// let rows = StepRows {
///     delassus: Mobility::Dense(&delassus),
///     free_velocity: &[-1.0, 3.0, 4.0, 0.2],
///     items: &[Rows::Contact(0), Rows::Bilateral],
///     keys: None,
///     factors: None,
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
    /// Of dry friction, and of contacts that only their normal row moves.
    line: Law,
    frictionless: Law,
    solver: Solver,
    problem: ContactProblem,
    workspace: Workspace,
    memory: Memory,
    /// What the contacts did before the step.
    history: Vec<ContactState>,
    shares: Shares,
    arranged: Arranged,
    joints: Joints,
    layout: Layout,
    /// That of the step before, to which the problem belongs, and buffers.
    earlier: Layout,
    remembered: HashMap<u64, Remembered>,
    /// In the order of keys, and as rows and items are listed.
    found: Found,
    listed: Found,
    unresolved: Mismatch,
    refused: Option<usize>,
    /// Factors of the friction of the contacts, row by row of the problem.
    by_place: Vec<f64>,
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
            frictionless: Law::frictionless(),
            solver,
            problem: ContactProblem::assemble([], Delassus::Blocks(BlockMatrix::default())),
            workspace: Workspace::default(),
            memory: Memory::default(),
            history: Vec::new(),
            shares: Shares::default(),
            arranged: Arranged::default(),
            joints: Joints::default(),
            layout: Layout::default(),
            earlier: Layout::default(),
            remembered: HashMap::new(),
            found: Found::default(),
            listed: Found::default(),
            unresolved: Mismatch::default(),
            refused: None,
            by_place: Vec::new(),
        })
    }

    /// Solves a step.
    ///
    /// A status other than converged says that percussions are no solution: [`Status::NoSolution`] also where joints contradict each
    /// other by more than drift or links are so light that they look like it, [`Status::Unbounded`] where percussions have grown so far
    /// that they hide it, with one of them as the worst contact of the report. Contacts in it are items.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] if numbers of rows, items and keys do not fit, a number is not finite or too large to be squared, a key
    /// occurs twice, a diagonal entry is negative, `G` is not symmetric, or a law with drilling has rows that nothing
    /// moves.
    pub fn step(
        &mut self,
        rows: &StepRows<'_>,
        stop: Stop<'_>,
    ) -> Result<SolveReport, ArgumentError> {
        self.refused = None;
        self.arranged.arrange(rows, &self.laws)?;
        self.joints.eliminate(&self.arranged);
        self.lay_out()?;
        self.fill();
        self.recall();
        self.by_place.clear();
        if let Some(factors) = rows.factors {
            let members = self.layout.members.iter().zip(&self.layout.sizes);
            self.by_place.extend(members.flat_map(|(member, &size)| {
                std::iter::repeat_n(factors[self.arranged.order[member.place]], size)
            }));
        }
        let Self { solver, problem, memory, history, shares, workspace, by_place, .. } = self;
        history.clone_from(&memory.states);
        let mut report = solver.solve_prepared(problem, stop, memory, workspace);
        if report.status == Status::Converged {
            let by_place = rows.factors.map(|_| &by_place[..]);
            let given = Given { report: &report, history, by_place };
            let shared = shares.find(problem, stop, &given, memory, workspace);
            report = shared.unwrap_or(report);
        }
        self.expand();
        self.keep();
        self.find_unresolved();
        report.worst_contact = self.item_of(report.worst_contact);
        if !self.unresolved.is_drift {
            report.status = match (self.unresolved.has_grown, report.status) {
                (false, _) => Status::NoSolution,
                (true, Status::Converged) => Status::Unbounded,
                (true, status) => status,
            };
            let place = self.unresolved.place;
            report.worst_contact = self.arranged.order.get(place).copied().unwrap_or(0);
        } else if let (Status::Converged, Some(member)) = (report.status, self.moving()) {
            (report.status, report.worst_contact) = (Status::Unbounded, self.item_of(member));
        }
        Ok(report)
    }

    /// A contact that pushes and moves, as percussions may have grown so far that the elimination of joints has lost velocities.
    fn moving(&self) -> Option<usize> {
        let most = MOVES * self.arranged.largest_velocity();
        let Found { percussion, velocity, .. } = &self.found;
        self.layout.members.iter().position(|&Member { place, first, friction, .. }| {
            let brought = self.arranged.own(place, 0, 0) * percussion[first];
            friction != Friction::Dry && f64::min(brought, velocity[first].abs()) > most
        })
    }

    /// The item that the last step was refused for, where its law asks for a motion that it has not.
    pub fn refused(&self) -> Option<usize> {
        self.refused
    }

    /// The laws of contacts.
    pub(super) fn laws(&self) -> &[Law] {
        &self.laws
    }

    /// Forgets the steps before: the next one starts from no percussions.
    pub fn forget(&mut self) {
        self.remembered.clear();
    }

    /// Percussions in N s of the last step, row by row.
    pub fn percussion(&self) -> &[f64] {
        &self.listed.percussion
    }

    /// Velocities `G P + b` in m/s after the last step, row by row.
    pub fn velocity(&self) -> &[f64] {
        &self.listed.velocity
    }

    /// What every item did in the last step: joints stick, contacts that nothing can move are unknown.
    pub fn phases(&self) -> &[Phase] {
        &self.listed.phases
    }

    /// Whether every item had several solutions in the last step, the others held.
    pub fn ambiguous(&self) -> &[bool] {
        &self.listed.ambiguous
    }

    /// Largest velocity in m/s that is left in a bilateral row, or with which bodies approach each other that nothing can move.
    pub fn mismatch(&self) -> f64 {
        self.unresolved.velocity
    }

    /// Whether the last step, of this report, has no percussions for its contacts, whatever its joints contradict.
    pub(super) fn runs_away(&self, report: &SolveReport) -> bool {
        self.unresolved.is_drift && matches!(report.status, Status::NoSolution | Status::Unbounded)
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

    /// The contacts of the last step as a problem of their own, in which joints have been eliminated.
    pub fn contact_problem(&self) -> &ContactProblem {
        &self.problem
    }

    /// The items that are its contacts: their places as listed, and what they are.
    pub fn contact_items(&self) -> impl Iterator<Item = (usize, Rows)> + '_ {
        let of = |member: &Member| {
            (self.arranged.order[member.place], self.arranged.items[member.place])
        };
        self.layout.members.iter().map(of)
    }

    fn item_of(&self, member: usize) -> usize {
        self.layout.members.get(member).map_or(0, |member| self.arranged.order[member.place])
    }

    /// Finds the contacts of the problem that is left, and which of them influence each other.
    fn lay_out(&mut self) -> Result<(), ArgumentError> {
        let Self { laws, arranged, joints, layout, earlier, refused, .. } = self;
        mem::swap(layout, earlier);
        layout.clear();
        for (place, kind) in arranged.items.iter().enumerate() {
            let (friction, dimension) = match *kind {
                Rows::Bilateral => continue,
                Rows::Contact(law) => (Friction::Law(law), laws[law].dimension()),
                Rows::Frictionless => (Friction::Frictionless, 0),
                Rows::DryFriction(_) => (Friction::Dry, 0),
            };
            let first = arranged.rows(place).start;
            let own = |a: usize, b: usize| {
                let before = arranged.own(place, a, b);
                (before, before - joints.entry(first + a, first + b))
            };
            let velocity =
                |a: usize| arranged.free_velocity[first + a] - joints.velocity(first + a);
            let item = arranged.order[place];
            let freedom =
                freedom::of_contact(item, dimension, own, velocity).inspect_err(|_| {
                    *refused = Some(item);
                    layout.clear();
                    earlier.clear();
                })?;
            let is_held = arranged.rows(place).any(|row| joints.influence(row));
            layout.add(Member { place, first, dimension, friction, freedom, is_held });
        }
        layout.connect(arranged, joints);
        Ok(())
    }

    /// Brings the problem up to date: its contacts where they are others than before, its entries and velocities.
    fn fill(&mut self) {
        let Self { laws, line, frictionless, problem, workspace, shares, arranged, .. } = self;
        let Self { joints, layout, earlier, .. } = self;
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
                    (Friction::Dry, _) => line.clone(),
                    _ => frictionless.clone(),
                };
                (law, normal)
            });
            *problem = ContactProblem::assemble(contacts, Delassus::Blocks(layout.blocks()));
        }
        problem.refill(|delassus| {
            if let Delassus::Blocks(blocks) = delassus {
                layout.fill(blocks, arranged, joints);
            }
        });
        let free = |i: usize| arranged.free_velocity[i] - joints.velocity(i);
        for (velocity, row) in problem.free_velocity_mut().iter_mut().zip(&layout.rows) {
            *velocity = row.of(free);
        }
        for (contact, member) in problem.contacts_mut().iter_mut().zip(&layout.members) {
            if let Rows::DryFriction(bound) = arranged.items[member.place] {
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
    fn recall(&mut self) {
        let Self { memory, remembered, arranged, layout, .. } = self;
        memory.percussion.clear();
        memory.states.clear();
        let mut own = &layout.rows[..];
        for (member, &size) in layout.members.iter().zip(&layout.sizes) {
            let key = &arranged.keys[member.place];
            let known = remembered.get(key).copied().unwrap_or_default();
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
    fn expand(&mut self) {
        let Self { laws, memory, workspace, arranged, joints, layout, found, listed, .. } = self;
        let Found { percussion, velocity, phases, ambiguous } = found;
        percussion.clear();
        percussion.resize(arranged.len(), 0.0);
        for (row, p) in layout.rows.iter().zip(&memory.percussion) {
            for (i, weight) in (row.first..).zip(row.weights).filter(|(_, weight)| *weight != 0.0) {
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
                    let free = |row: usize| arranged.free_velocity[row] - joints.velocity(row);
                    let least = ROUNDED * arranged.largest_velocity();
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
        velocity.resize(arranged.len(), 0.0);
        // Sums whose order is that of the keys, wherever a row is listed.
        arranged.mobility.apply(percussion, velocity);
        velocity.iter_mut().zip(&arranged.free_velocity).for_each(|(v, free)| *v += free);
        phases.clear();
        let known =
            |kind: &Rows| if *kind == Rows::Bilateral { Phase::Stick } else { Phase::Unknown };
        phases.extend(arranged.items.iter().map(known));
        ambiguous.clear();
        ambiguous.resize(phases.len(), false);
        for (i, member) in layout.members.iter().enumerate() {
            phases[member.place] = memory.states[i].phase;
            ambiguous[member.place] = workspace.ambiguous()[i];
        }
        arranged.list_rows(percussion, &mut listed.percussion);
        arranged.list_rows(velocity, &mut listed.velocity);
        arranged.list_items(phases, &mut listed.phases);
        arranged.list_items(ambiguous, &mut listed.ambiguous);
    }

    /// The largest velocity that is left where no percussion can change it.
    fn find_unresolved(&mut self) {
        let Self { laws, arranged, joints, layout, found, .. } = self;
        let Found { percussion, velocity, phases, .. } = found;
        let mut worst = joints.mismatch(arranged, percussion, velocity);
        // A contact that moves has no phase either, where the solver came to no end.
        let unmoved = |&place: &usize| phases[place] == Phase::Unknown && !layout.moves(place);
        for place in (0..phases.len()).filter(unmoved) {
            let row = arranged.rows(place).start;
            let kind = arranged.items[place];
            let closing = if matches!(kind, Rows::DryFriction(_)) { 0.0 } else { -velocity[row] };
            let size = match kind {
                Rows::Contact(law) => 1 + laws[law].dimension().min(2),
                _ => 1,
            };
            let free = &arranged.free_velocity[row..row + size];
            let own = free.iter().fold(0.0, |most, v| v.abs().max(most));
            let is_drift = closing <= f64::max(DRIFT * own, ROUNDED * arranged.largest_velocity());
            if (!is_drift, closing) > (!worst.is_drift, worst.velocity) {
                worst = Mismatch { place, velocity: closing, is_drift, has_grown: false };
            }
        }
        self.unresolved = worst;
    }

    /// Remembers the items of this step, and no others.
    fn keep(&mut self) {
        let Self { memory, remembered, arranged, layout, found, .. } = self;
        remembered.clear();
        for (member, &state) in layout.members.iter().zip(&memory.states) {
            let freedom = Some(member.freedom);
            let mut own = Remembered { percussion: [0.0; 4], state, freedom };
            let percussion = &found.percussion[arranged.rows(member.place)];
            own.percussion[..percussion.len()].copy_from_slice(percussion);
            remembered.insert(arranged.keys[member.place], own);
        }
    }
}

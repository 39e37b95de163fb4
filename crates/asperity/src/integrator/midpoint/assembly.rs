//! From a system at the midpoint to the contact problem, and back from percussions to velocities.
//!
//! A contact touches few blocks of velocities and is coupled only with the other contacts of these: nothing is larger
//! than the contacts, the blocks and their couplings are many.

use std::ops::Range;

use nalgebra::{Matrix4, SymmetricEigen};

use super::closed::{Change, Closed};
use super::coupling;
use super::outcome::StepError;
use super::products::Part;
use super::rated::Factors;
use crate::contact::{BlockMatrix, ContactProblem, Delassus, NormalForce};
use crate::system::friction_map::scale_rows;
use crate::system::mass::MassFactors;
use crate::system::{self, Configuration, Constancy, Midpoint, Step, System, SystemError};
use crate::vectors::copy;

/// Part of the way that the contact forces have to make up for in a step, up to which a gap is rounding.
const ROUNDING: f64 = 1e-6;

/// Compliance in directions that joints hold, relative to that of the bodies without joints: contacts see them at rest, and
/// transmit nothing there while they stick.
const COMPLIANCE: f64 = 1e-8;

/// Part of the largest load that this compliance may bear: what friction wedges between joints asks for ever more.
const BORNE: f64 = 1e-2;

/// A contact that slips by more than this multiple of what its directions change by slides. One that sticks has slip of
/// once as much, of none where a run begins, and of twice as much where it was not held along the chord before, which
/// must not go on: four keeps away from all of these.
const SLIDING: f64 = 4.0;

/// The system and its closed contacts at the midpoint.
#[derive(Debug, Default)]
pub(super) struct Assembly {
    /// What of the system never changes.
    constancy: Constancy,
    midpoint: Midpoint,
    mass: MassFactors,
    has_mass: bool,
    /// Velocities without contact forces, then with them.
    free: Vec<f64>,
    contacts: Vec<Rows>,
    sides: Vec<Side>,
    /// `W_Nᵀ`, `Wᵀ` row by row, every row with the velocities of the blocks of its contact; `M⁻¹W` with the factors
    /// of the speed likewise.
    directions: Vec<f64>,
    responses: Vec<f64>,
    /// The velocities before the step that joints let pass at its midpoint, and what joints change these by until its end.
    passed: Vec<f64>,
    bend: Vec<f64>,
    /// Diagonal of the Delassus operator without joints where there are any, times their compliance.
    compliance: Vec<f64>,
    /// χ row by row, and the velocities before the step where they are needed.
    chi: Vec<f64>,
    slip: Vec<f64>,
    /// The factors of friction by place of all rows, and whether some contact has one.
    by_place: Vec<f64>,
    has_maps: bool,
    /// What χ changes by on the way to the next midpoint, row by row, of contacts that stay closed.
    chord: Vec<f64>,
    /// The blocks that a new contact touches.
    struck: Vec<bool>,
    factors: Factors,
    /// Whether a step only needs products with `Wᵀ` and `M⁻¹W`, see [`is_constant`](Self::is_constant).
    constant: bool,
    /// The contact whose rows were evaluated last.
    evaluated: Evaluated,
}

/// Rows and χ of one contact.
#[derive(Debug, Default)]
struct Evaluated {
    rows: Vec<f64>,
    chi: [f64; 4],
    /// The factor of friction at the place of the contact, which the rows of friction have, and whether it has a map.
    by_place: f64,
    has_map: bool,
    /// What they change by on the way to the next midpoint, and whether they do, once that was asked for.
    chord: [f64; 4],
    bends: Option<bool>,
}

impl Evaluated {
    /// Evaluates the rows of a contact; its gap.
    fn update(
        &mut self,
        system: &dyn System,
        at: &Configuration<'_>,
        contact: usize,
    ) -> Result<f64, SystemError> {
        let len = system.contacts()[contact].rows();
        let entries = len * width(system, contact);
        if self.rows.len() < entries {
            self.rows.resize(entries, 0.0);
        }
        self.bends = None;
        let (rows, chi) = (&mut self.rows[..entries], &mut self.chi[..len]);
        let gap = system.rows(at, contact, rows, chi)?;
        (self.by_place, self.has_map) = (1.0, false);
        if let Some((map, place)) = system.friction_place(at, contact) {
            (self.by_place, self.has_map) = (map.factor(map.region(place), place), true);
            scale_rows(self.by_place, &system.contacts()[contact], entries / len, rows, chi);
        }
        Ok(gap)
    }

    /// What the rows of a contact, which were evaluated last, change by; zero where nothing changes.
    fn chord(
        &mut self,
        system: &dyn System,
        midpoint: &Midpoint,
        step: &Step<'_>,
        contact: usize,
        joints_bend: &[f64],
    ) -> [f64; 4] {
        if self.bends.is_none() {
            let len = system.contacts()[contact].rows();
            let rows = &self.rows[..len * width(system, contact)];
            self.chord = [0.0; 4];
            let correction = &mut self.chord[..len];
            self.bends =
                Some(system.turning().is_some_and(|turning| {
                    turning.chord(midpoint, step, contact, rows, correction)
                }));
            let law = &system.contacts()[contact];
            if law.law().dimension() == 3 {
                // That of drilling does not follow from its row.
                correction[law.rows() - 1] *= self.by_place;
            }
            if !joints_bend.is_empty() {
                let (mut entries, width) = (rows, rows.len() / len);
                for &block in system.touched(contact) {
                    let bend = &joints_bend[system.blocks().range(block)];
                    Part { entries, width }.add_product(bend, correction);
                    entries = &entries[bend.len()..];
                }
                self.bends = Some(true);
            }
        }
        if self.bends == Some(true) { self.chord } else { [0.0; 4] }
    }
}

/// The rows of a closed contact.
#[derive(Debug, Clone)]
struct Rows {
    /// First row, and number of rows.
    first: usize,
    len: usize,
    /// First entry, and number of entries per row.
    place: usize,
    width: usize,
    /// The blocks that the contact touches.
    sides: Range<usize>,
}

/// A block that a contact touches.
#[derive(Debug, Clone, Copy)]
struct Side {
    block: usize,
    /// Its first velocity, and their number.
    velocity: usize,
    len: usize,
    /// The first of them in the contact's rows.
    offset: usize,
}

impl Rows {
    /// What belongs to one of its blocks from row `k` on.
    #[inline]
    fn part<'a>(&self, k: usize, side: &Side, entries: &'a [f64]) -> Part<'a> {
        let Self { place, len, width, .. } = self;
        let first = place + k * width + side.offset;
        Part { entries: &entries[first..place + len * width], width: *width }
    }

    #[inline]
    fn entries(&self) -> Range<usize> {
        self.place..self.place + self.len * self.width
    }
}

impl Assembly {
    /// The system in a state; `momenta` are those that it carries, where they are known.
    pub(super) fn new(system: &dyn System, q: &[f64], u: &[f64], momenta: Vec<f64>) -> Self {
        let (dof, constancy) = (system.dof(), system.constancy());
        let momenta = if momenta.is_empty() { system::momenta(system, q, u) } else { momenta };
        Self {
            constancy,
            midpoint: Midpoint {
                q: q.to_vec(),
                before: vec![0.0; dof],
                forces: vec![0.0; dof],
                momenta,
                ..Midpoint::default()
            },
            free: vec![0.0; dof],
            struck: vec![false; system.blocks().count()],
            ..Self::default()
        }
    }

    /// Whether the contact problem of the first step from any state has the operator of the last one.
    pub(super) fn is_reusable(&self) -> bool {
        self.constant && self.has_mass
    }

    /// The same system in another state, where [`is_reusable`](Self::is_reusable).
    pub(super) fn restart(&mut self, system: &dyn System, q: &[f64], u: &[f64], momenta: Vec<f64>) {
        self.midpoint.q.copy_from_slice(q);
        self.midpoint.momenta =
            if momenta.is_empty() { system::momenta(system, q, u) } else { momenta };
    }

    /// What the system carries from step to step besides coordinates and velocities.
    pub(super) fn momenta(&self) -> &[f64] {
        &self.midpoint.momenta
    }

    /// Velocities before and after the last step, both as they are expressed at its midpoint.
    pub(super) fn change(&self) -> (&[f64], &[f64]) {
        (&self.midpoint.before, &self.free)
    }

    /// `γ = Wᵀu + χ` of any contact.
    pub(super) fn slip(
        &mut self,
        system: &dyn System,
        at: &Configuration<'_>,
        u: &[f64],
        contact: usize,
    ) -> Result<[f64; 3], SystemError> {
        self.evaluated.update(system, at, contact)?;
        let (law, width) = (&system.contacts()[contact], width(system, contact));
        let Evaluated { rows, chi, .. } = &self.evaluated;
        let mut slip = [0.0; 3];
        let tangent = law.normal_rows()..law.rows();
        let (slip_rows, mut entries) = (tangent.len(), &rows[tangent.start * width..]);
        slip[..slip_rows].copy_from_slice(&chi[tangent]);
        for &block in system.touched(contact) {
            let velocities = &u[system.blocks().range(block)];
            Part { entries, width }.add_product(velocities, &mut slip[..slip_rows]);
            entries = &entries[velocities.len()..];
        }
        Ok(slip.map(|slip| slip / self.evaluated.by_place))
    }

    /// The contact problem of a step.
    #[inline]
    pub(super) fn update(
        &mut self,
        system: &dyn System,
        step: &Step<'_>,
        closed: &mut Closed,
    ) -> Result<Change, StepError> {
        let dt = step.dt;
        system::begin(system, step, &mut self.midpoint)?;
        let mut new_mass = !(self.has_mass && self.constancy.mass);
        if new_mass {
            self.has_mass = false;
            self.mass.update(system, step.midpoint, &self.midpoint.q)?;
            self.has_mass = true;
        }
        let Midpoint { before, forces, .. } = &self.midpoint;
        self.mass.accelerate(system, before, (dt, forces), &mut self.free);
        if !self.midpoint.held.is_empty() && !system.contacts().is_empty() {
            self.let_pass(system, dt)?;
            // Joints change what contacts do to each other.
            new_mass = true;
        }
        if self.constant && closed.ready && !new_mass {
            let loads = closed.problem.free_velocity_mut();
            copy(&self.chi, loads);
            let Self { free, directions, .. } = self;
            Part { entries: directions, width: free.len() }.add_product(free, loads);
            return Ok(Change::None);
        }
        self.update_contacts(system, step, new_mass, closed)
    }

    /// The same where more than the velocities of contacts may change.
    #[inline(never)]
    fn update_contacts(
        &mut self,
        system: &dyn System,
        step: &Step<'_>,
        new_mass: bool,
        closed: &mut Closed,
    ) -> Result<Change, StepError> {
        let (same, changed) = self.find_closed(system, step, new_mass, closed)?;
        if !same {
            self.renew(system, step, closed)?;
        }
        if self.factors.any() {
            self.factors.update(&closed.problem, |row| self.slip[row]);
        }
        if !same || changed || self.factors.any() {
            self.fill(system, closed);
            closed.check_directions(&self.compliance, system.has_joints())?;
            self.constant = self.is_constant(system, closed);
            if self.constant {
                // No sum with a chord of zero tells zeros from their negatives any more.
                self.chi.iter_mut().for_each(|chi| *chi += 0.0);
            }
        }
        if closed.bounces() {
            closed.bounce(|row| self.slip[row]);
        }
        Ok(match (same, changed || self.factors.any()) {
            (false, _) => Change::Contacts,
            (true, true) => Change::Operator,
            (true, false) => Change::None,
        })
    }

    /// Finds the closed contacts and brings their rows up to date, in one pass while they are those of the last step;
    /// whether they are, and whether the operator has changed.
    ///
    /// A contact is closed where its gap has vanished. One that was closed in the last step, or at the beginning of a
    /// run, may also have been lifted by rounding and by what the solver leaves over: up to a millionth of the way that
    /// the contact forces have to make up for in a step; and while it turns by what is left over of the chord, of which
    /// the step takes all but a part of O(Δt). It may close this gap until the next midpoint: else resting contacts
    /// would creep open.
    fn find_closed(
        &mut self,
        system: &dyn System,
        step: &Step<'_>,
        new_mass: bool,
        closed: &mut Closed,
    ) -> Result<(bool, bool), StepError> {
        closed.found.clear();
        closed.gaps.clear();
        closed.stay.clear();
        let (mut same, mut changed) = (closed.ready, new_mass);
        let constant = self.constancy.contacts;
        for (contact, law) in system.contacts().iter().enumerate() {
            // What was closed most probably still is.
            let was_closed = closed.was_closed(contact);
            let known = was_closed && !constant;
            let gap = match law.normal_force() {
                _ if known => self.evaluate(system, contact)?,
                NormalForce::Prescribed(_) => 0.0,
                NormalForce::Unilateral => system.gap(&self.midpoint.configuration(), contact)?,
            };
            if !gap.is_finite() {
                return Err(StepError::NotFiniteContact { time: self.midpoint.t, contact });
            }
            if gap > 0.0 && !(was_closed && gap <= self.lift(system, step, contact, known)?) {
                continue;
            }
            let place = closed.found.len();
            closed.found.push(contact);
            closed.gaps.push(gap.max(0.0) / step.dt);
            closed.stay.push(was_closed);
            // What has closed in a step that was given up closes once more.
            same = same && was_closed && closed.active.get(place) == Some(&contact);
            if same {
                if !constant {
                    if !known {
                        self.evaluate(system, contact)?;
                    }
                    changed |= self.store(place);
                    self.update_chord(system, step, place, contact, true);
                }
                self.update_velocities(place, closed.gaps[place], closed);
            }
        }
        Ok((same && closed.found.len() == closed.active.len(), changed))
    }

    /// The gap up to which a contact counts as closed; evaluates its rows unless they are known.
    fn lift(
        &mut self,
        system: &dyn System,
        step: &Step<'_>,
        contact: usize,
        known: bool,
    ) -> Result<f64, SystemError> {
        if !known {
            self.evaluate(system, contact)?;
        }
        let (mut gained, mut row) = (0.0, self.evaluated.rows.iter());
        for &block in system.touched(contact) {
            let range = system.blocks().range(block);
            let change = self.free[range.clone()].iter().zip(&self.before()[range]);
            gained += change.zip(&mut row).map(|((a, b), w)| (w * (a - b)).abs()).sum::<f64>();
        }
        let chord = self.evaluated.chord(system, &self.midpoint, step, contact, &self.bend);
        Ok(step.dt * (ROUNDING * gained + chord[0].abs()))
    }

    /// Evaluates the rows of a contact at the midpoint; its gap.
    fn evaluate(&mut self, system: &dyn System, contact: usize) -> Result<f64, SystemError> {
        self.evaluated.update(system, &self.midpoint.configuration(), contact)
    }

    /// Takes the rows that were evaluated last for those of a closed contact; whether they differ from the old ones.
    #[inline]
    fn store(&mut self, place: usize) -> bool {
        let Rows { first, len, .. } = self.contacts[place];
        self.chi[first..first + len].copy_from_slice(&self.evaluated.chi[..len]);
        self.by_place[first..first + len].fill(self.evaluated.by_place);
        self.has_maps |= self.evaluated.has_map;
        let old = &mut self.directions[self.contacts[place].entries()];
        let new = &self.evaluated.rows[..old.len()];
        let changed = *old != *new;
        if changed {
            old.copy_from_slice(new);
        }
        changed
    }

    /// What the rows that were evaluated last change by until the next midpoint.
    ///
    /// Contacts of what an impact strikes have no such chord: rotations may jump, and the laws of impact hold in the
    /// velocities of an instant. Nor have the directions of one that slides: they would be right to second order while
    /// its force is of first order, friction along them might not take energy, and contacts of one body could not all
    /// come to stick in one step. A contact that sticks has on average no slip on its way to the midpoint, that is, in
    /// this instant one as large as the correction.
    #[inline]
    fn update_chord(
        &mut self,
        system: &dyn System,
        step: &Step<'_>,
        place: usize,
        contact: usize,
        undisturbed: bool,
    ) {
        let Rows { first, len, .. } = self.contacts[place];
        let (own, mut chord) = (first..first + len, [0.0; 4]);
        if undisturbed {
            chord = self.evaluated.chord(system, &self.midpoint, step, contact, &self.bend);
        }
        self.chord[own.clone()].copy_from_slice(&chord[..len]);
        if !undisturbed || self.evaluated.bends != Some(true) {
            return;
        }
        let (rows, tangent) =
            (&self.contacts[place], system.contacts()[contact].normal_rows()..len);
        let before = self.velocities(rows, self.before());
        let slip = tangent.clone().map(|k| before[k] + self.chi[first + k]);
        let slip = slip.fold(0.0, |sum, v| sum + v * v);
        let change = tangent.clone().map(|k| self.chord[first + k]).fold(0.0, |s, v| s + v * v);
        if slip > SLIDING * SLIDING * change {
            self.chord[own][tangent].fill(0.0);
        }
    }

    /// Whether all that steps need of the contacts from now on are products with `Wᵀ` and `M⁻¹W` as they are, each one
    /// matrix, as all velocities are in one block.
    fn is_constant(&self, system: &dyn System, closed: &Closed) -> bool {
        let Constancy { mass, contacts, .. } = self.constancy;
        mass && contacts
            && system.blocks().count() == 1
            && system.contacts().iter().all(|contact| !contact.normal_force().is_unilateral())
            && !self.factors.any()
            && !closed.bounces()
            && self.chord.iter().all(|&c| c == 0.0)
    }

    /// Brings the velocities of a contact up to date; `closing` is that with which it closes its gap in a step.
    ///
    /// After the step the laws see the mean velocities on the way to the next midpoint, before it those on the way from
    /// the last one, which to second order differ from those at the midpoint by as much on the other side.
    #[inline]
    fn update_velocities(&mut self, place: usize, closing: f64, closed: &mut Closed) {
        let Rows { first, len, .. } = self.contacts[place];
        let loads = &mut closed.problem.free_velocity_mut()[first..first + len];
        match len {
            1 => self.load::<1>(place, closing, loads),
            2 => self.load::<2>(place, closing, loads),
            3 => self.load::<3>(place, closing, loads),
            _ => self.load::<4>(place, closing, loads),
        }
        if closed.bounces() || self.factors.any() {
            self.update_slip(place, closing);
        }
    }

    /// The velocities of a contact with `N` rows after a step without percussions.
    #[inline(always)]
    fn load<const N: usize>(&self, place: usize, closing: f64, loads: &mut [f64]) {
        let rows = &self.contacts[place];
        let own = rows.first..rows.first + N;
        let (chi, chord) = (&self.chi[own.clone()], &self.chord[own]);
        let mut sums: [f64; N] = std::array::from_fn(|k| chi[k] + chord[k]);
        sums[0] += closing;
        self.add_velocities(rows, &self.free, &mut sums);
        loads[..N].copy_from_slice(&sums);
    }

    /// The velocities before the step that contacts see at its midpoint.
    #[inline]
    fn before(&self) -> &[f64] {
        if self.passed.is_empty() { &self.midpoint.before } else { &self.passed }
    }

    /// The velocities of a contact before the step.
    fn update_slip(&mut self, place: usize, closing: f64) {
        let rows = &self.contacts[place];
        let before = self.velocities(rows, self.before());
        for (k, row) in (rows.first..rows.first + rows.len).enumerate() {
            let closing = if k == 0 { closing } else { 0.0 };
            self.slip[row] = before[k] + self.chi[row] + closing - self.chord[row];
        }
    }

    /// `Wᵀu` of the rows of a contact.
    fn velocities(&self, rows: &Rows, u: &[f64]) -> [f64; 4] {
        let mut sums = [0.0; 4];
        self.add_velocities(rows, u, &mut sums[..rows.len]);
        sums
    }

    /// Adds `Wᵀu` of the rows of a contact.
    #[inline(always)]
    fn add_velocities(&self, rows: &Rows, u: &[f64], sums: &mut [f64]) {
        for side in &self.sides[rows.sides.clone()] {
            let own = &u[side.velocity..side.velocity + side.len];
            rows.part(0, side, &self.directions).add_product(own, sums);
        }
    }

    /// Rows and operator for a new set of closed contacts.
    fn renew(
        &mut self,
        system: &dyn System,
        step: &Step<'_>,
        closed: &mut Closed,
    ) -> Result<(), SystemError> {
        let delassus = coupling::pattern(system, &closed.found, &self.midpoint.q)?;
        closed.renew(system.contacts(), step.dt, delassus);
        let blocks = system.blocks();
        self.contacts.clear();
        self.sides.clear();
        let mut place = 0;
        for (rows, &contact) in closed.problem.contacts().iter().zip(&closed.active) {
            let (first_side, mut width) = (self.sides.len(), 0);
            for &block in system.touched(contact) {
                let range = blocks.range(block);
                let (velocity, len) = (range.start, range.len());
                self.sides.push(Side { block, velocity, len, offset: width });
                width += len;
            }
            let (first, len, sides) = (rows.offset, rows.len(), first_side..self.sides.len());
            self.contacts.push(Rows { first, len, place, width, sides });
            place += len * width;
        }
        let rows = closed.problem.rows();
        for list in [&mut self.directions, &mut self.responses] {
            list.resize(place, 0.0);
        }
        for list in [
            &mut self.compliance,
            &mut self.chi,
            &mut self.slip,
            &mut self.chord,
            &mut self.by_place,
        ] {
            list.resize(rows, 0.0);
        }
        self.factors.reset(&closed.problem);
        self.struck.fill(false);
        for (&contact, _) in closed.active.iter().zip(&closed.stay).filter(|(_, stays)| !**stays) {
            system.touched(contact).iter().for_each(|&block| self.struck[block] = true);
        }
        for place in 0..self.contacts.len() {
            let contact = closed.active[place];
            let undisturbed = !system.touched(contact).iter().any(|&block| self.struck[block]);
            self.evaluate(system, contact)?;
            self.store(place);
            self.update_chord(system, step, place, contact, undisturbed);
            self.update_velocities(place, closed.gaps[place], closed);
        }
        Ok(())
    }

    /// `M⁻¹W`, scaled by the factors of the speed, and the Delassus operator.
    pub(super) fn fill(&mut self, system: &dyn System, closed: &mut Closed) {
        for rows in &self.contacts {
            for k in 0..rows.len {
                let factor = self.factors.rows()[rows.first + k];
                let start = rows.place + k * rows.width;
                self.compliance[rows.first + k] = 0.0;
                for side in &self.sides[rows.sides.clone()] {
                    let first = start + side.offset;
                    let response = &mut self.responses[first..first + side.len];
                    response.copy_from_slice(&self.directions[first..first + side.len]);
                    self.mass.solve_block(system, side.block, response);
                    let mut held = self.midpoint.held.iter();
                    if let Some(held) = held.find(|held| held.block == side.block) {
                        let own = &self.directions[first..first + side.len];
                        let mobility = own.iter().zip(&*response).map(|(w, r)| w * r).sum::<f64>();
                        self.compliance[rows.first + k] += COMPLIANCE * mobility;
                        held.project(response);
                    }
                    if factor != 1.0 {
                        response.iter_mut().for_each(|value| *value *= factor);
                    }
                }
            }
        }
        closed.problem.refill(|delassus| match delassus {
            Delassus::Blocks(blocks) => self.fill_blocks(blocks),
            Delassus::Factored(factored) => {
                let (_, directions, blocks) = factored.parts_mut();
                directions.copy_from_slice(&self.directions);
                self.fill_blocks(blocks);
            }
            _ => {}
        });
    }

    /// The contact whose percussions joints bear by their compliance: the laws of rigid joints allow none.
    pub(super) fn wedged(&self, problem: &ContactProblem, percussion: &[f64]) -> Option<usize> {
        if self.midpoint.held.is_empty() {
            return None;
        }
        let yields = |row: usize| self.compliance[row] * percussion[row].abs();
        let rows = |rows: &Rows| rows.first..rows.first + rows.len;
        let of = |contact: &Rows| rows(contact).map(yields).fold(0.0, f64::max);
        let load = (0..self.contacts.len()).flat_map(|i| problem.load(i));
        let load = load.fold(0.0, |largest: f64, load| largest.max(load.abs()));
        let most = self.contacts.iter().map(of).enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
        (most.1 > BORNE * load).then_some(most.0)
    }

    fn fill_blocks(&self, blocks: &mut BlockMatrix) {
        for (i, contact) in self.contacts.iter().enumerate() {
            for k in 0..blocks.neighbours(i).len() {
                let (j, block) = blocks.block_mut(i, k);
                self.fill_block(contact, &self.contacts[j], block);
                if i == j && !self.midpoint.held.is_empty() {
                    self.yield_to(contact, block);
                }
            }
        }
    }

    /// Adds the compliance of joints to the block of a contact, in the directions that they hold.
    fn yield_to(&self, contact: &Rows, block: &mut [f64]) {
        let len = contact.len;
        let compliance = &self.compliance[contact.first..contact.first + len];
        let entry = |a: usize, b: usize| (compliance[a] * compliance[b]).sqrt();
        if compliance.contains(&0.0) {
            return;
        }
        let scaled = Matrix4::from_fn(|a, b| match a.max(b) < len {
            true => block[len * a + b] / entry(a, b),
            // Out of the way of what is held.
            false => f64::from(u8::from(a == b)) * 2.0,
        });
        let SymmetricEigen { eigenvalues, eigenvectors } = SymmetricEigen::new(scaled);
        for k in (0..len).filter(|&k| eigenvalues[k] < 1.0) {
            for (i, g) in block.iter_mut().enumerate() {
                let (a, b) = (i / len, i % len);
                *g += eigenvectors[(a, k)] * entry(a, b) * eigenvectors[(b, k)];
            }
        }
    }

    /// `G_ij`: what the percussions of one contact do to the velocities of another, over the blocks that both touch.
    #[inline]
    fn fill_block(&self, i: &Rows, j: &Rows, block: &mut [f64]) {
        block.fill(0.0);
        for own in &self.sides[i.sides.clone()] {
            for other in self.sides[j.sides.clone()].iter().filter(|side| side.block == own.block) {
                let columns = j.part(0, other, &self.responses);
                for (a, sums) in block.chunks_exact_mut(j.len).enumerate() {
                    let row = &i.part(a, own, &self.directions).entries[..own.len];
                    columns.add_product(row, sums);
                }
            }
        }
    }

    /// The factors that forces have by the speed and, row by row, by the place, if it depends on it.
    #[inline]
    pub(super) fn factors_of_forces(&self) -> (&Factors, Option<&[f64]>) {
        (&self.factors, self.has_maps.then_some(&self.by_place))
    }

    /// Factors of the speed.
    #[inline]
    pub(super) fn factors(&mut self) -> &mut Factors {
        &mut self.factors
    }

    /// Coordinates and velocities at the end of the step, from the percussions.
    pub(super) fn finish(
        &mut self,
        system: &dyn System,
        percussion: &[f64],
        dt: f64,
        q: &mut [f64],
        u: &mut [f64],
    ) -> Result<(), SystemError> {
        if self.constant {
            let Self { free, responses, .. } = self;
            Part { entries: responses, width: free.len() }.add_transposed(percussion, free);
        } else {
            self.add_responses(percussion);
        }
        if !self.midpoint.held.is_empty() {
            system::hold(system, &self.midpoint, &mut self.free, dt)?;
        }
        system::finish(system, &mut self.midpoint, &self.free, dt, q, u)
    }

    /// Leaves of the free velocities what joints let pass at the midpoint; and what those before the step would change by
    /// until its end.
    fn let_pass(&mut self, system: &dyn System, dt: f64) -> Result<(), SystemError> {
        let Self { midpoint, free, passed, bend, .. } = self;
        passed.clone_from(&midpoint.before);
        for held in &midpoint.held {
            held.project(&mut free[held.velocities.clone()]);
            held.project(&mut passed[held.velocities.clone()]);
        }
        // Compliance leaves ever less of a velocity that a contact stops, until its square vanishes.
        let vanishes = |u: &&mut f64| **u * **u < f64::MIN_POSITIVE;
        free.iter_mut().filter(vanishes).for_each(|u| *u = 0.0);
        bend.clone_from(passed);
        system::hold(system, midpoint, bend, dt)?;
        bend.iter_mut().zip(passed).for_each(|(end, before)| *end -= *before);
        Ok(())
    }

    /// Adds what percussions change of the velocities.
    #[inline(never)]
    fn add_responses(&mut self, percussion: &[f64]) {
        for rows in &self.contacts {
            let own = &percussion[rows.first..rows.first + rows.len];
            for side in &self.sides[rows.sides.clone()] {
                let free = &mut self.free[side.velocity..side.velocity + side.len];
                rows.part(0, side, &self.responses).add_transposed(own, free);
            }
        }
    }
}

/// Number of velocities that a contact sees.
#[inline]
fn width(system: &dyn System, contact: usize) -> usize {
    let blocks = system.blocks();
    system.touched(contact).iter().map(|&block| blocks.range(block).len()).sum()
}

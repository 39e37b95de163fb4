//! Percussions that equilibrium leaves open: those of contacts of equal compliance.
//!
//! Feet whose normals depend on each other, `W_N z = 0` for some `z ≠ 0`, can share what they carry in many ways. Where they
//! slip in different directions, as those of a body that turns, its motion depends on their shares, and a solver would
//! choose by the order of contacts. The shares are those of contacts on springs of one and the same normal compliance ε,
//! `0 ≤ P_N ⊥ ξ_N + εP_N ≥ 0`, for ε → 0.
//!
//! In the limit the contacts L that carry load have `ξ_L = 0`, hence `Zᵀξ_L = −ε ZᵀP_L = 0` for the null space
//! `W_L Z = 0`: `P_L = W_Lᵀx`, which have the least sum of squares. With the orthogonal projection onto the columns of Z
//! times any `ρ > 0` added to `G_LL`, the contact problem has these shares and no others. A contact that those of L keep
//! closed has the share `w_iᵀx = βᵀP_L`, `β = N_LL⁺N_Li`: it belongs to L if this presses, and carries nothing if it would
//! pull.

use super::measure::stop::Stop;
use super::report::SolveReport;
use super::settings::{Solver, Steps};
use super::solve::{Workspace, grade};
use crate::contact::{
    BlockMatrix, ContactProblem, ContactRows, ContactState, Delassus, Memory, NormalForce, Phase,
};
use crate::linear::{BlockLu, DenseLu};
use crate::vectors::{dot, largest};

/// Normal velocity, over the largest one without percussions or by one of them, that counts as none: solvers leave as much.
const AT_REST: f64 = 1e-9;
/// The same over the largest velocity of all, which rounding leaves.
const ROUNDING: f64 = 1e-14;
/// The same as the first of contacts that may carry load, at the tolerance of the solver.
const MAY_CARRY: f64 = 1e-6;
/// Pivot over the largest entry that counts as zero, and share of the largest part of a matrix below which parts do.
pub(crate) const SINGULAR: f64 = 1e-11;
pub(crate) const RANK: f64 = 1e-10;
/// What is left of the mobility of a normal row beside others, over the whole, of a row that depends on them.
pub(crate) const DEPENDENT: f64 = 1e-10;
/// Normal force over the largest one that counts as none, beyond which a contact without load carries again: where its share
/// vanishes for good, rounding must not load and unload it in turns.
pub(crate) const LIGHT: f64 = 1e-10;
/// Difference of the friction of contacts per unit normal force that counts as none: feet that slip in one direction.
const SAME: f64 = 1e-9;
/// Most contacts of several bodies whose shares are looked for: their dense equations are solved several times.
const MOST_CONTACTS: usize = 16;
/// Compliance over the mean normal mobility at which contacts carry load as for ε → 0.
const STIFF: f64 = 1e-6;
/// How often contacts exchange load at most: at first, as stiff springs are a better start where it takes long; later, besides
/// once for each of them.
const EXCHANGES: usize = 4;
/// Outer steps of the proximal point iteration, which takes hundreds where it does not end soon: other starts lead on.
const OUTER: usize = 30;
/// Residual that counts as solved; what it is in the whole is looked at afterwards.
const ROUNDED: f64 = 1e-9;
/// Newton iterations that make what is found as accurate as rounding allows, so that it does not depend on the start.
const POLISH: usize = 8;

/// What is known of a problem whose shares are asked for.
pub(crate) struct Given<'a> {
    pub(crate) report: &'a SolveReport,
    /// What the contacts did before.
    pub(crate) history: &'a [ContactState],
    /// The factors of friction by place that rows have, if some differ.
    pub(crate) by_place: Option<&'a [f64]>,
}

/// What shares are found with, kept from one step to the next as long as contacts and laws stay.
#[derive(Debug, Clone, Default)]
pub(crate) struct Shares {
    /// Contacts that may share, and their normal mobilities.
    closed: Vec<usize>,
    normals: BlockLu,
    before: Memory,
    /// Of the islands that have shared, at their numbers.
    islands: Vec<Equations>,
}

impl Shares {
    /// Puts the percussions of equal compliance in place of those of a solution, in every island of one body or of few contacts whose
    /// motion depends on their shares; the new report, if there is such an island.
    pub(crate) fn find(
        &mut self,
        problem: &ContactProblem,
        stop: Stop<'_>,
        &Given { report, history, by_place }: &Given<'_>,
        memory: &mut Memory,
        workspace: &mut Workspace,
    ) -> Option<SolveReport> {
        if problem.contacts().len() < 2 || problem.delassus().is_matrix_free() {
            return None;
        }
        let mut shared = false;
        for number in 0..workspace.members().count() {
            let contacts = workspace.members().of(number);
            let feet = Feet { problem, contacts, velocity: workspace.velocity(), by_place };
            let Self { closed, normals, .. } = self;
            if feet.may_share()
                && feet.motion_depends_on_shares(memory, stop.tolerance, closed, normals)
            {
                if !shared {
                    self.before.copy_from(memory);
                }
                if self.islands.len() <= number {
                    self.islands.resize_with(number + 1, Equations::default);
                }
                let found = self.islands[number].share(&feet, stop, history, memory);
                shared |= found.is_some();
            }
        }
        if !shared {
            return None;
        }
        let found = grade(problem, stop, memory, workspace);
        if found.residual > f64::max(stop.tolerance, report.residual) {
            memory.copy_from(&self.before);
            problem.velocity(&memory.percussion, &mut workspace.velocity);
            return None;
        }
        Some(SolveReport {
            residual: found.residual,
            worst_contact: found.worst_contact,
            ..*report
        })
    }
}

/// The contacts of an island.
struct Feet<'p> {
    problem: &'p ContactProblem,
    contacts: &'p [usize],
    velocity: &'p [f64],
    by_place: Option<&'p [f64]>,
}

impl Feet<'_> {
    /// Whether they are those of one body, which all meet each other, or few.
    fn may_share(&self) -> bool {
        let blocks = self.problem.delassus().blocks();
        let count = self.contacts.len();
        let meets_all = |&i: &usize| blocks.neighbours(i).len() == count;
        count > 1 && (count <= MOST_CONTACTS || self.contacts.iter().all(meets_all))
    }

    fn rows(&self) -> impl Iterator<Item = &ContactRows> {
        self.contacts.iter().map(|&i| &self.problem.contacts()[i])
    }

    /// `b + e γ_B` of a row.
    fn load(&self, row: usize) -> f64 {
        self.problem.free_velocity()[row] + self.problem.restitution()[row]
    }

    /// The largest normal velocity without percussions or by one of them.
    fn speed(&self, memory: &Memory) -> f64 {
        let speed = |&i: &usize| {
            let rows = &self.problem.contacts()[i];
            if rows.normal != NormalForce::Unilateral {
                return 0.0;
            }
            let own = self.problem.delassus().own(i, 0, 0) * memory.percussion[rows.offset];
            f64::max(self.load(rows.offset).abs(), own)
        };
        self.contacts.iter().map(speed).fold(0.0, f64::max)
    }

    /// Whether contacts that are closed can share their load in many ways, and their friction tells them apart.
    fn motion_depends_on_shares(
        &self,
        memory: &Memory,
        tolerance: f64,
        carrying: &mut Vec<usize>,
        normals: &mut BlockLu,
    ) -> bool {
        let percussion = &memory.percussion;
        let fastest = self.rows().flat_map(ContactRows::rows).map(|row| self.load(row).abs());
        let rounding = ROUNDING * fastest.fold(0.0, f64::max);
        let speed = self.speed(memory);
        let at_rest = f64::max(MAY_CARRY * speed, rounding);
        let still = f64::max(f64::max(AT_REST, tolerance) * speed, rounding);
        let most = self.rows().map(|rows| rows.normal_percussion(percussion)).fold(0.0, f64::max);
        let xi = |row: usize| self.velocity[row] + self.problem.restitution()[row];
        let closed = |rows: &ContactRows| {
            rows.normal == NormalForce::Unilateral
                && (percussion[rows.offset] > 0.0 || xi(rows.offset) <= at_rest)
        };
        let (mut first, mut sticks, mut differ) = (None, false, false);
        carrying.clear();
        for &i in self.contacts {
            let rows = &self.problem.contacts()[i];
            if !closed(rows) {
                continue;
            }
            carrying.push(i);
            let normal = percussion[rows.offset];
            let mut friction = [0.0; 3];
            if normal > LIGHT * most {
                if memory.states[i].phase == Phase::Stick {
                    sticks = true;
                    continue;
                }
                let own = friction.iter_mut().zip(&percussion[rows.tangential_rows()]);
                own.for_each(|(to, force)| *to = force / normal);
            } else {
                let slip = friction.iter_mut().zip(rows.tangential_rows());
                slip.for_each(|(to, row)| *to = xi(row));
                // What slides no faster than the solver leaves has no direction.
                if largest(&friction) <= still {
                    sticks = true;
                    continue;
                }
                match rows.law.sliding(&friction[..rows.law.dimension()]) {
                    Some(force) => friction = force,
                    None => continue,
                }
            }
            let by_place = self.by_place.map_or(1.0, |factors| factors[rows.offset]);
            let friction = friction.map(|force| by_place * force);
            let first = *first.get_or_insert(friction);
            differ |= friction.iter().zip(&first).any(|(a, b)| (a - b).abs() > SAME);
        }
        let count = carrying.len();
        if count < 2 || !(differ || sticks && first.is_some()) {
            return false;
        }
        let entries = normals.begin(count);
        entries.fill(0.0);
        for (k, &i) in carrying.iter().enumerate() {
            let offset = self.problem.contacts()[i].offset;
            self.problem.each_entry(i, offset, |j, column, entry| {
                let place = carrying.binary_search(&j);
                if let (true, Ok(l)) = (column == self.problem.contacts()[j].offset, place) {
                    entries[k * count + l] = entry;
                }
            });
        }
        !normals.factor(SINGULAR)
    }
}

/// The rows of a contact in its island.
#[derive(Debug, Clone)]
struct Rows {
    offset: usize,
    len: usize,
    unilateral: bool,
}

impl Rows {
    fn range(&self) -> std::ops::Range<usize> {
        self.offset..self.offset + self.len
    }
}

/// `ξ = G P + b + e γ_B` of an island, and the problem of the contacts that carry load.
#[derive(Debug, Clone, Default)]
struct Equations {
    contacts: Vec<Rows>,
    /// `G`, row by row.
    effects: Vec<f64>,
    load: Vec<f64>,
    percussion: Vec<f64>,
    velocity: Vec<f64>,
    /// Whether each contact carries load, and the normal rows of those that do.
    carries: Vec<bool>,
    normals: Vec<usize>,
    /// The projection onto the null space of their rows, what is left of `N` there, and the factors of `N` with it.
    projection: Vec<f64>,
    rest: Vec<f64>,
    factors: DenseLu,
    weights: Vec<f64>,
    /// The contacts of the problem, in the island.
    with: Vec<usize>,
    problem: Option<ContactProblem>,
    history: Vec<ContactState>,
    found: Memory,
    start: Memory,
    workspace: Option<Box<Workspace>>,
    wrong: Vec<usize>,
}

impl Equations {
    /// Finds the contacts that carry load, and what they carry; nothing where they are not found.
    fn share(
        &mut self,
        feet: &Feet<'_>,
        stop: Stop<'_>,
        history: &[ContactState],
        memory: &mut Memory,
    ) -> Option<()> {
        let at_rest = self.begin(feet, history, memory);
        let many = self.contacts.len() + EXCHANGES;
        if self.exchange(feet, stop, at_rest, EXCHANGES).is_none() {
            self.begin(feet, history, memory);
            let loaded = self.load_springs(feet, stop);
            if loaded.and_then(|()| self.exchange(feet, stop, at_rest, many)).is_none() {
                self.begin(feet, history, memory);
                self.exchange(feet, stop, at_rest, many)?;
            }
        }
        self.put(feet, memory);
        Some(())
    }

    /// Begins where the solver ended, with all contacts that may carry load; the velocity that counts as none.
    fn begin(&mut self, feet: &Feet<'_>, history: &[ContactState], memory: &Memory) -> f64 {
        self.take(feet, history, memory);
        let (rounding, speed) = (ROUNDING * largest(&self.load), feet.speed(memory));
        self.find_velocity();
        let may_carry = f64::max(MAY_CARRY * speed, rounding);
        self.carries.clear();
        self.carries.extend(self.contacts.iter().map(|own| {
            let (force, xi) = (self.percussion[own.offset], self.velocity[own.offset]);
            !own.unilateral || force > 0.0 || xi <= may_carry
        }));
        f64::max(AT_REST * speed, rounding)
    }

    /// Finds the contacts that carry load on stiff springs: from others, exchange may be long or go round in circles.
    fn load_springs(&mut self, feet: &Feet<'_>, stop: Stop<'_>) -> Option<()> {
        self.carries.fill(true);
        let compliance = STIFF * self.take_normals();
        self.projection.iter_mut().for_each(|entry| *entry *= compliance);
        self.solve(feet, stop)?;
        let none = self.light();
        for (carries, own) in self.carries.iter_mut().zip(&self.contacts) {
            *carries = !own.unilateral || self.percussion[own.offset] > none;
        }
        Some(())
    }

    /// The normal percussion that counts as none.
    fn light(&self) -> f64 {
        let forces = self.normals.iter().map(|&row| self.percussion[row]);
        LIGHT * forces.fold(0.0, f64::max)
    }

    /// Lets contacts take up and give up load until all have the right sign.
    fn exchange(
        &mut self,
        feet: &Feet<'_>,
        stop: Stop<'_>,
        at_rest: f64,
        most: usize,
    ) -> Option<()> {
        for _ in 0..=most {
            self.factor_normals();
            self.solve(feet, stop)?;
            self.find_wrong_signs(at_rest);
            if self.wrong.is_empty() {
                return Some(());
            }
            self.wrong.iter().for_each(|&k| self.carries[k] = !self.carries[k]);
        }
        None
    }

    fn take(&mut self, feet: &Feet<'_>, history: &[ContactState], memory: &Memory) {
        for list in [&mut self.effects, &mut self.load, &mut self.percussion] {
            list.clear();
        }
        self.contacts.clear();
        for own in feet.rows() {
            let unilateral = own.normal == NormalForce::Unilateral;
            self.contacts.push(Rows { offset: self.load.len(), len: own.len(), unilateral });
            for row in own.rows() {
                self.load.push(feet.load(row));
                self.percussion.push(memory.percussion[row]);
            }
        }
        let n = self.load.len();
        self.effects.resize(n * n, 0.0);
        let Self { effects, contacts, .. } = self;
        let mut effects = effects.chunks_exact_mut(n);
        for (&i, own) in feet.contacts.iter().zip(feet.rows()) {
            for (row, effects) in own.rows().zip(&mut effects) {
                feet.problem.each_entry(i, row, |j, column, entry| {
                    if let Ok(place) = feet.contacts.binary_search(&j) {
                        let first = feet.problem.contacts()[j].offset;
                        effects[contacts[place].offset + column - first] = entry;
                    }
                });
            }
        }
        self.history.clear();
        self.history.extend(feet.contacts.iter().map(|&i| history[i]));
    }

    /// Hands over what was found.
    fn put(&self, feet: &Feet<'_>, memory: &mut Memory) {
        for (own, rows) in self.contacts.iter().zip(feet.rows()) {
            memory.percussion[rows.rows()].copy_from_slice(&self.percussion[own.range()]);
        }
        for (&i, before) in feet.contacts.iter().zip(&self.history) {
            memory.states[i] = before.after(Phase::Open, [0.0; 3]);
        }
        for (&k, &state) in self.with.iter().zip(&self.found.states) {
            memory.states[feet.contacts[k]] = state;
        }
    }

    fn effect(&self, row: usize, column: usize) -> f64 {
        self.effects[row * self.load.len() + column]
    }

    fn find_velocity(&mut self) {
        let rows = self.effects.chunks_exact(self.load.len()).zip(&self.load);
        self.velocity.clear();
        self.velocity.extend(rows.map(|(row, load)| dot(row, &self.percussion) + load));
    }

    /// Takes the normal rows of the contacts that carry load, `N` and the unit matrix; the mean of the diagonal of `N`.
    fn take_normals(&mut self) -> f64 {
        self.normals.clear();
        let with = self.contacts.iter().zip(&self.carries);
        let with = with.filter(|(own, carries)| own.unilateral && **carries);
        self.normals.extend(with.map(|(own, _)| own.offset));
        let n = self.normals.len();
        self.rest.clear();
        self.projection.clear();
        for (k, &row) in self.normals.iter().enumerate() {
            for (l, &column) in self.normals.iter().enumerate() {
                self.rest.push(self.effects[row * self.load.len() + column]);
                self.projection.push(if k == l { 1.0 } else { 0.0 });
            }
        }
        (0..n).map(|k| self.rest[k * n + k]).sum::<f64>() / n.max(1) as f64
    }

    /// The projection `ρP` onto the null space of the normal rows of the contacts that carry load, by Gram and Schmidt's
    /// method with the largest column first, ρ the mean of the diagonal of `N`; and the factors of `N + ρP`.
    fn factor_normals(&mut self) {
        let scale = self.take_normals();
        let n = self.normals.len();
        if n == 0 {
            return;
        }
        let entries = self.factors.begin(n);
        entries.copy_from_slice(&self.rest);
        let mut first = 0.0;
        for _ in 0..n {
            let size = |row: &[f64]| dot(row, row).sqrt();
            let rows = self.rest.chunks_exact(n).map(size).enumerate();
            let Some((k, size)) = rows.max_by(|a, b| a.1.total_cmp(&b.1)) else { break };
            first = f64::max(first, size);
            if size <= RANK * first {
                break;
            }
            // Projected twice, as rounding of the first time is in the way of small parts.
            self.weights.clear();
            let own = &self.rest[k * n..][..n];
            self.weights.extend(self.projection.chunks_exact(n).map(|row| dot(row, own)));
            let length = dot(&self.weights, &self.weights).sqrt();
            self.weights.iter_mut().for_each(|weight| *weight /= length);
            for matrix in [&mut self.rest, &mut self.projection] {
                for row in matrix.chunks_exact_mut(n) {
                    let part = dot(row, &self.weights);
                    row.iter_mut().zip(&self.weights).for_each(|(x, q)| *x -= part * q);
                }
            }
            // What is left of a row that has been taken is rounding.
            self.rest[k * n..][..n].fill(0.0);
        }
        for (shared, entry) in self.projection.iter_mut().zip(entries) {
            *shared *= scale;
            *entry += *shared;
        }
        // What is not finite has no shares of the right sign.
        self.factors.factor(0.0);
    }

    /// Finds the shares of the contacts that carry load.
    fn solve(&mut self, feet: &Feet<'_>, stop: Stop<'_>) -> Option<()> {
        let stays = self.problem.is_some()
            && self.with.iter().copied().eq((0..self.carries.len()).filter(|&k| self.carries[k]));
        if !stays {
            self.with.clear();
            self.with.extend((0..self.carries.len()).filter(|&k| self.carries[k]));
            let sizes: Vec<usize> = self.with.iter().map(|&k| self.contacts[k].len).collect();
            let contact = |&k: &usize| {
                let contact = &feet.problem.contacts()[feet.contacts[k]];
                (contact.law.clone(), contact.normal)
            };
            let delassus = BlockMatrix::full(&sizes, |_, _| 0.0);
            let contacts = self.with.iter().map(contact);
            self.problem = Some(ContactProblem::assemble(contacts, delassus.into()));
        }
        if self.with.is_empty() {
            self.problem = None;
            self.found.states.clear();
            self.percussion.fill(0.0);
            self.find_velocity();
            return Some(());
        }
        let Self { problem, with, contacts, normals, .. } = self;
        let mut problem = problem.take()?;
        let rows = || with.iter().flat_map(|&k| contacts[k].range());
        let place = |row: usize| normals.binary_search(&row).ok();
        problem.refill(|delassus| {
            let Delassus::Blocks(blocks) = delassus else { return };
            let mut values = blocks.values_mut().iter_mut();
            for own in with.iter().map(|&k| &contacts[k]) {
                for other in with.iter().map(|&k| &contacts[k]) {
                    for row in own.range() {
                        for (column, value) in other.range().zip(&mut values) {
                            let shared = place(row).zip(place(column));
                            let shared =
                                shared.map_or(0.0, |(a, b)| self.projection[a * normals.len() + b]);
                            *value = self.effects[row * self.load.len() + column] + shared;
                        }
                    }
                }
            }
        });
        let free = problem.free_velocity_mut().iter_mut().zip(rows());
        free.for_each(|(free, row)| *free = self.load[row]);
        for (own, &k) in problem.contacts_mut().iter_mut().zip(&*with) {
            own.normal = feet.problem.contacts()[feet.contacts[k]].normal;
        }
        self.start.percussion.clear();
        self.start.percussion.extend(rows().map(|row| self.percussion[row]));
        self.start.states.clear();
        self.start.states.extend(with.iter().map(|&k| self.history[k]));
        let workspace = self.workspace.get_or_insert_default();
        if stays {
            workspace.refresh(&problem)
        } else {
            workspace.prepare(&problem)
        }
        let solved = solve(&problem, stop, &self.start, &mut self.found, workspace);
        self.percussion.fill(0.0);
        let forces = rows().zip(&self.found.percussion);
        forces.for_each(|(row, force)| self.percussion[row] = *force);
        self.problem = Some(problem);
        self.find_velocity();
        solved.then_some(())
    }

    /// Finds the contacts that carry load and would pull; else those that part, and only then others that approach or would
    /// press.
    fn find_wrong_signs(&mut self, at_rest: f64) {
        let none = self.light();
        let mut wrong = std::mem::take(&mut self.wrong);
        wrong.clear();
        let (contacts, carries) = (&self.contacts, &self.carries);
        let own = |k: usize| contacts[k].offset;
        let unilateral = |carry: bool| {
            let is_one = move |k: &usize| contacts[*k].unilateral && carries[*k] == carry;
            (0..contacts.len()).filter(is_one)
        };
        wrong.extend(unilateral(true).filter(|&k| self.percussion[own(k)] <= none));
        if wrong.is_empty() {
            wrong.extend(unilateral(true).filter(|&k| self.velocity[own(k)] > at_rest));
        }
        if wrong.is_empty() {
            let mut weights = std::mem::take(&mut self.weights);
            wrong.extend(unilateral(false).filter(|&k| {
                let xi = self.velocity[own(k)];
                xi < -at_rest || xi <= at_rest && self.presses(own(k), none, &mut weights)
            }));
            self.weights = weights;
        }
        self.wrong = wrong;
    }

    /// Whether a contact is closed by those that carry load, and its share in this presses.
    fn presses(&self, own: usize, none: f64, weights: &mut Vec<f64>) -> bool {
        weights.clear();
        weights.extend(self.normals.iter().map(|&row| self.effect(row, own)));
        if weights.is_empty() || !self.factors.solve(weights) {
            return false;
        }
        let (mut left, mut share) = (self.effect(own, own), 0.0);
        for (&row, weight) in self.normals.iter().zip(&*weights) {
            left -= self.effect(own, row) * weight;
            share += self.percussion[row] * weight;
        }
        left <= DEPENDENT * self.effect(own, own) && share > none
    }
}

/// Solves a problem from `start`, to rounding if it can be; whether it is solved.
fn solve(
    problem: &ContactProblem,
    stop: Stop<'_>,
    start: &Memory,
    found: &mut Memory,
    workspace: &mut Workspace,
) -> bool {
    let finest = Stop { tolerance: f64::EPSILON, ..stop };
    found.copy_from(start);
    if workspace.polish(problem, finest, found, POLISH) <= stop.tolerance {
        return true;
    }
    found.copy_from(start);
    let steps = Steps::ALL.without("proximal_point").unwrap_or(Steps::ALL);
    let report = Solver::Auto { steps, threads: 1 }.solve_prepared(problem, stop, found, workspace);
    if report.residual > ROUNDED {
        let last = Solver::ProximalPoint { max_iterations: OUTER };
        last.solve_prepared(problem, stop, found, workspace);
    }
    found.states.clone_from(&start.states);
    workspace.polish(problem, finest, found, POLISH) <= ROUNDED
}

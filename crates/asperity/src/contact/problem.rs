//! Delassus operator, free velocities and laws in; percussions out.

use std::num::NonZeroU64;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

use super::{Delassus, IntoDelassus};
use crate::argument::{ArgumentError, check, finite, length, not_negative, refuse};
use crate::law::Law;
use crate::vectors::unrolled;

/// Largest velocity, percussion and product of the two with an entry of `G`: solvers take squares and cubes of them.
pub(crate) const LARGEST: f64 = 1e100;
/// Least value of the largest velocity, if any is not zero, and of the percussion that belongs to it: squares of values far
/// below vanish, and no percussions would look like a solution.
const SMALLEST: f64 = 1e-100;

/// How the normal force of a contact is found. In a [`ContactProblem`] it is a percussion in N s, in a system a force in N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NormalForce {
    /// It is given and not negative; the contact has tangential rows only.
    Prescribed(f64),
    /// `0 ≤ P_N ⊥ ξ_N ≥ 0`; the normal row comes first.
    Unilateral,
}

impl NormalForce {
    /// Whether the contact finds it by itself.
    #[inline]
    pub fn is_unilateral(self) -> bool {
        matches!(self, Self::Unilateral)
    }

    /// Its value, if it is given.
    #[inline]
    pub fn prescribed(self) -> Option<f64> {
        match self {
            Self::Prescribed(value) => Some(value),
            Self::Unilateral => None,
        }
    }
}

impl From<Option<f64>> for NormalForce {
    fn from(prescribed: Option<f64>) -> Self {
        prescribed.map_or(Self::Unilateral, Self::Prescribed)
    }
}

/// One contact of a problem.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactRows {
    /// Friction law.
    pub law: Law,
    /// Normal force.
    pub normal: NormalForce,
    /// First row.
    pub offset: usize,
}

impl ContactRows {
    /// Number of normal rows, 0 or 1.
    pub fn normal_rows(&self) -> usize {
        usize::from(self.normal.is_unilateral())
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.normal_rows() + self.law.dimension()
    }

    /// Whether the contact has no rows: problems refuse those without friction and with a prescribed normal force.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// First tangential row.
    pub fn tangent(&self) -> usize {
        self.offset + self.normal_rows()
    }

    /// All rows.
    #[inline]
    pub fn rows(&self) -> Range<usize> {
        self.offset..self.offset + self.len()
    }

    /// Normal percussion: the prescribed one, or that of the normal row.
    #[inline]
    pub fn normal_percussion(&self, percussion: &[f64]) -> f64 {
        self.normal.prescribed().unwrap_or_else(|| percussion[self.offset])
    }

    /// Tangential rows.
    #[inline]
    pub fn tangential_rows(&self) -> Range<usize> {
        self.tangent()..self.offset + self.len()
    }
}

/// Gives every contact its rows, one contact after the other; also the number of rows.
fn number_rows(
    contacts: impl IntoIterator<Item = (Law, NormalForce)>,
) -> (Vec<ContactRows>, usize) {
    let mut offset = 0;
    let number = |(law, normal)| {
        let rows = ContactRows { law, normal, offset };
        offset += rows.len();
        rows
    };
    let contacts = contacts.into_iter().map(number).collect();
    (contacts, offset)
}

/// `γ_E = G P + b` with the contact laws between the percussions `P` and `ξ = γ_E + e γ_B`
/// (\[WL19\] (19), restitution as usual). Nothing in it knows the mechanical system.
#[derive(Debug, Clone)]
pub struct ContactProblem {
    /// `G`, not necessarily symmetric.
    delassus: Delassus,
    /// `b`.
    free_velocity: Vec<f64>,
    /// `e γ_B`.
    restitution: Vec<f64>,
    contacts: Vec<ContactRows>,
    /// `ρ = rows/tr G` of every contact's own block, the prox parameter of the residual.
    rho: Vec<f64>,
    /// What tells the operator and the laws from those of other problems. Clones share it, as neither ever changes; a
    /// problem whose operator an integrator refills has none.
    identity: Option<NonZeroU64>,
}

impl PartialEq for ContactProblem {
    /// Whether the data are the same, whoever has made them.
    fn eq(&self, other: &Self) -> bool {
        self.delassus == other.delassus
            && self.free_velocity == other.free_velocity
            && self.restitution == other.restitution
            && self.contacts == other.contacts
    }
}

/// A number that no other problem of this process has.
fn new_identity() -> Option<NonZeroU64> {
    static LAST: AtomicU64 = AtomicU64::new(0);
    NonZeroU64::new(LAST.fetch_add(1, Ordering::Relaxed).wrapping_add(1))
}

impl ContactProblem {
    /// A problem without restitution.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] if `free_velocity` or the operator has not one row per row of the contacts, if a number is not
    /// finite, a prescribed normal percussion is negative or that of a contact without friction, or the diagonal of the
    /// operator is not positive, if numbers are so large that their squares are none, or if a law depends on the sliding
    /// speed.
    pub fn new(
        delassus: impl IntoDelassus,
        free_velocity: Vec<f64>,
        contacts: impl IntoIterator<Item = (Law, NormalForce)>,
    ) -> Result<Self, ArgumentError> {
        let (contacts, offset) = number_rows(contacts);
        length("free_velocity", offset, free_velocity.len())?;
        if contacts.iter().any(ContactRows::is_empty) {
            return refuse("normal_force", "must be left out of a contact without friction");
        }
        let sizes: Vec<usize> = contacts.iter().map(ContactRows::len).collect();
        let delassus = delassus.into_delassus(&sizes)?;
        finite("delassus", delassus.blocks().values())?;
        finite("free_velocity", &free_velocity)?;
        for (i, contact) in contacts.iter().enumerate() {
            if contact.law.rate().is_some() {
                let message =
                    "must not have a factor of the speed; scale the tangential columns of G by it";
                return refuse("laws", message);
            }
            not_negative("normal_force", contact.normal.prescribed().unwrap_or(0.0))?;
            for a in 0..contact.len() {
                let value = delassus.own(i, a, a);
                check("delassus", value, value > 0.0, "positive on its diagonal")?;
            }
        }
        check_sizes(&delassus, &free_velocity, &contacts)?;
        let (restitution, rho) = (vec![0.0; offset], vec![0.0; contacts.len()]);
        let identity = new_identity();
        let mut problem = Self { delassus, free_velocity, restitution, contacts, rho, identity };
        problem.update_rho();
        let allowed =
            "zero everywhere, or 1e-100 and more somewhere, also divided by the entries of G";
        problem.check_reach("free_velocity", &problem.free_velocity, allowed)?;
        Ok(problem)
    }

    /// The problem of an integrator, without velocities.
    ///
    /// Laws may depend on the speed here, and the operator may still be filled in with
    /// [`refill`](Self::refill); whoever does so makes sure that its entries are finite and its diagonal positive.
    pub(crate) fn assemble(
        contacts: impl IntoIterator<Item = (Law, NormalForce)>,
        delassus: Delassus,
    ) -> Self {
        let (contacts, rows) = number_rows(contacts);
        let (velocities, rho) = (vec![0.0; rows], vec![0.0; contacts.len()]);
        let restitution = velocities.clone();
        let (free_velocity, identity) = (velocities, None);
        let mut problem = Self { delassus, free_velocity, restitution, contacts, rho, identity };
        problem.update_rho();
        problem
    }

    /// Changes the entries of the operator, and what is derived from them.
    #[inline]
    pub(crate) fn refill(&mut self, fill: impl FnOnce(&mut Delassus)) {
        fill(&mut self.delassus);
        self.update_rho();
    }

    /// The problem with restitution: coefficients `e_N`, `e_T` per contact and velocities `γ_B` before,
    /// row by row.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] if there are not as many coefficients as contacts and velocities as rows, or if a number is not
    /// finite or its product too large or too small to be squared.
    pub fn with_restitution(
        mut self,
        normal: &[f64],
        tangential: &[f64],
        initial_velocity: &[f64],
    ) -> Result<Self, ArgumentError> {
        length("normal_restitution", self.contacts.len(), normal.len())?;
        length("tangential_restitution", self.contacts.len(), tangential.len())?;
        length("initial_velocity", self.rows(), initial_velocity.len())?;
        finite("normal_restitution", normal)?;
        finite("tangential_restitution", tangential)?;
        finite("initial_velocity", initial_velocity)?;
        for ((contact, e_n), e_t) in self.contacts.iter().zip(normal).zip(tangential) {
            let own = contact.rows();
            let terms = self.restitution[own.clone()].iter_mut().zip(&initial_velocity[own]);
            for (k, (term, velocity)) in terms.enumerate() {
                *term = velocity * if k < contact.normal_rows() { e_n } else { e_t };
            }
        }
        for &term in &self.restitution {
            let allowed = "at most 1e100 times the restitution";
            check("initial_velocity", term, term.abs() <= LARGEST, allowed)?;
        }
        if self.free_velocity.iter().all(|b| *b == 0.0) {
            let allowed = "zero everywhere, or 1e-100 and more somewhere, times the restitution and divided by the entries of G";
            self.check_reach("initial_velocity", &self.restitution, allowed)?;
        }
        Ok(self)
    }

    /// `b` and `e γ_B`, to be changed.
    pub(super) fn velocities_mut(&mut self) -> (&mut [f64], &mut [f64]) {
        (&mut self.free_velocity, &mut self.restitution)
    }

    /// The contacts, to be changed in their normal percussions.
    pub(crate) fn contacts_mut(&mut self) -> &mut [ContactRows] {
        &mut self.contacts
    }

    /// Whether no contact influences another.
    #[inline]
    pub(crate) fn is_uncoupled(&self) -> bool {
        !self.delassus.is_matrix_free() && self.delassus.blocks().is_block_diagonal()
    }

    /// Calls `each` with contact, column and entry of a contact's row; of a matrix-free operator with its own block.
    pub(crate) fn each_entry(
        &self,
        contact: usize,
        row: usize,
        mut each: impl FnMut(usize, usize, f64),
    ) {
        let local = row - self.contacts[contact].offset;
        for (j, block) in self.delassus.blocks().row(contact) {
            let columns = self.contacts[j].rows();
            let entries = &block[local * columns.len()..(local + 1) * columns.len()];
            columns.zip(entries).for_each(|(column, g)| each(j, column, *g));
        }
    }

    /// Brings `ρ` up to date with the Delassus operator.
    fn update_rho(&mut self) {
        for (i, (rho, contact)) in self.rho.iter_mut().zip(&self.contacts).enumerate() {
            let diagonal = |a| self.delassus.own(i, a, a);
            *rho = contact.len() as f64 / (0..contact.len()).map(diagonal).sum::<f64>().abs();
        }
    }

    /// `ρ = rows/tr G` of the whole problem.
    pub fn global_rho(&self) -> f64 {
        let traces = self.contacts.iter().zip(&self.rho).map(|(c, rho)| c.len() as f64 / rho);
        self.rows() as f64 / traces.sum::<f64>()
    }

    /// `‖b + e γ_B‖`.
    pub(crate) fn load_norm(&self) -> f64 {
        let loads = self.free_velocity.iter().zip(&self.restitution);
        loads.map(|(b, e)| (b + e) * (b + e)).sum::<f64>().sqrt()
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.free_velocity.len()
    }

    /// The contacts with their rows.
    #[inline]
    pub fn contacts(&self) -> &[ContactRows] {
        &self.contacts
    }

    /// The contacts alone.
    pub(crate) fn into_contacts(self) -> Vec<ContactRows> {
        self.contacts
    }

    /// Delassus operator `G`.
    #[inline]
    pub fn delassus(&self) -> &Delassus {
        &self.delassus
    }

    /// Free velocities `b`.
    #[inline]
    pub fn free_velocity(&self) -> &[f64] {
        &self.free_velocity
    }

    /// Free velocities `b`, to be changed.
    #[inline]
    pub(crate) fn free_velocity_mut(&mut self) -> &mut [f64] {
        &mut self.free_velocity
    }

    /// Restitution terms `e γ_B`.
    #[inline]
    pub fn restitution(&self) -> &[f64] {
        &self.restitution
    }

    /// Restitution terms `e γ_B`, to be changed.
    #[inline]
    pub(crate) fn restitution_mut(&mut self) -> &mut [f64] {
        &mut self.restitution
    }

    /// `ρ = rows/tr G` of a contact's own block, the prox parameter of the residual.
    #[inline]
    pub(crate) fn rho(&self, contact: usize) -> f64 {
        self.rho[contact]
    }

    /// Velocities `ξ = G P + b + e γ_B` of a contact's rows by all percussions, or by those of the others only.
    #[inline(always)]
    pub(crate) fn contact_velocity(
        &self,
        i: usize,
        percussion: &[f64],
        with_own: bool,
    ) -> [f64; 4] {
        let mut sum = self.load(i);
        self.delassus.blocks().add_row(i, percussion, with_own, &mut sum);
        sum
    }

    /// Velocities `b + e γ_B` of a contact's rows without percussions.
    #[inline(always)]
    pub(crate) fn load(&self, i: usize) -> [f64; 4] {
        let rows = self.contacts[i].rows();
        let (free, restitution) = (&self.free_velocity[rows.clone()], &self.restitution[rows]);
        let mut load = [0.0; 4];
        unrolled!(n = free.len() => {
            let (free, restitution) = (&free[..n], &restitution[..n]);
            for k in 0..n {
                load[k] = free[k] + restitution[k];
            }
        });
        load
    }

    /// Largest sum of magnitudes `|G_ij|` over a contact's rows, over its own columns or all.
    pub(crate) fn row_sum_bound(&self, i: usize, own_only: bool) -> f64 {
        if let Delassus::MatrixFree(operator) = &self.delassus {
            return operator.norm();
        }
        let mut sums = [0.0; 4];
        for (_, block) in self.delassus.blocks().row(i).filter(|(j, _)| !own_only || *j == i) {
            let columns = block.len() / self.contacts[i].len();
            for (sum, row) in sums.iter_mut().zip(block.chunks_exact(columns)) {
                *sum += row.iter().map(|g| g.abs()).sum::<f64>();
            }
        }
        sums.into_iter().fold(0.0, f64::max)
    }

    /// Velocities `γ_E = G P + b` in m/s of percussions in N s, row by row.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] if there is not one percussion per row.
    pub fn velocities(&self, percussion: &[f64]) -> Result<Vec<f64>, ArgumentError> {
        self.check_rows("percussion", percussion)?;
        let mut velocity = vec![0.0; self.rows()];
        self.velocity(percussion, &mut velocity);
        Ok(velocity)
    }

    /// Refuses velocities that are not zero but so small, all of them, that the squares of percussions or velocities vanish.
    fn check_reach(
        &self,
        argument: &'static str,
        velocities: &[f64],
        allowed: &str,
    ) -> Result<(), ArgumentError> {
        let largest = velocities.iter().fold(0.0, |largest: f64, b| largest.max(b.abs()));
        let reach = self.rho.iter().fold(1.0, |least: f64, rho| least.min(*rho));
        let fits = largest == 0.0 || largest * reach >= SMALLEST;
        check(argument, largest, fits, allowed).map(|_| ())
    }

    /// Refuses what has not one number per row.
    pub(crate) fn check_rows(
        &self,
        argument: &'static str,
        values: &[f64],
    ) -> Result<(), ArgumentError> {
        length(argument, self.rows(), values.len())
    }

    /// What tells the operator and the laws from those of other problems, if they never change.
    #[inline]
    pub(crate) fn identity(&self) -> Option<NonZeroU64> {
        self.identity
    }

    /// `velocity ← G P + b`.
    #[inline]
    pub(crate) fn velocity(&self, percussion: &[f64], velocity: &mut [f64]) {
        debug_assert_eq!(percussion.len(), self.rows());
        // Most solves begin without percussions.
        if percussion.iter().all(|p| *p == 0.0) {
            velocity.fill(0.0);
        } else {
            self.delassus.apply(percussion, velocity);
        }
        for (value, free) in velocity.iter_mut().zip(&self.free_velocity) {
            *value += free;
        }
    }
}

/// Refuses velocities and normal percussions whose squares, or those of what follows from them, would overflow.
fn check_sizes(
    delassus: &Delassus,
    free_velocity: &[f64],
    contacts: &[ContactRows],
) -> Result<(), ArgumentError> {
    let diagonal = contacts
        .iter()
        .enumerate()
        .flat_map(|(i, contact)| (0..contact.len()).map(move |a| delassus.own(i, a, a)));
    let (smallest, largest) =
        diagonal.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), g| (low.min(g), high.max(g)));
    let reach = f64::max(1.0, f64::max(largest, 1.0 / smallest));
    for &b in free_velocity {
        let allowed = "at most 1e100, also times and divided by the entries of G";
        check("free_velocity", b, b.abs() * reach <= LARGEST, allowed)?;
    }
    for value in contacts.iter().filter_map(|contact| contact.normal.prescribed()) {
        let allowed = "at most 1e100, also times the entries of G";
        check("normal_force", value, value * f64::max(1.0, largest) <= LARGEST, allowed)?;
    }
    Ok(())
}

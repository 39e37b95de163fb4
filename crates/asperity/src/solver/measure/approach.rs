//! Contacts that move although their percussions say otherwise, and percussions that run away.
//!
//! Residuals are relative to percussions: where these grow without bound while contacts go on approaching, as
//! they do where no percussions are admissible, every relative defect becomes small. Velocities are therefore compared with
//! loads, contact by contact: with `l_i` the velocity that a contact would have without unilateral percussions, the defect of
//! `0 ≤ P_N ⊥ ξ_N ≥ 0` as a velocity, `|min(ξ_N, G_NN P_N)|`, may be a hundredth of `|l_i|`, or, as bodies that fall together
//! have no loads of their own, what a residual leaves of the largest load of all contacts that influence each other.
//!
//! `G_NN P_N`, what a percussion brings to its own contact, over the largest load is how far percussions have grown.

use super::natural_residual::Measured;
use crate::contact::{ContactProblem, Delassus, NormalForce};
use crate::vectors::largest;

/// Part of its own load that a contact may move with; a hundredth of that where percussions may run away.
const OF_OWN: f64 = 1e-2;
/// The same of the largest load, which a small residual leaves of it.
const OF_OTHERS: f64 = 1e-5;
/// Growth that stacks and vaults of like bodies do not exceed, that from which on they run away, and that beyond
/// which rounding leaves too little of velocities to say whether contacts approach.
const GROWN: f64 = 1e3;
pub(crate) const RUNNING: f64 = 1e6;
const DIVERGED: f64 = 1e12;
/// The same of a single contact, whose rows may cancel.
pub(crate) const UNRESOLVED: f64 = 1e10;
/// Contacts among which a proof is exact and soon found: it is looked for at less growth.
pub(crate) const FEW: usize = 48;
/// Velocity relative to those that cancel in it which rounding explains: a sum of some tens to hundreds of products.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// How contacts that influence no others move, and how far their percussions have grown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Approach {
    /// `max G_NN P_N` over the largest load.
    pub(crate) growth: f64,
    /// The contact of that.
    grown: usize,
    /// Growth from which on it counts as divergence, and whether a proof is soon looked for.
    limit: f64,
    few: bool,
    /// The contact that moves with most of what is allowed, if that is more.
    moving: Option<usize>,
}

/// Why percussions with a small residual are no solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Flaw {
    /// The contact that moves, or has grown.
    pub(crate) contact: usize,
    /// Whether percussions run away.
    pub(crate) unbounded: bool,
}

impl Approach {
    /// Of contacts that influence each other and no others.
    pub(crate) fn of(
        measured: &Measured<'_>,
        contacts: impl Iterator<Item = usize> + Clone,
        tolerance: f64,
    ) -> Self {
        let Measured { problem, percussion, .. } = *measured;
        let is_unilateral = |i: &usize| problem.contacts()[*i].normal == NormalForce::Unilateral;
        let prescribed = contacts.clone().any(|i| !is_unilateral(&i));
        let (mut all, mut normal, mut squares, mut count) = (0.0_f64, 0.0_f64, 0.0, 0);
        let (mut brought, mut grown) = (0.0, 0);
        for i in contacts.clone() {
            let rows = &problem.contacts()[i];
            let load = problem.load(i);
            squares += load.iter().map(|l| l * l).sum::<f64>();
            // Drilling has another unit.
            let planar = load.into_iter().take(rows.normal_rows() + 2);
            all = planar.fold(all, |m, l| m.max(l.abs()));
            count += 1;
            if is_unilateral(&i) {
                normal = normal.max(own_load(problem, i, percussion, prescribed));
                // The comparison also finds NaN.
                let own = brought_by_itself(problem, i, percussion);
                if !(own <= brought || brought.is_nan()) {
                    (brought, grown) = (own, i);
                }
            }
        }
        all = all.max(normal);
        let growth = if all > 0.0 { brought / all } else { 0.0 };
        let limit = if count == 1 { UNRESOLVED } else { DIVERGED };
        let mut found = Self { growth, grown, limit, few: count <= FEW, moving: None };
        let shared = f64::max(of_others(tolerance) * normal, tolerance * squares.sqrt());
        let of_own = if growth > 0.1 * RUNNING { OF_OWN * OF_OWN } else { OF_OWN };
        let mut most = 1.0;
        for i in contacts.filter(is_unilateral) {
            let row = problem.contacts()[i].offset;
            let brought = brought_by_itself(problem, i, percussion);
            let moves = f64::min(measured.xi(row), brought).abs();
            if !(moves > most * shared) {
                continue;
            }
            let load = own_load(problem, i, percussion, prescribed);
            // A load that is rounding of percussions is none that they carry.
            let least = OF_OWN * load.max(OF_OWN * normal);
            let explained = f64::min(ROUNDING * brought_to(problem, i, percussion), least);
            let allowed = f64::max(shared, of_own * load).max(explained);
            if moves > most * allowed {
                most = moves / allowed;
                found.moving = Some(i);
            }
        }
        found
    }

    /// Why the percussions are no solution however small their residual is.
    pub(crate) fn flaw(&self) -> Option<Flaw> {
        match self.moving {
            Some(contact) => Some(Flaw { contact, unbounded: !(self.growth <= RUNNING) }),
            None => self.has_diverged().then_some(Flaw { contact: self.grown, unbounded: true }),
        }
    }

    /// Whether rounding hides what contacts do.
    pub(crate) fn has_diverged(&self) -> bool {
        !(self.growth < self.limit)
    }

    /// Whether a residual, which is relative to what percussions bring, may hide contacts that close on each other.
    pub(crate) fn has_grown(&self) -> bool {
        !(self.growth <= if self.few { 0.1 * GROWN } else { 0.3 * GROWN })
    }

    /// Whether a proof is worth more than a look at the direction of the percussions.
    pub(crate) fn has_grown_far(&self) -> bool {
        self.few || !(self.growth <= GROWN)
    }
}

/// Part of the largest load that a contact may move with.
fn of_others(tolerance: f64) -> f64 {
    f64::max(OF_OTHERS, 100.0 * tolerance)
}

/// Whether percussions of a contact that influences no others may have a flaw, from its own rows: a first look.
#[inline(always)]
pub(crate) fn may_be_flawed(percussion: f64, xi: f64, load: &[f64], g_nn: f64) -> bool {
    let brought = g_nn * percussion;
    // The comparisons also find NaN.
    percussion > 0.0 && {
        let all = load.iter().take(3).fold(0.0, |m: f64, l| m.max(l.abs()));
        !(brought <= 0.1 * GROWN * all && f64::min(xi, brought).abs() <= OF_OWN * load[0].abs())
    }
}

/// `|l|` of the normal row of a contact, with what contacts of prescribed normal percussion bring.
fn own_load(problem: &ContactProblem, i: usize, percussion: &[f64], prescribed: bool) -> f64 {
    let [mut load, ..] = problem.load(i);
    // Without entries it is not known what they bring.
    if prescribed && !problem.delassus().is_matrix_free() {
        for (j, block) in problem.delassus().blocks().row(i) {
            let rows = &problem.contacts()[j];
            if rows.normal != NormalForce::Unilateral {
                // The normal row is the first one of the block.
                let terms = block.iter().zip(&percussion[rows.rows()]);
                terms.for_each(|(g, p)| load += g * p);
            }
        }
    }
    load.abs()
}

/// `G_NN P_N` of a contact; without entries their size is that of the operator.
fn brought_by_itself(problem: &ContactProblem, i: usize, percussion: &[f64]) -> f64 {
    let normal = percussion[problem.contacts()[i].offset];
    match problem.delassus() {
        Delassus::MatrixFree(_) => normal / problem.rho(i),
        delassus => delassus.own(i, 0, 0) * normal,
    }
}

/// `Σ_j |G_ij P_j|` in the normal row of a contact.
#[cold]
fn brought_to(problem: &ContactProblem, i: usize, percussion: &[f64]) -> f64 {
    match problem.delassus() {
        // Without entries only their size is known.
        Delassus::MatrixFree(operator) => operator.norm() * largest(percussion),
        delassus => delassus.blocks().first_magnitude(i, percussion),
    }
}

#[cfg(test)]
mod tests;

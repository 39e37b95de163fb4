//! Which closed contacts carry load, and which touch without any.
//!
//! Contacts of one and the same normal compliance ε yield by ελ_N. With friction in proportion to the normal force where
//! contacts slip, and as it is where they rest, normal forces and normal accelerations are a linear complementarity problem
//!
//! `0 ≤ λ_N ⊥ γ̈_N + ελ_N ≥ 0`, `γ̈_N = K λ_N + b`, `K = W_NᵀM⁻¹(W_N + W F)`,
//!
//! and the forces of rigid contacts are its limit for ε → 0. In the limit the contacts L that carry load have
//! `γ̈_L = 0` and, as `Zᵀγ̈_L = 0` for the null space `W_L Z = 0` of their rows, `Zᵀλ_L = 0`: `λ_L = W_Lᵀx`, see
//! [`Sharing`](crate::integrator::event::dynamics::forces::sharing). For a contact without load `γ̈_N + ελ_N` is
//! `γ̈_i − ε w_iᵀx`, the second term where its row depends on those of L, `w_i = W_L β` with `β = N_LL⁺ N_Li`, and with it
//! its acceleration: then `γ̈_i = βᵀγ̈_L = −ε βᵀλ_L`. Such a contact is closed by the others and carries nothing while
//! its share `βᵀλ_L = w_iᵀx` would pull; all others without load open. So the signs of the pairs (γ̈_i, −βᵀλ_L),
//! read as words of a dictionary are, and those of λ_L tell whether L is the right set. Where surfaces part, `Zᵀb_L ≠ 0`, forces
//! grow with 1/ε, `λ_L = μ/ε` with `(K + ρP) μ = −ρPb`, and contacts with `μ_i < 0` do not carry.
//!
//! Without friction K is symmetric and has no negative eigenvalue: for every ε the solution is unique, the limit is the one
//! of least `‖λ_N‖`, and nothing depends on the order of the contacts or on what they did before. The same holds with
//! friction as long as no principal minor of K is negative: those of K + ε1 are positive then, so that the solution is
//! unique (\[CottlePangStone1992\] theorem 3.3.7). Where friction wedges contacts or lifts them there may be several
//! solutions: what the contacts did before is kept where it is one. Boxes as high as wide do this now and then: the share
//! of a foot without load presses and its load with it would pull, and the box tips over.

use nalgebra::{DMatrix, DVector};

use crate::integrator::event::dynamics::{Dynamics, ROWS, mean_mobility, null_projection};
use crate::integrator::event::resolution::{PARTS, SOLVED};
use crate::linear::LeastNorm;
use crate::solver::{DEPENDENT, LIGHT, RANK};
use crate::vectors::{add, largest};

/// Exchanges at most, for each contact.
const EXCHANGES: usize = 20;
/// Rounds without fewer contacts of the wrong sign before another way is taken.
const PATIENCE: usize = 3;

/// A closed unilateral contact.
pub(crate) struct ClosedContact {
    pub(crate) contact: usize,
    /// Whether it slips, so that its friction is in proportion to its normal force.
    pub(crate) slips: bool,
    /// Its normal force.
    pub(crate) force: f64,
    /// Whether it has been taken to carry load.
    pub(crate) carries: bool,
}

/// Whether each of some closed contacts carries load, with the friction that the dynamics hold; `None` if that is not found.
pub(crate) fn load_bearing(dynamics: &Dynamics<'_>, closed: &[ClosedContact]) -> Option<Vec<bool>> {
    let parts = dynamics.parts_of_contacts();
    let mut carries: Vec<bool> = closed.iter().map(|contact| contact.carries).collect();
    let mut left: Vec<usize> = (0..closed.len()).collect();
    left.sort_unstable_by_key(|&k| (parts[closed[k].contact], closed[k].contact));
    for together in left.chunk_by(|&k, &l| parts[closed[k].contact] == parts[closed[l].contact]) {
        let members: Vec<&ClosedContact> = together.iter().map(|&k| &closed[k]).collect();
        let start = members.iter().map(|contact| contact.carries).collect();
        let found = NormalForces::of(dynamics, &members).load_bearing(start)?;
        together.iter().zip(found).for_each(|(&k, found)| carries[k] = found);
    }
    Some(carries)
}

/// The complementarity problem of the normal forces of closed contacts.
struct NormalForces {
    /// `K`: normal accelerations that unit normal forces give, with the friction in proportion to them.
    effects: DMatrix<f64>,
    /// `N = W_NᵀM⁻¹W_N`.
    mobility: DMatrix<f64>,
    /// `b`: normal accelerations without normal forces, and the sizes of what they are made of.
    free: Vec<f64>,
    sizes: Vec<f64>,
}

impl NormalForces {
    fn of(dynamics: &Dynamics<'_>, closed: &[&ClosedContact]) -> Self {
        let count = closed.len();
        let column = |closed: &ClosedContact| {
            let normal = ROWS * closed.contact;
            let mut column = dynamics.response(normal).to_vec();
            let friction = if closed.slips { dynamics.sliding(closed.contact) } else { [0.0; 3] };
            for (r, force) in friction[..dynamics.contacts[closed.contact].p].iter().enumerate() {
                add(&mut column, *force, dynamics.response(normal + 1 + r));
            }
            column
        };
        let columns: Vec<Vec<f64>> = closed.iter().map(|closed| column(closed)).collect();
        let row = |k: usize| ROWS * closed[k].contact;
        let effects =
            DMatrix::from_fn(count, count, |k, l| dynamics.mobility(row(k), row(l), &columns[l]));
        let mobility = DMatrix::from_fn(count, count, |k, l| {
            dynamics.normal_mobility(closed[k].contact, closed[l].contact)
        });
        let free = |k: usize| {
            let forces = closed.iter().enumerate();
            let given = forces.map(|(l, closed)| effects[(k, l)] * closed.force).sum::<f64>();
            dynamics.rate(row(k), &dynamics.acceleration) - given
        };
        let free = (0..count).map(free).collect();
        let sizes = closed.iter().map(|closed| dynamics.normal_rate_scale(closed.contact));
        Self { sizes: sizes.collect(), effects, mobility, free }
    }

    /// Whether each contact carries load, looked for from `start` on; `None` if that is not found.
    fn load_bearing(&self, start: Vec<bool>) -> Option<Vec<bool>> {
        let all = vec![true; start.len()];
        self.exchanged(start).or_else(|| self.exchanged(all))
    }

    /// Exchanges all contacts of the wrong sign until there are none; where they do not become fewer, the first of them
    /// only: Murty's method (\[CottlePangStone1992\] section 4.2), which ends where no principal minor of K is negative.
    fn exchanged(&self, mut loaded: Vec<bool>) -> Option<Vec<bool>> {
        let (mut fewest, mut patience) = (usize::MAX, PATIENCE);
        for _ in 0..=EXCHANGES * loaded.len() {
            let wrong = self.of_wrong_sign(&loaded)?;
            if wrong.is_empty() {
                return Some(loaded);
            }
            patience = if wrong.len() < fewest { PATIENCE } else { patience.saturating_sub(1) };
            fewest = fewest.min(wrong.len());
            let exchanged = if patience > 0 { &wrong } else { &wrong[..1] };
            exchanged.iter().for_each(|&i| loaded[i] = !loaded[i]);
        }
        None
    }

    /// The contacts whose load, acceleration or share has the wrong sign; `None` if the contacts with load have no forces.
    fn of_wrong_sign(&self, loaded: &[bool]) -> Option<Vec<usize>> {
        let (with, without): (Vec<usize>, Vec<usize>) = (0..loaded.len()).partition(|&i| loaded[i]);
        let Load { forces, unbounded, dependence } = self.load(&with)?;
        let none = LIGHT * largest(forces.as_slice());
        let pulls = |k: &usize| forces[*k] < -none;
        let mut wrong: Vec<usize> = (0..with.len()).filter(pulls).map(|k| with[k]).collect();
        if unbounded {
            // Squeezed contacts all press.
            return Some(wrong).filter(|wrong| !wrong.is_empty());
        }
        for i in without {
            let parts = with.iter().zip(&forces).map(|(&j, force)| self.effects[(i, j)] * force);
            let start = (self.free[i], self.sizes[i]);
            let (rate, size) =
                parts.fold(start, |(rate, size), part| (rate + part, size + part.abs()));
            let share = || {
                let row = with.iter().map(|&j| self.mobility[(i, j)]);
                let row = DVector::from_iterator(with.len(), row);
                let weights = dependence.as_ref()?.solve(&row);
                let left = self.mobility[(i, i)] - row.dot(&weights);
                (left <= DEPENDENT * self.mobility[(i, i)]).then(|| weights.dot(&forces))
            };
            // Where all of them lift off together, shares of what is left of the load are rounding.
            let light = f64::max(none, PARTS * self.sizes[i] / self.mobility[(i, i)]);
            let carries = || rate <= SOLVED * size && share().is_some_and(|share| share > light);
            if rate < -SOLVED * size || carries() {
                wrong.push(i);
            }
        }
        wrong.sort_unstable();
        Some(wrong)
    }

    /// The forces of the contacts that carry load.
    fn load(&self, with: &[usize]) -> Option<Load> {
        if with.is_empty() {
            let forces = DVector::zeros(0);
            return Some(Load { forces, unbounded: false, dependence: None });
        }
        let count = with.len();
        let entries =
            |of: &DMatrix<f64>| DMatrix::from_fn(count, count, |k, l| of[(with[k], with[l])]);
        let (mut matrix, mobility) = (entries(&self.effects), entries(&self.mobility));
        let dependence = LeastNorm::new(mobility.clone(), RANK)?;
        let mut free = DVector::from_iterator(count, with.iter().map(|&i| self.free[i]));
        let mut unbounded = false;
        if let Some(sharing) = null_projection(&mobility, &dependence) {
            let size = with.iter().map(|&i| self.sizes[i]).fold(0.0, f64::max);
            let parting = &sharing * &free;
            unbounded = largest(parting.as_slice()) > PARTS * mean_mobility(&mobility) * size;
            if unbounded {
                free = parting;
            }
            matrix += sharing;
        }
        let forces = matrix.lu().solve(&-free)?;
        let finite = forces.iter().all(|force| force.is_finite());
        finite.then_some(Load { forces, unbounded, dependence: Some(dependence) })
    }
}

/// What contacts carry.
struct Load {
    /// Their forces, or what these are over 1/ε if no forces keep all of the contacts closed.
    forces: DVector<f64>,
    unbounded: bool,
    /// `N` of these contacts.
    dependence: Option<LeastNorm>,
}

#[cfg(test)]
mod tests;

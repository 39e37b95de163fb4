//! Proofs that contacts close on each other whatever the percussions.
//!
//! Let `d ≥ 0` be a vector over the normal rows of unilateral contacts, zero on all other rows, with `Gᵀd = 0`.
//! Whatever percussions `P` act, admissible or not,
//!
//! `Σ d_i ξ_i = d·(G P + b + e γ_B) = (Gᵀd)·P + d·(b + e γ_B) = d·(b + e γ_B)`.
//!
//! A solution has `ξ_i ≥ 0` at all these rows: if `d·(b + e γ_B) < 0`, there is none. The contacts with `d_i > 0`
//! close on each other and no percussion changes how fast. For symmetric `G` and normal rows alone this is
//! Farkas' lemma: such a `d` exists wherever no `P` makes all `ξ_N ≥ 0`. Percussions that run away come closer
//! and closer to such a `d`: `G P` stays bounded while `P` grows.
//!
//! Of bodies, `G = Wᵀ M⁻¹ W`, `W d = 0` is asked, which knows no masses: light bodies beside heavy ones do not hide in
//! rounding. With the velocities `u` that percussions bring to the bodies
//!
//! `Σ d_i ξ_i = (W d)·u + d·(b + e γ_B)`,
//!
//! where `W d` is rounding, so that a solution has `Σ_k |(W d)_k| |u_k| ≥ −d·(b + e γ_B)`. That must take velocities at
//! contacts, `u_k max_j |W_kj|`, beyond [`FASTEST`] times the loads.
//!
//! Of other operators `Gᵀd` vanishes to the rounding of the entries of `G`, and what is left says how large the percussions
//! of a solution would have to be: with `s_i = √G_ii` and `|(Gᵀd)_j| ≤ η s_j max_i s_i d_i`, any `P` that solves the problem
//! satisfies `Σ s_j |P_j| ≥ −d·(b + e γ_B)/(η max_i s_i d_i)`. That must be [`HUGE`] times what the loads call for.

use nalgebra::DVector;

use super::balance::{Balance, PASSES};
use super::nonnegative;
use super::proof::{Infeasibility, InfeasibilityKind};
use crate::contact::{ContactProblem, Delassus, Factored};
use crate::solver::measure::approach::FEW;
use crate::vectors::largest;

/// Times that contacts of negative weight are left out.
const ROUNDS: usize = 12;
/// Parts of the largest percussion beyond which contacts are looked at by themselves: those that only carry loads have less.
const PARTS: [f64; 3] = [0.1, 1e-2, 1e-3];
/// The largest weight where weights are tried as whole numbers.
const WHOLE: f64 = (1_u64 << 40) as f64;
/// Weights below this part of the largest are none.
const SMALLEST: f64 = 1e-9;
/// `|(Gᵀd)_j|` relative to `s_j Σ s_i d_i`, and `|(W d)_k|` to `max_j |W_kj|` and the weights on the body, that rounding explains.
const IN_OPERATOR: f64 = 2.0 * f64::EPSILON;
const IN_DIRECTIONS: f64 = 8.0 * f64::EPSILON;
/// Percussions over those that normal loads call for, from which on they are no solution: those that `G` cannot hold.
pub(super) const HUGE: f64 = 1e10;
/// The same of velocities over loads: they grow by no more than the square root of the ratio of masses.
const FASTEST: f64 = 1e8;
/// Smallest closing velocity relative to the loads of the contacts, of which it is the rounding.
const MARGIN: f64 = 1e-12;

/// A proof from percussions: from their direction or, where friction has its part in that, from the weights that come nearest to a
/// proof; of all contacts or of those with the largest percussions. If it need not be thorough, only the first of
/// these is tried.
pub(crate) fn prove_closing(
    problem: &ContactProblem,
    percussion: &[f64],
    thorough: bool,
) -> Option<Infeasibility> {
    if problem.delassus().is_matrix_free() {
        return None;
    }
    let balance = Balance::new(problem);
    let of_normal = |i: usize| percussion[problem.contacts()[i].offset];
    let (contacts, scales) = (balance.contacts.iter(), balance.scales.iter());
    let own = contacts.clone().zip(scales.clone());
    let mut pushes: Vec<f64> = own.map(|(&i, s)| s * of_normal(i)).collect();
    // In units of the largest load no square of them is too small.
    let loads: Vec<f64> = contacts.zip(scales).map(|(&i, s)| problem.load(i)[0] / s).collect();
    let unit = largest(&loads);
    if !loads.iter().any(|load| *load < 0.0) || !pushes.iter().all(|push| push.is_finite()) {
        return None;
    }
    pushes.iter_mut().for_each(|push| *push = push.max(0.0));
    let loads: Vec<f64> = loads.iter().map(|load| load / unit).collect();
    let mut all = vec![1.0; pushes.len()];
    balance.peel(&mut all);
    pushes.iter_mut().zip(&all).for_each(|(push, all)| *push *= all);
    trim(&mut pushes);
    let search = Search { problem, balance: &balance, loads: &loads };
    let few = |weights: &[f64]| weights.iter().filter(|d| **d > 0.0).count() <= FEW;
    // Contacts that happen to be open may have their part in it.
    let whole = pushes.iter().zip(&all).map(|(push, all)| push.max(2.0 * SMALLEST * all));
    let whole: Vec<f64> = whole.collect();
    if !thorough {
        let mut first = whole.clone();
        balance.project(&mut first, 1);
        let closes = first.iter().all(|d| *d >= 0.0);
        return if closes { search.polish(whole) } else { None };
    }
    let mut found = search.polish(pushes.clone());
    if found.is_none() && whole != pushes {
        found = search.polish(whole);
    }
    if found.is_none() && few(&all) {
        return search.nearest(&all);
    }
    for part in PARTS {
        if found.is_some() {
            break;
        }
        let mut largest = pushes.clone();
        largest.iter_mut().filter(|d| **d < part).for_each(|d| *d = 0.0);
        found = search.polish(largest.clone());
        balance.peel(&mut largest);
        if found.is_none() && few(&largest) {
            found = search.nearest(&largest);
        }
    }
    found
}

/// Leaves out contacts without a weight, and makes the largest weight one; whether a negative one was left out.
fn trim(weights: &mut [f64]) -> bool {
    let (least, largest) =
        weights.iter().fold((0.0_f64, 0.0_f64), |(least, m), d| (least.min(*d), m.max(*d)));
    for d in weights.iter_mut() {
        *d = if *d > SMALLEST * largest { *d / largest } else { 0.0 };
    }
    least < -SMALLEST * largest
}

struct Search<'a> {
    problem: &'a ContactProblem,
    balance: &'a Balance,
    /// Normal loads of the contacts in scaled rows, the largest one.
    loads: &'a [f64],
}

impl Search<'_> {
    /// The proof next to these weights.
    fn polish(&self, mut weights: Vec<f64>) -> Option<Infeasibility> {
        for _ in 0..ROUNDS {
            self.balance.peel(&mut weights);
            if weights.iter().all(|d| *d == 0.0) {
                return None;
            }
            self.balance.project(&mut weights, PASSES);
            if !trim(&mut weights) {
                let scales = self.balance.scales.iter();
                weights.iter_mut().zip(scales).for_each(|(d, s)| *d /= s);
                let certify = |of: &[f64]| certify(self.problem, &self.balance.contacts, of);
                // Weights that are whole multiples of each other, as along a chain, lose no body to rounding.
                let unit = largest(&weights) / WHOLE;
                let whole: Vec<f64> = weights.iter().map(|d| (d / unit).round()).collect();
                return certify(&whole).or_else(|| certify(&weights));
            }
        }
        None
    }

    /// The proof next to the weights `d ≥ 0` of these contacts that minimise `‖A d‖² + (1 + d·(b + e γ_B))²` in scaled rows:
    /// zero where there is a proof.
    fn nearest(&self, among: &[f64]) -> Option<Infeasibility> {
        let chosen: Vec<usize> = (0..among.len()).filter(|&k| among[k] > 0.0).collect();
        let matrix = self.balance.dense(&chosen, self.loads);
        let mut right = DVector::zeros(matrix.nrows());
        right[matrix.nrows() - 1] = -1.0;
        if chosen.is_empty() || !matrix.iter().all(|v| v.is_finite()) {
            return None;
        }
        let mut weights = vec![0.0; among.len()];
        let found = nonnegative::least_squares(&matrix, &right)?;
        chosen.iter().zip(found).for_each(|(&k, d)| weights[k] = d);
        trim(&mut weights);
        self.polish(weights)
    }
}

/// The proof by weights of contacts, if they are one.
fn certify(problem: &ContactProblem, contacts: &[usize], weights: &[f64]) -> Option<Infeasibility> {
    let sum: f64 = weights.iter().sum();
    let mut direction = vec![0.0; problem.rows()];
    let (mut closing, mut loads, mut heaviest) = (0.0, 0.0, (0.0, 0));
    for (&i, d) in contacts.iter().zip(weights).filter(|(_, d)| **d > 0.0) {
        let (d, row) = (d / sum, problem.contacts()[i].offset);
        direction[row] = d;
        closing -= d * problem.load(i)[0];
        loads += d * planar_load(problem, i);
        if d > heaviest.0 {
            heaviest = (d, i);
        }
    }
    let (heaviest, contact) = heaviest;
    // The comparisons also turn away NaN.
    let closes = closing > MARGIN * loads;
    let residual = match problem.delassus() {
        Delassus::Factored(factored) => {
            let fastest = (0..problem.contacts().len()).map(|i| planar_load(problem, i));
            let left = brought_to_bodies(factored, &direction)?;
            (closing >= FASTEST * left.sum * fastest.fold(0.0, f64::max))
                .then_some(left.largest / heaviest)
        }
        _ => brought_to_rows(problem, contacts, &direction, closing),
    };
    let (kind, residual) = (InfeasibilityKind::Closing, residual.filter(|_| closes)?);
    Some(Infeasibility {
        kind,
        contact,
        direction,
        closing_velocity: closing,
        residual,
        cases: Vec::new(),
    })
}

/// The largest load of a contact along its normal and its plane; drilling has another unit.
fn planar_load(problem: &ContactProblem, contact: usize) -> f64 {
    let rows = &problem.contacts()[contact];
    let planar = problem.load(contact).into_iter().take(rows.len().min(rows.normal_rows() + 2));
    planar.fold(0.0, |m: f64, b| m.max(b.abs()))
}

/// `η`, if rounding of `G` explains it and percussions of a solution would be beyond all that `G` can hold.
fn brought_to_rows(
    problem: &ContactProblem,
    contacts: &[usize],
    direction: &[f64],
    closing: f64,
) -> Option<f64> {
    let mut brought = vec![0.0; problem.rows()];
    let (mut called_for, mut terms, mut largest) = (0.0_f64, 0.0, 0.0_f64);
    for &i in contacts {
        let row = problem.contacts()[i].offset;
        let (d, scale) = (direction[row], problem.delassus().own(i, 0, 0).sqrt());
        if d > 0.0 {
            problem.each_entry(i, row, |_, column, g| brought[column] += g * d);
            terms += d * scale;
            largest = largest.max(d * scale);
            called_for = called_for.max(problem.load(i)[0].abs() / scale);
        }
    }
    let mut left = 0.0_f64;
    for (j, rows) in problem.contacts().iter().enumerate() {
        for (own, row) in rows.rows().enumerate() {
            left = left.max(brought[row].abs() / problem.delassus().own(j, own, own).sqrt());
        }
    }
    let proves = closing >= HUGE * left * called_for && left <= IN_OPERATOR * terms;
    proves.then_some(left / largest)
}

/// `Σ_k |(W d)_k|/max_j |W_kj|`, and the largest term.
struct Brought {
    sum: f64,
    largest: f64,
}

/// What weights as percussions bring to the bodies, if rounding of the entries of `W` explains it: a velocity `u_k` of the bodies
/// comes to `u_k max_j |W_kj|` at some contact.
fn brought_to_bodies(factored: &Factored, weights: &[f64]) -> Option<Brought> {
    let directions = factored.directions();
    let mut momentum = vec![0.0; directions.columns()];
    let mut lever = vec![0.0_f64; directions.columns()];
    let mut touching = vec![0.0; directions.columns()];
    for (row, d) in weights.iter().enumerate() {
        let (columns, values) = directions.row(row);
        for (&k, w) in columns.iter().zip(values) {
            momentum[k] += w * d;
            lever[k] = lever[k].max(w.abs());
            touching[k] += d;
        }
    }
    let mut left = Brought { sum: 0.0, largest: 0.0 };
    for k in (0..momentum.len()).filter(|&k| lever[k] > 0.0) {
        let part = momentum[k].abs() / lever[k];
        // The comparison also turns away NaN.
        if !(part <= IN_DIRECTIONS * touching[k]) {
            return None;
        }
        left.sum += part;
        left.largest = left.largest.max(part);
    }
    Some(left)
}

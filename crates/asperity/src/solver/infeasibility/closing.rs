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
//! In numbers, `Gᵀd` vanishes to the rounding of the entries of `G`, and what is left says how large the percussions of
//! a solution would have to be: with `s_i = √G_ii` and `|(Gᵀd)_j| ≤ η s_j max_i s_i d_i`, any `P` that solves the problem
//! satisfies `Σ s_j |P_j| ≥ −d·(b + e γ_B)/(η max_i s_i d_i)`. Both are asked for: that `Gᵀd` is rounding, and that
//! such percussions are beyond all that `G` can hold, [`HUGE`] times those that the loads call for. `s_j` makes `η`
//! independent of units and masses.
//!
//! Where `G = Wᵀ M⁻¹ W` is that of bodies, `Gᵀd` vanishes where `W d` does, whatever the masses. Weights are then searched with
//! the masses of `suitable_masses.rs`, so that rounding does not hide light bodies beside heavy ones, and `W d` is asked as well.
//! With the velocities `u` that percussions bring to the bodies
//!
//! `Σ d_i ξ_i = (W d)·u + d·(b + e γ_B)`,
//!
//! where `W d` is rounding, so that a solution has `Σ_k |(W d)_k| |u_k| ≥ −d·(b + e γ_B)`. That must take velocities at
//! contacts, `u_k max_j |W_kj|`, beyond [`FASTEST`] times the loads.

use nalgebra::{DMatrix, DVector};

use super::nonnegative;
use super::proof::{Infeasibility, InfeasibilityKind};
use crate::contact::{Components, ContactProblem, Delassus, Factored, Members, NormalForce};
use crate::linear::LeastNorm;
use crate::solver::suitable_masses::with_suitable_masses;
use crate::vectors::largest;

/// Most contacts among which a proof is searched: its cost grows with their third power.
const MOST_CONTACTS: usize = 128;
/// Most contacts among which the nearest weights are searched, all of a problem or a group of those with the largest weights:
/// the fourth power.
const MOST_SEARCHED: usize = 48;
/// Times that contacts of negative weight are left out; with 3 and 48 the same is proven of the systems that `cases.rs`
/// names.
const ROUNDS: usize = 12;
/// Parts of the rows that count as zero, relative to the largest.
const KERNEL: f64 = 1e-13;
/// `|(Gᵀd)_j|` relative to `s_j Σ s_i d_i` that rounding of the entries of `G` explains: they are sums of products of the
/// size `s_i s_j`, however much of it cancels. The problems of `tests/test_certificate.py` leave up to 0.7 units in the
/// last place. Of bodies one of which is 10¹⁵ times as heavy as the other `G` does not know any more that both can
/// be moved.
const ROUNDING: f64 = 2.0 * f64::EPSILON;
/// Percussions over those that normal loads call for, `Σ s_j |P_j|` over `max_i |b_Ni|/s_i`, from which on they are no
/// solution: with all digits of `G`, contacts are proven to close that do so with a hundred-thousandth of the loads.
pub(crate) const HUGE: f64 = 1e10;
/// Velocities that percussions bring to contacts over the loads, from which on they are no solution. As percussions bring no
/// energy to bodies that nothing drives, these become faster by no more than the square root of the ratio of their masses.
const FASTEST: f64 = 1e8;
/// `|(W d)_k|` relative to `max_j |W_kj|` and the sum of the weights of the body's contacts, which rounding explains.
const IN_DIRECTIONS: f64 = 8.0 * f64::EPSILON;
/// Errors of the weights relative to the largest one: what projections onto the kernel of `G` leave over.
const MOVED: f64 = 1e-10;
/// Smallest closing velocity relative to the free velocities of the contacts, in their normal rows.
const MARGIN: f64 = 1e-12;
/// Parts of the largest weight beyond which contacts are looked at by themselves: spheres that two walls squeeze within a
/// packing of hundreds carry a thousand times what the others do (`tests/test_certificate.py`, `squeezed_packing`).
const PARTS: [f64; 3] = [0.1, 1e-2, 1e-3];
/// Weights below this part of the largest are none.
const SMALLEST: f64 = 1e-9;

/// A proof from percussions that have grown: from their direction, or, where friction has its part in that, from
/// the weights that come nearest to a proof; of all contacts or of those with the largest percussions.
pub(crate) fn prove_closing(problem: &ContactProblem, percussion: &[f64]) -> Option<Infeasibility> {
    if problem.delassus().is_matrix_free() {
        return None;
    }
    let suitable = with_suitable_masses(problem);
    search(suitable.as_ref().unwrap_or(problem), percussion)
}

/// The same by the operator of this problem.
fn search(problem: &ContactProblem, percussion: &[f64]) -> Option<Infeasibility> {
    // In the rows' own scale, s_i P_i, units and masses drop out.
    let pushes = |i: usize| scale_of(problem, i) * percussion[problem.contacts()[i].offset];
    let all: Weights = (0..problem.contacts().len())
        .filter(|&i| problem.contacts()[i].normal == NormalForce::Unilateral)
        .map(|i| (i, pushes(i)))
        .collect();
    let mut support = all.clone();
    support.retain(|(_, d)| d.is_finite());
    trim(&mut support);
    let near = |among: Weights| nearest(problem, &among).and_then(|found| polish(problem, found));
    let by_all = polish(problem, support.clone());
    if by_all.is_some() {
        return by_all;
    }
    // A search among all of them leaves nothing to be found among some.
    match [&all, &support].into_iter().find(|among| among.len() <= MOST_SEARCHED) {
        Some(among) => near(among.clone()),
        None => parts(problem, &support)
            .find_map(|part| polish(problem, part.clone()).or_else(|| near(part))),
    }
}

/// What runs away may be hidden among many contacts that only carry loads: the contacts with the largest weights, in groups
/// that influence each other, few enough to be searched; groups of the largest weights first.
fn parts(problem: &ContactProblem, support: &Weights) -> impl Iterator<Item = Weights> {
    let mut before = support.len();
    PARTS.into_iter().flat_map(move |part| {
        let largest: Weights = support.iter().copied().filter(|(_, d)| *d > part).collect();
        let is_new = std::mem::replace(&mut before, largest.len()) != largest.len();
        let mut groups = if is_new { coupled(problem, largest) } else { Vec::new() };
        // More of them would cost more than many solves take.
        groups.retain(|group| group.len() <= MOST_SEARCHED);
        groups
    })
}

/// Contacts in groups that do not influence each other, those with the largest weights first.
fn coupled(problem: &ContactProblem, mut weights: Weights) -> Vec<Weights> {
    weights.sort_by(|(_, a), (_, b)| b.total_cmp(a));
    let mut place = vec![usize::MAX; problem.contacts().len()];
    weights.iter().enumerate().for_each(|(k, (contact, _))| place[*contact] = k);
    let mut components = Components::default();
    components.separate(weights.len());
    for (k, (contact, _)) in weights.iter().enumerate() {
        for (other, block) in problem.delassus().blocks().row(*contact) {
            if place[other] != usize::MAX && block.iter().any(|g| *g != 0.0) {
                components.join(k, place[other]);
            }
        }
    }
    let mut groups = Members::default();
    groups.update(&mut components);
    let of = |group: usize| groups.of(group).iter().map(|&k| weights[k]).collect();
    (0..groups.count()).map(of).collect()
}

/// Contacts with their weights in scaled rows.
type Weights = Vec<(usize, f64)>;

/// Leaves out contacts without a weight, and makes the largest weight one; whether any was left out.
fn trim(weights: &mut Weights) -> bool {
    let (before, largest) = (weights.len(), weights.iter().fold(0.0, |m: f64, (_, d)| m.max(*d)));
    weights.retain(|(_, d)| *d > SMALLEST * largest);
    weights.iter_mut().for_each(|(_, d)| *d /= largest);
    weights.len() < before
}

/// The proof next to these weights.
fn polish(problem: &ContactProblem, mut weights: Weights) -> Option<Infeasibility> {
    for _ in 0..ROUNDS {
        if weights.is_empty() || weights.len() > MOST_CONTACTS {
            return None;
        }
        project(problem, &mut weights)?;
        if !trim(&mut weights) {
            return certify(problem, &weights);
        }
    }
    None
}

/// Weights `d ≥ 0` that minimise `‖Gᵀd‖² + (1 + d·(b + e γ_B))²` in scaled rows and velocities: zero where there is a
/// proof.
fn nearest(problem: &ContactProblem, support: &[(usize, f64)]) -> Option<Weights> {
    let matrix = scaled(problem, support);
    let loads = support.iter().map(|&(i, _)| problem.load(i)[0] / scale_of(problem, i));
    let loads: Vec<f64> = loads.collect();
    let unit = largest(&loads);
    let (rows, columns) = matrix.shape();
    let mut bordered = matrix.insert_row(rows, 0.0);
    (0..columns).for_each(|k| bordered[(rows, k)] = loads[k] / unit);
    let mut right = DVector::zeros(rows + 1);
    right[rows] = -1.0;
    if !bordered.iter().all(|v| v.is_finite()) {
        return None;
    }
    let found = nonnegative::least_squares(&bordered, &right)?;
    let mut weights: Weights = support.iter().zip(&found).map(|(&(i, _), &d)| (i, d)).collect();
    trim(&mut weights);
    Some(weights)
}

/// `√G_NN` of a unilateral contact.
fn scale_of(problem: &ContactProblem, contact: usize) -> f64 {
    problem.delassus().own(contact, 0, 0).sqrt()
}

/// `√G_jj` of a row of a contact.
fn row_scale(problem: &ContactProblem, contact: usize, row: usize) -> f64 {
    let offset = problem.contacts()[contact].offset;
    problem.delassus().own(contact, row - offset, row - offset).sqrt()
}

/// `G_ij/(s_i s_j)` of the normal rows `i` of contacts, one column for each, over the rows that they touch.
fn scaled(problem: &ContactProblem, support: &[(usize, f64)]) -> DMatrix<f64> {
    let mut place = vec![usize::MAX; problem.rows()];
    let mut rows = 0;
    let mut entries = Vec::new();
    for (k, &(contact, _)) in support.iter().enumerate() {
        let own = scale_of(problem, contact);
        problem.each_entry(contact, problem.contacts()[contact].offset, |j, column, g| {
            if place[column] == usize::MAX {
                place[column] = rows;
                rows += 1;
            }
            entries.push((place[column], k, g / (own * row_scale(problem, j, column))));
        });
    }
    let mut matrix = DMatrix::zeros(rows.max(support.len()), support.len());
    for (row, column, value) in entries {
        matrix[(row, column)] = value;
    }
    matrix
}

/// Projects weights onto the vectors with `Gᵀd = 0`, in scaled rows.
fn project(problem: &ContactProblem, support: &mut [(usize, f64)]) -> Option<()> {
    let matrix = scaled(problem, support);
    let before = DVector::from_iterator(support.len(), support.iter().map(|(_, d)| *d));
    let across = LeastNorm::new(matrix.clone(), KERNEL)?.solve(&(matrix * &before));
    let rest = before - across;
    support.iter_mut().zip(rest.iter()).for_each(|((_, d), rest)| *d = *rest);
    Some(())
}

/// The proof by weights in scaled rows, if they are one.
fn certify(problem: &ContactProblem, support: &[(usize, f64)]) -> Option<Infeasibility> {
    let mut direction = vec![0.0; problem.rows()];
    for &(contact, d) in support {
        direction[problem.contacts()[contact].offset] = d / scale_of(problem, contact);
    }
    let sum: f64 = direction.iter().sum();
    direction.iter_mut().for_each(|d| *d /= sum);
    let mut brought = vec![0.0; problem.rows()];
    let (mut closing, mut loads, mut called_for, mut terms) = (0.0, 0.0, 0.0_f64, 0.0);
    let (mut contact, mut largest) = (0, 0.0);
    for &(i, _) in support {
        let rows = &problem.contacts()[i];
        let (d, scale) = (direction[rows.offset], scale_of(problem, i));
        problem.each_entry(i, rows.offset, |_, column, g| brought[column] += g * d);
        terms += d * scale;
        // Loads of all rows in the units of the normal one.
        let own = rows.rows().zip(problem.load(i));
        let load = own.map(|(row, b)| b.abs() / row_scale(problem, i, row)).fold(0.0, f64::max);
        let [normal, ..] = problem.load(i);
        closing -= d * normal;
        loads += d * load * scale;
        called_for = called_for.max(normal.abs() / scale);
        if d * scale > largest {
            (contact, largest) = (i, d * scale);
        }
    }
    let mut residual = 0.0_f64;
    for (j, rows) in problem.contacts().iter().enumerate() {
        let own = brought.iter().enumerate().skip(rows.offset).take(rows.len());
        for (row, velocity) in own {
            residual = residual.max(velocity.abs() / (row_scale(problem, j, row) * largest));
        }
    }
    let rests = match problem.delassus() {
        Delassus::Factored(factored) => {
            let fastest = (0..problem.contacts().len()).map(|i| planar_load(problem, i));
            let fastest = fastest.fold(0.0, f64::max);
            brought_to_bodies(factored, &direction)
                .is_some_and(|brought| closing >= FASTEST * brought * fastest)
        }
        _ => true,
    };
    // The comparisons also turn away NaN.
    let closes = closing > MARGIN * loads && closing >= HUGE * residual * largest * called_for;
    let proves = closes && residual * largest <= ROUNDING * terms && rests;
    let kind = InfeasibilityKind::Closing;
    proves.then_some(Infeasibility {
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

/// `Σ_k |(W d)_k|/max_j |W_kj|`, what weights as percussions bring to the bodies, if rounding of the entries of `W` explains it.
///
/// A velocity `u_k` of the bodies comes to `u_k max_j |W_kj|` at some contact. `Gᵀd` does not tell as much: bodies whose
/// velocities contacts hardly feel are in it with the square of that, and beside a body of the mass 1 it holds nothing of one of
/// the mass 10¹⁷, which percussions move nevertheless.
fn brought_to_bodies(factored: &Factored, weights: &[f64]) -> Option<f64> {
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
    let mut sum = 0.0;
    for ((momentum, lever), touching) in momentum.iter().zip(&lever).zip(&touching) {
        // The comparison also turns away NaN.
        if *lever > 0.0 && !(momentum.abs() <= IN_DIRECTIONS * lever * touching) {
            return None;
        }
        sum += if *lever > 0.0 { momentum.abs() / lever } else { 0.0 };
    }
    Some(sum)
}

/// Part of `G_jj` that a velocity brings, from which on `G` tells what percussions do with it: its rounding is 2e-10 of
/// that.
const HELD: f64 = 1e-6;

/// Whether weights as percussions move no body that `G` may have lost: on the way to the largest `G_jj` of the rows that
/// a velocity `k` is in, `max_j W_jk²/M_kk` is rounding, or nearly so.
pub(crate) fn keeps_lost_bodies_at_rest(factored: &Factored, weights: &[f64]) -> bool {
    let (directions, mass) = (factored.directions(), factored.mass());
    let own = squares_of_scales(factored);
    let is_held = |k: usize| {
        let (mut lever, mut whole) = (0.0_f64, 0.0_f64);
        for (row, g) in own.iter().enumerate() {
            let (columns, values) = directions.row(row);
            for (_, w) in columns.iter().zip(values).filter(|(column, _)| **column == k) {
                (lever, whole) = (lever.max(w * w), whole.max(*g));
            }
        }
        let (columns, values) = mass.row(k);
        let own = columns.iter().zip(values).find(|(column, _)| **column == k);
        own.is_some_and(|(_, mass)| lever >= HELD * mass * whole)
    };
    moved(factored, weights).all(is_held)
}

/// Velocities that weights as percussions change: whose momenta `(W d)_k` are more than errors of the weights, each of a
/// part [`MOVED`] of the largest weight in scaled rows, explain.
fn moved(factored: &Factored, weights: &[f64]) -> impl Iterator<Item = usize> {
    let directions = factored.directions();
    let scales: Vec<f64> = squares_of_scales(factored).into_iter().map(f64::sqrt).collect();
    let largest = weights.iter().zip(&scales).fold(0.0_f64, |m, (d, s)| m.max(s * d.abs()));
    let mut momentum = vec![0.0; directions.columns()];
    let mut explained = vec![0.0; directions.columns()];
    for (row, (d, scale)) in
        weights.iter().zip(&scales).enumerate().filter(|(_, (d, _))| **d != 0.0)
    {
        let (columns, values) = directions.row(row);
        for (&k, w) in columns.iter().zip(values) {
            momentum[k] += w * d;
            explained[k] += w.abs() / scale;
        }
    }
    // The comparison also counts NaN in.
    let moves =
        move |(k, (p, w)): (usize, (f64, f64))| (!(p.abs() <= MOVED * largest * w)).then_some(k);
    momentum.into_iter().zip(explained).enumerate().filter_map(moves)
}

/// `G_jj` of all rows.
fn squares_of_scales(factored: &Factored) -> Vec<f64> {
    let blocks = factored.blocks();
    let own = |i: usize| {
        let (size, block) = (blocks.size(i), blocks.diagonal(i));
        (0..size).map(move |a| block[a * size + a])
    };
    (0..blocks.contacts()).flat_map(own).collect()
}

//! What percussions along the normals of unilateral contacts bring, as columns of a sparse matrix, and the weights that it
//! makes vanish.

use crate::contact::{ContactProblem, Delassus, NormalForce};

/// Entries below this part of a row are rounding of directions: they oppose nothing.
const NO_ENTRY: f64 = 1e-12;
/// Times that what rounding leaves of a projection is projected again: each takes away most of its digits.
pub(super) const PASSES: usize = 4;
/// Part of the gradient at which a projection ends.
const SMALL: f64 = 1e-10;

/// The matrix `A` with the columns `W_i/s_i` of bodies, each velocity in the unit `(Σ_j W_kj²)^½` that frees it of masses, or
/// `G_ji/(s_i s_j)` where only the operator is known; columns of length one, or with a diagonal of one.
pub(super) struct Balance {
    pub(super) contacts: Vec<usize>,
    /// `s_i`.
    pub(super) scales: Vec<f64>,
    columns: Vec<Vec<(usize, f64)>>,
    rows: usize,
}

impl Balance {
    /// Of all unilateral contacts of a problem whose entries are known.
    pub(super) fn new(problem: &ContactProblem) -> Self {
        let unilateral = |i: &usize| problem.contacts()[*i].normal == NormalForce::Unilateral;
        let contacts: Vec<usize> = (0..problem.contacts().len()).filter(unilateral).collect();
        let normal = |i: &usize| problem.contacts()[*i].offset;
        let (mut columns, rows): (Vec<Vec<_>>, usize) = match problem.delassus() {
            Delassus::Factored(factored) => {
                let directions = factored.directions();
                let mut units = vec![0.0; directions.columns()];
                for row in 0..directions.rows() {
                    let (places, values) = directions.row(row);
                    places.iter().zip(values).for_each(|(&k, w)| units[k] += w * w);
                }
                let entries = |i| {
                    let (places, values) = directions.row(normal(i));
                    let entries = places.iter().zip(values).filter(|(_, w)| **w != 0.0);
                    entries.map(|(&k, w)| (k, w / f64::sqrt(units[k]))).collect()
                };
                (contacts.iter().map(entries).collect(), directions.columns())
            }
            _ => {
                let unit = |j: usize, row: usize| {
                    let own = row - problem.contacts()[j].offset;
                    problem.delassus().own(j, own, own).sqrt()
                };
                let mut columns = vec![Vec::new(); contacts.len()];
                for (column, i) in columns.iter_mut().zip(&contacts) {
                    // The entries of a row: `G` is symmetric up to its rounding, which the proof looks at.
                    problem.each_entry(*i, normal(i), |j, row, g| {
                        column.push((row, g / unit(j, row)));
                    });
                }
                (columns, problem.rows())
            }
        };
        let scale = |(column, i): (&mut Vec<(usize, f64)>, &usize)| {
            let scale = match problem.delassus() {
                Delassus::Factored(_) => column.iter().map(|(_, a)| a * a).sum::<f64>().sqrt(),
                delassus => delassus.own(*i, 0, 0).sqrt(),
            };
            column.iter_mut().for_each(|(_, a)| *a /= scale);
            scale
        };
        let scales = columns.iter_mut().zip(&contacts).map(scale).collect();
        Self { contacts, scales, columns, rows }
    }

    /// Sets weights to zero that nothing can oppose: on some row all contacts that have a weight push the same way. Stacks
    /// peel off from the top.
    pub(super) fn peel(&self, weights: &mut [f64]) {
        let mut opposed = vec![[false; 2]; self.rows];
        loop {
            opposed.fill([false; 2]);
            for (column, _) in self.columns.iter().zip(&*weights).filter(|(_, d)| **d > 0.0) {
                column
                    .iter()
                    .filter(|(_, a)| a.abs() > NO_ENTRY)
                    .for_each(|&(row, a)| opposed[row][usize::from(a > 0.0)] = true);
            }
            let mut peeled = false;
            for (column, d) in self.columns.iter().zip(&mut *weights).filter(|(_, d)| **d > 0.0) {
                let alone =
                    |&(row, a): &(usize, f64)| a.abs() > NO_ENTRY && opposed[row] != [true; 2];
                if column.iter().any(alone) {
                    (*d, peeled) = (0.0, true);
                }
            }
            if !peeled {
                return;
            }
        }
    }

    /// Projects weights onto those with `A d = 0`, where zeros stay: conjugate gradients for the least-norm `x` with
    /// `A x = A d`, which is taken away.
    pub(super) fn project(&self, weights: &mut [f64], passes: usize) {
        let free: Vec<bool> = weights.iter().map(|d| *d > 0.0).collect();
        for _ in 0..passes {
            let mut rest = self.product(weights);
            let mut gradient = self.transposed(&rest, &free);
            let (mut direction, mut step) = (gradient.clone(), vec![0.0; weights.len()]);
            let mut square = dot(&gradient, &gradient);
            let end = SMALL * SMALL * square;
            for _ in 0..2 * weights.len() {
                let brought = self.product(&direction);
                let length = square / dot(&brought, &brought);
                if !length.is_finite() {
                    break;
                }
                step.iter_mut().zip(&direction).for_each(|(x, p)| *x += length * p);
                rest.iter_mut().zip(&brought).for_each(|(r, q)| *r -= length * q);
                gradient = self.transposed(&rest, &free);
                let before = std::mem::replace(&mut square, dot(&gradient, &gradient));
                if square <= end {
                    break;
                }
                let part = square / before;
                direction.iter_mut().zip(&gradient).for_each(|(p, g)| *p = g + part * *p);
            }
            weights.iter_mut().zip(&step).for_each(|(d, x)| *d -= x);
        }
    }

    /// The columns of the contacts that have a weight, and below them a row of their `loads`.
    pub(super) fn dense(&self, chosen: &[usize], loads: &[f64]) -> nalgebra::DMatrix<f64> {
        let mut place = vec![usize::MAX; self.rows];
        let mut count = 0;
        for &(row, _) in chosen.iter().flat_map(|&k| &self.columns[k]) {
            if place[row] == usize::MAX {
                (place[row], count) = (count, count + 1);
            }
        }
        let mut matrix = nalgebra::DMatrix::zeros(count + 1, chosen.len());
        for (column, &k) in chosen.iter().enumerate() {
            self.columns[k].iter().for_each(|&(row, a)| matrix[(place[row], column)] = a);
            matrix[(count, column)] = loads[k];
        }
        matrix
    }

    fn product(&self, weights: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.rows];
        for (column, d) in self.columns.iter().zip(weights).filter(|(_, d)| **d != 0.0) {
            column.iter().for_each(|&(row, a)| out[row] += a * d);
        }
        out
    }

    fn transposed(&self, rest: &[f64], free: &[bool]) -> Vec<f64> {
        let of = |(column, free): (&Vec<(usize, f64)>, &bool)| match free {
            true => column.iter().map(|&(row, a)| a * rest[row]).sum(),
            false => 0.0,
        };
        self.columns.iter().zip(free).map(of).collect()
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

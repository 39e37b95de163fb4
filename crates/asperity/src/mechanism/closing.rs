//! Percussions that close rows without friction, where their active set is soon found.

use nalgebra::{DMatrix, DVector};

use super::arranged::Rows;
use super::trees::TreeRows;

/// Part of a diagonal entry of `G` below which a pivot says that rows repeat each other.
const SINGULAR: f64 = 1e-9;

/// Rows beyond which exchanges cost more than sweeps.
const MOST: usize = 16;

/// Percussions with `G P + b = 0` in bilateral rows and `0 ≤ P ⊥ G P + b ≥ 0` in the others, by exchange of one row at a time; `None`
/// where rows are many or repeat each other, or the exchange comes to no end.
pub(super) fn percussions(
    directions: &TreeRows,
    items: &[Rows],
    free: &[f64],
    tolerance: f64,
) -> Option<Vec<f64>> {
    let all = items.len();
    if all > MOST {
        return None;
    }
    let is_joint = |i: usize| items[i] == Rows::Bilateral;
    let g = DMatrix::from_fn(all, all, |i, j| directions.product(i, j));
    let least = -tolerance * free.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    let mut active: Vec<usize> = (0..all).filter(|&i| is_joint(i) || free[i] < least).collect();
    for _ in 0..=all {
        let count = active.len();
        let own = DMatrix::from_fn(count, count, |a, b| g[(active[a], active[b])]);
        let factor = own.cholesky()?;
        let pivots = factor.l_dirty().diagonal();
        if pivots.iter().zip(&active).any(|(l, &i)| l * l <= SINGULAR * g[(i, i)]) {
            return None;
        }
        let found = factor.solve(&DVector::from_fn(count, |a, _| -free[active[a]]));
        let smallest = (0..count).filter(|&a| !is_joint(active[a]));
        let smallest = smallest.min_by(|&a, &b| found[a].total_cmp(&found[b]));
        if let Some(a) = smallest.filter(|&a| found[a] < 0.0) {
            active.remove(a);
            continue;
        }
        let velocity = |i: usize| {
            free[i] + active.iter().zip(&found).map(|(&j, p)| g[(i, j)] * p).sum::<f64>()
        };
        let others = (0..all).filter(|i| !active.contains(i)).map(|i| (velocity(i), i));
        let Some((_, i)) = others.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|(v, _)| *v < least)
        else {
            let mut all = vec![0.0; all];
            active.iter().zip(&found).for_each(|(&i, p)| all[i] = *p);
            return Some(all);
        };
        active.push(i);
    }
    None
}

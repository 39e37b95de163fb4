//! Least squares with nonnegative unknowns.

use nalgebra::{DMatrix, DVector};

use crate::linear::LeastNorm;

/// `x ≥ 0` with the least `‖A x − f‖`, by the active sets of \[LawsonHanson1974\]; `None` if `A` is not finite.
///
/// Columns that depend on each other leave the active sets to rounding: one that is freed and at once driven back is
/// not freed again before another one has been. Whoever uses `x` checks what follows from it, so that it may be the best
/// so far where the active sets do not settle.
pub(crate) fn least_squares(a: &DMatrix<f64>, f: &DVector<f64>) -> Option<Vec<f64>> {
    let n = a.ncols();
    let mut x = vec![0.0; n];
    let mut free: Vec<usize> = Vec::new();
    let mut driven_back = vec![false; n];
    let small = 1e-12 * a.norm() * f.norm();
    let solve = |free: &[usize]| Some(LeastNorm::new(a.select_columns(free), 1e-14)?.solve(f));
    for _ in 0..3 * n {
        let gradient = a.tr_mul(&(f - a * DVector::from_column_slice(&x)));
        let held = (0..n).filter(|j| !free.contains(j) && !driven_back[*j]);
        let steepest = held.max_by(|&i, &j| gradient[i].total_cmp(&gradient[j]));
        let Some(next) = steepest.filter(|&j| gradient[j] > small) else { break };
        free.push(next);
        let mut solved = solve(&free)?;
        if !(solved[free.len() - 1] > 0.0) {
            free.pop();
            driven_back[next] = true;
            continue;
        }
        driven_back.fill(false);
        while let Some(length) = until_one_vanishes(free.iter().map(|j| x[*j]).zip(&solved)) {
            // Those that vanish are held.
            free.iter().zip(&solved).for_each(|(&j, v)| x[j] += length * (v - x[j]));
            let largest = x.iter().fold(0.0, |m: f64, v| m.max(*v));
            free.retain(|&j| x[j] > 1e-14 * largest);
            if free.is_empty() {
                break;
            }
            solved = solve(&free)?;
        }
        x.fill(0.0);
        free.iter().zip(&solved).for_each(|(&j, v)| x[j] = *v);
    }
    Some(x)
}

/// The part of the way from positive unknowns to others on which all stay positive; `None` if that is the whole way.
fn until_one_vanishes<'a>(pairs: impl Iterator<Item = (f64, &'a f64)>) -> Option<f64> {
    let parts = pairs.filter(|(_, end)| **end <= 0.0).map(|(start, end)| start / (start - end));
    parts.min_by(f64::total_cmp)
}

#[cfg(test)]
mod tests;

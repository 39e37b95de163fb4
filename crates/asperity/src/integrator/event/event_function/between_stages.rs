//! Events between the stages of a step: event functions as polynomials through the stages.

use crate::integrator::event::collocation::{STAGES, Tableau, lagrange_at};

/// Nodes of the polynomials: the start and the stages.
pub(crate) const NODES: usize = STAGES + 1;
/// Points of an interval at which the polynomial is evaluated: polynomials of degree five have at most four extrema.
pub(crate) const POINTS: usize = 8;
/// How far polynomials may leave the range of their values at the nodes, in such ranges: a bound on their Lebesgue constant.
const LEBESGUE: f64 = 2.0;
/// Height over the largest value of an event function that may be the error of the polynomial.
const MARGIN: f64 = 1e-10;

/// The start of a step and its stages, relative to the step.
fn nodes() -> [f64; NODES] {
    let mut nodes = [0.0; NODES];
    nodes[1..].copy_from_slice(&Tableau::radau().c);
    nodes
}

/// The polynomial through values at the first nodes, at a place relative to the step.
pub(crate) fn interpolated(values: &[f64], x: f64) -> f64 {
    through(&nodes()[..values.len()], values, x)
}

/// The polynomial through values at nodes, at a place relative to the step.
fn through(nodes: &[f64], values: &[f64], x: f64) -> f64 {
    (0..values.len()).map(|j| values[j] * lagrange_at(nodes, j, x)).sum()
}

/// The place of a positive maximum between the nodes of an event function that is not positive at them, relative to the step.
/// `values` are those of the start and of the first stages.
pub(crate) fn hidden_maximum(values: &[f64]) -> Option<f64> {
    if values.len() < 3 {
        return None;
    }
    let (least, most) =
        values.iter().fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(*v), b.max(*v)));
    if most + LEBESGUE * (most - least) < 0.0 {
        return None;
    }
    let largest = most.abs().max(least.abs());
    let nodes = nodes();
    let nodes = &nodes[..values.len()];
    for (i, ends) in nodes.windows(2).enumerate() {
        if values[i].max(values[i + 1]) > 0.0 {
            continue;
        }
        let width = (ends[1] - ends[0]) / POINTS as f64;
        let heights: [f64; POINTS + 1] = std::array::from_fn(|k| match k {
            0 => values[i],
            POINTS => values[i + 1],
            _ => through(nodes, values, ends[0] + k as f64 * width),
        });
        for k in 1..POINTS {
            let [left, here, right] = [heights[k - 1], heights[k], heights[k + 1]];
            if here >= left && here >= right {
                // The vertex of the parabola through three points.
                let bend = left - 2.0 * here + right;
                let shift = if bend < 0.0 { 0.5 * (left - right) / bend } else { 0.0 };
                let top = here - 0.25 * (left - right) * shift;
                if top > MARGIN * largest {
                    return Some(ends[0] + (k as f64 + shift) * width);
                }
            }
        }
    }
    None
}

#[cfg(test)]
mod tests;

//! Where boundaries cross.

use std::f64::consts::TAU;

use super::SAME;
use crate::numeric::root::{Bracket, Sample};
use crate::numeric::vectors::cast;
use crate::{StarSet, Vector};

/// Directions in which the boundaries of two sets are compared to find where they cross.
const DIRECTIONS: usize = 2048;

/// Corners of an intersection (`choose` the larger gauge) or a union (the smaller one): the corners of
/// the members that stay on the boundary and, in the plane, the points where boundaries cross.
pub(super) fn seams<const P: usize, S: StarSet<P>>(
    sets: &[S],
    choose: fn(f64, f64) -> f64,
) -> Vec<Vector<P>> {
    let gauge = |x: &Vector<P>| sets.iter().map(|s| s.gauge(x)).reduce(choose).unwrap_or(0.0);
    let mut found: Vec<Vector<P>> = sets.iter().flat_map(|set| set.corners()).collect();
    if P == 2 {
        for (i, a) in sets.iter().enumerate() {
            for b in &sets[..i] {
                let difference = |x: &Vector<2>| {
                    let x = cast(x);
                    let (a, b) = (a.gauge(&x), b.gauge(&x));
                    (a - b) / (a + b)
                };
                let directions =
                    crossings(&difference, &found.iter().map(cast).collect::<Vec<_>>());
                found.extend(directions.iter().map(|d| {
                    let d = cast(d);
                    d / a.gauge(&d)
                }));
            }
        }
    }
    let mut kept: Vec<Vector<P>> = Vec::new();
    for x in found {
        let new = kept.iter().all(|k| (k - x).norm() > SAME * x.norm());
        if new && (gauge(&x) - 1.0).abs() <= SAME {
            kept.push(x);
        }
    }
    kept
}

/// Directions in which a function of degree zero, without dimension, changes its sign.
fn crossings(f: &dyn Fn(&Vector<2>) -> f64, further: &[Vector<2>]) -> Vec<Vector<2>> {
    // An odd offset, so that symmetric sets do not cross at a node.
    let even = (0..DIRECTIONS).map(|k| TAU * (k as f64 + 0.317) / DIRECTIONS as f64);
    let mut angles: Vec<f64> =
        even.chain(further.iter().map(|x| x.y.atan2(x.x).rem_euclid(TAU))).collect();
    angles.sort_by(f64::total_cmp);
    let nodes: Vec<(Vector<2>, f64)> =
        angles.iter().map(|t| Vector::<2>::new(t.cos(), t.sin())).map(|d| (d, f(&d))).collect();
    let mut found = Vec::new();
    for i in 0..nodes.len() {
        let ((p, fp), (q, fq)) = (nodes[i], nodes[(i + 1) % nodes.len()]);
        // Equal up to rounding on both sides: the boundaries coincide there.
        if fp * fq < 0.0 && fp.abs().max(fq.abs()) > 1e-13 {
            let sample = |at, data, value| Sample { at, value, data };
            let mut bracket = Bracket::new(sample(0.0, p, fp), sample(1.0, q, fq));
            bracket.refine(0.0, f64::EPSILON, |w| {
                let d = p * (1.0 - w) + q * w;
                (f(&d), d)
            });
            found.push(bracket.best.data);
        }
    }
    found
}

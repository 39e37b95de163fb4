//! Projections in the plane.
//!
//! The height `g = n·z − h(n)` of a point `z` above the tangent line is quasi-concave where it is positive and is
//! largest at the projection; its slope along the boundary is `f = n⊥·(z − x)`. A point with `f = 0` and `g ≥ 0` is
//! the projection, however it was found.

use super::in_plane::InPlane;
use crate::numeric::vectors::{cast, cross, quarter_turn};
use crate::numeric::{Arc, BoundaryPoint};
use crate::{ConvexSet, StarSet, Vector};

/// Newton steps before the bracket takes over.
const PATIENCE: usize = 12;

/// Projection from the gauge.
pub(super) fn onto_planar<const P: usize, S: ConvexSet<P> + ?Sized>(
    set: &S,
    z: &Vector<P>,
) -> Vector<P> {
    let (set, z) = (InPlane { set }, cast(z));
    cast(&by_positions(&set, &z, &z).unwrap_or_else(|| by_bracket(&set, &z)))
}

/// Newton's method along the boundary, `f′ = −(1 + gκ)` per length of arc, with the curvature κ from a second
/// gradient nearby; `None` if that does not converge, as at corners.
fn by_positions<S: StarSet<2> + ?Sized>(
    set: &S,
    z: &Vector<2>,
    start: &Vector<2>,
) -> Option<Vector<2>> {
    let mut x = *start;
    for _ in 0..PATIENCE {
        let (gauge, gradient) = set.gauge_jet(&x);
        x /= gauge;
        let (n, size) = (gradient.normalize(), x.norm());
        let (tangent, away) = (quarter_turn(&n), z - x);
        let (slope, height) = (tangent.dot(&away), n.dot(&away));
        // The comparisons also turn away NaN.
        if !(height >= 0.0) {
            return None;
        }
        if slope.abs() <= f64::EPSILON * z.norm() {
            return Some(x);
        }
        let probe = 1e-7 * size;
        let turned = set.gauge_jet(&(x + tangent * probe)).1;
        let curvature = (cross(&n, &turned) / turned.norm() / probe).max(0.0);
        let step = slope / (1.0 + height * curvature);
        if !(step.abs() >= 0.0 && size > 0.0) {
            return None;
        }
        x += tangent * step.clamp(-0.5 * size, 0.5 * size);
    }
    None
}

/// Newton's method over the normals, for sets whose support function is at hand and whose gauge is not.
pub(crate) fn by_normals<S: ConvexSet<2> + ?Sized>(
    set: &S,
    z: &Vector<2>,
    start: Option<&Vector<2>>,
) -> Vector<2> {
    let mut n = start.filter(|n| n.amax() > 0.0).unwrap_or(z).normalize();
    for _ in 0..PATIENCE {
        let (x, hessian) = set.support_jet(&n);
        let (tangent, away) = (quarter_turn(&n), z - x);
        let (slope, height) = (tangent.dot(&away), n.dot(&away));
        let bend = height + tangent.dot(&(hessian * tangent));
        if slope.abs() <= f64::EPSILON * z.norm() && height >= 0.0 {
            return x;
        }
        let turn = slope / bend;
        if !(turn.abs() < 1.0 && bend > 0.0) {
            break;
        }
        n = (n + tangent * turn).normalize();
    }
    if set.gauge(z) <= 1.0 { *z } else { by_bracket(set, z) }
}

/// The walk along the boundary in both positions and normals, which knows corners and flats. It starts below
/// `z` as seen from the origin, where `g > 0`.
fn by_bracket<S: ConvexSet<2> + ?Sized>(set: &S, z: &Vector<2>) -> Vector<2> {
    let slope = |p: &BoundaryPoint| quarter_turn(&p.normal).dot(&(z - p.position));
    let start = BoundaryPoint::at_position(set, z);
    let sign = slope(&start).signum();
    if slope(&start) == 0.0 {
        return start.position;
    }
    // Past the crest, g may turn negative and its slope positive again: that still counts as past.
    let signed_slope = |p: &BoundaryPoint| {
        let above = p.normal.dot(&(z - p.position)) > 0.0;
        if above { slope(p) } else { -sign * slope(p).abs() }
    };
    let turned = |v: &Vector<2>| quarter_turn(v) * sign;
    let mut arc = Arc { start, end: start };
    // An eighth of a turn of the normal at a time, a quarter of the position at the most.
    for _ in 0..8 {
        arc.start = arc.end;
        let normal = arc.start.normal + turned(&arc.start.normal);
        arc.end = BoundaryPoint::at_normal(set, &normal);
        let ahead = turned(&arc.start.position);
        if arc.start.position.dot(&arc.end.position) < 0.0 {
            arc.end = BoundaryPoint::at_position(set, &ahead);
        }
        if signed_slope(&arc.end) * sign <= 0.0 {
            break;
        }
    }
    let tolerance = 0.5 * f64::EPSILON * z.norm();
    arc.root(set, tolerance, signed_slope).position
}

//! Tangent cones.

use crate::numeric::vectors::{aside, cast, quarter_turn};
use crate::{Cone, ConvexSet, Star, StarSet, Vector};

/// Tangent cone `T_C(x)` (\[WL19\] Def. 7, (10)) as convex cones whose union it is; `None` outside.
///
/// Points with `|k(x) − 1| ≤ tolerance` count as boundary points. For a convex set it is the polar of the
/// normal cone. At a corner of a planar set that is star-shaped only, it is the sector between the
/// tangents on both sides, which may exceed a half turn; in space it is the half-space below the
/// gradient.
pub fn tangent_cone<const P: usize>(
    set: &Star<P>,
    x: &Vector<P>,
    tolerance: f64,
) -> Option<Vec<Cone<P>>> {
    if let Some(convex) = set.as_convex() {
        return Some(vec![convex.normal_cone(x, tolerance)?.polar()]);
    }
    // The gauge is of no help beside a cusp, where it is steep without bound.
    let near = |c: &Vector<P>| (c - x).norm() <= tolerance.max(1e-12) * c.norm();
    match set.corners().into_iter().find(near) {
        Some(corner) if is_cusped(set) => Some(vec![Cone::new([-corner])]),
        Some(corner) if P == 2 => Some(sector(set, &corner)),
        _ => Some(vec![Cone::smooth(set, x, tolerance)?.polar()]),
    }
}

/// Whether the corners of a set are the tips of cusps, whose tangent cone is a ray.
fn is_cusped<const P: usize>(set: &Star<P>) -> bool {
    match set {
        Star::Superellipsoid(_) => true,
        Star::Image(image) => is_cusped(image.preimage()),
        _ => false,
    }
}

/// The sector at a corner of a planar set, from the tangents just beside it, through `−x`.
fn sector<const P: usize>(set: &Star<P>, x: &Vector<P>) -> Vec<Cone<P>> {
    let inward = -x.normalize();
    let tangent = |side: f64| {
        let normal = set.gauge_jet(&aside(x, side)).1;
        cast::<2, P>(&(quarter_turn(&cast(&normal)) * side)).normalize()
    };
    let (ahead, behind) = (tangent(1.0), tangent(-1.0));
    let sweep =
        ahead.dot(&inward).clamp(-1.0, 1.0).acos() + behind.dot(&inward).clamp(-1.0, 1.0).acos();
    if sweep <= std::f64::consts::PI + 1e-6 {
        vec![Cone::new([ahead, inward, behind])]
    } else {
        vec![Cone::new([ahead, inward]), Cone::new([inward, behind])]
    }
}

//! Projections without a closed form.

mod in_plane;
pub(crate) mod jet;
mod plane;
mod space;

use crate::{ConvexSet, Vector};

pub(crate) use in_plane::InPlane;
pub(crate) use plane::by_normals;
pub(crate) use space::{by_cuts, by_dual_newton, by_support_points, onto_image};

/// Projection onto any convex set from its gauge and support points.
pub(crate) fn onto_any<const P: usize, S: ConvexSet<P> + ?Sized>(
    set: &S,
    z: &Vector<P>,
) -> Vector<P> {
    if set.gauge(z) <= 1.0 {
        return *z;
    }
    match P {
        1 => set.support_point(z),
        2 => plane::onto_planar(set, z),
        _ => space::onto_any_in_space(set, z),
    }
}

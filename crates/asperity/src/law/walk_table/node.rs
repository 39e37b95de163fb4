//! Points of the boundaries of both sets that belong together.

use asperity_set::{BoundaryPoint, Star, StarSet, Vector};

/// A node: a point of bdry *D* with its normal, and the point of bdry *C* on the same ray.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Node {
    /// The point of bdry *D*.
    pub point: BoundaryPoint,
    /// `x = z/k_C(z)`.
    pub x: Vector<2>,
}

impl Node {
    /// The node at a point of bdry *D*.
    pub(super) fn new(reservoir: &Star<2>, point: BoundaryPoint) -> Self {
        Self { point, x: point.position / reservoir.gauge(&point.position) }
    }
}

/// Angle between two vectors.
pub(super) fn angle(a: &Vector<2>, b: &Vector<2>) -> f64 {
    (a.x * b.y - a.y * b.x).atan2(a.dot(b)).abs()
}

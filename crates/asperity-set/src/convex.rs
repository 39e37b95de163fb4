//! Convex sets: support function, projection, normal cone.

use crate::numeric::polarity;
use crate::{Cone, Matrix, StarSet, Vector, project};

/// A compact convex set with the origin in its interior.
///
/// Nothing has to be given besides the gauge; a support point, where it is known, makes all the rest faster.
pub trait ConvexSet<const P: usize>: StarSet<P> {
    /// A point of the set that is farthest in direction `y ≠ 0`: `argmax{xᵀy : x ∈ C}`.
    ///
    /// Where a whole face is farthest, closed forms give its most symmetric point. The default finds the
    /// point from the gauge.
    fn support_point(&self, y: &Vector<P>) -> Vector<P> {
        polarity::support_point(self, y)
    }

    /// Support function `h(y) = sup{xᵀy : x ∈ C}` (\[WL19\] Def. 5).
    fn support(&self, y: &Vector<P>) -> f64 {
        if y.amax() == 0.0 { 0.0 } else { y.dot(&self.support_point(y)) }
    }

    /// Support point and Hessian `∇²h(y)` in one evaluation, for `y ≠ 0`.
    ///
    /// The Hessian is symmetric positive semidefinite with `∇²h(y) y = 0`; it is infinite where the
    /// boundary's curvature vanishes and zero where `y` points at a corner. The default takes central
    /// differences.
    fn support_jet(&self, y: &Vector<P>) -> (Vector<P>, Matrix<P>) {
        (self.support_point(y), polarity::support_hessian(self, y))
    }

    /// Support point at `y ≠ 0` and its derivative `∇²h(y) dy`.
    fn support_derivative(&self, y: &Vector<P>, dy: &Vector<P>) -> (Vector<P>, Vector<P>) {
        let (point, hessian) = self.support_jet(y);
        (point, hessian * dy)
    }

    /// Hessian of the support function, see [`support_jet`](Self::support_jet).
    fn support_hessian(&self, y: &Vector<P>) -> Matrix<P> {
        self.support_jet(y).1
    }

    /// Proximal point `prox_C(z) = argmin{‖z − x‖ : x ∈ C}` (\[WL19\] (11)).
    ///
    /// The default walks along the boundary in the plane and is not made for speed in space.
    fn project(&self, z: &Vector<P>) -> Vector<P> {
        project::onto_any(self, z)
    }

    /// [`project`](Self::project), told a point that is likely to lie near the result.
    ///
    /// The start changes the cost, never the result beyond rounding.
    fn project_from(&self, z: &Vector<P>, _start: &Vector<P>) -> Vector<P> {
        self.project(z)
    }

    /// Proximal point and an element of the generalised Jacobian of `prox_C` there, from a point that is likely
    /// to lie near the result.
    ///
    /// The Jacobian is the identity inside; outside it is symmetric with eigenvalues between 0 and 1 and
    /// vanishes along the normal. The default takes differences (error about 1e-8).
    fn project_jet(&self, z: &Vector<P>, start: &Vector<P>) -> (Vector<P>, Matrix<P>) {
        project::jet::by_differences(self, z, start)
    }

    /// Normal cone `N_C(x) = {y : yᵀ(x* − x) ≤ 0 ∀x* ∈ C}` (\[WL19\] Def. 6); `None` outside the set.
    ///
    /// Points with `|k(x) − 1| ≤ tolerance` count as boundary points. The default holds for smooth
    /// boundaries.
    fn normal_cone(&self, x: &Vector<P>, tolerance: f64) -> Option<Cone<P>> {
        Cone::smooth(self, x, tolerance)
    }

    /// Outward normals of any length, among them those of all flat parts of the boundary that are known.
    ///
    /// The default knows none. A normal may belong to a flat that another member of an intersection cuts off; in space
    /// the facets are missing that edges of different members of a sum span.
    fn flat_normals(&self) -> Vec<Vector<P>> {
        Vec::new()
    }
}

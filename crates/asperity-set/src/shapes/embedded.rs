//! Sets that exist in one dimension only, held by the enums that are written once for every dimension.

use crate::numeric::vectors::{cast, cast_matrix};
use crate::{Cone, ConvexSet, Matrix, StarSet, Vector};

/// A set of R^Q as an arm of the enums over all sets; made for `P = Q` only.
#[derive(Debug, Clone, PartialEq)]
pub struct Embedded<S, const Q: usize>(S);

impl<S, const Q: usize> Embedded<S, Q> {
    pub(crate) fn new(set: S) -> Self {
        Self(set)
    }

    /// The set of R^Q.
    pub fn set(&self) -> &S {
        &self.0
    }
}

impl<const P: usize, const Q: usize, S: StarSet<Q>> StarSet<P> for Embedded<S, Q> {
    #[inline]
    fn gauge(&self, x: &Vector<P>) -> f64 {
        self.0.gauge(&cast(x))
    }

    #[inline]
    fn gauge_jet(&self, x: &Vector<P>) -> (f64, Vector<P>) {
        let (gauge, gradient) = self.0.gauge_jet(&cast(x));
        (gauge, cast(&gradient))
    }

    fn corners(&self) -> Vec<Vector<P>> {
        self.0.corners().iter().map(cast).collect()
    }
}

impl<const P: usize, const Q: usize, S: ConvexSet<Q>> ConvexSet<P> for Embedded<S, Q> {
    #[inline]
    fn support_point(&self, y: &Vector<P>) -> Vector<P> {
        cast(&self.0.support_point(&cast(y)))
    }

    #[inline]
    fn support(&self, y: &Vector<P>) -> f64 {
        self.0.support(&cast(y))
    }

    #[inline]
    fn support_jet(&self, y: &Vector<P>) -> (Vector<P>, Matrix<P>) {
        let (point, hessian) = self.0.support_jet(&cast(y));
        (cast(&point), cast_matrix(&hessian))
    }

    fn project(&self, z: &Vector<P>) -> Vector<P> {
        cast(&self.0.project(&cast(z)))
    }

    fn project_from(&self, z: &Vector<P>, start: &Vector<P>) -> Vector<P> {
        cast(&self.0.project_from(&cast(z), &cast(start)))
    }

    fn project_jet(&self, z: &Vector<P>, start: &Vector<P>) -> (Vector<P>, Matrix<P>) {
        let (point, jacobian) = self.0.project_jet(&cast(z), &cast(start));
        (cast(&point), cast_matrix(&jacobian))
    }

    fn normal_cone(&self, x: &Vector<P>, tolerance: f64) -> Option<Cone<P>> {
        Some(self.0.normal_cone(&cast(x), tolerance)?.cast())
    }

    fn flat_normals(&self) -> Vec<Vector<P>> {
        self.0.flat_normals().iter().map(cast).collect()
    }
}

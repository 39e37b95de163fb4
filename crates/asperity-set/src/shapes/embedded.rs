//! Passing between a dimension known at compile time and one known at run time.
//!
//! Some sets exist in one dimension only (a polygon in the plane). The enums over all sets are written
//! once for every dimension: [`Embedded`] lets them hold such a set, [`InPlane`] lets planar algorithms
//! run on a set whose dimension turns out to be two.

use crate::{Cone, ConvexSet, Matrix, StarSet, Vector};

/// The same vector under another constant dimension, equal to the first one at run time.
#[inline(always)]
pub(crate) fn cast<const P: usize, const Q: usize>(x: &Vector<P>) -> Vector<Q> {
    debug_assert_eq!(P, Q);
    Vector::from_fn(|i, _| x[i])
}

#[inline(always)]
fn cast_matrix<const P: usize, const Q: usize>(m: &Matrix<P>) -> Matrix<Q> {
    debug_assert_eq!(P, Q);
    Matrix::from_fn(|i, j| m[(i, j)])
}

/// Counter-clockwise quarter turn.
#[inline(always)]
pub(crate) fn quarter_turn(v: &Vector<2>) -> Vector<2> {
    Vector::<2>::new(-v.y, v.x)
}

/// `a × b`.
#[inline(always)]
pub(crate) fn cross(a: &Vector<2>, b: &Vector<2>) -> f64 {
    a.x * b.y - a.y * b.x
}

/// The cross product of two vectors whose dimension is three at run time.
#[inline(always)]
pub(crate) fn cross_3<const P: usize>(a: &Vector<P>, b: &Vector<P>) -> Vector<P> {
    debug_assert_eq!(P, 3);
    Vector::from_fn(|i, _| {
        let (j, k) = ((i + 1) % P, (i + 2) % P);
        a[j] * b[k] - a[k] * b[j]
    })
}

/// A `ConvexSet<P>` with `P = 2` at run time, seen as a planar set.
#[derive(Debug)]
pub(crate) struct InPlane<'a, const P: usize, S: ?Sized> {
    pub(crate) set: &'a S,
}

impl<const P: usize, S: ConvexSet<P> + ?Sized> StarSet<2> for InPlane<'_, P, S> {
    fn gauge(&self, x: &Vector<2>) -> f64 {
        self.set.gauge(&cast(x))
    }

    fn gauge_jet(&self, x: &Vector<2>) -> (f64, Vector<2>) {
        let (gauge, gradient) = self.set.gauge_jet(&cast(x));
        (gauge, cast(&gradient))
    }
}

impl<const P: usize, S: ConvexSet<P> + ?Sized> ConvexSet<2> for InPlane<'_, P, S> {
    fn support_point(&self, y: &Vector<2>) -> Vector<2> {
        cast(&self.set.support_point(&cast(y)))
    }

    fn support_jet(&self, y: &Vector<2>) -> (Vector<2>, Matrix<2>) {
        let (point, hessian) = self.set.support_jet(&cast(y));
        (cast(&point), cast_matrix(&hessian))
    }
}

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
}

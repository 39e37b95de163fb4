//! Planar algorithms on sets whose dimension turns out to be two.

use crate::numeric::vectors::{cast, cast_matrix};
use crate::{ConvexSet, Matrix, StarSet, Vector};

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

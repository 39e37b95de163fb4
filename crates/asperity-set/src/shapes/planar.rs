//! The sets that exist in the plane only, as one value.

use crate::{
    CappedRectangle, Cone, ConvexSet, Matrix, PolarCurve, Polygon, StarSet, SupportCurve, Vector,
    WedgeAsperity,
};

/// A set of the plane.
#[derive(Debug, Clone, PartialEq)]
pub enum Planar {
    /// Rectangle with two half-ellipses.
    CappedRectangle(CappedRectangle),
    /// Force reservoir of wedge-shaped asperities.
    WedgeAsperity(WedgeAsperity),
    /// Polygon.
    Polygon(Polygon),
    /// Smooth curve through measured radii.
    PolarCurve(PolarCurve),
    /// Smooth curve through values of the support function.
    SupportCurve(SupportCurve),
}

macro_rules! each {
    ($self:ident, $set:ident => $call:expr) => {
        match $self {
            Planar::CappedRectangle($set) => $call,
            Planar::WedgeAsperity($set) => $call,
            Planar::Polygon($set) => $call,
            Planar::PolarCurve($set) => $call,
            Planar::SupportCurve($set) => $call,
        }
    };
}

impl Planar {
    /// Whether the set is convex, which every kind decides from its parameters.
    pub fn is_convex(&self) -> bool {
        match self {
            Self::CappedRectangle(_) | Self::SupportCurve(_) => true,
            Self::WedgeAsperity(set) => set.is_convex(),
            Self::Polygon(set) => set.is_convex(),
            Self::PolarCurve(set) => set.is_convex(),
        }
    }
}

impl StarSet<2> for Planar {
    #[inline]
    fn gauge(&self, x: &Vector<2>) -> f64 {
        each!(self, set => set.gauge(x))
    }

    #[inline]
    fn gauge_jet(&self, x: &Vector<2>) -> (f64, Vector<2>) {
        each!(self, set => set.gauge_jet(x))
    }

    fn corners(&self) -> Vec<Vector<2>> {
        each!(self, set => set.corners())
    }
}

/// Meaningful where [`Planar::is_convex`]; [`Convex`](crate::Convex) admits no other.
impl ConvexSet<2> for Planar {
    #[inline]
    fn support_point(&self, y: &Vector<2>) -> Vector<2> {
        each!(self, set => set.support_point(y))
    }

    #[inline]
    fn support(&self, y: &Vector<2>) -> f64 {
        each!(self, set => set.support(y))
    }

    #[inline]
    fn support_jet(&self, y: &Vector<2>) -> (Vector<2>, Matrix<2>) {
        each!(self, set => set.support_jet(y))
    }

    fn project(&self, z: &Vector<2>) -> Vector<2> {
        each!(self, set => set.project(z))
    }

    fn project_from(&self, z: &Vector<2>, start: &Vector<2>) -> Vector<2> {
        each!(self, set => set.project_from(z, start))
    }

    fn project_jet(&self, z: &Vector<2>, start: &Vector<2>) -> (Vector<2>, Matrix<2>) {
        each!(self, set => set.project_jet(z, start))
    }

    fn normal_cone(&self, x: &Vector<2>, tolerance: f64) -> Option<Cone<2>> {
        each!(self, set => set.normal_cone(x, tolerance))
    }

    fn flat_normals(&self) -> Vec<Vector<2>> {
        each!(self, set => set.flat_normals())
    }
}

/// A planar set from each of its kinds.
macro_rules! from {
    ($($kind:ident),*) => {
        $(impl From<$kind> for Planar {
            fn from(set: $kind) -> Self {
                Self::$kind(set)
            }
        })*
    };
}
from!(CappedRectangle, WedgeAsperity, Polygon, PolarCurve, SupportCurve);

//! Walking along the boundary of a planar convex set.
//!
//! A boundary point is a pair (position, normal). Along the boundary, counter-clockwise, the position
//! angle θ and the normal angle φ both never decrease, and θ + φ increases strictly: in that parameter
//! flats (normal fixed) and corners (position fixed) are continuous arcs like any other. Between two
//! points the one of the two that turns more is interpolated and the other follows from the set, which
//! keeps full accuracy where the curvature is very small or very large. No trigonometry is needed.

use crate::numeric::root::{Bracket, Sample};
use crate::numeric::vectors::cross;
use crate::{ConvexSet, Vector};

/// A point of the boundary together with one of its unit outward normals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundaryPoint {
    /// The point.
    pub position: Vector<2>,
    /// Unit outward normal.
    pub normal: Vector<2>,
}

/// What is interpolated between two boundary points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The normal; the position is its support point.
    Normal,
    /// The position; the normal is the gradient of the gauge.
    Position,
}

/// `1 − cos` of the angle between two vectors, a monotone measure of how far they are apart.
fn turn(a: &Vector<2>, b: &Vector<2>) -> f64 {
    let scale = a.norm() * b.norm();
    let (sine, cosine) = (cross(a, b) / scale, a.dot(b) / scale);
    // 1 − cos cancels at small angles.
    if cosine > 0.0 { sine * sine / (1.0 + cosine) } else { 1.0 - cosine }
}

impl BoundaryPoint {
    /// The point with this normal, which need not have unit length.
    pub fn at_normal<S: ConvexSet<2> + ?Sized>(set: &S, normal: &Vector<2>) -> Self {
        Self { position: set.support_point(normal), normal: normal.normalize() }
    }

    /// The point in this direction from the origin.
    pub fn at_position<S: ConvexSet<2> + ?Sized>(set: &S, direction: &Vector<2>) -> Self {
        let (gauge, gradient) = set.gauge_jet(direction);
        Self { position: direction / gauge, normal: gradient.normalize() }
    }
}

/// A piece of the boundary, counter-clockwise or clockwise, with less than a half turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arc {
    /// First end.
    pub start: BoundaryPoint,
    /// Second end.
    pub end: BoundaryPoint,
}

impl Arc {
    /// The side that turns more along the arc.
    pub fn side(&self) -> Side {
        let positions = turn(&self.start.position, &self.end.position);
        if turn(&self.start.normal, &self.end.normal) >= positions {
            Side::Normal
        } else {
            Side::Position
        }
    }

    /// The point at fraction `weight` of the arc, interpolating `side`.
    pub fn point<S: ConvexSet<2> + ?Sized>(
        &self,
        set: &S,
        side: Side,
        weight: f64,
    ) -> BoundaryPoint {
        let blend = |a: &Vector<2>, b: &Vector<2>| a * (1.0 - weight) + b * weight;
        match side {
            Side::Normal => {
                BoundaryPoint::at_normal(set, &blend(&self.start.normal, &self.end.normal))
            }
            Side::Position => {
                BoundaryPoint::at_position(set, &blend(&self.start.position, &self.end.position))
            }
        }
    }

    /// The middle of the arc.
    pub fn middle<S: ConvexSet<2> + ?Sized>(&self, set: &S) -> BoundaryPoint {
        self.point(set, self.side(), 0.5)
    }

    /// A zero of `f` on an arc with a change of sign, to `|f| ≤ tolerance` or to the last bit.
    pub fn root<S, F>(&self, set: &S, tolerance: f64, mut f: F) -> BoundaryPoint
    where
        S: ConvexSet<2> + ?Sized,
        F: FnMut(&BoundaryPoint) -> f64,
    {
        let sample = |at, point: BoundaryPoint, value| Sample { at, value, data: point };
        let (first, last) = (f(&self.start), f(&self.end));
        let mut bracket = Bracket::new(sample(0.0, self.start, first), sample(1.0, self.end, last));
        // Once one side is resolved the other may still turn: a corner next to a flat.
        for _ in 0..4 {
            let arc = Self { start: bracket.a.data, end: bracket.b.data };
            (bracket.a.at, bracket.b.at) = (0.0, 1.0);
            let side = arc.side();
            bracket.refine(tolerance, f64::EPSILON, |weight| {
                let point = arc.point(set, side, weight);
                (f(&point), point)
            });
            if bracket.a.at > bracket.b.at {
                (bracket.a, bracket.b) = (bracket.b, bracket.a);
            }
            let unchanged = (arc.start, arc.end) == (bracket.a.data, bracket.b.data);
            if unchanged || bracket.best.value.abs() <= tolerance {
                break;
            }
        }
        bracket.best.data
    }
}

//! Walking along the boundary of a planar convex set.
//!
//! A boundary point is a pair (position, normal). Along the boundary, counter-clockwise, the position
//! angle θ and the normal angle φ both never decrease, and θ + φ increases strictly: in that parameter
//! flats (normal fixed) and corners (position fixed) are continuous arcs like any other. Between two
//! points the one of the two that turns more is interpolated and the other follows from the set, which
//! keeps full accuracy where the curvature is very small or very large. No trigonometry is needed.

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

/// `a × b`.
#[inline]
pub(crate) fn cross(a: &Vector<2>, b: &Vector<2>) -> f64 {
    a.x * b.y - a.y * b.x
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
        let values = (f(&self.start), f(&self.end));
        let best = if values.0.abs() <= values.1.abs() { self.start } else { self.end };
        let smallest = values.0.abs().min(values.1.abs());
        let mut bracket = Bracket { arc: *self, values, best, smallest };
        // Once one side is resolved the other may still turn: a corner next to a flat.
        for _ in 0..4 {
            let before = bracket.arc;
            if bracket.smallest <= tolerance {
                break;
            }
            bracket.refine(set, tolerance, &mut f);
            if bracket.arc == before {
                break;
            }
        }
        bracket.best
    }
}

/// An arc with a change of sign of some function, whose values at the ends are kept.
struct Bracket {
    arc: Arc,
    values: (f64, f64),
    /// The point with the smallest value that was seen, and that value.
    best: BoundaryPoint,
    smallest: f64,
}

impl Bracket {
    /// Chandrupatla's method (inverse quadratic interpolation, bisection where that is not safe) in
    /// the side that turns more now.
    fn refine<S, F>(&mut self, set: &S, tolerance: f64, f: &mut F)
    where
        S: ConvexSet<2> + ?Sized,
        F: FnMut(&BoundaryPoint) -> f64,
    {
        let (arc, side) = (self.arc, self.arc.side());
        let (mut a, mut fa, mut at_a) = (0.0, self.values.0, arc.start);
        let (mut b, mut fb, mut at_b) = (1.0, self.values.1, arc.end);
        let mut weight = 0.5;
        while f64::abs(b - a) > f64::EPSILON {
            let x = a + weight * (b - a);
            let at_x = arc.point(set, side, x);
            let fx = f(&at_x);
            let (c, fc);
            if (fx > 0.0) == (fa > 0.0) {
                (c, fc) = (a, fa);
            } else {
                (c, fc) = (b, fb);
                (b, fb, at_b) = (a, fa, at_a);
            }
            (a, fa, at_a) = (x, fx, at_x);
            if fa.abs() < self.smallest {
                (self.smallest, self.best) = (fa.abs(), at_a);
            }
            if self.smallest <= tolerance {
                break;
            }
            let (xi, phi) = ((a - b) / (c - b), (fa - fb) / (fc - fb));
            let margin = f64::min(0.5, 0.5 * f64::EPSILON / f64::abs(b - a));
            weight = if phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi {
                let quadratic = fa / (fb - fa) * (fc / (fb - fc))
                    + (c - a) / (b - a) * (fa / (fc - fa)) * (fb / (fc - fb));
                quadratic.clamp(margin, 1.0 - margin)
            } else {
                0.5
            };
        }
        if a <= b {
            (self.arc, self.values) = (Arc { start: at_a, end: at_b }, (fa, fb));
        } else {
            (self.arc, self.values) = (Arc { start: at_b, end: at_a }, (fb, fa));
        }
    }
}

//! Intersection, union and Minkowski sum.

use std::f64::consts::TAU;

use crate::plane::{cast, cross};
use crate::root::{Bracket, Sample};
use crate::{Cone, Convex, ConvexSet, Matrix, SetError, Star, StarSet, Vector, along, polar};

/// Directions in which the boundaries of two sets are compared to find where they cross.
const DIRECTIONS: usize = 2048;
/// Gauges this close count as equal at a crossing.
const SAME: f64 = 1e-9;

/// The intersection `C₁ ∩ C₂ ∩ …`, whose gauge is the largest one; convex if its members are.
#[derive(Debug, Clone, PartialEq)]
pub struct Intersection<S, const P: usize> {
    sets: Vec<S>,
    corners: Vec<Vector<P>>,
}

/// The union `C₁ ∪ C₂ ∪ …`, star-shaped, whose gauge is the smallest one.
#[derive(Debug, Clone, PartialEq)]
pub struct Union<const P: usize> {
    sets: Vec<Star<P>>,
    corners: Vec<Vector<P>>,
}

/// The sum `{x₁ + x₂ + … : xᵢ ∈ Cᵢ}` of convex sets, whose support function is the sum.
#[derive(Debug, Clone, PartialEq)]
pub struct MinkowskiSum<const P: usize> {
    sets: Vec<Convex<P>>,
    corners: Vec<Vector<P>>,
}

fn some<S>(sets: &[S]) -> Result<(), SetError> {
    if sets.is_empty() {
        let message = String::from("must hold at least one set");
        return Err(SetError::Shape { argument: "sets", message });
    }
    Ok(())
}

impl<const P: usize, S: StarSet<P>> Intersection<S, P> {
    /// The intersection of some sets.
    pub fn new(sets: Vec<S>) -> Result<Self, SetError> {
        some(&sets)?;
        let corners = seams(&sets, f64::max);
        Ok(Self { sets, corners })
    }

    /// The members.
    pub fn sets(&self) -> &[S] {
        &self.sets
    }

    fn outermost(&self, x: &Vector<P>) -> (f64, Vector<P>) {
        let jets = self.sets.iter().map(|set| set.gauge_jet(x));
        jets.reduce(|a, b| if b.0 > a.0 { b } else { a }).unwrap_or((0.0, Vector::zeros()))
    }
}

impl<const P: usize> Union<P> {
    /// The union of some sets.
    pub fn new(sets: Vec<Star<P>>) -> Result<Self, SetError> {
        some(&sets)?;
        let corners = seams(&sets, f64::min);
        Ok(Self { sets, corners })
    }

    /// The members.
    pub fn sets(&self) -> &[Star<P>] {
        &self.sets
    }
}

impl<const P: usize> MinkowskiSum<P> {
    /// The sum of some sets.
    pub fn new(sets: Vec<Convex<P>>) -> Result<Self, SetError> {
        some(&sets)?;
        let corners = sums_of_corners(&sets);
        Ok(Self { sets, corners })
    }

    /// The members.
    pub fn sets(&self) -> &[Convex<P>] {
        &self.sets
    }
}

impl<const P: usize, S: StarSet<P>> StarSet<P> for Intersection<S, P> {
    fn gauge(&self, x: &Vector<P>) -> f64 {
        self.sets.iter().map(|set| set.gauge(x)).fold(0.0, f64::max)
    }

    fn gauge_jet(&self, x: &Vector<P>) -> (f64, Vector<P>) {
        self.outermost(x)
    }

    fn corners(&self) -> Vec<Vector<P>> {
        self.corners.clone()
    }
}

impl<const P: usize, S: ConvexSet<P>> ConvexSet<P> for Intersection<S, P> {
    /// A member's support point that lies in all others is the farthest; else the farthest point lies where
    /// boundaries cross.
    fn support_point(&self, y: &Vector<P>) -> Vector<P> {
        let own = self.sets.iter().map(|set| set.support_point(y));
        let inside = |x: &Vector<P>| self.gauge(x) <= 1.0 + 4.0 * f64::EPSILON;
        own.into_iter().find(inside).unwrap_or_else(|| polar::support_point(self, y))
    }

    fn normal_cone(&self, x: &Vector<P>, tolerance: f64) -> Option<Cone<P>> {
        let cones: Option<Vec<Cone<P>>> =
            self.sets.iter().map(|set| set.normal_cone(x, tolerance)).collect();
        Some(Cone::new(cones?.iter().flat_map(|cone| cone.generators().to_vec())))
    }
}

impl<const P: usize> StarSet<P> for Union<P> {
    fn gauge(&self, x: &Vector<P>) -> f64 {
        self.sets.iter().map(|set| set.gauge(x)).fold(f64::INFINITY, f64::min)
    }

    fn gauge_jet(&self, x: &Vector<P>) -> (f64, Vector<P>) {
        let jets = self.sets.iter().map(|set| set.gauge_jet(x));
        jets.reduce(|a, b| if b.0 < a.0 { b } else { a }).unwrap_or((0.0, Vector::zeros()))
    }

    fn corners(&self) -> Vec<Vector<P>> {
        self.corners.clone()
    }
}

impl<const P: usize> StarSet<P> for MinkowskiSum<P> {
    fn gauge(&self, x: &Vector<P>) -> f64 {
        self.gauge_jet(x).0
    }

    fn gauge_jet(&self, x: &Vector<P>) -> (f64, Vector<P>) {
        polar::gauge_jet(self, x)
    }

    fn corners(&self) -> Vec<Vector<P>> {
        self.corners.clone()
    }
}

impl<const P: usize> ConvexSet<P> for MinkowskiSum<P> {
    fn support_point(&self, y: &Vector<P>) -> Vector<P> {
        self.sets.iter().map(|set| set.support_point(y)).sum()
    }

    fn support(&self, y: &Vector<P>) -> f64 {
        self.sets.iter().map(|set| set.support(y)).sum()
    }

    fn support_jet(&self, y: &Vector<P>) -> (Vector<P>, Matrix<P>) {
        let jets = self.sets.iter().map(|set| set.support_jet(y));
        jets.fold((Vector::zeros(), Matrix::zeros()), |sum, jet| (sum.0 + jet.0, sum.1 + jet.1))
    }

    fn normal_cone(&self, x: &Vector<P>, tolerance: f64) -> Option<Cone<P>> {
        Cone::beside_corner(self, x, tolerance)
    }
}

/// Corners of an intersection (`choose` the larger gauge) or a union (the smaller one): the corners of
/// the members that stay on the boundary and, in the plane, the points where boundaries cross.
fn seams<const P: usize, S: StarSet<P>>(sets: &[S], choose: fn(f64, f64) -> f64) -> Vec<Vector<P>> {
    let gauge = |x: &Vector<P>| sets.iter().map(|s| s.gauge(x)).reduce(choose).unwrap_or(0.0);
    let mut found: Vec<Vector<P>> = sets.iter().flat_map(|set| set.corners()).collect();
    if P == 2 {
        for (i, a) in sets.iter().enumerate() {
            for b in &sets[..i] {
                let difference = |x: &Vector<2>| {
                    let x = cast(x);
                    a.gauge(&x) - b.gauge(&x)
                };
                let directions =
                    crossings(&difference, &found.iter().map(cast).collect::<Vec<_>>());
                found.extend(directions.iter().map(|d| {
                    let d = cast(d);
                    d / a.gauge(&d)
                }));
            }
        }
    }
    let mut kept: Vec<Vector<P>> = Vec::new();
    for x in found {
        let new = kept.iter().all(|k| (k - x).norm() > SAME * x.norm());
        if new && (gauge(&x) - 1.0).abs() <= SAME {
            kept.push(x);
        }
    }
    kept
}

/// Directions in which a function of degree one changes its sign.
fn crossings(f: &dyn Fn(&Vector<2>) -> f64, further: &[Vector<2>]) -> Vec<Vector<2>> {
    // An odd offset, so that symmetric sets do not cross at a node.
    let even = (0..DIRECTIONS).map(|k| TAU * (k as f64 + 0.317) / DIRECTIONS as f64);
    let mut angles: Vec<f64> =
        even.chain(further.iter().map(|x| x.y.atan2(x.x).rem_euclid(TAU))).collect();
    angles.sort_by(f64::total_cmp);
    let nodes: Vec<(Vector<2>, f64)> =
        angles.iter().map(|t| Vector::<2>::new(t.cos(), t.sin())).map(|d| (d, f(&d))).collect();
    let mut found = Vec::new();
    for i in 0..nodes.len() {
        let ((p, fp), (q, fq)) = (nodes[i], nodes[(i + 1) % nodes.len()]);
        // Equal up to rounding on both sides: the boundaries coincide there.
        if fp * fq < 0.0 && fp.abs().max(fq.abs()) > 1e-13 {
            let sample = |at, data, value| Sample { at, value, data };
            let mut bracket = Bracket::new(sample(0.0, p, fp), sample(1.0, q, fq));
            bracket.refine(0.0, f64::EPSILON, |w| {
                let d = p * (1.0 - w) + q * w;
                (f(&d), d)
            });
            found.push(bracket.best.data);
        }
    }
    found
}

/// Corners of a planar sum: sums of corners, one of each set, whose normal cones have a common interior.
fn sums_of_corners<const P: usize>(sets: &[Convex<P>]) -> Vec<Vector<P>> {
    match P {
        1 => [1.0, -1.0]
            .map(|s| sets.iter().map(|set| set.support_point(&along(0, s))).sum())
            .to_vec(),
        2 => {
            // (corner so far, first and last normal counter-clockwise)
            type Fan<const P: usize> = (Vector<P>, Vector<2>, Vector<2>);
            let fans = |set: &Convex<P>| -> Vec<Fan<P>> {
                let corners = set.corners().into_iter();
                corners.filter_map(|x| fan(set, &x).map(|(a, b)| (x, a, b))).collect()
            };
            let first = sets.first().map(fans).unwrap_or_default();
            let all = sets.iter().skip(1).fold(first, |sums, set| {
                let fans = fans(set);
                let pairs = sums.iter().flat_map(|sum| fans.iter().map(move |fan| (sum, fan)));
                let shared = pairs.filter_map(|((x, a, b), (y, c, d))| {
                    let (start, end) = common((a, b), (c, d))?;
                    Some((x + y, start, end))
                });
                shared.collect()
            });
            all.into_iter().map(|fan| fan.0).collect()
        }
        _ => Vec::new(),
    }
}

/// First and last unit normal at a corner, counter-clockwise.
fn fan<const P: usize>(set: &Convex<P>, x: &Vector<P>) -> Option<(Vector<2>, Vector<2>)> {
    let cone = set.normal_cone(x, SAME)?;
    let [a, b] = cone.generators() else { return None };
    let (a, b): (Vector<2>, Vector<2>) = (cast(a), cast(b));
    Some(if cross(&a, &b) >= 0.0 { (a, b) } else { (b, a) })
}

/// The common part of two fans of less than a half turn, if it has an interior.
fn common(
    (a, b): (&Vector<2>, &Vector<2>),
    (c, d): (&Vector<2>, &Vector<2>),
) -> Option<(Vector<2>, Vector<2>)> {
    let holds = |v: &Vector<2>, from: &Vector<2>, to: &Vector<2>| {
        cross(from, v) >= -1e-12 && cross(v, to) >= -1e-12
    };
    let start = if holds(c, a, b) {
        c
    } else if holds(a, c, d) {
        a
    } else {
        return None;
    };
    let end = if holds(d, a, b) {
        d
    } else if holds(b, c, d) {
        b
    } else {
        return None;
    };
    (cross(start, end) > SAME).then_some((*start, *end))
}

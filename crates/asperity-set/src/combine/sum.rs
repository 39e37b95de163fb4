//! Minkowski sums.

use super::{SAME, some};
use crate::plane::{InPlane, cast, cross};
use crate::{Cone, Convex, ConvexSet, Matrix, SetError, StarSet, Vector, along, polar, project};

/// The sum `{x₁ + x₂ + … : xᵢ ∈ Cᵢ}` of convex sets, whose support function is the sum.
#[derive(Debug, Clone, PartialEq)]
pub struct MinkowskiSum<const P: usize> {
    sets: Vec<Convex<P>>,
    corners: Vec<Vector<P>>,
}

impl<const P: usize> MinkowskiSum<P> {
    /// The sum of some sets.
    ///
    /// # Errors
    ///
    /// [`SetError`] if there are no sets.
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

    fn project(&self, z: &Vector<P>) -> Vector<P> {
        match P {
            2 => cast(&project::by_normals(&InPlane { set: self }, &cast(z), None)),
            3 => project::onto_sum(self, z),
            _ => project::onto_any(self, z),
        }
    }

    fn normal_cone(&self, x: &Vector<P>, tolerance: f64) -> Option<Cone<P>> {
        Cone::beside_corner(self, x, tolerance)
    }
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
    let all: Vec<Vector<2>> = cone.generators().iter().map(cast).collect();
    let first = *all.iter().find(|a| all.iter().all(|g| cross(a, g) >= -1e-12))?;
    let last = *all.iter().find(|b| all.iter().all(|g| cross(g, b) >= -1e-12))?;
    (cross(&first, &last) > SAME).then_some((first, last))
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

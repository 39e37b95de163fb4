//! Intersections.

use super::edges;
use super::seams::seams;
use super::some;
use crate::numeric::polarity;
use crate::numeric::vectors::{aside, cast, cross};
use crate::{Cone, ConvexSet, Matrix, SetError, StarSet, Vector, project};

/// The intersection `C₁ ∩ C₂ ∩ …`, whose gauge is the largest one; convex if its members are.
#[derive(Debug, Clone, PartialEq)]
pub struct Intersection<S, const P: usize> {
    sets: Vec<S>,
    corners: Vec<Vector<P>>,
}

impl<const P: usize, S: StarSet<P>> Intersection<S, P> {
    /// The intersection of some sets.
    ///
    /// # Errors
    ///
    /// [`SetError`] if there are no sets.
    pub fn new(sets: Vec<S>) -> Result<Self, SetError> {
        some(&sets)?;
        let corners = seams(&sets, f64::max);
        Ok(Self { sets, corners })
    }

    /// The members.
    pub fn sets(&self) -> &[S] {
        &self.sets
    }

    fn holds(&self, x: &Vector<P>) -> bool {
        self.gauge(x) <= 1.0 + 4.0 * f64::EPSILON
    }

    /// The corner that is farthest along `y`, if `y` is a normal there.
    fn farthest_corner(&self, y: &Vector<P>) -> Option<Vector<P>> {
        let height = |x: &&Vector<P>| y.dot(x);
        let farthest = self.corners.iter().max_by(|a, b| height(a).total_cmp(&height(b)))?;
        is_normal_at(self, farthest, y).then_some(*farthest)
    }
}

impl<const P: usize, S: StarSet<P>> StarSet<P> for Intersection<S, P> {
    fn gauge(&self, x: &Vector<P>) -> f64 {
        self.sets.iter().map(|set| set.gauge(x)).fold(0.0, f64::max)
    }

    fn gauge_jet(&self, x: &Vector<P>) -> (f64, Vector<P>) {
        let jets = self.sets.iter().map(|set| set.gauge_jet(x));
        jets.reduce(|a, b| if b.0 > a.0 { b } else { a }).unwrap_or((0.0, Vector::zeros()))
    }

    fn corners(&self) -> Vec<Vector<P>> {
        self.corners.clone()
    }
}

impl<const P: usize, S: ConvexSet<P>> Intersection<S, P> {
    /// The projection onto a member that lies in all others: no point of the intersection is nearer.
    fn nearest_of_one(&self, z: &Vector<P>) -> Option<Vector<P>> {
        self.sets.iter().map(|set| set.project(z)).find(|x| self.holds(x))
    }
}

impl<const P: usize, S: ConvexSet<P>> ConvexSet<P> for Intersection<S, P> {
    /// A member's support point that lies in all others is the farthest; else the farthest point lies where
    /// boundaries cross.
    fn support_point(&self, y: &Vector<P>) -> Vector<P> {
        let own = self.sets.iter().map(|set| set.support_point(y)).find(|x| self.holds(x));
        let point = own.or_else(|| self.farthest_corner(y));
        point.unwrap_or_else(|| polarity::support_point(self, y))
    }

    /// The Hessian is that of the member whose support point it is, and zero at corners.
    fn support_jet(&self, y: &Vector<P>) -> (Vector<P>, Matrix<P>) {
        let own = self.sets.iter().map(|set| set.support_jet(y)).find(|jet| self.holds(&jet.0));
        let corner = || Some((self.farthest_corner(y)?, Matrix::zeros()));
        own.or_else(corner).unwrap_or_else(|| {
            (polarity::support_point(self, y), polarity::support_hessian(self, y))
        })
    }

    fn project(&self, z: &Vector<P>) -> Vector<P> {
        if self.gauge(z) <= 1.0 {
            return *z;
        }
        let distance = |x: &&Vector<P>| (z - *x).norm_squared();
        let nearest = self.corners.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        match nearest {
            Some(corner) if is_normal_at(self, corner, &(z - corner)) => *corner,
            _ if P == 3 => self.nearest_of_one(z).unwrap_or_else(|| {
                let near = project::by_cuts(self, z)
                    .or_else(|| alternately(&self.sets, z))
                    .unwrap_or_else(|| project::onto_any(self, z));
                edges::refined(&self.sets, z, near)
            }),
            _ => project::onto_any(self, z),
        }
    }

    /// Members whose normals do not carry `z − x` do not matter.
    fn project_jet(&self, z: &Vector<P>, start: &Vector<P>) -> (Vector<P>, Matrix<P>) {
        let x = self.project(z);
        if x == *z {
            return (x, Matrix::identity());
        }
        match edges::jacobian(&self.sets, z, &x) {
            Some(jacobian) => (x, jacobian),
            None => project::jet::by_differences(self, z, start),
        }
    }

    fn normal_cone(&self, x: &Vector<P>, tolerance: f64) -> Option<Cone<P>> {
        let cones: Option<Vec<Cone<P>>> =
            self.sets.iter().map(|set| set.normal_cone(x, tolerance)).collect();
        Some(Cone::new(cones?.iter().flat_map(|cone| cone.generators().to_vec())))
    }

    fn flat_normals(&self) -> Vec<Vector<P>> {
        self.sets.iter().flat_map(|set| set.flat_normals()).collect()
    }
}

/// Whether `y` is a normal of a planar set at one of its corners.
fn is_normal_at<const P: usize, S>(set: &S, corner: &Vector<P>, y: &Vector<P>) -> bool
where
    S: StarSet<P>,
{
    if P != 2 {
        return false;
    }
    let beside = |side| cast::<P, 2>(&set.gauge_jet(&aside(corner, side)).1);
    let (first, y, last) = (beside(-1.0), cast(y), beside(1.0));
    cross(&first, &y) >= 0.0 && cross(&y, &last) >= 0.0
}

/// Most members that are projected onto in turn, and most rounds.
const MEMBERS: usize = 8;
const SWEEPS: usize = 4000;

/// Projection onto an intersection by Dykstra's method: onto one member after another, each time with that
/// member's last correction put back first. The corrections `pᵢ` add up to `z − x`; `x` is the projection if
/// it lies in every member and `pᵢ ∈ N_i(x)`, that is `Σ h_i(pᵢ) = xᵀ(z − x)`. `None` if that takes too long.
fn alternately<const P: usize, S: ConvexSet<P>>(sets: &[S], z: &Vector<P>) -> Option<Vector<P>> {
    if sets.len() > MEMBERS {
        return None;
    }
    let mut corrections = [Vector::<P>::zeros(); MEMBERS];
    let mut x = *z;
    for _ in 0..SWEEPS {
        for (set, correction) in sets.iter().zip(&mut corrections) {
            let target = x + *correction;
            x = set.project(&target);
            *correction = target - x;
        }
        let gap: f64 =
            sets.iter().zip(&corrections).map(|(set, p)| set.support(p) - x.dot(p)).sum();
        let outside = sets.iter().map(|set| set.gauge(&x)).fold(0.0, f64::max) - 1.0;
        let rounding = 1e-14 * x.norm() + 4.0 * f64::EPSILON * z.norm();
        if outside <= 1e-13 && gap.abs() <= rounding * (z - x).norm() {
            return Some(x);
        }
    }
    None
}

//! Minkowski sums.

use super::{SAME, some};
use crate::numeric::polarity;
use crate::numeric::vectors::{along, cast, cross};
use crate::{Cone, Convex, ConvexSet, Matrix, SetError, StarSet, Vector, project};

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
        polarity::gauge_jet_with(self, x, |x, near| normal_by_members(&self.sets, x, near))
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
            2 => cast(&project::by_normals(&project::InPlane { set: self }, &cast(z), None)),
            3 => onto_sum(self, z),
            _ => project::onto_any(self, z),
        }
    }

    /// In space from the Jacobians of the projections onto the members: the differences of points that have not all of
    /// their digits have few.
    fn project_jet(&self, z: &Vector<P>, start: &Vector<P>) -> (Vector<P>, Matrix<P>) {
        if P == 3 {
            let x = self.project(z);
            let Some((n, _)) = project::jet::normal(self, z, &x) else {
                return (x, Matrix::identity());
            };
            if let Some((improved, jacobian)) = by_members(&self.sets, z, &x) {
                return (nearer(z, improved, x), project::jet::across(&n, |t| jacobian * t));
            }
        }
        project::jet::by_differences(self, z, start)
    }

    fn normal_cone(&self, x: &Vector<P>, tolerance: f64) -> Option<Cone<P>> {
        Cone::beside_corner(self, x, tolerance)
    }

    fn flat_normals(&self) -> Vec<Vector<P>> {
        self.sets.iter().flat_map(|set| set.flat_normals()).collect()
    }
}

/// Excess of the gauge up to which tangent planes are asked before support points. Without them 0, 2, 47, 187 and 325 of 600
/// points around the three sums of round and flat sets in `tests/space.rs`, at excesses of 1e-4, 1e-5 … 1e-8, are moved more than
/// a hundredth too far; with them none is, down to 1e-13.
const HARDLY_OUTSIDE: f64 = 1e-4;

/// Projection onto a sum of sets in space; what support points find is improved by the projections onto the members.
///
/// How far a point of theirs may lie from the nearest one scales with the size of the sum, not with the distance to it. Of
/// points that are hardly outside, tangent planes of the sum tell more.
fn onto_sum<const P: usize>(sum: &MinkowskiSum<P>, z: &Vector<P>) -> Vector<P> {
    let gauge = sum.gauge(z);
    if gauge <= 1.0 {
        return *z;
    }
    let on_ray = z / gauge;
    let is_near = gauge <= 1.0 + HARDLY_OUTSIDE;
    let by_planes = || is_near.then(|| project::by_cuts(sum, z)).flatten();
    let nearest = project::by_dual_newton(sum, z).or_else(by_planes).unwrap_or_else(|| {
        let near = project::by_support_points(sum, z);
        by_members(sum.sets(), z, &near).map_or(near, |(x, _)| x)
    });
    nearer(z, nearest, on_ray)
}

/// The one of two points that is nearer to `z`, the first of equals.
fn nearer<const P: usize>(z: &Vector<P>, first: Vector<P>, second: Vector<P>) -> Vector<P> {
    if (z - second).norm() < (z - first).norm() { second } else { first }
}

/// Most members, sweeps over them before Newton's method, and its iterations.
const MEMBERS: usize = 4;
const SWEEPS: usize = 8;
const ITERATIONS: usize = 20;
/// Largest change of the point that is an improvement, relative to the point.
const NEAR: f64 = 1e-5;

/// The members of a sum near points `aᵢ` of theirs that belong to one normal `y`: `daᵢ = MᵢJᵢ dy − Mᵢfᵢ` with the Jacobian
/// `Jᵢ` and the residual `fᵢ = aᵢ − prox(aᵢ + y)` of each, and `Mᵢ = (I − Jᵢ)⁻¹`.
struct Linearised<const P: usize> {
    count: usize,
    jacobians: [Matrix<P>; MEMBERS],
    /// `MᵢJᵢ` and `Mᵢfᵢ`, and their sums.
    parts: [(Matrix<P>, Vector<P>); MEMBERS],
    yields: Matrix<P>,
    moved: Vector<P>,
    /// The largest of the residuals.
    residual: f64,
}

impl<const P: usize> Linearised<P> {
    /// On flat faces `Mᵢ` is bounded by a `small` number on the diagonal, which costs no digits because the residuals vanish.
    fn new(
        sets: &[Convex<P>],
        points: &[Vector<P>; MEMBERS],
        y: &Vector<P>,
        small: f64,
    ) -> Option<Self> {
        let none = (Matrix::zeros(), Vector::zeros());
        let mut all = Self {
            count: sets.len(),
            jacobians: [Matrix::zeros(); MEMBERS],
            parts: [none; MEMBERS],
            yields: Matrix::zeros(),
            moved: Vector::zeros(),
            residual: 0.0,
        };
        for (i, (set, point)) in sets.iter().zip(points).enumerate() {
            let (onto, jacobian) = set.project_jet(&(point + y), point);
            let inverse = (Matrix::identity() * (1.0 + small) - jacobian).try_inverse()?;
            let residual = point - onto;
            let (yields, moved) = (inverse * jacobian, inverse * residual);
            (all.jacobians[i], all.parts[i]) = (jacobian, (yields, moved));
            all.yields += yields;
            all.moved += moved;
            all.residual = all.residual.max(residual.norm());
        }
        Some(all)
    }

    /// Moves the points with the normal.
    fn step(&self, points: &mut [Vector<P>; MEMBERS], dy: &Vector<P>) {
        for (point, (yields, moved)) in points.iter_mut().zip(&self.parts).take(self.count) {
            *point += yields * dy - moved;
        }
    }
}

/// Newton's method for one point `aᵢ` of each member, `aᵢ = prox(aᵢ + y)` with `y = z − Σ aⱼ` normal to all of them.
///
/// Where some members are flat and others round, neither the sum's support function nor hulls of its support points
/// tell more than half of the digits; the projections onto the members do. With [`Linearised`] members `dy = −Σ daᵢ`, so that
/// `(I + Σ MᵢJᵢ) dy = Σ Mᵢfᵢ`.
fn by_members<const P: usize>(
    sets: &[Convex<P>],
    z: &Vector<P>,
    near: &Vector<P>,
) -> Option<(Vector<P>, Matrix<P>)> {
    // The steps of a point along a flat direction are differences of numbers `1/SMALL` times as large, whose own rounding is
    // multiplied by `1/SMALL` again: below the root of the machine precision it grows from step to step where members are
    // flat. Where they are nearly so, steps are too short with the first number, and the smaller one finds the digits that
    // are left.
    const SMALL: [f64; 2] = [1e-7, 1e-11];
    const SETTLED: f64 = 1e-11;
    if sets.len() > MEMBERS {
        return None;
    }
    let mut points = [Vector::<P>::zeros(); MEMBERS];
    let away = z - near;
    for (point, set) in points.iter_mut().zip(sets) {
        *point = set.support_point(&away);
    }
    for _ in 0..SWEEPS {
        for (i, set) in sets.iter().enumerate() {
            let others = points.iter().sum::<Vector<P>>() - points[i];
            points[i] = set.project(&(z - others));
        }
    }
    let rounding = 4.0 * f64::EPSILON * z.norm();
    let mut best = (f64::INFINITY, points, [Matrix::<P>::zeros(); MEMBERS]);
    for small in SMALL {
        points = best.1;
        for _ in 0..ITERATIONS {
            let y = z - points.iter().sum::<Vector<P>>();
            let Some(members) = Linearised::new(sets, &points, &y, small) else { break };
            if members.residual < best.0 {
                best = (members.residual, points, members.jacobians);
            }
            let matrix = Matrix::identity() + members.yields;
            let (true, Some(inverse)) = (members.residual > rounding, matrix.try_inverse()) else {
                break;
            };
            members.step(&mut points, &(inverse * members.moved));
        }
        if best.0 <= rounding {
            break;
        }
    }
    // Where a flat direction of one member is round in another one, rounding may grow again on the way.
    let (largest, points, jacobians) = best;
    let sum: Vector<P> = points.iter().sum();
    let ends = largest <= SETTLED * z.norm() && (sum - near).norm() <= NEAR * near.norm();
    let jacobian = jacobian_of_sum(&jacobians[..sets.len()])?;
    ends.then_some((sum, jacobian))
}

/// The Jacobian of the projection onto a sum from those of the projections onto the members.
///
/// Where `z` moves `dy = dz − Σ daᵢ` and `daᵢ = Jᵢ (daᵢ + dy)`. With `K = I − J` for the sum and each of its members,
/// `dy = K dz` and `daᵢ = (Kᵢ⁻¹ − I) dy`, hence `K⁻¹ − I = Σ (Kᵢ⁻¹ − I)`, for two members `K = K₂ (K₁ + K₂ − K₁K₂)⁻¹ K₁`.
/// Along a flat that all members share every `Kᵢ` vanishes, and so does the product, whatever small number is added to what
/// is inverted.
fn jacobian_of_sum<const P: usize>(jacobians: &[Matrix<P>]) -> Option<Matrix<P>> {
    const NONE: f64 = 1e-14;
    let identity = Matrix::<P>::identity();
    let mut stays = jacobians.iter().map(|jacobian| identity - jacobian);
    let first = stays.next()?;
    let sum = stays.try_fold(first, |sum, member| {
        let between = sum + member - sum * member + identity * NONE;
        Some(member * between.try_inverse()? * sum)
    })?;
    Some(identity - sum)
}

/// Newton's method for the normal with `h = 1` at the point `sx` where the ray along `x` leaves the sum, from a normal near it.
///
/// As in [`by_members`], with one point `aᵢ = prox(aᵢ + y)` of each member, but with `Σ aᵢ = sx` for an unknown `s` and the
/// component of `y` along `x` given: `Σ MᵢJᵢ dy − x ds = sx − Σ aᵢ + Σ Mᵢfᵢ`, `x·dy = 0`.
fn normal_by_members<const P: usize>(
    sets: &[Convex<P>],
    x: &Vector<P>,
    near: &Vector<P>,
) -> Option<Vector<P>> {
    const SMALL: f64 = 1e-7;
    // Residual, and difference of the two bounds of the gauge, that count as none.
    const SETTLED: f64 = 1e-13;
    const EXACT: f64 = 8.0 * f64::EPSILON;
    // Where the curvature of a member vanishes, convergence is linear, and the ellipsoid method takes less time.
    const FEW_SWEEPS: usize = 2;
    const FEW_ITERATIONS: usize = 8;
    // Projections that take support points themselves take more of them than the ellipsoid method does.
    let is_dear = |set: &Convex<P>| {
        matches!(
            set,
            Convex::Custom(_) | Convex::Image(_) | Convex::Intersection(_) | Convex::Sum(_)
        )
    };
    if sets.len() > MEMBERS || sets.iter().any(is_dear) {
        return None;
    }
    let support = |y: &Vector<P>| sets.iter().map(|set| set.support(y)).sum::<f64>();
    let along_x = x.dot(near);
    // The comparison also turns away what is not a number.
    if !(along_x > 0.0) {
        return None;
    }
    let mut exit = support(near) / along_x;
    let mut y = near * (exit * x.norm_squared() / along_x);
    let mut points = [Vector::<P>::zeros(); MEMBERS];
    for (point, set) in points.iter_mut().zip(sets) {
        *point = set.support_point(near);
    }
    for _ in 0..FEW_SWEEPS {
        for (i, set) in sets.iter().enumerate() {
            let others = points.iter().sum::<Vector<P>>() - points[i];
            points[i] = set.project(&(x * exit - others));
        }
    }
    for _ in 0..FEW_ITERATIONS {
        let missing = x * exit - points.iter().sum::<Vector<P>>();
        let members = Linearised::new(sets, &points, &y, SMALL)?;
        let largest = members.residual.max(missing.norm());
        // The plane with normal y bounds the sum: the ray leaves it at s at the latest. What the points say is on the other side.
        let latest = support(&y) / x.dot(&y);
        if largest <= SETTLED * exit * x.norm() && (latest - exit).abs() <= EXACT * exit {
            return Some(y / support(&y));
        }
        let inverse = (members.yields + Matrix::identity() * SMALL).try_inverse()?;
        let (turn, push) = (inverse * (missing + members.moved), inverse * x);
        let ds = -x.dot(&turn) / x.dot(&push);
        let dy = turn + push * ds;
        exit += ds;
        y += dy;
        members.step(&mut points, &dy);
        if !(exit > 0.0 && exit < f64::MAX) {
            return None;
        }
    }
    None
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Ball, Cuboid};

    type W = Vector<3>;

    /// Of a box and a ball the ray leaves where the box is the radius of the ball away, most often through a rounded edge.
    #[test]
    fn rays_leave_a_rounded_box_where_newtons_method_finds_it() {
        let (half, radius) = (W::new(1.0, 0.7, 0.4), 0.5);
        let members: Vec<Convex<3>> =
            vec![Cuboid::symmetric(half).unwrap().into(), Ball::new(radius).unwrap().into()];
        let sum = MinkowskiSum::new(members).unwrap();
        let (mut rounded, mut found) = (0, 0);
        for x in crate::directions::<3>(2000) {
            let beyond = |s: f64| x.zip_map(&half, |x, a| ((s * x).abs() - a).max(0.0)).norm();
            let (mut low, mut high) = (0.0, 10.0);
            while high - low > f64::EPSILON * high {
                let middle = 0.5 * (low + high);
                if middle == low || middle == high {
                    break;
                }
                if beyond(middle) < radius { low = middle } else { high = middle }
            }
            let off = (sum.gauge(&x) * high - 1.0).abs();
            assert!(off <= 1e-14, "{off:e} along {x}");
            let out = |k: usize| (high * x[k]).abs() > half[k] * 1.01;
            if (0..3).filter(|&k| out(k)).count() > 1 {
                rounded += 1;
                let normal = normal_by_members(&sum.sets, &x, &x);
                found +=
                    usize::from(normal.is_some_and(|n| (n.dot(&x) * high - 1.0).abs() <= 1e-14));
            }
        }
        assert!(rounded > 800 && found * 10 > rounded * 9, "{found} of {rounded}");
    }
}

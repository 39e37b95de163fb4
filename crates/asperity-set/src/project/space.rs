//! Projections in three dimensions.

use crate::{ConvexSet, Matrix, Vector};

/// Projection in three dimensions by Newton's method on the dual problem
/// `max z·y − h(y) − ½‖y‖²`, whose solution is `y = z − prox(z)`. Made for strictly convex sets.
///
/// Else by support points.
pub(super) fn onto_any_in_space<const P: usize, S: ConvexSet<P> + ?Sized>(
    set: &S,
    z: &Vector<P>,
) -> Vector<P> {
    by_dual_newton(set, z).unwrap_or_else(|| by_support_points(set, z))
}

/// Newton's method on the dual; `None` where it does not end in the projection.
pub(crate) fn by_dual_newton<const P: usize, S: ConvexSet<P> + ?Sized>(
    set: &S,
    z: &Vector<P>,
) -> Option<Vector<P>> {
    let value = |y: &Vector<P>| z.dot(y) - set.support(y) - 0.5 * y.norm_squared();
    let mut y = z * (1.0 - 1.0 / set.gauge(z));
    for _ in 0..200 {
        let (point, hessian) = set.support_jet(&y);
        let residual = z - point - y;
        if residual.norm() <= 4.0 * f64::EPSILON * z.norm() {
            break;
        }
        let newton = (hessian + Matrix::identity()).try_inverse().map(|inverse| inverse * residual);
        let step = newton.filter(|s| s.iter().all(|v| v.is_finite())).unwrap_or(residual);
        let (before, gain) = (value(&y), 1e-4 * residual.dot(&step));
        // Near the solution what is gained is lost in the rounding of the value, half the digits too early: there
        // the residual tells.
        let closer = |y: &Vector<P>| (z - set.support_point(y) - y).norm() < 0.5 * residual.norm();
        let mut length = 1.0;
        while value(&(y + step * length)) < before + gain * length && length > 1e-10 {
            if length == 1.0 && closer(&(y + step)) {
                break;
            }
            length *= 0.5;
        }
        if length <= 1e-10 {
            break;
        }
        y += step * length;
    }
    // z − y loses digits for points far away, the support point for flat boundaries nearby.
    let x = if y.norm() > z.norm() * 0.5 { set.support_point(&y) } else { z - y };
    let normal = z - x;
    let gap = set.support(&normal) - x.dot(&normal);
    let fits = gap.abs() <= 1e-12 * x.norm() * normal.norm() && set.gauge(&x) <= 1.0 + 1e-12;
    fits.then_some(x)
}

/// Most planes that are tried before another method has to do.
const CUTS: usize = 200;
/// Excess of the gauge that is rounding.
const ROUNDING: f64 = 1e-14;

/// Projection onto the half-spaces below tangent planes of the set, one more plane as long as the point is outside:
/// the dual active-set method of \[GoldfarbIdnani1983\], which keeps at most `P` planes. A point of the set that is
/// nearest in half-spaces around the set is nearest in the set. Edges and corners of polytopes are found after as
/// many planes as they have faces; on round boundaries the planes close in. `None` if that takes too long.
pub(crate) fn by_cuts<const P: usize, S: ConvexSet<P> + ?Sized>(
    set: &S,
    z: &Vector<P>,
) -> Option<Vector<P>> {
    let mut planes = Planes::<P>::new();
    let mut x = *z;
    for _ in 0..CUTS {
        let (gauge, gradient) = set.gauge_jet(&x);
        let size = gradient.norm();
        // Digits of a point far away are lost on the way to the set.
        if gauge <= 1.0 + ROUNDING + 4.0 * f64::EPSILON * size * z.norm() {
            return Some(x / gauge.max(1.0));
        }
        planes.add(gradient / size, 1.0 / size, &x)?;
        x = planes.nearest(z);
    }
    None
}

/// Planes `nᵀx = c` that hold the point nearest to `z`, with their multipliers in `z − x = Σ uᵢnᵢ`.
struct Planes<const P: usize> {
    count: usize,
    normals: [Vector<P>; P],
    offsets: [f64; P],
    multipliers: [f64; P],
    /// Orthonormal vectors that span the normals, and the normals' components along them.
    basis: [Vector<P>; P],
    components: Matrix<P>,
}

impl<const P: usize> Planes<P> {
    fn new() -> Self {
        Self {
            count: 0,
            normals: [Vector::zeros(); P],
            offsets: [0.0; P],
            multipliers: [0.0; P],
            basis: [Vector::zeros(); P],
            components: Matrix::zeros(),
        }
    }

    /// Adds the half-space `nᵀx ≤ c`, which `x` violates, and drops those that hold the point no more.
    fn add(&mut self, n: Vector<P>, c: f64, x: &Vector<P>) -> Option<()> {
        let mut violation = n.dot(x) - c;
        let mut multiplier = 0.0;
        loop {
            let (shares, away) = self.split(&n);
            let slope = away.norm_squared();
            // Along `away` the plane is reached; a multiplier that vanishes before that frees its plane.
            let reach = if self.count < P && slope > f64::EPSILON.powi(2) {
                violation / slope
            } else {
                f64::INFINITY
            };
            let (mut step, mut freed) = (reach, None);
            for (i, (held, share)) in self.multipliers.iter().zip(shares).enumerate() {
                if share > 0.0 && *held < step * share {
                    (step, freed) = (held / share, Some(i));
                }
            }
            // Half-spaces around one set have points in common; rounding may say otherwise.
            if !step.is_finite() {
                return None;
            }
            // Places that are not in use have no share.
            for (held, share) in self.multipliers.iter_mut().zip(shares) {
                *held -= step * share;
            }
            multiplier += step;
            if self.count < P {
                violation -= step * slope;
            }
            match freed {
                Some(i) => self.drop(i),
                None => {
                    self.normals[self.count] = n;
                    self.offsets[self.count] = c;
                    self.multipliers[self.count] = multiplier;
                    self.count += 1;
                    self.factorise();
                    return Some(());
                }
            }
        }
    }

    fn drop(&mut self, which: usize) {
        self.normals[which..self.count].rotate_left(1);
        self.offsets[which..self.count].rotate_left(1);
        self.multipliers[which..self.count].rotate_left(1);
        self.count -= 1;
        self.factorise();
    }

    /// Gram and Schmidt, twice.
    fn factorise(&mut self) {
        self.components = Matrix::zeros();
        for j in 0..self.count {
            let mut rest = self.normals[j];
            for _ in 0..2 {
                for i in 0..j {
                    let part = self.basis[i].dot(&rest);
                    rest -= self.basis[i] * part;
                    self.components[(i, j)] += part;
                }
            }
            let length = rest.norm();
            self.components[(j, j)] = length;
            self.basis[j] = rest / length;
        }
    }

    /// Shares of the normals in `n`, and what is orthogonal to them.
    fn split(&self, n: &Vector<P>) -> ([f64; P], Vector<P>) {
        let mut rest = *n;
        let mut along = [0.0; P];
        for _ in 0..2 {
            for (basis, along) in self.basis.iter().zip(&mut along).take(self.count) {
                let part = basis.dot(&rest);
                rest -= basis * part;
                *along += part;
            }
        }
        for i in (0..self.count).rev() {
            let later: f64 = (i + 1..self.count).map(|j| self.components[(i, j)] * along[j]).sum();
            along[i] = (along[i] - later) / self.components[(i, i)];
        }
        (along, rest)
    }

    /// The point of all planes that is nearest to `z`.
    fn nearest(&self, z: &Vector<P>) -> Vector<P> {
        let mut along = [0.0; P];
        for j in 0..self.count {
            let earlier: f64 = (0..j).map(|i| self.components[(i, j)] * along[i]).sum();
            along[j] = (self.offsets[j] - earlier) / self.components[(j, j)];
        }
        let mut x = *z;
        for (basis, along) in self.basis.iter().zip(&along).take(self.count) {
            x += basis * (along - basis.dot(&x));
        }
        x
    }
}

/// Most support points that are asked for.
const SUPPORT_POINTS: usize = 1000;

/// The same for sets with edges and flat faces, where the dual has no Hessian: the point nearest to `z` in the hull of
/// support points, of which those that carry it are kept, at most `P`, and one more along `z − x` is added
/// \[GilbertJohnsonKeerthi1988\].
///
/// Every point on the way is in the set, and `h(z − x) − x·(z − x)`, which the support point gives for nothing, bounds
/// how far it is from the nearest one. Polytopes take as many points as they have corners around it and are exact to
/// rounding; on curved boundaries it is the distance that is, and the point has half the digits.
pub(crate) fn by_support_points<const P: usize, S: ConvexSet<P> + ?Sized>(
    set: &S,
    z: &Vector<P>,
) -> Vector<P> {
    let mut simplex = Simplex { points: [set.support_point(z); 4], count: 1 };
    let mut x = simplex.points[0];
    for _ in 0..SUPPORT_POINTS {
        let normal = z - x;
        let distance = normal.norm();
        let point = set.support_point(&normal);
        let size = x.norm() + z.norm();
        // The comparison also ends at what is not a number.
        if !(normal.dot(&(point - x)) > f64::EPSILON * size * distance) {
            break;
        }
        let nearest = simplex.nearest_with(point, z);
        if !((z - nearest).norm() < distance) {
            break;
        }
        x = nearest;
    }
    x
}

/// Up to four points, the first `count` of them in use.
struct Simplex<const P: usize> {
    points: [Vector<P>; 4],
    count: usize,
}

impl<const P: usize> Simplex<P> {
    /// The point of the hull with one more point that is nearest to `z`, which is not in the hull; keeps
    /// the points that carry it.
    fn nearest_with(&mut self, point: Vector<P>, z: &Vector<P>) -> Vector<P> {
        self.points[self.count] = point;
        let count = self.count + 1;
        let mut best = (f64::INFINITY, point, 1_usize << self.count);
        for members in 1_usize..1 << count {
            // The nearest point lies on a face, which as many points as there are dimensions carry.
            if members.count_ones() as usize > P.min(3) {
                continue;
            }
            if let Some(x) = self.nearest_in_span(members, z) {
                let distance = (z - x).norm_squared();
                if distance < best.0 {
                    best = (distance, x, members);
                }
            }
        }
        self.count = 0;
        for i in (0..count).filter(|i| best.2 >> i & 1 == 1) {
            self.points[self.count] = self.points[i];
            self.count += 1;
        }
        best.1
    }

    /// The point nearest to `z` on the line or plane through some of the points, if it is between them.
    fn nearest_in_span(&self, members: usize, z: &Vector<P>) -> Option<Vector<P>> {
        let mut chosen = (0..4).filter(|i| members >> i & 1 == 1).map(|i| &self.points[i]);
        let first = chosen.next()?;
        let Some(second) = chosen.next().map(|point| point - first) else { return Some(*first) };
        let away = z - first;
        let Some(third) = chosen.next().map(|point| point - first) else {
            let weight = second.dot(&away) / second.norm_squared();
            return (0.0..=1.0).contains(&weight).then(|| first + second * weight);
        };
        // Orthogonal to the second edge, so that little is lost where the triangle is slender.
        let turned = third - second * (second.dot(&third) / second.norm_squared());
        let last = turned.dot(&away) / turned.norm_squared();
        let middle = second.dot(&(away - third * last)) / second.norm_squared();
        let between = last >= 0.0 && middle >= 0.0 && last + middle <= 1.0;
        between.then(|| first + second * middle + third * last)
    }
}

/// Projection onto an image `{A u : u ∈ S}` outside of which `z` is, with its Jacobian: Newton's method for
/// `u = prox_S(u − ρ Aᵀ(A u − z))` from a point near it, with `ρ = 1/‖AᵀA‖`. With the Jacobian `J` of the projection onto
/// `S` the point moves by `du = J ((I − ρ AᵀA) du + ρ Aᵀ dz)`.
///
/// Where `S` is nearly a polytope neither its support function nor hulls of its support points tell more than half of the
/// digits; the projection onto it does. `None` where the method does not end nearby.
pub(crate) fn onto_image<const P: usize, S: ConvexSet<P> + ?Sized>(
    set: &S,
    map: &Matrix<P>,
    z: &Vector<P>,
    near: Vector<P>,
) -> Option<(Vector<P>, Matrix<P>)> {
    const ITERATIONS: usize = 20;
    const SETTLED: f64 = 1e-12;
    const NEAR: f64 = 1e-4;
    let rate = 1.0 / map.tr_mul(map).norm();
    let held = Matrix::identity() - map.tr_mul(map) * rate;
    let mut best = (f64::INFINITY, near, Matrix::zeros());
    let mut u = near;
    for _ in 0..ITERATIONS {
        let (onto, jacobian) = set.project_jet(&(u - map.tr_mul(&(map * u - z)) * rate), &u);
        let residual = onto - u;
        let inverse = (Matrix::identity() - jacobian * held).try_inverse()?;
        if residual.norm() < best.0 {
            best = (residual.norm(), onto, inverse * jacobian);
        }
        if residual.norm() <= 2.0 * f64::EPSILON * u.norm() {
            break;
        }
        u += inverse * residual;
    }
    let (residual, u, follows) = best;
    let ends = residual <= SETTLED * u.norm() && (u - near).norm() <= NEAR * near.norm();
    ends.then(|| (map * u, map * follows * map.transpose() * rate))
}

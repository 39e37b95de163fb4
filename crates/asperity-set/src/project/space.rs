//! Projections in three dimensions.

use crate::{ConvexSet, Matrix, Vector, polar};

/// Projection in three dimensions by Newton's method on the dual problem
/// `max z·y − h(y) − ½‖y‖²`, whose solution is `y = z − prox(z)`. Made for strictly convex sets.
pub(super) fn by_dual_newton<const P: usize, S: ConvexSet<P> + ?Sized>(
    set: &S,
    z: &Vector<P>,
) -> Vector<P> {
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
        let mut length = 1.0;
        while value(&(y + step * length)) < before + gain * length && length > 1e-10 {
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
    if fits { x } else { by_dual_ellipsoids(set, z) }
}

/// The same for sets with edges and flat faces, where the dual has no Hessian, from subgradients alone.
fn by_dual_ellipsoids<const P: usize, S: ConvexSet<P> + ?Sized>(
    set: &S,
    z: &Vector<P>,
) -> Vector<P> {
    let descent = |y: &Vector<P>| if y.amax() > 0.0 { set.support_point(y) + y - z } else { -z };
    // The origin is in the set, so that the solution is no longer than z.
    let y = polar::by_ellipsoids(&(z * 0.5), 0.5 * z.norm(), &descent);
    let x = z - y;
    x / set.gauge(&x).max(1.0)
}

/// Projection onto an image `{A u : u ∈ S}` in the preimage: `min ‖A u − z‖` over `u ∈ S` by Nesterov's
/// accelerated gradient with restarts; the number of steps grows with the condition of `A`.
pub(crate) fn onto_image<const P: usize, S: ConvexSet<P> + ?Sized>(
    set: &S,
    map: &Matrix<P>,
    inverse: &Matrix<P>,
    z: &Vector<P>,
) -> Vector<P> {
    let gauge = set.gauge(&(inverse * z));
    if gauge <= 1.0 {
        return *z;
    }
    let rate = 1.0 / (map.transpose() * map).norm();
    let advance = |u: &Vector<P>| set.project(&(u - map.tr_mul(&(map * u - z)) * rate));
    let mut u = inverse * z / gauge;
    let (mut ahead, mut momentum) = (u, 1.0_f64);
    for _ in 0..100_000 {
        let next = advance(&ahead);
        let change = next - u;
        if change.amax() <= 0.5 * f64::EPSILON * u.amax() {
            break;
        }
        let next_momentum = 0.5 * (1.0 + (1.0 + 4.0 * momentum * momentum).sqrt());
        let backwards = (ahead - next).dot(&change) > 0.0;
        let weight = if backwards { 0.0 } else { (momentum - 1.0) / next_momentum };
        momentum = if backwards { 1.0 } else { next_momentum };
        ahead = next + change * weight;
        u = next;
    }
    map * u
}

//! Projections without a closed form.

use crate::boundary::{Arc, BoundaryPoint};
use crate::plane::{InPlane, cast, quarter_turn};
use crate::{ConvexSet, Matrix, StarSet, Superellipsoid, Vector, polar};

/// Projection onto any convex set from its support points and gauge.
pub(crate) fn by_bracket<const P: usize, S: ConvexSet<P> + ?Sized>(
    set: &S,
    z: &Vector<P>,
) -> Vector<P> {
    if set.gauge(z) <= 1.0 {
        return *z;
    }
    match P {
        1 => set.support_point(z),
        2 => cast(&onto_planar(&InPlane { set }, &cast(z))),
        _ => by_dual_newton(set, z),
    }
}

/// Projection of a point outside onto a planar set.
///
/// The height `g = n·z − h(n)` of `z` above the tangent line is quasi-concave where it is positive and
/// is largest at the projection; its slope along the boundary is `n⊥·(z − x)`. The walk starts below
/// `z` as seen from the origin, where `g > 0`.
fn onto_planar<S: ConvexSet<2> + ?Sized>(set: &S, z: &Vector<2>) -> Vector<2> {
    let slope = |p: &BoundaryPoint| quarter_turn(&p.normal).dot(&(z - p.position));
    let start = BoundaryPoint::at_position(set, z);
    let sign = slope(&start).signum();
    if slope(&start) == 0.0 {
        return start.position;
    }
    // Past the crest, g may turn negative and its slope positive again: that still counts as past.
    let signed_slope = |p: &BoundaryPoint| {
        let above = p.normal.dot(&(z - p.position)) > 0.0;
        if above { slope(p) } else { -sign * slope(p).abs() }
    };
    let turned = |v: &Vector<2>| quarter_turn(v) * sign;
    let mut arc = Arc { start, end: start };
    // An eighth of a turn of the normal at a time, a quarter of the position at the most.
    for _ in 0..8 {
        arc.start = arc.end;
        let normal = arc.start.normal + turned(&arc.start.normal);
        arc.end = BoundaryPoint::at_normal(set, &normal);
        let ahead = turned(&arc.start.position);
        if arc.start.position.dot(&arc.end.position) < 0.0 {
            arc.end = BoundaryPoint::at_position(set, &ahead);
        }
        if signed_slope(&arc.end) * sign <= 0.0 {
            break;
        }
    }
    let tolerance = f64::EPSILON * f64::EPSILON * z.norm();
    arc.root(set, tolerance, signed_slope).position
}

/// Projection in three dimensions by Newton's method on the dual problem
/// `max z·y − h(y) − ½‖y‖²`, whose solution is `y = z − prox(z)`. Made for strictly convex sets.
fn by_dual_newton<const P: usize, S: ConvexSet<P> + ?Sized>(set: &S, z: &Vector<P>) -> Vector<P> {
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
    if gap <= 1e-12 * x.norm() * normal.norm() { x } else { by_dual_ellipsoids(set, z) }
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

/// Projection onto a superellipsoid with exponent `s ≥ 1`, for any distance and axis ratio.
///
/// In the positive orthant with `ξᵢ = xᵢ/aᵢ`, (13) of \[WL19\] reads `ξᵢ + (β/aᵢ²) ξᵢ^(s−1) = zᵢ/aᵢ`;
/// given β every `ξᵢ` is the root of a monotone function, and `Σξᵢ^s` decreases with β. The outer
/// equation `log Σξᵢ^s = 0` is solved in `log β` by Newton's method inside a bracket.
pub(crate) fn onto_superellipsoid<const P: usize>(
    semi_axes: &Vector<P>,
    exponent: f64,
    z: &Vector<P>,
) -> Vector<P> {
    let scaled = z.abs().component_div(semi_axes);
    let excess = lp_norm(&scaled, exponent) - 1.0;
    if excess <= 0.0 {
        return *z;
    }
    let back = |xi: Vector<P>| Vector::from_fn(|i, _| xi[i] * semi_axes[i] * z[i].signum());
    if exponent == 1.0 {
        return back(onto_rhombus(semi_axes, &scaled));
    }
    let coordinate =
        |beta: f64, i: usize| power_balance(scaled[i], beta / semi_axes[i].powi(2), exponent - 1.0);
    let squares = semi_axes.component_mul(semi_axes);
    // Convexity of the gauge bounds β from both sides by k(z) − 1.
    let (mut low, mut high) =
        ((0.5 * excess * squares.min() / P as f64).ln(), (2.0 * excess * squares.sum()).ln());
    let mut log_beta = 0.5 * (low + high);
    let mut xi = scaled;
    for _ in 0..200 {
        let beta = log_beta.exp();
        xi = Vector::from_fn(|i, _| coordinate(beta, i));
        let powers = xi.map(|x| x.powf(exponent));
        let sum = powers.sum();
        let value = sum.ln();
        if value > 0.0 {
            low = log_beta
        } else {
            high = log_beta
        }
        let slope: f64 = (0..P)
            .map(|i| {
                let pull = beta / squares[i] * xi[i].powf(exponent - 1.0);
                let share = pull / (xi[i] + (exponent - 1.0) * pull);
                if xi[i] > 0.0 { -exponent * powers[i] * share / sum } else { 0.0 }
            })
            .sum();
        let newton = log_beta - value / slope;
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if (next - log_beta).abs() <= f64::EPSILON * log_beta.abs().max(1.0) || low >= high {
            break;
        }
        log_beta = next;
    }
    let norm = lp_norm(&xi, exponent);
    back(xi / norm)
}

fn lp_norm<const P: usize>(w: &Vector<P>, exponent: f64) -> f64 {
    let largest = w.amax();
    largest * w.map(|wi| (wi / largest).powf(exponent)).sum().powf(1.0 / exponent)
}

/// The root `ξ ≥ 0` of `ξ + cξ^p = ζ`.
fn power_balance(zeta: f64, c: f64, p: f64) -> f64 {
    if zeta == 0.0 {
        return 0.0;
    }
    if p < 1.0 {
        // In η = ξ^p the same equation has the exponent 1/p > 1 and is convex.
        return power_balance(zeta / c, 1.0 / c, 1.0 / p).powf(1.0 / p);
    }
    // Convex and increasing: Newton's method from above the root decreases to it.
    let mut xi = zeta.min((zeta / c).powf(1.0 / p));
    for _ in 0..200 {
        let pull = c * xi.powf(p);
        let next = xi - (xi + pull - zeta) / (1.0 + p * pull / xi);
        if !(next < xi * (1.0 - 0.5 * f64::EPSILON)) {
            break;
        }
        xi = next.max(0.0);
    }
    xi
}

/// Projection onto the rhombus `Σ|ξᵢ| ≤ 1` in the metric of the semi-axes: soft thresholding with the
/// threshold that the active coordinates share.
fn onto_rhombus<const P: usize>(semi_axes: &Vector<P>, scaled: &Vector<P>) -> Vector<P> {
    let weights = semi_axes.map(|a| 1.0 / (a * a));
    let mut active = [true; P];
    loop {
        let over = |f: &dyn Fn(usize) -> f64| (0..P).filter(|&i| active[i]).map(f).sum::<f64>();
        let beta = (over(&|i| scaled[i]) - 1.0) / over(&|i| weights[i]);
        let mut xi =
            Vector::<P>::from_fn(
                |i, _| if active[i] { scaled[i] - beta * weights[i] } else { 0.0 },
            );
        if xi.min() >= 0.0 {
            // The coordinate with the largest weight has cancelled most: it follows from the others.
            let last = weights.imax();
            xi[last] = if active[last] { f64::max(0.0, 1.0 - (xi.sum() - xi[last])) } else { 0.0 };
            return xi / xi.sum();
        }
        for i in 0..P {
            active[i] &= xi[i] > 0.0;
        }
    }
}

/// Projection onto a smooth superellipsoid by Newton's method for `x + β∇k(x) = z`, `k(x) = 1`, from a
/// point close by; `None` if that does not converge at once.
pub(crate) fn by_newton<const P: usize>(
    set: &Superellipsoid<P>,
    z: &Vector<P>,
    start: &Vector<P>,
) -> Option<Vector<P>> {
    if set.gauge(z) <= 1.0 {
        return Some(*z);
    }
    let curvature = set.exponent() - 1.0;
    let tolerance = 8.0 * f64::EPSILON * z.norm();
    let mut x = *start;
    for _ in 0..6 {
        let (gauge, gradient) = set.gauge_jet(&x);
        x /= gauge;
        let beta = gradient.dot(&(z - x)) / gradient.norm_squared();
        let residual = z - x - gradient * beta;
        // The comparison also turns away NaN, which a start at the origin would bring.
        if !(beta >= 0.0) {
            return None;
        }
        if residual.norm() <= tolerance {
            return Some(x);
        }
        let mut metric = gradient * gradient.transpose() * -curvature;
        for i in 0..P {
            // ∂²k/∂xᵢ² + (s−1)(∂k/∂xᵢ)² = (s−1) (∂k/∂xᵢ)/xᵢ on the boundary.
            metric[(i, i)] += if x[i] == 0.0 { 0.0 } else { curvature * gradient[i] / x[i] };
        }
        let inverse = (Matrix::identity() + metric * beta).try_inverse()?;
        let (along, across) = (inverse * gradient, inverse * residual);
        x += across - along * (gradient.dot(&across) / gradient.dot(&along));
    }
    None
}

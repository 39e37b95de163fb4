//! Projection onto superellipsoids.

use crate::numeric::vectors::cast;
use crate::{Matrix, StarSet, Vector};

/// Projection onto a superellipsoid with exponent `s ≥ 1`, for any distance and axis ratio.
///
/// In the positive orthant with `ξᵢ = xᵢ/aᵢ`, (13) of \[WL19\] reads `ξᵢ + (β/aᵢ²) ξᵢ^(s−1) = zᵢ/aᵢ`;
/// given β every `ξᵢ` is the root of a monotone function, and `Σξᵢ^s` decreases with β. The outer
/// equation `log Σξᵢ^s = 0` is solved in `log β` by Newton's method inside a bracket.
pub(super) fn onto_superellipsoid<const P: usize>(
    semi_axes: &Vector<P>,
    exponent: f64,
    z: &Vector<P>,
) -> Vector<P> {
    if P == 2 && exponent > 1.0 {
        return cast(&onto_superellipse(&cast(semi_axes), exponent, &cast(z)));
    }
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
    // The value is known to this at best: the relative rounding of ξ counts `exponent` times in its power.
    let noise = 2.0 * f64::EPSILON * (1.0 + exponent);
    for _ in 0..200 {
        let beta = log_beta.exp();
        xi = Vector::from_fn(|i, _| coordinate(beta, i));
        let powers = xi.map(|x| x.powf(exponent));
        let sum = powers.sum();
        let value = sum.ln();
        if value.abs() <= noise {
            break;
        }
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
    if largest == 0.0 {
        return 0.0;
    }
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
///
/// `ξᵢ = ζᵢ − βwᵢ` with `wᵢ = 1/aᵢ²` and `Σξᵢ = 1` is `wᵢ (1 + Σⱼ wⱼ (rᵢ − rⱼ))/Σⱼ wⱼ`, `rᵢ = aᵢ²ζᵢ`: of a point far
/// away only the differences count.
fn onto_rhombus<const P: usize>(semi_axes: &Vector<P>, scaled: &Vector<P>) -> Vector<P> {
    let weights = semi_axes.map(|a| 1.0 / (a * a));
    let heights = scaled.component_div(&weights);
    let mut active = [true; P];
    loop {
        let over = |f: &dyn Fn(usize) -> f64| (0..P).filter(|&i| active[i]).map(f).sum::<f64>();
        let total = over(&|i| weights[i]);
        let ahead = |i: usize| 1.0 + over(&|j| weights[j] * (heights[i] - heights[j]));
        let share = |i: usize| weights[i] / total * ahead(i);
        let mut xi = Vector::<P>::from_fn(|i, _| if active[i] { share(i) } else { 0.0 });
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
pub(super) fn by_newton<const P: usize, S: StarSet<P>>(
    set: &S,
    exponent: f64,
    z: &Vector<P>,
    start: &Vector<P>,
) -> Option<Vector<P>> {
    if set.gauge(z) <= 1.0 {
        return Some(*z);
    }
    let curvature = exponent - 1.0;
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

/// The same in the plane, in one unknown.
///
/// With `ξ^s = 1/(1 + e^w)` and `η = ξ e^(w/s)` the boundary needs no further equation. (13) of \[WL19\] then says
/// `η + R = v` with `R = (u − ξ)(a/b)² (η/ξ)^(s−1)`, where `(u, v) = (z₁/a, z₂/b)`. Both terms are nearly
/// exponential in `w`, so that `ln(η + R) = ln v` is nearly linear, and Newton's method starts at the point below
/// `z` as seen from the origin. The coordinate with the larger share there is called ξ.
fn onto_superellipse(semi_axes: &Vector<2>, s: f64, z: &Vector<2>) -> Vector<2> {
    let scaled = z.abs().component_div(semi_axes);
    if lp_norm(&scaled, s) <= 1.0 {
        return *z;
    }
    let swap = scaled.y > scaled.x;
    let (i, j) = if swap { (1, 0) } else { (0, 1) };
    let (u, v) = (scaled[i], scaled[j]);
    let (xi, eta) = if v > 0.0 {
        balance(u, v, (semi_axes[i] / semi_axes[j]).powi(2), s)
    } else {
        // On an axis of symmetry the nearest point is the tip.
        (1.0, 0.0)
    };
    let point = if swap { Vector::<2>::new(eta, xi) } else { Vector::<2>::new(xi, eta) };
    Vector::<2>::from_fn(|k, _| (point[k] * semi_axes[k]).copysign(z[k]))
}

/// `(ξ, η)` at the root of `ln(η + R) = ln v`.
#[inline]
fn balance(u: f64, v: f64, squares: f64, s: f64) -> (f64, f64) {
    let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
    let mut w = s * (v / u).ln();
    let (mut xi, mut eta) = (1.0, 0.0);
    for _ in 0..100 {
        let share;
        (xi, eta, share) = on_superellipse(w, s);
        let left = u - xi;
        let rest = left * squares * (w * (1.0 - 1.0 / s)).exp();
        let sum = eta + rest;
        let value = (sum / v).ln();
        // Where ξ > u there is no such point: the root lies ahead.
        if value > 0.0 {
            high = w
        } else {
            low = w
        }
        let noise = f64::EPSILON * (2.0 + w.abs() / s + u / left * (rest / sum));
        if value.abs() <= noise || high - low <= f64::EPSILON * w.abs() {
            break;
        }
        // dη/dw = η (1 − η^s)/s, dξ/dw = −ξ η^s/s.
        let slope = (eta * (1.0 - share) + rest * (s - 1.0 + xi * share / left)) / (s * sum);
        let newton = w - value / slope;
        w = if newton > low && newton < high && left > 0.0 {
            newton
        } else if low.is_infinite() {
            w - 1.0 - w.abs()
        } else if high.is_infinite() {
            w + 1.0 + w.abs()
        } else {
            0.5 * (low + high)
        };
    }
    (xi, eta)
}

/// `(ξ, η, η^s)` with `ξ^s = 1/(1 + e^w)`, `η^s = 1/(1 + e^−w)`.
#[inline]
fn on_superellipse(w: f64, s: f64) -> (f64, f64, f64) {
    let small = (-w.abs()).exp();
    let large = (-small.ln_1p() / s).exp();
    let other = large * (-w.abs() / s).exp();
    if w <= 0.0 {
        (large, other, small / (1.0 + small))
    } else {
        (other, large, 1.0 / (1.0 + small))
    }
}

//! Newton's method for a slip.

use asperity_set::{Convex, ConvexSet, Star, StarSet};

use super::super::single::SOLUTION;
use super::super::solution::LocalSolution;
use super::equation::{Slip, V, cross};

/// Whether the curvature of a reservoir is known to have a bound. The first step from the last slip then ends most solves.
#[inline]
fn has_bounded_curvature(reservoir: &Star<2>) -> bool {
    fn is_round(set: &Convex<2>) -> bool {
        match set {
            Convex::Ball(_) | Convex::Ellipsoid(_) => true,
            Convex::Superellipsoid(set) => set.exponent() >= 2.0,
            Convex::Image(image) => is_round(image.preimage()),
            _ => false,
        }
    }
    reservoir.as_convex().is_some_and(is_round)
}

/// A root of `F` that Newton's method finds from a slip velocity, or from the normal below the load of stick, a good start
/// where the last direction is far off.
#[inline(always)]
pub(super) fn newton(slip: &Slip<'_, '_>, guess: &V) -> Option<LocalSolution<2>> {
    let below = || slip.local.law.direction().normal(&slip.local.stick().load());
    newton_from(slip, guess).or_else(
        #[cold]
        || newton_from(slip, &below()),
    )
}

/// Newton's method for `F = 0` in the angle of the normal.
///
/// `dF/dφ = −n·v − n × (A x')`, `x' = (z' − x (∇k_C·z'))/k_C`, `z' = ∇²h_D n⊥`, where `n` may have any length: it is a
/// factor of `F` and `dF/dφ` alike.
#[inline(always)]
fn newton_from(slip: &Slip<'_, '_>, guess: &V) -> Option<LocalSolution<2>> {
    let law = slip.local.law;
    if let Some(mu) = law.isotropic_coefficient() {
        return newton_on_circle(slip, guess.try_normalize(0.0)?, mu);
    }
    let (mut n, mut before) = (*guess, f64::NAN);
    let round = has_bounded_curvature(law.reservoir());
    for _ in 0..10 {
        let turn = V::new(-n.y, n.x);
        let (z, dz) = law.direction().support_derivative(&n, &turn);
        let (gauge, gradient) = law.reservoir().gauge_jet(&z);
        let reciprocal = 1.0 / gauge;
        let x = z * reciprocal;
        let v = slip.velocity(&x);
        let value = cross(&n, &v);
        if value.abs() <= slip.rounding * n.norm() {
            return slip.admit_root(&n, &x, &v);
        }
        let dx = (dz - x * gradient.dot(&dz)) * reciprocal;
        let dv = slip.a * dx;
        let step = value / (n.dot(&v) + cross(&n, &dv));
        // Where Newton's method converges quadratically, what is left after a step below 1e-8 is rounding, unless the
        // boundary is nearly flat here. At the tips of superellipses of exponents below two, where the curvature of C has no
        // bound, it does not: the steps tell by how much less they become.
        let quadratic = round || step.abs() * value.abs() <= SOLUTION * before.max(value.abs());
        if step.abs() < 1e-8 && quadratic && dx.norm_squared() < slip.mild_bend {
            return slip.admit_root(&n, &(x + dx * step), &(v - dv * step));
        }
        // The comparison also turns away NaN from flats, where the Hessian is infinite.
        if !(step.abs() < 0.3) {
            // At a corner of D the slip velocity does not depend on the normal, which must be along it.
            if dx == V::zeros()
                && let Some(along) = v.try_normalize(0.0)
                && along != n
            {
                n = along;
                continue;
            }
            return None;
        }
        n += turn * step;
        before = value.abs();
    }
    None
}

/// Newton's method for the slip equation, where `x = μ n`.
#[inline]
pub(super) fn newton_on_circle(slip: &Slip<'_, '_>, mut n: V, mu: f64) -> Option<LocalSolution<2>> {
    let a = slip.a * mu;
    for _ in 0..10 {
        let v = slip.c0 - a * n;
        let value = cross(&n, &v);
        if value.abs() <= slip.rounding {
            return slip.admit_root(&n, &(n * mu), &v);
        }
        let turn = V::new(-n.y, n.x);
        let step = value / (n.dot(&v) + cross(&n, &(a * turn)));
        if !(step.abs() < 0.3) {
            return None;
        }
        n = (n + turn * step) * (1.0 / (1.0 + step * step).sqrt());
        if step.abs() < 1e-8 {
            return slip.admit_root(&n, &(n * mu), &(slip.c0 - a * n));
        }
    }
    None
}

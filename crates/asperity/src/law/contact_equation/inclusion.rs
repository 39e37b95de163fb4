//! How far friction is from the law: the defect that every measure of friction is made of.
//!
//! Per unit of `P_N`, friction is a pair of the percussion `x = −P_T/P_N` and the velocity `σ = ρ ξ_T/P_N`, and the law is
//! the set of all pairs with `σ ∈ N_D(z)`, `z = α(x) x`. The defect is the distance to a pair near by that obeys the law
//! exactly, percussion and velocity weighed alike. Two such pairs are known:
//!
//! - Slip. The prox step `z′ = prox_D(z + r σ)` leaves a rest `z + r σ − z′ ∈ N_D(z′)`, so that `x′ = z′/α(z′)` and
//!   `σ′ = (z + r σ − z′)/r` obey the law. They are off by `‖x − x′‖` and by `‖σ − σ′‖ = ‖z − z′‖/r`, of which the larger
//!   one counts. With `r = α(x)` the scale of *D* drops out of the step, as it does out of the adaptive prox iteration.
//! - Rest. `x/max(1, k_C(x))` with `σ = 0` is off by `‖x‖ max(0, 1 − 1/k_C(x)) + ‖σ‖`.
//!
//! The nearer one counts. The defect vanishes exactly where the law holds. As `x′` and the point of rest are in *C*, it is
//! never less than the distance of the percussion from *C*, and as `σ′ ≠ 0` belongs to an `x′` on bdry *C*, a velocity
//! larger than the defect is one of a percussion that is no farther than that from bdry *C*. Units, the scale of *D* and
//! the choice of rows change nothing.
//!
//! `‖z − z′‖` alone would not do: where *D* is thin, `α ≪ 1`, a change `δ` of `x` along its ray is one of `α² δ` of `z`. Nor
//! would `‖x − x′‖`: along a slender *D* normals turn where `x` hardly changes. And in stick near the border `x′` moves with
//! `‖σ‖/α`, while rest is only `‖σ‖` away.
//!
//! For `D = C`, where `α = 1`, both parts of the first pair are `‖x − prox_C(x + σ)‖`, and as `prox_C` does not expand
//! distances, the sum of both parts is no less for any other pair that obeys the law: the defect is the natural map of
//! \[WL19\] (12).
//!
//! Solvers end in rest, or in slip on the ray of `x` along a normal of *D*. Where such a pair is as near as rounding, no
//! projection is made to find a nearer one.
//!
//! Where *C* is not convex a third pair is asked for, see [`slip_beside`]: beside a cusp the lengths of neighbouring rays
//! differ, as those of `x` and `x′` do by rounding, by much more than bdry *C* is away.

use asperity_set::{ConvexSet, StarSet, Vector};

use crate::law::FrictionLaw;

/// Square of the defect of the percussion `x = −P_T/P_N` and the velocity `σ = ρ ξ_T/P_N`.
#[inline(always)]
pub(in crate::law) fn squared_defect<const P: usize>(
    law: &FrictionLaw<P>,
    x: &Vector<P>,
    sigma: &Vector<P>,
) -> f64 {
    if law.is_associated() {
        return (x - law.direction().project_from(&(x + sigma), x)).norm_squared();
    }
    let (speed, k_c) = (sigma.norm_squared(), law.reservoir().gauge(x));
    let rounding = ROUNDING * (x.norm_squared() + speed);
    if k_c <= 1.0 && speed <= rounding {
        return speed;
    }
    // Slip: what `x` is off the point of bdry *C* on its ray, and what the velocity is off the normal of *D* there.
    let off = (1.0 - 1.0 / k_c).powi(2) * x.norm_squared();
    if off <= rounding {
        let on_ray = off + off_normal(law, x, sigma);
        if on_ray <= rounding {
            return on_ray;
        }
    }
    let k_d = law.direction().gauge(x);
    let alpha = 1.0 / (k_d - k_c + 1.0);
    let start = x * alpha;
    let target = start + sigma * alpha;
    let end = law.direction().project_from(&target, &start);
    let sticks = end == target;
    if sticks && k_c <= 1.0 {
        // Both pairs are at rest, and none is nearer than that with the same percussion.
        return speed;
    }
    // On bdry D, where a projection ends, 1/α(z′) = 1/k_C(z′) without a difference of large numbers.
    let gauge = law.reservoir().gauge(&end);
    let inverse = if sticks { gauge - law.direction().gauge(&end) + 1.0 } else { gauge };
    let off = (x - end / inverse).norm_squared();
    let turned = (start - end).norm_squared() / (alpha * alpha);
    // The comparisons let not-a-number through.
    let slip = if off <= turned { turned } else { off };
    let slip = if slip > ROUNDING * x.norm_squared() && law.reservoir().as_convex().is_none() {
        let beside = slip_beside(law, x, sigma);
        slip.min(beside * beside)
    } else {
        slip
    };
    if !(speed < slip) {
        return slip;
    }
    if k_c <= 1.0 {
        return speed;
    }
    let beyond = x.norm() * (1.0 - 1.0 / k_c) + speed.sqrt();
    slip.min(beyond * beyond)
}

/// The square of a relative defect that needs no nearer pair: it is rounding.
const ROUNDING: f64 = 1e-30;

/// Square of how far the velocity is off the normal of *D* on the ray of `x`.
#[inline(always)]
fn off_normal<const P: usize>(law: &FrictionLaw<P>, x: &Vector<P>, sigma: &Vector<P>) -> f64 {
    let normal = law.direction().normal(x);
    let along = f64::max(0.0, sigma.dot(&normal) / normal.norm_squared());
    (sigma - normal * along).norm_squared()
}

/// How far it is to slip with a percussion on bdry *C* near `x` that need not be on its ray: the length of a step across
/// bdry *C*, and what the velocity is off the normals of *D* at its ends; infinite where the step does not cross bdry *C*.
#[cold]
fn slip_beside<const P: usize>(law: &FrictionLaw<P>, x: &Vector<P>, sigma: &Vector<P>) -> f64 {
    let (gauge, slope) = law.reservoir().gauge_jet(x);
    let steepness = slope.norm();
    // Twice the way and beyond what rounding of x hides.
    let way = 2.0 * (gauge - 1.0) / steepness;
    let across = slope * ((way + (16.0 * f64::EPSILON * x.norm()).copysign(way)) / steepness);
    let near = x - across;
    let crosses = (law.reservoir().gauge(&near) - 1.0) * (gauge - 1.0) <= 0.0;
    let aside = |at: &Vector<P>| {
        let normal = law.direction().normal(at).normalize();
        (sigma - normal * sigma.dot(&normal).max(0.0)).norm()
    };
    let distance = across.norm() + aside(x).max(aside(&near));
    if crosses && distance.is_finite() { distance } else { f64::INFINITY }
}

#[cfg(test)]
mod tests;

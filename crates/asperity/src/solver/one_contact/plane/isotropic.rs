//! Shortcuts for isotropic friction, the law of most contacts: stick, Newton's method, and that there is one slip only.

use super::super::local::{Local, LocalSolution};
use super::equation::{Slip, V, cross};
use crate::contact::Phase;

/// Stick or slip of a unilateral contact with a sound block. That friction holds it, `‖P_T‖ < μ P_N`, needs no
/// root and no division.
#[inline(always)]
pub(super) fn stick_or_slip(
    local: &Local<'_, 2>,
    guess: impl Fn() -> V,
) -> Option<LocalSolution<2>> {
    let mu = local.law.isotropic_coefficient()?;
    let block = local.block;
    if local.prescribed.is_some() {
        return None;
    }
    let load = local.b_t - block.g_tn * (local.b_n * block.inverse_nn);
    let tangent = -(block.schur_inverse * load);
    let normal = -(local.b_n + block.g_nt.dot(&tangent)) * block.inverse_nn;
    let held = normal > 0.0 && tangent.norm_squared() < (mu * normal).powi(2);
    if held {
        let (phase, slip, degenerate) = (Phase::Stick, V::zeros(), false);
        return Some(LocalSolution { phase, normal, tangent, slip, degenerate });
    }
    newton(&Slip::new(local, mu), guess().try_normalize(0.0)?, mu)
}

/// Newton's method for the slip equation, where `x = μ n`.
#[inline]
pub(super) fn newton(slip: &Slip<'_, '_>, mut n: V, mu: f64) -> Option<LocalSolution<2>> {
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

/// Gauge of the force of stick, far more than rounding beyond that of the border: nearer to it rounding decides which of the
/// two roots is a slip.
const OUTSIDE: f64 = 1.0 + 1e-6;
/// What the discriminant of a quartic whose largest coefficient is 1 is asked to be beyond zero: a hundred times what
/// rounding makes of it, as long as that coefficient is no smaller against `c₀` and `μ A`.
const BEYOND: f64 = 1e-5;
const CANCELLED: f64 = 1e-3;

/// Whether there certainly is one slip only, of a contact with a sound block that no friction pulls towards the surface.
///
/// With `n = (cos φ, sin φ)` the equation `n × (c₀ − μ A n) = 0` is a trigonometric polynomial of degree two, a quartic
/// `a t⁴ + b t³ + c t² + d t + e` in `t = tan φ/2`. Of its invariants `I = 12ae − 3bd + c²` and
/// `J = 72ace + 9bcd − 27ad² − 27b²e − 2c³` the discriminant is `(4I³ − J²)/27`: if it is negative, the slip velocity is
/// along `n`, or against it, at two `n` in all. `c₀ − A x` vanishes at the force of stick only: where that is outside the disk,
/// it does not turn round along the circle while `n` turns once, and is along `n` once at least, and once against it.
pub(super) fn has_one_slip(slip: &Slip<'_, '_>, mu: f64) -> bool {
    // The comparison also turns away what is not a number.
    if !(slip.local.stick_load().gauge > OUTSIDE) {
        return false;
    }
    let (c0, m) = (slip.c0, slip.a * (0.5 * mu));
    let (turn, along, across) = (m.m21 - m.m12, m.m21 + m.m12, m.m22 - m.m11);
    let coefficients = [
        -c0.y - turn - along,
        4.0 * across - 2.0 * c0.x,
        6.0 * along - 2.0 * turn,
        -4.0 * across - 2.0 * c0.x,
        c0.y - turn - along,
    ];
    let largest = coefficients.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    // The comparison also turns away what is not a number.
    if !(largest > CANCELLED * (slip.norm_c + mu * slip.norm_a)) {
        return false;
    }
    let [a, b, c, d, e] = coefficients.map(|value| value / largest);
    let i = 12.0 * a * e - 3.0 * b * d + c * c;
    let j = 72.0 * a * c * e + 9.0 * b * c * d - 27.0 * (a * d * d + b * b * e) - 2.0 * c * c * c;
    j * j - 4.0 * i * i * i > BEYOND
}

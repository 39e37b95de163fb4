//! Shortcuts for isotropic friction, the law of most contacts.

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

//! One contact in the plane: all solutions by walking along bdry *D*, and a fast path to one of them.
//!
//! In slip `−P_T = P_N x` with `x = z/k_C(z)` on bdry *C* and `z` on bdry *D*. The normal row gives
//! `P_N = −b_N/den(x)`, and multiplied by `den` the slip velocity is `v(x) = c₀ − A x`: the equation
//! `F = n × v = 0` with `n·v/den > 0` has no pole. See `law/table.rs` for the table that is walked.

mod all;
mod equation;
mod scan;

use asperity_set::{ConvexSet, StarSet};

use super::local::{Local, LocalSolution, Selection, Shape};
use crate::contact::ContactState;
use crate::law::COARSE;
pub(super) use all::solutions;
use equation::{Slip, V, cross};
use scan::Scan;

/// The solution that continues `state`, by the fast path where uniqueness is certain.
#[inline(always)]
pub(super) fn solve(
    local: &Local<'_, 2>,
    state: &ContactState,
    guess: impl Fn() -> V,
    buffer: &mut Vec<LocalSolution<2>>,
) -> Option<Selection<2>> {
    match fast(local, guess) {
        Some(solution) => Some(Selection { solution, ambiguous: false }),
        None => select_among_all(*local, state, buffer),
    }
}

#[cold]
#[inline(never)]
fn select_among_all(
    local: Local<'_, 2>,
    state: &ContactState,
    buffer: &mut Vec<LocalSolution<2>>,
) -> Option<Selection<2>> {
    solutions(&local, buffer);
    let solution = local.select(buffer, state)?;
    let continuum = buffer.iter().any(|s| s.degenerate);
    Some(Selection { solution, ambiguous: buffer.len() > 1 || continuum })
}

/// The solution, if it is found quickly and certainly the only one.
#[inline(always)]
fn fast(local: &Local<'_, 2>, guess: impl Fn() -> V) -> Option<LocalSolution<2>> {
    if local.prescribed == Some(0.0) {
        return Some(local.open());
    }
    let table = local.law.table();
    if local.prescribed.is_none() {
        let pressed = local.block.g_nn > local.block.g_nt.norm() * table.largest_radius;
        if !pressed {
            return None;
        }
        if local.b_n >= 0.0 {
            return Some(local.open());
        }
    }
    let stick = local.stick();
    let shape = match local.prescribed {
        Some(_) => local.block.shape,
        None => Shape::new(&local.affine().1, table.smallest_sine),
    };
    let certain = match shape {
        Shape::Monotone => true,
        Shape::Scalar => !table.may_be_ambiguous(&stick.load, stick.gauge),
        Shape::General => false,
    };
    if let Some(solution) = stick.solution {
        if solution.degenerate || stick.gauge >= 1.0 - 1e-12 {
            return None;
        }
        if certain {
            return Some(solution);
        }
        let slip = Slip::new(local, table);
        let scan = Scan::new(&slip, table);
        return (0..COARSE).all(|i| scan.excluded(&slip, table, i)).then_some(solution);
    }
    let slip = Slip::new(local, table);
    let mut found = newton(&slip, &guess());
    if found.is_none() {
        // Where the last direction is far off, the normal below the load is a good start.
        found = newton(&slip, &local.law.direction().gauge_jet(&stick.load).1);
    }
    let solution = found?;
    (certain || Scan::new(&slip, table).has_one_root(&slip, table)).then_some(solution)
}

/// Newton's method for `F = 0` in the angle of the normal, from the last slip direction.
///
/// `dF/dφ = −n·v − n × (A x')`, `x' = (z' − x (∇k_C·z'))/k_C`, `z' = ∇²h_D n⊥`.
fn newton(slip: &Slip<'_, '_>, guess: &V) -> Option<LocalSolution<2>> {
    let law = slip.local.law;
    let mut n = guess.try_normalize(0.0)?;
    for _ in 0..10 {
        let turn = V::new(-n.y, n.x);
        let (z, dz) = law.direction().support_derivative(&n, &turn);
        let (gauge, gradient) = law.reservoir().gauge_jet(&z);
        let reciprocal = 1.0 / gauge;
        let x = z * reciprocal;
        let v = slip.velocity(&x);
        let value = cross(&n, &v);
        if value.abs() <= slip.rounding {
            return slip.admit_root(&n, &x, &v, false);
        }
        let dx = (dz - x * gradient.dot(&dz)) * reciprocal;
        let dv = slip.a * dx;
        let step = value / (n.dot(&v) + cross(&n, &dv));
        // What is left after the last step is its square, unless the boundary is nearly flat here.
        if step.abs() < 1e-8 && dx.norm_squared() < slip.mild_bend {
            return slip.admit_root(&n, &(x + dx * step), &(v - dv * step), false);
        }
        // The comparison also turns away NaN from flats, where the Hessian is infinite.
        if !(step.abs() < 0.3) {
            return None;
        }
        n = (n + turn * step) * (1.0 / (1.0 + step * step).sqrt());
    }
    None
}

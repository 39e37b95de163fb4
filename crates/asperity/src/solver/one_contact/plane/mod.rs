//! One contact in the plane: all solutions by walking along bdry *D*, and a fast path to one of them.
//!
//! In slip `−P_T = P_N x` with `x = z/k_C(z)` on bdry *C* and `z` on bdry *D*. The normal row gives
//! `P_N = |b_N|/den(x)`, and multiplied by `den` the slip velocity is `v(x) = c₀ − A x`: the equation
//! `F = n × v = 0` with `n·v > 0` and `den > 0` has no pole. See `law/walk_table/` for the table that is walked.

mod all;
mod equation;
mod isotropic;
mod proof;
mod rising;
mod scan;
mod search;
#[cfg(test)]
mod tests;

use asperity_set::{Convex, ConvexSet, Star, StarSet};

use super::block::Shape;
use super::effort::Effort;
use super::local::{Local, LocalSolution, Selection, Stick};
use crate::contact::{ContactState, Phase};
pub(crate) use all::solutions;
use equation::{Slip, V, cross};
pub(crate) use proof::proves_no_solution;
pub(crate) use rising::Rising;
pub(crate) use rising::{solutions as rising_solutions, solutions_on_a_line};
use scan::Scan;

/// A solution for sweeps that will come back to the contact: the one that continues `state` as far as the
/// stick solution and Newton's method from the last direction show, without a proof that there is no other.
#[inline(always)]
pub(crate) fn first_found(
    local: &Local<'_, 2>,
    state: &ContactState,
    guess: impl Fn() -> V,
    buffer: &mut Vec<LocalSolution<2>>,
    effort: &mut Effort,
) -> Option<LocalSolution<2>> {
    match opens(local) {
        Some(None) if local.block.sound => {}
        Some(Some(open)) => return Some(open),
        _ if !local.block.sound => return ill_conditioned(*local, state, guess(), buffer, effort),
        _ => return select_among_all(*local, state, buffer).map(|s| s.solution),
    }
    if state.phase != Phase::Slip
        && let Some(found) = isotropic::stick_or_slip(local, &guess)
    {
        return Some(found);
    }
    let stick = local.stick_load();
    let slips = || {
        let slip = Slip::new(local, local.law.bounds().largest_radius);
        newton(&slip, &guess()).or_else(|| newton_from_load(local, &slip))
    };
    let mut others = || select_among_all(*local, state, buffer).map(|s| s.solution);
    match stick.holds() {
        true if state.phase != Phase::Slip || has_one_solution(local, &stick) => {
            Some(stick.solution())
        }
        // Where several are possible, the rule decides between all of them.
        true => others(),
        false => slips().or_else(others),
    }
}

/// The same where the closed forms divide by small pivots: by Newton's method on all rows, and only where it does
/// not succeed by a walk along the boundary, as long as the effort lasts.
#[cold]
#[inline(never)]
fn ill_conditioned(
    local: Local<'_, 2>,
    state: &ContactState,
    guess: V,
    buffer: &mut Vec<LocalSolution<2>>,
    effort: &mut Effort,
) -> Option<LocalSolution<2>> {
    if local.opens() {
        return Some(local.open());
    }
    let found = match state.phase {
        Phase::Slip => local.slip_from(&guess, effort).or_else(|| local.stick_of_any_rank(effort)),
        _ => local.stick_of_any_rank(effort).or_else(|| local.slip_from(&guess, effort)),
    };
    if found.is_some() {
        return found;
    }
    let walks = effort.walk().then(|| select_among_all(local, state, buffer));
    walks.flatten().map(|s| s.solution)
}

/// The solution that continues `state`, from all that there are.
#[cold]
#[inline(never)]
pub(crate) fn select_among_all(
    local: Local<'_, 2>,
    state: &ContactState,
    buffer: &mut Vec<LocalSolution<2>>,
) -> Option<Selection<2>> {
    let complete = solutions(&local, buffer);
    let solution = local.select(buffer, state)?;
    let continuum = buffer.iter().any(|s| s.degenerate);
    Some(Selection { solution, ambiguous: buffer.len() > 1 || continuum || !complete })
}

/// The solution, if it is found quickly and certainly the only one.
#[inline(always)]
pub(crate) fn fast(local: &Local<'_, 2>, guess: impl Fn() -> V) -> Option<LocalSolution<2>> {
    // Friction may pull a contact towards the surface that is not pressed by any.
    if local.prescribed.is_none() && !local.block.pressed {
        return None;
    }
    if local.opens() {
        return Some(local.open());
    }
    if !local.block.sound {
        return None;
    }
    let mut certain = certainly_slips(local);
    if !certain {
        let stick = local.stick_load();
        certain = has_one_solution(local, &stick);
        if stick.holds() {
            let unique = stick.gauge < 1.0 - 1e-12 && (certain || is_only(local));
            return unique.then(|| stick.solution());
        }
    }
    let slip = Slip::new(local, local.law.bounds().largest_radius);
    let found = newton(&slip, &guess()).or_else(|| newton_from_load(local, &slip));
    found.filter(|_| certain || has_one_root(local, &slip))
}

/// Newton's method from the normal below the load of stick, a good start where the last direction is far off.
#[inline(never)]
fn newton_from_load(local: &Local<'_, 2>, slip: &Slip<'_, '_>) -> Option<LocalSolution<2>> {
    newton(slip, &local.law.direction().normal(&local.stick_load().load))
}

/// Whether there is no slip beside stick.
#[inline(never)]
fn is_only(local: &Local<'_, 2>) -> bool {
    let slip = Slip::new(local, local.law.bounds().largest_radius);
    Scan::new(&slip, local.law.walk().table).open().next().is_none()
}

/// Whether there is one slip only.
#[inline(never)]
fn has_one_root(local: &Local<'_, 2>, slip: &Slip<'_, '_>) -> bool {
    let friction = local.law.isotropic_coefficient();
    if friction.is_some_and(|mu| isotropic::has_one_slip(slip, mu)) {
        return true;
    }
    let table = local.law.walk().table;
    Scan::new(slip, table).has_one_root(slip, table)
}

/// The open contact, if it opens; `None` where friction may pull it towards the surface.
#[inline(always)]
fn opens(local: &Local<'_, 2>) -> Option<Option<LocalSolution<2>>> {
    if local.prescribed.is_some() {
        return Some((local.prescribed == Some(0.0)).then(|| local.open()));
    }
    local.block.pressed.then(|| (local.b_n >= 0.0).then(|| local.open()))
}

/// Whether the contact certainly has one solution only, a slip.
#[inline(always)]
fn certainly_slips(local: &Local<'_, 2>) -> bool {
    let pressure = local.prescribed.unwrap_or(-local.b_n);
    local.b_t.norm_squared() > (local.block.certain_slip * pressure).powi(2)
}

/// Whether the contact certainly has one solution only, whatever it is, as the percussions show that stick would need.
#[inline(always)]
fn has_one_solution(local: &Local<'_, 2>, stick: &Stick<2>) -> bool {
    let shape = match local.prescribed {
        Some(_) => local.block.shape,
        None => Shape::new(&local.affine().1, local.law.bounds().smallest_sine),
    };
    match shape {
        Shape::Monotone => true,
        Shape::Scalar => !local.law.may_be_ambiguous(&stick.load, stick.gauge),
        Shape::General => false,
    }
}

/// Step of Newton's method, in rad, times the factor by which `F` has fallen with the step before, that may be left.
const LEFT: f64 = 1e-12;

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

/// Newton's method for `F = 0` in the angle of the normal, from the last slip direction.
///
/// `dF/dφ = −n·v − n × (A x')`, `x' = (z' − x (∇k_C·z'))/k_C`, `z' = ∇²h_D n⊥`, where `n` may have any length: it is a
/// factor of `F` and `dF/dφ` alike.
#[inline(always)]
fn newton(slip: &Slip<'_, '_>, guess: &V) -> Option<LocalSolution<2>> {
    let law = slip.local.law;
    if let Some(mu) = law.isotropic_coefficient() {
        return isotropic::newton(slip, guess.try_normalize(0.0)?, mu);
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
        let quadratic = round || step.abs() * value.abs() <= LEFT * before.max(value.abs());
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

//! One contact in the plane: all solutions by walking along bdry *D*, and a fast path to one of them.
//!
//! In slip `−P_T = P_N x` with `x = z/k_C(z)` on bdry *C* and `z` on bdry *D*. The normal row gives
//! `P_N = |b_N|/den(x)`, and multiplied by `den` the slip velocity is `v(x) = c₀ − A x`: the equation
//! `F = n × v = 0` with `n·v > 0` and `den > 0` has no pole. See `law/walk_table/` for the table that is walked.

mod all;
mod equation;
mod implicit_rate;
mod newton;
mod scan;
mod search;
#[cfg(test)]
mod tests;

use super::block::Shape;
use super::local::{Local, Stick};
use super::solution::{LocalSolution, Policy};
use crate::contact::{ContactState, Phase};
pub(crate) use all::solutions;
use equation::{Slip, V};
pub(crate) use implicit_rate::{
    ImplicitRate, solutions as implicit_solutions, solutions_on_a_line,
};
use newton::newton;
use scan::Scan;
pub(crate) use search::proves_no_solution;

/// The solution that continues `state`; for [`Policy::FirstFound`] as far as the stick solution and Newton's method from
/// the last direction show, without a proof that there is no other.
#[inline(always)]
pub(crate) fn solve(
    local: &Local<'_, 2>,
    state: &ContactState,
    guess: impl Fn() -> V,
    policy: Policy,
    buffer: &mut Vec<LocalSolution<2>>,
) -> Option<LocalSolution<2>> {
    let found = match policy {
        Policy::FirstFound if !local.block.sound => ill_conditioned(*local, state, guess()),
        _ => without_search(local, state, guess, policy),
    };
    found.or_else(|| select_among_all(*local, state, buffer))
}

/// A solution where closed forms divide by small pivots: by Newton's method on all rows.
#[cold]
#[inline(never)]
fn ill_conditioned(
    local: Local<'_, 2>,
    state: &ContactState,
    guess: V,
) -> Option<LocalSolution<2>> {
    let open = local.opens().then(|| local.open());
    open.or_else(|| local.single().solve(state, Some(guess), &[], false))
}

/// The solution that continues `state`, from all that there are.
#[cold]
#[inline(never)]
fn select_among_all(
    local: Local<'_, 2>,
    state: &ContactState,
    buffer: &mut Vec<LocalSolution<2>>,
) -> Option<LocalSolution<2>> {
    let complete = solutions(&local, buffer);
    let found = local.select(buffer.iter(), state)?;
    Some(LocalSolution { ambiguous: found.ambiguous || !complete, ..found })
}

/// A solution that is found quickly, which for [`Policy::Prove`] is certainly the only one.
#[inline(always)]
fn without_search(
    local: &Local<'_, 2>,
    state: &ContactState,
    guess: impl Fn() -> V,
    policy: Policy,
) -> Option<LocalSolution<2>> {
    // Friction may pull the contact towards the surface.
    if local.prescribed.is_none() && !local.block.normal_dominates {
        return None;
    }
    if local.opens() {
        return Some(local.open());
    }
    if !local.block.sound {
        return None;
    }
    let first = policy == Policy::FirstFound;
    let mut certain = !first && certainly_slips(local);
    if !certain {
        let stick = local.stick();
        certain = !first && has_one_solution(local, &stick);
        let (holds, well) = match policy {
            Policy::FirstFound => (stick.holds(local.law, 1.0), true),
            Policy::Prove => stick.holds_well(local.law),
        };
        if holds {
            // Where several are possible, the rule decides between all of them.
            let takes = match policy {
                Policy::FirstFound => state.phase != Phase::Slip || has_one_solution(local, &stick),
                Policy::Prove => well && (certain || is_only(local)),
            };
            return takes.then(|| stick.solution());
        }
    }
    let slip = Slip::new(local);
    let only = || first || certain || Scan::has_one_root(&slip, local.law.walk().table);
    newton(&slip, &guess()).filter(|_| only())
}

/// Whether there is no slip beside stick.
#[inline(never)]
fn is_only(local: &Local<'_, 2>) -> bool {
    Scan::new(&Slip::new(local), local.law.walk().table).open().next().is_none()
}

/// Whether the contact certainly has one solution only, a slip.
#[inline(always)]
fn certainly_slips(local: &Local<'_, 2>) -> bool {
    let pressure = local.prescribed.unwrap_or(-local.b_n);
    local.b_t.norm_squared() > (local.block.slip_certificate * pressure).powi(2)
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
        Shape::Scalar => !local.law.may_be_ambiguous(&stick.load(), stick.gauge(local.law)),
        Shape::General => false,
    }
}

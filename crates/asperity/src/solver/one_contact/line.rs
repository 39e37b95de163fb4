//! One contact on a line: stick, forward slip or backward slip, each in closed form.

use asperity_set::{StarSet, Vector};

use super::block::MARGIN;
use super::local::Local;
use super::solution::LocalSolution;
use crate::contact::ContactState;

/// All solutions: open, stick, backward slip, forward slip, as far as they exist.
pub(crate) fn solutions(local: &Local<'_, 1>) -> [Option<LocalSolution<1>>; 4] {
    let open = local.opens().then(|| local.open());
    if local.prescribed == Some(0.0) {
        return [open, None, None, None];
    }
    let stick = local.any_stick();
    let (c0, a) = local.affine();
    let slip = |direction: f64| {
        let end = Vector::<1>::new(direction);
        let x = end / local.law.reservoir().gauge(&end);
        let v = c0 - a * x;
        let admissible =
            direction * v[0] > 0.0 && local.denominator(&x) > local.vanishing_denominator(x.amax());
        // With b_N = 0 the normal percussion of a slip solution vanishes: the contact is open.
        let loaded = local.prescribed.is_some() || local.b_n != 0.0;
        let solution = local.slip(&x, &v);
        // On the boundary of the reservoir slip with vanishing velocity is stick.
        let distinct = stick.is_none() || solution.slip[0].abs() > 1e-12 * local.b_t[0].abs();
        (admissible && loaded && distinct).then_some(solution)
    };
    let all = [open, stick, slip(-1.0), slip(1.0)];
    match all.iter().any(Option::is_some) {
        true => all,
        false => [None, local.stick_on_border(), None, None],
    }
}

/// The solution that continues `state`.
pub(crate) fn solve(local: &Local<'_, 1>, state: &ContactState) -> Option<LocalSolution<1>> {
    local.select(solutions(local).iter().flatten(), state)
}

/// Whether neither open nor stick nor slip is possible, with a margin: see `proves_no_solution` in `one_contact/solve.rs`.
pub(crate) fn proves_no_solution(local: &Local<'_, 1>) -> bool {
    if !local.excludes_open_and_stick() {
        return false;
    }
    let (c0, a) = local.affine();
    [-1.0, 1.0].into_iter().all(|direction| {
        let end = Vector::<1>::new(direction);
        let x = end / local.law.reservoir().gauge(&end);
        let (moved, size) = (c0 - a * x, c0.amax() + (a * x).amax());
        let lift = (local.block.g_nt.x * x[0]).abs();
        direction * moved[0] < -MARGIN * size
            || local.denominator(&x) < -MARGIN * (local.block.g_nn + lift)
    })
}

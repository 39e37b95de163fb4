//! Newton's method for a direction of the plane, in all lanes at once.

use pulp::Simd;

use super::vector::{Mask, Number, Pair};

/// Newton iterations after which the stepper is asked.
pub(super) const ITERATIONS: usize = 8;
/// Defects that are nothing but rounding, twice those of the scalar solver.
pub(super) const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// Largest step of Newton's method, as the tangent of an angle.
const LARGEST_STEP: f64 = 0.5;

/// The direction `d − (Φ/Φ′) d⊥` in the lanes that are open, with the derivative `Φ′` along `d⊥`; others keep theirs.
#[inline(always)]
pub(super) fn turned<S: Simd>(
    simd: S,
    direction: Pair<Number<S>>,
    value: Number<S>,
    slope: Number<S>,
    open: Mask<S>,
) -> Pair<Number<S>> {
    let (zero, limit) = (Number::splat(simd, 0.0), Number::splat(simd, LARGEST_STEP));
    let turn = -value / slope;
    let whole = turn.abs().below(limit);
    let turn = whole.select(turn, turn.above(zero).select(limit, -limit));
    let turn = open.select(turn, zero);
    let [x, y] = direction;
    [x - turn * y, y + turn * x]
}

//! A time step of several runs at once.
//!
//! In coordinates `y = (WF)ᵀq`, where `F` maps the unit disk of a norm to *D*, the direction set is this disk: with
//! `ν = Fᵀγ`, and χ likewise, the midpoint scheme is
//!
//! ```text
//! y_M = y + ½Δt (ν − χ),   β = A y_M + B ν + c,   ν′ = β − K x,   y′ = y_M + ½Δt (ν′ − χ),
//! ```
//!
//! where `K = P_N FᵀGF` and `−P_T = P_N F x`. Where the contact slips, `x` is on the boundary of the reservoir, and `ν′` is
//! along the normal of the disk there, which the kind of law tells: see `ellipses.rs` and `superellipses.rs`.

use pulp::Simd;

use super::vector::{Mask, Number, Pair, components, dot, product};

/// How far a gauge is from one where rounding does not decide between stick and slip, that of the scalar solver.
const BORDER: f64 = 1e-12;

/// Two sets of the plane, for which slip is found in lanes.
pub(super) trait Sets<S: Simd>: Copy {
    /// The sets of one run.
    type Plain: 'static;

    /// Those of the runs of all lanes.
    fn gather<'a>(simd: S, of: impl Fn(usize) -> &'a Self::Plain) -> Self;

    /// What loads are compared by: the reservoir's gauge of a force, or an increasing function of it that costs less; or a
    /// lower bound of it, if that is above `enough` in all lanes that are `active`.
    fn measure(
        &self,
        simd: S,
        force: Pair<Number<S>>,
        enough: Number<S>,
        active: Mask<S>,
    ) -> Number<S>;

    /// The measure of a force with this gauge.
    fn of_gauge(gauge: Number<S>) -> Number<S>;

    /// The slip `ν′` that solves the slip equation, and the lanes of those wanted in which it is found, from a normal of
    /// *D*, or from a force where there is none yet.
    fn slip(
        &self,
        simd: S,
        equation: &SlipEquation<S>,
        from: Start<S>,
        wanted: Mask<S>,
    ) -> (Pair<Number<S>>, Mask<S>);
}

/// `ν′ = β − K x`.
pub(super) struct SlipEquation<S: Simd> {
    /// β.
    pub(super) free: Pair<Number<S>>,
    /// `K`.
    pub(super) resistance: [Pair<Number<S>>; 2],
    /// A bound of `‖β‖ + ‖K x‖`.
    pub(super) size: Number<S>,
}

/// Where the search for a slip begins.
pub(super) struct Start<S: Simd> {
    pub(super) direction: Pair<Number<S>>,
    /// Where it is a normal of *D*, else it is a force.
    pub(super) is_normal: Mask<S>,
}

/// The constants of a run.
#[derive(Debug, Clone, Copy)]
pub(super) struct Coefficients<T> {
    /// Half of the step.
    pub(super) half: T,
    /// χ.
    pub(super) belt: Pair<T>,
    /// `A`, `B`, `c`.
    pub(super) by_position: [Pair<T>; 2],
    pub(super) by_velocity: [Pair<T>; 2],
    pub(super) constant: Pair<T>,
    /// `K` and its inverse.
    pub(super) resistance: [Pair<T>; 2],
    pub(super) compliance: [Pair<T>; 2],
    /// A bound of `‖K x‖` in slip.
    pub(super) strongest: T,
    /// Gauges of the loads between which there may be several solutions.
    pub(super) doubtful: Pair<T>,
}

/// Where a run is.
#[derive(Debug, Clone, Copy)]
pub(super) struct State<T> {
    /// `y`.
    pub(super) position: Pair<T>,
    /// `ν`.
    pub(super) velocity: Pair<T>,
    /// The last one that was not zero, which decides between several solutions.
    pub(super) slip: Pair<T>,
    /// Its last differences of first and second order, from which it is extrapolated.
    pub(super) change: Pair<T>,
    pub(super) bend: Pair<T>,
    /// 1 where the contact slips, else 0.
    pub(super) slips: T,
}

/// A step that was tried.
pub(super) struct Tried<S: Simd> {
    pub(super) state: State<Number<S>>,
    /// Where it has not succeeded, or it must be asked whether there are several solutions.
    pub(super) failed: Mask<S>,
    pub(super) doubtful: Mask<S>,
    /// `K⁻¹β`, the force that stick needs.
    pub(super) load: Pair<Number<S>>,
}

/// A step of the runs that are `active`.
#[inline(always)]
pub(super) fn step<S: Simd, L: Sets<S>>(
    simd: S,
    c: &Coefficients<Number<S>>,
    sets: &L,
    s: &State<Number<S>>,
    active: Mask<S>,
) -> Tried<S> {
    let number = |value: f64| Number::splat(simd, value);
    let (zero, one) = (number(0.0), number(1.0));
    let middle = components(|i| s.position[i] + c.half * (s.velocity[i] - c.belt[i]));
    let (moved, kept) = (product(&c.by_position, middle), product(&c.by_velocity, s.velocity));
    let free = components(|i| moved[i] + kept[i] + c.constant[i]);
    let load = product(&c.compliance, free);
    let [low, high] = components(|i| L::of_gauge(c.doubtful[i]));
    let border = L::of_gauge(number(1.0 + BORDER));
    let measure = sets.measure(simd, load, high.above(border).select(high, border), active);
    let sticks = measure.below(L::of_gauge(number(1.0 - BORDER)));
    let wanted = active & measure.above(border);
    let doubtful = !(measure.below(low) | measure.above(high));

    // A contact that slips goes on as before, another one slips as the force that stick would need says.
    let slid = s.slips.above(zero);
    let ahead = components(|i| s.velocity[i] + s.change[i] + s.bend[i]);
    let goes_on = dot(ahead, s.velocity).above(0.5 * dot(s.velocity, s.velocity));
    let direction = components(|i| slid.select(goes_on.select(ahead[i], s.velocity[i]), load[i]));
    let size = free[0].abs() + free[1].abs() + c.strongest;
    let equation = SlipEquation { free, resistance: c.resistance, size };
    let start = Start { direction, is_normal: slid };
    let (velocity, found) = sets.slip(simd, &equation, start, wanted);
    let velocity = components(|i| found.select(velocity[i], zero));

    let continues = found & slid;
    let change = components(|i| continues.select(velocity[i] - s.velocity[i], zero));
    let state = State {
        position: components(|i| middle[i] + c.half * (velocity[i] - c.belt[i])),
        velocity,
        slip: components(|i| found.select(velocity[i], s.slip[i])),
        change,
        bend: components(|i| continues.select(change[i] - s.change[i], zero)),
        slips: found.select(one, zero),
    };
    let failed = active & !(sticks | found);
    Tried { state, failed, doubtful: active & doubtful, load }
}

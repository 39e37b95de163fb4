//! A time step of several runs at once.
//!
//! In coordinates `y = (WF)ᵀq`, where `F` maps the unit disk to *D*, the direction set is the unit disk: with `ν = Fᵀγ`,
//! and χ likewise, the midpoint scheme is
//!
//! ```text
//! y_M = y + ½Δt (ν − χ),   β = A y_M + B ν + c,   ν′ = β − K x,   y′ = y_M + ½Δt (ν′ − χ),
//! ```
//!
//! where `K = P_N FᵀGF` and `−P_T = P_N F x`. The reservoir is `{x : xᵀΓx ≤ 1}`, and `ν′` is along the normal `m` of the
//! disk where the contact slips, `x = m/√(mᵀΓm)`. Nothing is a function of an angle: `m` may have any length.

use pulp::Simd;

use super::vector::{Mask, Number};

/// Newton iterations after which the stepper is asked. On the belts of `benches/lanes.rs` with isotropic friction it never
/// is.
const ITERATIONS: usize = 8;
/// Largest step of Newton's method, as the tangent of an angle.
const LARGEST_STEP: f64 = 0.5;
/// Defects that are nothing but rounding, twice those of the scalar solver.
const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// How far a gauge is from one where rounding does not decide between stick and slip, that of the scalar solver.
const BORDER: f64 = 1e-12;

/// What a vector is in the plane.
pub(super) type Pair<T> = [T; 2];

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
    /// `Γ₁₁`, `Γ₁₂`, `Γ₂₂`.
    pub(super) gauge: [T; 3],
    /// Squares of the gauges of the loads between which there may be several solutions.
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
    /// `K⁻¹β`, the force that stick needs, and the square of its gauge.
    pub(super) load: Pair<Number<S>>,
    pub(super) gauge: Number<S>,
}

#[inline(always)]
fn dot<S: Simd>(a: Pair<Number<S>>, b: Pair<Number<S>>) -> Number<S> {
    a[0] * b[0] + a[1] * b[1]
}

#[inline(always)]
fn cross<S: Simd>(a: Pair<Number<S>>, b: Pair<Number<S>>) -> Number<S> {
    a[0] * b[1] - a[1] * b[0]
}

#[inline(always)]
fn product<S: Simd>(matrix: &[Pair<Number<S>>; 2], v: Pair<Number<S>>) -> Pair<Number<S>> {
    [dot(matrix[0], v), dot(matrix[1], v)]
}

/// The quadratic form of the matrix with these entries `₁₁`, `₁₂`, `₂₂`, by the products of the components.
#[inline(always)]
fn form<S: Simd>([g11, g12, g22]: [Number<S>; 3], [a, ab, b]: [Number<S>; 3]) -> Number<S> {
    g11 * a + 2.0 * (g12 * ab) + g22 * b
}

/// The products `₁₁`, `₁₂`, `₂₂` of the components of a vector.
#[inline(always)]
fn squares<S: Simd>(v: Pair<Number<S>>) -> [Number<S>; 3] {
    [v[0] * v[0], v[0] * v[1], v[1] * v[1]]
}

/// A step of the runs that are `active`.
#[inline(always)]
pub(super) fn step<S: Simd>(
    simd: S,
    c: &Coefficients<Number<S>>,
    s: &State<Number<S>>,
    active: Mask<S>,
) -> Tried<S> {
    let number = |value: f64| Number::splat(simd, value);
    let (zero, one) = (number(0.0), number(1.0));
    let middle = [0, 1].map(|i| s.position[i] + c.half * (s.velocity[i] - c.belt[i]));
    let (moved, kept) = (product(&c.by_position, middle), product(&c.by_velocity, s.velocity));
    let free = [0, 1].map(|i| moved[i] + kept[i] + c.constant[i]);
    let load = product(&c.compliance, free);
    let gauge = form(c.gauge, squares(load));
    let sticks = gauge.below(number((1.0 - BORDER) * (1.0 - BORDER)));
    let wanted = active & gauge.above(number((1.0 + BORDER) * (1.0 + BORDER)));
    let doubtful = !(gauge.below(c.doubtful[0]) | gauge.above(c.doubtful[1]));

    // A contact that slips goes on as before, another one slips as the force that stick would need says.
    let slid = s.slips.above(zero);
    let ahead = [0, 1].map(|i| s.velocity[i] + s.change[i] + s.bend[i]);
    let goes_on = dot(ahead, s.velocity).above(0.5 * dot(s.velocity, s.velocity));
    let start = [0, 1].map(|i| slid.select(goes_on.select(ahead[i], s.velocity[i]), load[i]));
    let (velocity, found) = slip(simd, c, free, start, wanted);
    let velocity = velocity.map(|v| found.select(v, zero));

    let continues = found & slid;
    let change = [0, 1].map(|i| continues.select(velocity[i] - s.velocity[i], zero));
    let state = State {
        position: [0, 1].map(|i| middle[i] + c.half * (velocity[i] - c.belt[i])),
        velocity,
        slip: [0, 1].map(|i| found.select(velocity[i], s.slip[i])),
        change,
        bend: [0, 1].map(|i| continues.select(change[i] - s.change[i], zero)),
        slips: found.select(one, zero),
    };
    let failed = active & !(sticks | found);
    Tried { state, failed, doubtful: active & doubtful, load, gauge }
}

/// The slip `ν′ = β − K x` along the normal `m`, by Newton's method from a normal, and where it is found.
///
/// With `q = mᵀΓm` the equation is `Φ(m) = √q m × ν′ = √q m × β − m × K m = 0`. Its derivative along `m⊥` is
/// `Φ′ = (m⊥ᵀΓm/√q) m × β − √q m·β − (m × K m)′`, and a step turns `m` to `m − (Φ/Φ′) m⊥`. Lanes that have ended stay
/// where they are.
#[inline(always)]
fn slip<S: Simd>(
    simd: S,
    c: &Coefficients<Number<S>>,
    free: Pair<Number<S>>,
    start: Pair<Number<S>>,
    wanted: Mask<S>,
) -> (Pair<Number<S>>, Mask<S>) {
    let (zero, limit) = (Number::splat(simd, 0.0), Number::splat(simd, LARGEST_STEP));
    let [[k11, k12], [k21, k22]] = c.resistance;
    let (unequal, skew) = (k22 - k11, k21 + k12);
    let [g11, g12, g22] = c.gauge;
    let rounding = ROUNDING * (free[0].abs() + free[1].abs() + c.strongest);
    let (mut m, mut root, mut open) = (start, Number::splat(simd, 1.0), wanted);
    if wanted.any() {
        for iteration in 0..=ITERATIONS {
            let [a, ab, b] = squares(m);
            let q = form(c.gauge, [a, ab, b]);
            root = q.sqrt();
            let across = cross(m, free);
            let value = root * across - (k21 * a + unequal * ab - k12 * b);
            // The comparison also keeps NaN open.
            open = wanted & !(value * value).below(rounding * rounding * (q * (a + b)));
            if iteration == ITERATIONS || !open.any() {
                break;
            }
            let difference = a - b;
            let slope = ((g22 - g11) * ab + g12 * difference) * across
                - q * dot(m, free)
                - root * (unequal * difference - 2.0 * (skew * ab));
            let turn = -(root * value) / slope;
            let whole = turn.abs().below(limit);
            let turn = whole.select(turn, turn.above(zero).select(limit, -limit));
            let turn = open.select(turn, zero);
            m = [m[0] - turn * m[1], m[1] + turn * m[0]];
        }
    }
    let force = product(&c.resistance, m);
    let velocity = [0, 1].map(|i| free[i] - force[i] / root);
    (velocity, wanted & !open & dot(m, velocity).above(zero))
}

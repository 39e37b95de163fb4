//! Slip under laws of two ellipses.
//!
//! *D* is the unit disk and the reservoir `{x : xᵀΓx ≤ 1}`: the normal of *D* at the force `x` is along `x`, and with any
//! normal `m` the force is `x = m/√(mᵀΓm)`. Nothing is a function of an angle: `m` may have any length.

use pulp::Simd;

use super::kernel::{Sets, SlipEquation, Start};
use super::newton;
use super::vector::{Mask, Number, Pair, cross, dot, product};

/// The reservoir.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ellipses<T> {
    /// `Γ₁₁`, `Γ₁₂`, `Γ₂₂`.
    pub(super) gauge: [T; 3],
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

impl<S: Simd> Sets<S> for Ellipses<Number<S>> {
    type Plain = Ellipses<f64>;

    fn gather<'a>(simd: S, of: impl Fn(usize) -> &'a Ellipses<f64>) -> Self {
        let entry = |i: usize| Number::from_fn(simd, |lane| of(lane).gauge[i]);
        Self { gauge: [0, 1, 2].map(entry) }
    }

    /// The square of the gauge.
    #[inline(always)]
    fn measure(
        &self,
        _simd: S,
        force: Pair<Number<S>>,
        _enough: Number<S>,
        _active: Mask<S>,
    ) -> Number<S> {
        form(self.gauge, squares(force))
    }

    #[inline(always)]
    fn of_gauge(gauge: Number<S>) -> Number<S> {
        gauge * gauge
    }

    /// With `q = mᵀΓm` the equation is `Φ(m) = √q m × ν′ = √q m × β − m × K m = 0`. Its derivative along `m⊥` is
    /// `Φ′ = (m⊥ᵀΓm/√q) m × β − √q m·β − (m × K m)′`.
    #[inline(always)]
    fn slip(
        &self,
        simd: S,
        equation: &SlipEquation<S>,
        from: Start<S>,
        wanted: Mask<S>,
    ) -> (Pair<Number<S>>, Mask<S>) {
        let &SlipEquation { free, resistance, size } = equation;
        let [[k11, k12], [k21, k22]] = resistance;
        let (unequal, skew) = (k22 - k11, k21 + k12);
        let [g11, g12, g22] = self.gauge;
        let rounding = newton::ROUNDING * size;
        let (mut m, mut root, mut open) = (from.direction, Number::splat(simd, 1.0), wanted);
        if wanted.any() {
            for iteration in 0..=newton::ITERATIONS {
                let [a, ab, b] = squares(m);
                let q = form(self.gauge, [a, ab, b]);
                root = q.sqrt();
                let across = cross(m, free);
                let value = root * across - (k21 * a + unequal * ab - k12 * b);
                // The comparison also keeps NaN open.
                open = wanted & !(value * value).below(rounding * rounding * (q * (a + b)));
                if iteration == newton::ITERATIONS || !open.any() {
                    break;
                }
                let difference = a - b;
                let slope = ((g22 - g11) * ab + g12 * difference) * across
                    - q * dot(m, free)
                    - root * (unequal * difference - 2.0 * (skew * ab));
                m = newton::turned(simd, m, root * value, slope, open);
            }
        }
        let force = product(&resistance, m);
        let velocity = [0, 1].map(|i| free[i] - force[i] / root);
        (velocity, wanted & !open & dot(m, velocity).above(Number::splat(simd, 0.0)))
    }
}

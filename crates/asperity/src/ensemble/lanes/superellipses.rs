//! Slip under laws of two superellipses, with ellipses among them.
//!
//! *D* is the unit disk `{z : Σ|zᵢ|^p ≤ 1}` and the reservoir `{x : Σ|(R x)ᵢ|^s ≤ 1}` with the gauge `k`. At the force
//! `x = d/k(d)` along `d` the normal of *D* has the components `nᵢ = |dᵢ|^(p−1) sign dᵢ`. Where `p ≥ 2` the normal is a
//! differentiable function of `d`, else `d` of the normal: Newton's method turns a vector `w` with
//!
//! ```text
//! n = w |w|^(p−2),  d = w                 for p ≥ 2,
//! n = w,            d = w |w|^((2−p)/(p−1))   for p < 2,
//! ```
//!
//! where powers and products are those of components. The lengths of `n` and `d` have no meaning: both may be divided by
//! the same power of the larger component of `w`, which then has a single power to compute. The derivative of that divisor
//! would add a multiple of `Φ` to `Φ′`, and Newton's method needs none, since `Φ = 0` at the solution.

use pulp::Simd;

use super::kernel::{Sets, SlipEquation, Start};
use super::newton;
use super::vector::{Mask, Number, Pair, cross, dot, product, times};

/// Both sets.
#[derive(Debug, Clone, Copy)]
pub(super) struct Superellipses<T> {
    /// `R`.
    pub(super) to_reservoir: [Pair<T>; 2],
    /// `s` and its reciprocal.
    pub(super) exponent: T,
    pub(super) reciprocal: T,
    /// 1 where `p ≥ 2` and `w` is a force, else 0, and `w` is a normal.
    pub(super) by_force: T,
    /// `p − 2` or `(2 − p)/(p − 1)`.
    pub(super) excess: T,
}

impl Superellipses<f64> {
    /// Of the exponents of *D* and of the reservoir, to whose unit disk `to_reservoir` maps.
    pub(super) fn new(p: f64, s: f64, to_reservoir: [Pair<f64>; 2]) -> Self {
        let excess = if p >= 2.0 { p - 2.0 } else { (2.0 - p) / (p - 1.0) };
        let by_force = f64::from(u8::from(p >= 2.0));
        Self { to_reservoir, exponent: s, reciprocal: 1.0 / s, by_force, excess }
    }
}

/// The components of `|v|` by the larger one of them, which is not zero.
struct Ratios<S: Simd> {
    larger: Number<S>,
    smaller: Number<S>,
    /// Where the first component is the larger one.
    first: Mask<S>,
}

impl<S: Simd> Ratios<S> {
    #[inline(always)]
    fn new(simd: S, v: Pair<Number<S>>) -> Self {
        let (x, y) = (v[0].abs(), v[1].abs());
        let first = x.above(y);
        let (larger, least) = (first.select(x, y), Number::splat(simd, f64::MIN_POSITIVE));
        // Of zero there are zero ratios, which have powers.
        let divisor = larger.below(least).select(least, larger);
        Self { larger, smaller: first.select(y, x) / divisor, first }
    }

    /// The power of the smaller ratio, which counts as 2⁻¹⁰²² if it is less.
    #[inline(always)]
    fn power(&self, simd: S, exponent: Number<S>) -> Number<S> {
        let least = Number::splat(simd, f64::MIN_POSITIVE);
        self.smaller.below(least).select(least, self.smaller).power(exponent)
    }

    /// Both ratios to the same power, the smaller one of which is given.
    #[inline(always)]
    fn both(&self, simd: S, smaller: Number<S>) -> Pair<Number<S>> {
        let one = Number::splat(simd, 1.0);
        [self.first.select(one, smaller), self.first.select(smaller, one)]
    }
}

/// Both ratios of the components of `|v|` to a power.
#[inline(always)]
fn powers<S: Simd>(simd: S, v: Pair<Number<S>>, exponent: Number<S>) -> Pair<Number<S>> {
    let ratios = Ratios::new(simd, v);
    ratios.both(simd, ratios.power(simd, exponent))
}

impl<S: Simd> Superellipses<Number<S>> {
    /// `k` and its derivative, from the components of `R x` and of its change.
    #[inline(always)]
    fn gauge_along(
        &self,
        simd: S,
        at: Pair<Number<S>>,
        change: Pair<Number<S>>,
    ) -> (Number<S>, Number<S>) {
        let (zero, one) = (Number::splat(simd, 0.0), Number::splat(simd, 1.0));
        let ratios = Ratios::new(simd, at);
        let slope = ratios.power(simd, self.exponent - one);
        let slopes = ratios.both(simd, slope);
        let [x, y] = slopes;
        let signed = [at[0].above(zero).select(x, -x), at[1].above(zero).select(y, -y)];
        // k = M (1 + tˢ)^(1/s) of the larger component M and the ratio t.
        let sum = one + ratios.smaller * slope;
        let root = sum.power(self.reciprocal);
        (ratios.larger * root, root / sum * dot(signed, change))
    }
}

impl<S: Simd> Sets<S> for Superellipses<Number<S>> {
    type Plain = Superellipses<f64>;

    fn gather<'a>(simd: S, of: impl Fn(usize) -> &'a Superellipses<f64>) -> Self {
        let number =
            |part: fn(&Superellipses<f64>) -> f64| Number::from_fn(simd, |lane| part(of(lane)));
        let entry = |i: usize, j: usize| Number::from_fn(simd, |lane| of(lane).to_reservoir[i][j]);
        Self {
            to_reservoir: [0, 1].map(|i| [0, 1].map(|j| entry(i, j))),
            exponent: number(|sets| sets.exponent),
            reciprocal: number(|sets| sets.reciprocal),
            by_force: number(|sets| sets.by_force),
            excess: number(|sets| sets.excess),
        }
    }

    /// The gauge, or the larger component of `R x`, which takes no power.
    #[inline(always)]
    fn measure(
        &self,
        simd: S,
        force: Pair<Number<S>>,
        enough: Number<S>,
        active: Mask<S>,
    ) -> Number<S> {
        let at = product(&self.to_reservoir, force);
        let larger = Ratios::new(simd, at).larger;
        if (active & !larger.above(enough)).any() {
            return self.gauge_along(simd, at, at).0;
        }
        larger
    }

    #[inline(always)]
    fn of_gauge(gauge: Number<S>) -> Number<S> {
        gauge
    }

    /// The equation is `Φ(w) = k n × ν′ = k n × β − n × K d = 0` with `k = k(d)`.
    #[inline(always)]
    fn slip(
        &self,
        simd: S,
        equation: &SlipEquation<S>,
        from: Start<S>,
        wanted: Mask<S>,
    ) -> (Pair<Number<S>>, Mask<S>) {
        let &SlipEquation { free, resistance, size } = equation;
        let (zero, one) = (Number::splat(simd, 0.0), Number::splat(simd, 1.0));
        let rounding = newton::ROUNDING * size;
        let by_force = self.by_force.above(zero);
        let raised = one + self.excess;
        let (mut open, mut velocity, mut along) = (wanted, free, zero);
        if wanted.any() {
            // w is the direction of the start itself, or the power 1 + excess of w is.
            let back = one / raised - one;
            let to_w = by_force
                .select(from.is_normal.select(back, zero), from.is_normal.select(zero, back));
            let mut w = times(powers(simd, from.direction, to_w), from.direction);
            for iteration in 0..=newton::ITERATIONS {
                let bent = powers(simd, w, self.excess);
                let to_normal = [by_force.select(bent[0], one), by_force.select(bent[1], one)];
                let to_force = [by_force.select(one, bent[0]), by_force.select(one, bent[1])];
                let (n, d) = (times(to_normal, w), times(to_force, w));
                let (to_dn, to_dd) = (by_force.select(raised, one), by_force.select(one, raised));
                let dn = times(to_normal, [-(to_dn * w[1]), to_dn * w[0]]);
                let dd = times(to_force, [-(to_dd * w[1]), to_dd * w[0]]);
                let at = product(&self.to_reservoir, d);
                let (k, dk) = self.gauge_along(simd, at, product(&self.to_reservoir, dd));
                let force = product(&resistance, d);
                let load = cross(n, free);
                let value = k * load - cross(n, force);
                velocity = [free[0] - force[0] / k, free[1] - force[1] / k];
                along = dot(n, velocity);
                let least = rounding * rounding * (k * k * dot(n, n));
                // The comparison also keeps NaN open.
                open = wanted & !(value * value).below(least);
                if iteration == newton::ITERATIONS || !open.any() {
                    break;
                }
                let slope = dk * load + k * cross(dn, free)
                    - cross(dn, force)
                    - cross(n, product(&resistance, dd));
                w = newton::turned(simd, w, value, slope, open);
            }
        }
        (velocity, wanted & !open & along.above(zero))
    }
}

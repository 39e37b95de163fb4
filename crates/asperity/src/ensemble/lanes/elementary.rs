//! Logarithm, exponential and powers of several numbers at once, for which there are no instructions.
//!
//! Additions, multiplications, divisions and operations on bits alone, so that every lane has the bits that it would have
//! alone. Both functions have a relative error of less than four units of rounding.

use std::f64::consts::{LOG2_E, SQRT_2};

use pulp::Simd;

use super::vector::Number;

/// `ln 2` in two parts, the first of which times any exponent is exact.
const LN_2: [f64; 2] = [0.693_147_180_369_123_8, 1.908_214_929_270_587_7e-10];
/// The least argument of the exponential whose value has all its digits; that of lower ones is this one's.
const LEAST: f64 = -708.0;
const MANTISSA: u64 = (1 << 52) - 1;
const EXPONENT_OF_ONE: f64 = 1023.0;
/// A number plus this one is rounded to an integer, which the last bits of the sum are.
const INTEGERS: f64 = 6_755_399_441_055_744.0;

/// `1/(2n + 1)`, the coefficients of `atanh z/z` in powers of `z²`; for `|z| ≤ 0.172` the last one adds less than 1e-18.
const ATANH: [f64; 12] = {
    let mut coefficients = [1.0; 12];
    let mut n = 1;
    while n < coefficients.len() {
        coefficients[n] = 1.0 / (2 * n + 1) as f64;
        n += 1;
    }
    coefficients
};

/// `1/n!`; for `|x| ≤ 0.347` the last one adds less than 1e-19.
const EXP: [f64; 16] = {
    let mut coefficients = [1.0; 16];
    let mut n = 1;
    while n < coefficients.len() {
        coefficients[n] = coefficients[n - 1] / n as f64;
        n += 1;
    }
    coefficients
};

/// A polynomial with a multiple of four coefficients, by groups of four: few operations wait for each other.
#[inline(always)]
fn polynomial<S: Simd, const N: usize>(simd: S, coefficients: [f64; N], x: Number<S>) -> Number<S> {
    let square = x * x;
    let fourth = square * square;
    let term = |n: usize| Number::splat(simd, coefficients[n]);
    let two = |n: usize| term(n) + x * term(n + 1);
    let four = |n: usize| two(n) + square * two(n + 2);
    (0..N / 4 - 1).rev().fold(four(N - 4), |sum, group| four(4 * group) + fourth * sum)
}

/// The natural logarithm of normal positive numbers; what is not finite has none.
///
/// `x = 2ᵏ m` with `1/√2 < m ≤ √2`, and `ln m = 2 atanh((m − 1)/(m + 1))`.
#[inline(always)]
pub(super) fn ln<S: Simd>(simd: S, x: Number<S>) -> Number<S> {
    let one = Number::splat(simd, 1.0);
    let (two_to_52, one_bits) = (f64::to_bits((1u64 << 52) as f64), f64::to_bits(1.0));
    let biased = x.map_bits(|bits| bits >> 52 | two_to_52);
    let m = x.map_bits(|bits| bits & MANTISSA | one_bits);
    let large = m.above(Number::splat(simd, SQRT_2));
    let m = large.select(0.5 * m, m);
    let bias = (1u64 << 52) as f64 + EXPONENT_OF_ONE;
    let k = biased - large.select(Number::splat(simd, bias - 1.0), Number::splat(simd, bias));
    let z = (m - one) / (m + one);
    let of_m = (z + z) * polynomial(simd, ATANH, z * z);
    // Bits tell nothing of NaN, which this product remembers.
    LN_2[0] * k + (LN_2[1] * k + of_m + 0.0 * x)
}

/// The exponential of numbers that are not above 700.
///
/// `eˣ = 2ᵏ e^f` with the integer `k` that is nearest to `x/ln 2`.
#[inline(always)]
pub(super) fn exp<S: Simd>(simd: S, x: Number<S>) -> Number<S> {
    let least = Number::splat(simd, LEAST);
    let x = x.below(least).select(least, x);
    let shifted = LOG2_E * x + Number::splat(simd, INTEGERS + EXPONENT_OF_ONE);
    let k = shifted - Number::splat(simd, INTEGERS + EXPONENT_OF_ONE);
    let f = x - LN_2[0] * k - LN_2[1] * k;
    polynomial(simd, EXP, f) * shifted.map_bits(|bits| bits << 52)
}

/// `xᵃ` of a number from 0 to 1, with `a ≥ 0`. Below the range of numbers it is nearly zero.
#[inline(always)]
pub(super) fn power<S: Simd>(simd: S, x: Number<S>, a: Number<S>) -> Number<S> {
    let least = Number::splat(simd, f64::MIN_POSITIVE);
    exp(simd, a * ln(simd, x.below(least).select(least, x)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn apart(found: f64, expected: f64) -> f64 {
        (found - expected).abs() / (f64::EPSILON * expected.abs())
    }

    fn number(value: f64) -> Number<pulp::Scalar> {
        Number::splat(pulp::Scalar, value)
    }

    /// Those of the standard library, which are right to less than a unit in the last place.
    #[test]
    fn logarithms_and_exponentials_have_all_their_digits() {
        let mut largest = [0.0; 2];
        for k in 0..200_000 {
            let x = (700.0 * (2.0 * f64::from(k) / 2e5 - 1.0)) * (f64::from(k) * 0.1).sin();
            let e = x.exp();
            largest[0] = f64::max(largest[0], apart(exp(pulp::Scalar, number(x)).of(0), e));
            for y in [e, 1.0 + 1e-3 * x, (1.0 + f64::EPSILON * f64::from(k))] {
                if y > 0.0 && y != 1.0 {
                    let found = ln(pulp::Scalar, number(y)).of(0);
                    largest[1] = f64::max(largest[1], apart(found, y.ln()));
                }
            }
        }
        assert!(largest.iter().all(|&units| units < 4.0), "{largest:?}");
        assert!(largest.iter().all(|&units| units > 0.1), "{largest:?}");
    }

    #[test]
    fn powers_at_the_ends() {
        let power = |x: f64, a: f64| power(pulp::Scalar, number(x), number(a)).of(0);
        assert_eq!([power(1.0, 3.7), power(0.3, 0.0), power(0.0, 0.0)], [1.0; 3]);
        assert!(power(0.0, 1.5) < 1e-300 && apart(power(0.25, 0.5), 0.5) < 2.0);
        for what in [f64::NAN, f64::INFINITY] {
            assert!(ln(pulp::Scalar, number(what)).of(0).is_nan());
        }
        assert!(exp(pulp::Scalar, number(f64::NAN)).of(0).is_nan());
        assert!(exp(pulp::Scalar, number(f64::NEG_INFINITY)).of(0) < 1e-300);
    }
}

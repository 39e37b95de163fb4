//! Logarithm, exponential and powers of several numbers at once, for which there are no instructions.
//!
//! Additions, multiplications, divisions and operations on bits alone, so that every lane has the bits that it would have
//! alone. The relative errors of both functions are less than four times `f64::EPSILON`.

use std::f64::consts::{LOG2_E, SQRT_2};

use pulp::Simd;

use super::vector::Number;

/// `ln 2` in two parts, the first of which times any exponent is exact.
const LN_2: [f64; 2] = [0.693_147_180_369_123_8, 1.908_214_929_270_587_7e-10];
/// The least argument whose exponential has all its digits. Lower arguments are replaced by this one.
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
    let mut sum = Number::splat(simd, 0.0);
    let mut group = N;
    // Closures and iterators are compiled for any processor if they are not inlined.
    while group >= 4 {
        group -= 4;
        let low = Number::splat(simd, coefficients[group])
            + x * Number::splat(simd, coefficients[group + 1]);
        let high = Number::splat(simd, coefficients[group + 2])
            + x * Number::splat(simd, coefficients[group + 3]);
        sum = low + square * high + fourth * sum;
    }
    sum
}

/// The bits of 2⁵² more than the biased exponent of a number.
#[inline(always)]
fn biased_exponent(bits: u64) -> u64 {
    bits >> 52 | f64::to_bits((1u64 << 52) as f64)
}

/// The bits of a number times the power of two that brings it between one and two.
#[inline(always)]
fn significand(bits: u64) -> u64 {
    bits & MANTISSA | f64::to_bits(1.0)
}

/// The bits of the power of two whose biased exponent the last bits are.
#[inline(always)]
fn power_of_two(bits: u64) -> u64 {
    bits << 52
}

/// The natural logarithm of normal positive numbers; what is not finite has none.
///
/// `x = 2ᵏ m` with `1/√2 < m ≤ √2`, and `ln m = 2 atanh((m − 1)/(m + 1))`.
#[inline(always)]
pub(super) fn ln<S: Simd>(simd: S, x: Number<S>) -> Number<S> {
    let one = Number::splat(simd, 1.0);
    let (biased, m) = (x.map_bits(biased_exponent), x.map_bits(significand));
    let large = m.above(Number::splat(simd, SQRT_2));
    let m = large.select(0.5 * m, m);
    let bias = (1u64 << 52) as f64 + EXPONENT_OF_ONE;
    let k = biased - large.select(Number::splat(simd, bias - 1.0), Number::splat(simd, bias));
    let z = (m - one) / (m + one);
    let of_m = (z + z) * polynomial(simd, ATANH, z * z);
    // The operations on bits make a number of NaN; this product does not.
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
    polynomial(simd, EXP, f) * shifted.map_bits(power_of_two)
}

/// `xᵃ` of a number from 0 to 1, which counts as 2⁻¹⁰²² if it is less; `a ≥ −0.98`, so that the power is a number.
#[inline(always)]
pub(super) fn power<S: Simd>(simd: S, x: Number<S>, a: Number<S>) -> Number<S> {
    let least = Number::splat(simd, f64::MIN_POSITIVE);
    exp(simd, a * ln(simd, x.below(least).select(least, x)))
}

#[cfg(test)]
mod tests;

//! Numbers and truth values of several runs at once.
//!
//! Only operations that IEEE 754 rounds correctly, and powers of one number after the other: every lane has the bits that
//! it would have alone, in registers of any width. Multiplications and additions are never fused.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use pulp::{Simd, bytemuck};

/// A number of every lane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Number<S: Simd> {
    simd: S,
    value: S::f64s,
}

/// A truth value of every lane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mask<S: Simd> {
    simd: S,
    value: S::m64s,
}

/// What a vector is in the plane.
pub(super) type Pair<T> = [T; 2];

/// Most lanes of any set of instructions.
pub(super) const MOST: usize = 8;

impl<S: Simd> Number<S> {
    #[inline(always)]
    pub(super) fn splat(simd: S, value: f64) -> Self {
        Self { simd, value: simd.splat_f64s(value) }
    }

    /// The number `of(lane)` in every lane.
    #[inline(always)]
    pub(super) fn from_fn(simd: S, of: impl Fn(usize) -> f64) -> Self {
        let mut number = Self::splat(simd, 0.0);
        (0..S::F64_LANES).for_each(|lane| number.set(lane, of(lane)));
        number
    }

    #[inline(always)]
    pub(super) fn of(self, lane: usize) -> f64 {
        bytemuck::cast_slice::<_, f64>(std::slice::from_ref(&self.value))[lane]
    }

    #[inline(always)]
    pub(super) fn set(&mut self, lane: usize, value: f64) {
        bytemuck::cast_slice_mut::<_, f64>(std::slice::from_mut(&mut self.value))[lane] = value;
    }

    /// Powers, one after the other, for which there are no instructions.
    #[inline(always)]
    pub(super) fn power(mut self, exponent: Self) -> Self {
        let bases: &mut [f64] = bytemuck::cast_slice_mut(std::slice::from_mut(&mut self.value));
        let exponents: &[f64] = bytemuck::cast_slice(std::slice::from_ref(&exponent.value));
        for (base, exponent) in bases.iter_mut().zip(exponents) {
            *base = base.powf(*exponent);
        }
        self
    }

    #[inline(always)]
    pub(super) fn sqrt(self) -> Self {
        Self { value: self.simd.sqrt_f64s(self.value), ..self }
    }

    #[inline(always)]
    pub(super) fn abs(self) -> Self {
        Self { value: self.simd.abs_f64s(self.value), ..self }
    }

    #[inline(always)]
    pub(super) fn above(self, other: Self) -> Mask<S> {
        let simd = self.simd;
        Mask { simd, value: simd.greater_than_f64s(self.value, other.value) }
    }

    #[inline(always)]
    pub(super) fn below(self, other: Self) -> Mask<S> {
        other.above(self)
    }
}

macro_rules! operator {
    ($operator:ident, $method:ident, $instruction:ident) => {
        impl<S: Simd> $operator for Number<S> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self { value: self.simd.$instruction(self.value, other.value), ..self }
            }
        }
    };
}

operator!(Add, add, add_f64s);
operator!(Sub, sub, sub_f64s);
operator!(Mul, mul, mul_f64s);
operator!(Div, div, div_f64s);

impl<S: Simd> Mul<Number<S>> for f64 {
    type Output = Number<S>;

    #[inline(always)]
    fn mul(self, other: Number<S>) -> Number<S> {
        Number::splat(other.simd, self) * other
    }
}

impl<S: Simd> Neg for Number<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self::splat(self.simd, 0.0) - self
    }
}

impl<S: Simd> Mask<S> {
    /// True in the lanes whose bits are set.
    #[inline(always)]
    pub(super) fn from_bits(simd: S, bits: u32) -> Self {
        let one = Number::from_fn(simd, |lane| f64::from(bits >> lane & 1));
        one.above(Number::splat(simd, 0.0))
    }

    /// A bit for every lane.
    #[inline(always)]
    pub(super) fn bits(self) -> u32 {
        let bytes = bytemuck::bytes_of(&self.value);
        if bytes.len() == 1 {
            return if S::F64_LANES == 1 { u32::from(bytes[0] != 0) } else { u32::from(bytes[0]) };
        }
        let width = bytes.len() / S::F64_LANES;
        (0..S::F64_LANES).fold(0, |bits, lane| bits | u32::from(bytes[lane * width] & 1) << lane)
    }

    /// Whether it is true in any lane.
    #[inline(always)]
    pub(super) fn any(self) -> bool {
        bytemuck::bytes_of(&self.value).iter().fold(0, |any, byte| any | byte) != 0
    }

    /// The first numbers where it is true, else the second ones.
    #[inline(always)]
    pub(super) fn select(self, yes: Number<S>, no: Number<S>) -> Number<S> {
        let value = self.simd.select_f64s(self.value, yes.value, no.value);
        Number { simd: self.simd, value }
    }
}

impl<S: Simd> BitAnd for Mask<S> {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self { value: self.simd.and_m64s(self.value, other.value), ..self }
    }
}

impl<S: Simd> BitOr for Mask<S> {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self { value: self.simd.or_m64s(self.value, other.value), ..self }
    }
}

impl<S: Simd> Not for Mask<S> {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        Self { value: self.simd.not_m64s(self.value), ..self }
    }
}

/// A vector by its components. The iterators of `array::map` are not compiled for the wide registers.
#[inline(always)]
pub(super) fn components<T>(of: impl Fn(usize) -> T) -> Pair<T> {
    [of(0), of(1)]
}

#[inline(always)]
pub(super) fn dot<S: Simd>(a: Pair<Number<S>>, b: Pair<Number<S>>) -> Number<S> {
    a[0] * b[0] + a[1] * b[1]
}

/// The products of the components of two vectors.
#[inline(always)]
pub(super) fn times<S: Simd>(a: Pair<Number<S>>, b: Pair<Number<S>>) -> Pair<Number<S>> {
    [a[0] * b[0], a[1] * b[1]]
}

#[inline(always)]
pub(super) fn cross<S: Simd>(a: Pair<Number<S>>, b: Pair<Number<S>>) -> Number<S> {
    a[0] * b[1] - a[1] * b[0]
}

#[inline(always)]
pub(super) fn product<S: Simd>(
    matrix: &[Pair<Number<S>>; 2],
    v: Pair<Number<S>>,
) -> Pair<Number<S>> {
    [dot(matrix[0], v), dot(matrix[1], v)]
}

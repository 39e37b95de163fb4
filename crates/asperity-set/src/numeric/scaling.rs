//! Arguments of any size: those of an unusual size are divided by a power of two.

use std::ops::RangeInclusive;

use crate::{SetError, Vector};

/// Sizes of arguments that the methods of all sets take as they are: over those of sets the squares are numbers.
const USUAL: RangeInclusive<f64> = 1e-80..=1e80;

/// Whether no method of a set has trouble with the size of an argument; not for zero, nor for what is no number.
#[inline]
pub(crate) fn is_usual<const P: usize>(x: &Vector<P>) -> bool {
    let sum: f64 = x.iter().map(|v| v.abs()).sum();
    USUAL.contains(&sum)
}

/// An argument `2^exponent · unit` with the largest component of `unit` between 1 and 2.
pub(crate) struct Part<const P: usize> {
    pub(crate) unit: Vector<P>,
    pub(crate) exponent: i32,
}

impl<const P: usize> Part<P> {
    /// `None` for zero.
    #[cold]
    pub(crate) fn of(argument: &'static str, x: &Vector<P>) -> Result<Option<Self>, SetError> {
        if let Some(&value) = x.iter().find(|v| !v.is_finite()) {
            return Err(SetError::Parameter { argument, allowed: "finite", value });
        }
        let size = x.iter().fold(0.0, |size, v| f64::max(size, v.abs()));
        if size == 0.0 {
            return Ok(None);
        }
        let exponent = exponent(size);
        let unit = x.map(|v| {
            let small = shifted(v, -exponent);
            // The sign decides between the ends of a face.
            if small == 0.0 && v != 0.0 { f64::MIN_POSITIVE.copysign(v) } else { small }
        });
        Ok(Some(Self { unit, exponent }))
    }
}

/// `f` of degree one at an argument of any size.
#[cold]
pub(crate) fn homogeneous<const P: usize>(
    argument: &'static str,
    x: &Vector<P>,
    f: impl Fn(&Vector<P>) -> f64,
) -> Result<f64, SetError> {
    let Some(part) = Part::of(argument, x)? else { return Ok(0.0) };
    let value = shifted(f(&part.unit), part.exponent);
    if value.is_infinite() {
        return Err(SetError::Range { argument, excess: "large" });
    }
    Ok(value)
}

/// `f` with values of degree one, whose squares are numbers, at an argument of any size.
pub(crate) fn at_usual_size<const P: usize>(
    x: &Vector<P>,
    f: impl Fn(&Vector<P>) -> Vector<P>,
) -> Vector<P> {
    match Part::of("y", x) {
        Ok(Some(part)) if !is_usual(x) => f(&part.unit).map(|v| shifted(v, part.exponent)),
        _ => f(x),
    }
}

/// The exponent `e` of a positive number `2^e · m`, `1 ≤ m < 2`.
fn exponent(x: f64) -> i32 {
    let biased = |x: f64| (x.to_bits() >> 52 & 0x7ff) as i32 - 1023;
    // Below the normal numbers the exponent is that of the leading bit.
    if x < f64::MIN_POSITIVE { biased(x * 2f64.powi(60)) - 60 } else { biased(x) }
}

/// `x · 2^exponent`, rounded once at the most; the power itself may be beyond the range of numbers.
pub(crate) fn shifted(x: f64, exponent: i32) -> f64 {
    let half = exponent / 2;
    x * 2f64.powi(half) * 2f64.powi(exponent - half)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::SIZES;

    #[test]
    fn parts_of_any_number_are_exact() {
        for x in [5e-324, 3e-310, 2.3e-308, 1e-80, 0.75, 1.0, 3.0, 1e300, f64::MAX] {
            let part = Part::of("x", &Vector::<1>::new(-x)).unwrap().unwrap();
            assert!((1.0..2.0).contains(&-part.unit[0]), "{x}");
            assert_eq!(shifted(part.unit[0], part.exponent), -x);
        }
        // A set of the smallest size holds whatever is refused by its size.
        assert!(SIZES.start() > USUAL.start());
    }
}

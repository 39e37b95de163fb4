//! Elementary functions of lanes against those of the standard library.

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
    // That of the start of Newton's method with the largest exponents.
    assert!((power(0.0, 1.0 / 19.0 - 1.0) * f64::MIN_POSITIVE).is_finite());
    assert!(power(0.0, 1.5) < 1e-300 && apart(power(0.25, 0.5), 0.5) < 2.0);
    for what in [f64::NAN, f64::INFINITY] {
        assert!(ln(pulp::Scalar, number(what)).of(0).is_nan());
    }
    assert!(exp(pulp::Scalar, number(f64::NAN)).of(0).is_nan());
    assert!(exp(pulp::Scalar, number(f64::NEG_INFINITY)).of(0) < 1e-300);
}

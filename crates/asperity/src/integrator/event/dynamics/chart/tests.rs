//! The differential of the chart against differences.

use super::*;
use nalgebra::Rotation3;

#[test]
fn the_differential_is_that_of_the_exponential() {
    let axis = Vector3::new(0.6, -0.64, 0.48);
    let rate = Vector3::new(0.3, 1.2, -0.7);
    for scale in [0.0, 1e-6, 0.3, 2.0, 4.0] {
        let at = |s: f64| axis * scale + rate * s;
        let (turned, h) = (|s: f64| Rotation3::new(at(s)), 1e-3);
        // Central differences of fourth order.
        let slope = |f: &dyn Fn(f64) -> Matrix3<f64>| {
            (f(-2.0 * h) - f(2.0 * h) + (f(h) - f(-h)) * 8.0) / (12.0 * h)
        };
        let spin = turned(0.0).matrix().tr_mul(&slope(&|s| *turned(s).matrix()));
        let omega = differential(&at(0.0)) * rate;
        assert!((spin - omega.cross_matrix()).amax() < 1e-10, "{scale}");
        let change = slope(&|s| differential(&at(s))) * rate;
        let rate = differential_rate(&at(0.0), &rate);
        assert!((change - rate).amax() < 1e-10, "{scale}: {change} {rate}");
    }
}

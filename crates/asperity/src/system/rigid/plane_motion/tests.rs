//! The angular velocity in the plane against the exponential.

use super::*;

#[test]
fn the_angular_velocity_is_that_of_the_exponential() {
    let (axis, rate) = (Vector3::new(0.6, -0.64, 0.48), Vector3::new(0.3, 1.2, -0.7));
    for scale in [0.0, 1e-6, 0.3, 0.499, 0.501, 2.0, 40.0] {
        let at = |s: f64| *Rotation3::new(axis * scale + rate * s).matrix();
        let h = 1e-3;
        let slope = (at(-2.0 * h) - at(2.0 * h) + (at(h) - at(-h)) * 8.0) / (12.0 * h);
        let spin = slope * at(0.0).transpose();
        let omega = angular_velocity(&(axis * scale), &rate);
        assert!((spin - omega.cross_matrix()).amax() < 1e-10, "{scale}");
    }
}

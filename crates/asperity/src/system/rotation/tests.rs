//! Quaternions against rotation matrices.

use super::*;
use nalgebra::Rotation3;

#[test]
fn quaternions_agree_with_rotation_matrices() {
    let start = normalized([0.3, -0.2, 0.9, 0.1]);
    for scale in [0.0, 1e-9, 1e-3, 0.4, 0.999, 1.001, 3.0, 40.0] {
        let angle = Vector3::new(0.6, -0.64, 0.48) * scale;
        let expected = matrix(&start) * Rotation3::new(angle).matrix();
        let end = turned(&start, &angle);
        assert!((matrix(&end) - expected).amax() < 4e-15, "turned by {scale}");
        let v = Vector3::new(0.3, -1.2, 0.7);
        let back = Rotation3::new(-angle) * v;
        assert!((turned_back(&angle, &v) - back).amax() < 4e-15, "turned back by {scale}");
        assert!((end.iter().map(|c| c * c).sum::<f64>() - 1.0).abs() < 4e-16);
    }
}

#[test]
fn the_differential_is_that_of_rotated_vectors() {
    for scale in [0.0, 1e-6, 0.09, 0.11, 1.0, 3.0, 5.0, 40.0] {
        let angle = Vector3::new(0.6, -0.64, 0.48) * scale;
        let (change, v) = (Vector3::new(0.5, 0.3, -0.8), Vector3::new(0.3, -1.2, 0.7));
        let turned = |angle: Vector3<f64>| turned_back(&-angle, &v);
        let differences = (turned(angle + change * 1e-5) - turned(angle - change * 1e-5)) / 2e-5;
        let found = (differential(&angle) * change).cross(&turned(angle));
        assert!((found - differences).amax() < 1e-8, "turned by {scale}");
    }
}

#[test]
fn quaternions_of_any_length_but_zero_become_unit_ones() {
    let start = normalized([0.3, -0.2, 0.9, 0.1]);
    assert_eq!(unit(start), Some(start));
    for scale in [1e-200, 0.5, 3.0, 1e200] {
        let end = unit(start.map(|c| c * scale)).unwrap();
        assert!(end.iter().zip(&start).all(|(a, b)| (a - b).abs() < 1e-15), "scaled by {scale}");
    }
    assert_eq!(unit([0.0; 4]), None);
}

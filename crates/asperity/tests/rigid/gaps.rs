//! Bounds on the second derivatives of gaps, against differences.

use asperity::law::FrictionLaw;
use asperity::system::rigid::{Pair, PlanarBody, Plane, RigidBodies, Shape};
use asperity::system::{Configuration, MotionBounds, System};

use crate::common::random::random;

/// Two planar bodies, the second of which carries a line or a disk.
fn system(shape: Shape) -> RigidBodies {
    let bodies = vec![PlanarBody::new(1.0, 0.1), PlanarBody::new(2.0, 0.3)];
    let pair = Pair::new(shape, FrictionLaw::<1>::isotropic(0.3).unwrap());
    RigidBodies::new(bodies, &[pair], vec![], [0.0; 3]).unwrap()
}

#[test]
fn no_gap_bends_more_than_its_bound() {
    let (duration, h) = (0.1, 1e-4);
    let mut seed = 5;
    let mut places = |scale: f64| [scale * random(&mut seed), scale * random(&mut seed)];
    let mut closest: f64 = 0.0;
    for case in 0..3000 {
        let ([x, y], [a, b]) = (places(0.5), places(0.5));
        let on_body = Plane { body: Some(1), ..Plane::line([a, b], [a + 0.6, b]) };
        let shape = match case % 3 {
            0 => Shape::PointPlane {
                body: 0,
                point: [x, y, 0.0],
                plane: Plane::line([a, b], [b, 1.0]),
            },
            1 => Shape::SpherePlane { body: 0, centre: [x, y, 0.0], radius: 0.1, plane: on_body },
            _ => Shape::SphereSphere {
                body: 0,
                centre: [x, y, 0.0],
                radius: 0.1,
                other: 1,
                other_centre: [a, b, 0.0],
                other_radius: 0.2,
            },
        };
        let system = system(shape);
        let mut six = |scale: f64| [places(scale), places(scale), places(scale)].concat();
        let (q0, u0, rates) = (six(2.0), six(5.0), six(20.0));
        let at = |t: f64| -> Vec<f64> {
            (0..6).map(|k| q0[k] + t * u0[k] + 0.5 * t * t * rates[k]).collect()
        };
        let gap = |t: f64| system.gap(&Configuration::new(t, &at(t)), 0).unwrap();
        let bounds = MotionBounds {
            duration,
            velocities: (0..6).map(|k| u0[k].abs() + duration * rates[k].abs()).collect(),
            accelerations: rates.iter().map(|rate| rate.abs()).collect(),
        };
        let bound = system.gap_acceleration(&Configuration::new(0.0, &q0), 0, &bounds).unwrap();
        for k in 0..20 {
            let t = duration * f64::from(k) / 20.0 + h;
            if gap(t) < 0.0 {
                break; // The bound is one while nothing overlaps.
            }
            let bend = ((gap(t + h) - 2.0 * gap(t) + gap(t - h)) / (h * h)).abs();
            assert!(bend <= bound + 1e-5, "{case}: {bend} {bound}");
            closest = closest.max(bend / bound);
        }
    }
    assert!(closest > 0.5, "{closest}");
}

//! Laws with drilling friction: a third slip `R ω_N`.

use std::f64::consts::PI;

use asperity::law::FrictionLaw;
use asperity::set::Vector;
use asperity::set::{Convex, CoulombContensou, Pressure};
use asperity::system::rigid::{Body, Pair, Plane, RigidBodies, Shape};

use crate::support::*;

const MU: f64 = 0.4;
const PATCH: f64 = 0.03;

fn law(pressure: Pressure) -> FrictionLaw<3> {
    let set = CoulombContensou::new(MU, pressure).unwrap();
    FrictionLaw::associated(Convex::from(set))
}

fn spinning(pressure: Pressure, velocity: f64, spin: f64, plane: Plane) -> RigidBodies {
    let body = Body {
        velocity: [velocity, 0.0, 0.0],
        angular_velocity: [0.0, 0.0, spin],
        ..Body::new(0.5, [0.001, 0.001, 0.0015])
    };
    let shape = Shape::PointPlane { body: 0, point: [0.0; 3], plane };
    let pair = Pair { patch_radius: Some(PATCH), ..Pair::new(shape, law(pressure)) };
    RigidBodies::new(vec![body], &[pair], vec![], [0.0, 0.0, -G]).unwrap()
}

/// On the spot it stops after `Jω/τ`, with `τ = ⅔ μNR` or `3π/16 μNR`.
#[test]
fn a_spinning_disk_stops_in_time() {
    let (j, omega, dt) = (0.0015, 10.0, 1e-4);
    for (pressure, factor) in [(Pressure::Uniform, 2.0 / 3.0), (Pressure::Hertz, 3.0 * PI / 16.0)] {
        let system = spinning(pressure, 0.0, omega, Plane::floor());
        let mut stops = f64::NAN;
        run(&system, dt, 1.0, |s| {
            if stops.is_nan() && s.u()[5].abs() < 1e-9 {
                stops = s.time();
            }
        });
        let torque = factor * MU * 0.5 * G * PATCH;
        assert!((stops - j * omega / torque).abs() < 2.0 * dt, "{pressure:?}: {stops}");
    }
}

/// While it slides and drills both end at the same time; against Heun's method with the law's force.
#[test]
fn a_sliding_disk_stops_to_spin_and_slide_together() {
    let system = spinning(Pressure::Hertz, 0.6, 30.0, Plane::floor());
    let law = law(Pressure::Hertz);
    let rate = |v: f64, w: f64| {
        let force = law.force(&Vector::<3>::new(v, 0.0, PATCH * w), 0.5 * G).unwrap();
        (force[0] / 0.5, force[2] * PATCH / 0.0015)
    };
    let (mut v, mut w, h) = (0.6, 30.0, 1e-5);
    let error = |dt: f64, v: f64, w: f64| {
        let u = run(&system, dt, 0.1, |_| {}).u;
        assert!(u[1].abs() < 1e-12);
        ((u[0] - v) / 0.6).hypot((u[5] - w) / 30.0)
    };
    for _ in 0..10_000 {
        let a = rate(v, w);
        let b = rate(v + h * a.0, w + h * a.1);
        v += 0.5 * h * (a.0 + b.0);
        w += 0.5 * h * (a.1 + b.1);
    }
    let errors = [error(1e-3, v, w), error(5e-4, v, w)];
    assert!(errors[1] < 1e-3 && order(errors) > 0.8, "{errors:?}");
}

/// A turntable takes a body on its axis along.
#[test]
fn a_turntable_spins_a_disk_up() {
    let table = Plane { spin: 5.0.into(), ..Plane::floor() };
    let system = spinning(Pressure::Uniform, 0.0, 0.0, table);
    let state = run(&system, 1e-3, 1.0, |_| {});
    assert!((state.u[5] - 5.0).abs() < 1e-9, "{:?}", state.u);
}

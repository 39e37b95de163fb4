//! Points that stick stay where they are, on bodies that turn and on surfaces that move.

use asperity::contact::Phase;
use asperity::system::rigid::{Body, Pair, Plane, RigidBodies, Shape};
use nalgebra::{Rotation3, Vector3};

use crate::support::*;

/// A plate of unequal moments on three points, and a point mass, both carried by a turntable.
fn turntable(spin: f64, r: f64, feet: &[[f64; 3]], load: f64) -> RigidBodies {
    let body = Body {
        position: [r, 0.0, -feet[0][2]],
        velocity: [0.0, spin * r, 0.0],
        angular_velocity: [0.0, 0.0, spin],
        force: [0.0, 0.0, -load],
        inertia: [[2e-4, 1e-5, 2e-5], [1e-5, 3e-4, -3e-5], [2e-5, -3e-5, 4e-4]],
        ..Body::new(1.0, [1.0; 3])
    };
    let plane = Plane { spin, ..Plane::floor() };
    let pair =
        |&point: &[f64; 3]| Pair::new(Shape::PointPlane { body: 0, point, plane }, disk(2.0));
    let pairs: Vec<Pair> = feet.iter().map(pair).collect();
    RigidBodies::new(vec![body], &pairs, vec![], [0.0, 0.0, -G]).unwrap()
}

const FEET: [[f64; 3]; 3] = [[0.03, 0.0, -0.01], [-0.02, 0.02, -0.01], [-0.01, -0.03, -0.01]];

/// The largest way of a foot from where the table has carried it since the first step: the half step at the beginning
/// goes along the tangent, which costs an angle of `(Δt spin)³/24` once.
fn drift(system: &RigidBodies, spin: f64, feet: &[[f64; 3]], (dt, steps): (f64, usize)) -> f64 {
    let mut stepper = stepper(system, dt);
    let place = |q: &[f64], foot: &[f64; 3]| system.pose(q, 0).point(&Vector3::from(*foot));
    stepper.step().unwrap();
    let start: Vec<_> = feet.iter().map(|foot| place(stepper.q(), foot)).collect();
    let mut largest = 0.0_f64;
    for step in 1..=steps {
        stepper.step().unwrap();
        if step % 1000 == 0 || step == steps {
            let angle = (spin * dt * step as f64).rem_euclid(std::f64::consts::TAU);
            let turned = Rotation3::from_axis_angle(&Vector3::z_axis(), angle);
            for (foot, start) in feet.iter().zip(&start) {
                largest = largest.max((place(stepper.q(), foot) - turned * start).norm());
            }
        }
    }
    assert!((0..feet.len()).all(|i| stepper.phase(i) == Phase::Stick));
    largest
}

#[test]
fn feet_stick_on_a_turntable() {
    let tau = std::f64::consts::TAU;
    for (spin, r, load, steps) in
        [(20.0 * tau, 0.001, 100.0, 500_000), (tau, 0.3, 0.0, 1_000_000), (2.0, 0.3, 0.0, 100_000)]
    {
        let system = turntable(spin, r, &FEET, load);
        let d = drift(&system, spin, &FEET, (1e-3, steps));
        println!("three feet, spin {spin}: {d:e}");
        let foot = [[0.0; 3]];
        let system = turntable(spin, r, &foot, load);
        let d = drift(&system, spin, &foot, (1e-3, steps));
        println!("one foot, spin {spin}: {d:e}");
    }
}

/// A top whose foot sticks.
fn top(moments: [f64; 3], omega: [f64; 3], tilt: f64) -> RigidBodies {
    let (s, c) = (0.5 * tilt).sin_cos();
    let foot = [0.0, 0.0, -0.1];
    let rotation = Rotation3::new(Vector3::new(tilt, 0.0, 0.0));
    let arm = rotation * Vector3::from(foot);
    let velocity = -(rotation * Vector3::from(omega)).cross(&arm);
    let body = Body {
        position: (-arm).into(),
        orientation: [c, s, 0.0, 0.0],
        velocity: velocity.into(),
        angular_velocity: omega,
        ..Body::new(1.0, moments)
    };
    let pair =
        Pair::new(Shape::PointPlane { body: 0, point: foot, plane: Plane::floor() }, disk(100.0));
    RigidBodies::new(vec![body], &[pair], vec![], [0.0, 0.0, -G]).unwrap()
}

#[test]
fn tops() {
    for (moments, omega) in [
        ([2e-3; 3], [1.0, 0.5, 30.0]),
        ([2e-3, 2e-3, 1e-3], [1.0, 0.5, 50.0]),
        ([2e-3, 1.5e-3, 1e-3], [1.0, 0.5, 50.0]),
        ([2e-3, 1.5e-3, 1e-3], [2.0, 1.0, 0.5]),
    ] {
        let system = top(moments, omega, 0.3);
        for dt in [4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4] {
            let (mut d, mut z, mut open, mut e) = (0.0_f64, 0.0_f64, 0, 0.0_f64);
            let e0 = energy(&system, system.q0(), system.u0());
            let mut stepper = stepper(&system, dt);
            while stepper.time() < 0.5 - 1e-9 {
                stepper.step().unwrap();
                let p = system.pose(stepper.q(), 0).point(&Vector3::new(0.0, 0.0, -0.1));
                d = d.max(p.xy().norm());
                z = z.max(p.z.abs());
                open += usize::from(stepper.phase(0) != Phase::Stick);
                e = e.max((energy(&system, stepper.q(), stepper.u()) - e0).abs());
            }
            println!(
                "{omega:?} {dt}: drift {d:e} height {z:e} not sticking {open} energy {e:e} of {e0} {:?}",
                &stepper.q()[..3]
            );
        }
    }
}

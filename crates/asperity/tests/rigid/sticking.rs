//! Points that stick stay where they are, on bodies that turn and on surfaces that move.

use asperity::contact::Phase;
use asperity::stepper::Stepper;
use asperity::system::rigid::{Body, Pair, Plane, RigidBodies, Shape};
use nalgebra::{Rotation3, UnitQuaternion, Vector3};

use crate::support::*;

const TURN: f64 = std::f64::consts::TAU;

/// Three points of a plate, and one below the centre of mass, where nothing tips a body.
const FEET: [[f64; 3]; 3] = [[0.03, 0.0, -0.01], [-0.02, 0.02, -0.01], [-0.01, -0.03, -0.01]];
const FOOT: [[f64; 3]; 1] = [[0.0; 3]];

/// A body of unequal moments about skew axes, carried by a turntable and pressed onto it.
fn rider(spin: f64, radius: f64, feet: &[[f64; 3]], load: f64) -> RigidBodies {
    let body = Body {
        position: [radius, 0.0, -feet[0][2]],
        velocity: [0.0, spin * radius, 0.0],
        angular_velocity: [0.0, 0.0, spin],
        force: [0.0, 0.0, -load].into(),
        inertia: [[2e-4, 1e-5, 2e-5], [1e-5, 3e-4, -3e-5], [2e-5, -3e-5, 4e-4]],
        ..Body::new(1.0, [1.0; 3])
    };
    let plane = Plane { spin: spin.into(), ..Plane::floor() };
    let pair = |&point: &[f64; 3]| {
        Pair::new(Shape::PointPlane { body: 0, point, plane: plane.clone() }, disk(2.0))
    };
    let pairs: Vec<Pair> = feet.iter().map(pair).collect();
    RigidBodies::new(vec![body], &pairs, vec![], [0.0, 0.0, -G]).unwrap()
}

fn place(system: &RigidBodies, stepper: &Stepper<'_>, point: &[f64; 3]) -> Vector3<f64> {
    system.pose(stepper.q(), 0).unwrap().point(&Vector3::from(*point))
}

/// The largest way of a foot in `steps` of a millisecond from where the table has carried it since the first one: the
/// half step at the beginning goes along the tangent, which costs an angle of `(Δt spin)³/24` once.
fn drift(spin: f64, radius: f64, feet: &[[f64; 3]], load: f64, steps: usize) -> f64 {
    let (system, dt) = (rider(spin, radius, feet, load), 1e-3);
    let mut stepper = stepper(&system, dt);
    stepper.step().unwrap();
    let start: Vec<_> = feet.iter().map(|foot| place(&system, &stepper, foot)).collect();
    let mut largest = 0.0_f64;
    for step in 1..=steps {
        stepper.step().unwrap();
        if step % 1000 == 0 || step == steps {
            let angle = (spin * dt * step as f64).rem_euclid(TURN);
            let turned = Rotation3::from_axis_angle(&Vector3::z_axis(), angle);
            for (foot, start) in feet.iter().zip(&start) {
                largest = largest.max((place(&system, &stepper, foot) - turned * start).norm());
            }
        }
    }
    assert!((0..feet.len()).all(|i| stepper.phase(i) == Phase::Stick));
    largest
}

#[test]
fn feet_stick_on_a_turntable() {
    for (spin, radius, load) in [(20.0 * TURN, 0.001, 100.0), (TURN, 0.3, 0.0)] {
        for feet in [&FEET[..], &FOOT] {
            let drift = drift(spin, radius, feet, load, 10_000);
            assert!(drift < 1e-12, "{} feet, {spin} rad/s: {drift:e}", feet.len());
        }
    }
}

/// Ten thousand turns.
#[test]
#[ignore = "minutes: part of `make long`"]
fn feet_stick_on_a_turntable_for_long() {
    for (spin, radius, load, steps) in
        [(20.0 * TURN, 0.001, 100.0, 500_000), (TURN, 0.3, 0.0, 10_000_000)]
    {
        for feet in [&FEET[..], &FOOT] {
            let drift = drift(spin, radius, feet, load, steps);
            println!("{} feet, {spin} rad/s: {drift:e}", feet.len());
            assert!(drift < 1e-10, "{} feet, {spin} rad/s: {drift:e}", feet.len());
        }
    }
}

const TIP: [f64; 3] = [0.0, 0.0, -0.1];

/// A top that turns about its tip.
fn top(moments: [f64; 3], omega: [f64; 3]) -> RigidBodies {
    let rotation = UnitQuaternion::from_scaled_axis(Vector3::new(0.3, 0.0, 0.0));
    let arm = rotation * -Vector3::from(TIP);
    let body = Body {
        position: arm.into(),
        orientation: [rotation.w, rotation.i, rotation.j, rotation.k],
        velocity: (rotation * Vector3::from(omega)).cross(&arm).into(),
        angular_velocity: omega,
        ..Body::new(1.0, moments)
    };
    let shape = Shape::PointPlane { body: 0, point: TIP, plane: Plane::floor() };
    let pair = Pair::new(shape, disk(100.0));
    RigidBodies::new(vec![body], &[pair], vec![], [0.0, 0.0, -G]).unwrap()
}

/// The tip moves, and energy changes, with the square of the step where Ω changes from step to step.
#[test]
fn the_tip_of_a_top_stays_to_second_order() {
    for (moments, omega) in [([2e-3; 3], [1.0, 0.5, 30.0]), ([2e-3, 2e-3, 1e-3], [1.0, 0.5, 50.0])]
    {
        let system = top(moments, omega);
        let start = energy(&system, system.q0(), system.u0());
        let errors = |dt: f64| {
            let (mut way, mut gain) = (0.0_f64, 0.0_f64);
            run(&system, dt, 0.3, |stepper| {
                way = way.max(place(&system, stepper, &TIP).norm());
                gain = gain.max((energy(&system, stepper.q(), stepper.u()) - start).abs());
            });
            [way, gain]
        };
        let (coarse, fine) = (errors(1e-3), errors(5e-4));
        for k in 0..2 {
            let order = order([coarse[k], fine[k]]);
            assert!(order > 1.9, "{k}: order {order}, {coarse:?} {fine:?}");
        }
        assert!(fine[0] < 5e-5, "{fine:?}");
    }
}

/// A ball rolls on a turntable along a circle, at 2/7 of its spin (Earnshaw). In the world's frame nothing but the place
/// of the contact point tells that the table turns.
#[test]
fn a_ball_rolls_on_a_turntable_in_circles() {
    let (spin, radius, v) = (3.0, 0.05, 0.4);
    // The slip vanishes at the beginning: v − R ω_y = −spin y, R ω_x + v_y = spin x.
    let body = Body {
        position: [0.2, 0.1, radius],
        velocity: [v, 0.0, 0.0],
        angular_velocity: [spin * 0.2 / radius, (v + spin * 0.1) / radius, 0.7],
        ..Body::ball(0.3, radius)
    };
    let table = Plane { spin: spin.into(), ..Plane::floor() };
    let pair = Pair::new(sphere(0, radius, table), disk(5.0));
    let system = RigidBodies::new(vec![body], &[pair], vec![], [0.0, 0.0, -G]).unwrap();
    let rate = 2.0 / 7.0 * spin;
    let error = |dt: f64| {
        let mut error = 0.0_f64;
        run(&system, dt, 5.0, |stepper| {
            assert_eq!(stepper.phase(0), Phase::Stick);
            let (sine, cosine) = (rate * stepper.time()).sin_cos();
            let x =
                Vector3::new(0.2, 0.1, radius) + Vector3::new(sine, 1.0 - cosine, 0.0) * v / rate;
            let q = Vector3::from_column_slice(&stepper.q()[..3]);
            error = error.max((q - x).norm());
        });
        error
    };
    let errors = [error(4e-3), error(2e-3)];
    assert!(order(errors) > 1.9 && errors[1] < 1e-4, "{errors:?}");
}

/// A dumbbell of two balls, the second of which is held by friction: they turn as one body, and its plane carries
/// a foot of a third body likewise.
#[test]
fn bodies_that_stick_together_turn_as_one() {
    let (spin, half) = (4.0, [0.3, 0.3, 0.02]);
    let disc = Body { angular_velocity: [0.0, 0.0, spin], ..Body::cuboid(50.0, half) };
    let rides = |x: f64| Body {
        position: [x, 0.0, 0.03],
        velocity: [0.0, spin * x, 0.0],
        angular_velocity: [0.0, 0.0, spin],
        ..Body::cuboid(0.1, [0.02; 3])
    };
    let top = Plane { point: [0.0, 0.0, 0.02], body: Some(0), ..Plane::floor() };
    let held = Plane::new([0.0, 0.0, -0.02], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    let foot =
        |body, point| Pair::new(Shape::PointPlane { body, point, plane: top.clone() }, disk(2.0));
    let mut pairs: Vec<Pair> = [[0.2, 0.2], [-0.2, 0.2], [0.0, -0.25]]
        .map(|[x, y]| {
            let shape = Shape::PointPlane { body: 0, point: [x, y, -0.02], plane: held.clone() };
            Pair::new(shape, disk(1e-9))
        })
        .to_vec();
    for body in [1, 2] {
        pairs.extend(FEET.map(|point| foot(body, point)));
    }
    let bodies = vec![disc, rides(0.2), rides(-0.2)];
    let system = RigidBodies::new(bodies, &pairs, vec![], [0.0, 0.0, -G]).unwrap();
    let apart = |q: &[f64]| {
        let (disc, rider) = (system.pose(q, 0).unwrap(), system.pose(q, 1).unwrap());
        disc.rotation.tr_mul(&(rider.position - disc.position))
    };
    let mut first = None;
    run(&system, 1e-3, 5.0, |stepper| {
        let start = *first.get_or_insert_with(|| apart(stepper.q()));
        let way = (apart(stepper.q()) - start).norm();
        assert!(way < 1e-11, "{way:e} at t = {}", stepper.time());
    });
}

/// What slides and spins on three feet loses energy in every step.
#[test]
fn sliding_and_spinning_feet_lose_energy() {
    let body = Body {
        position: [0.0, 0.0, 0.01],
        velocity: [0.5, 0.2, 0.0],
        angular_velocity: [0.0, 0.0, 40.0],
        ..Body::cuboid(1.0, [0.05, 0.03, 0.01])
    };
    let pair = |point| {
        let shape = Shape::PointPlane { body: 0, point, plane: Plane::floor() };
        Pair::new(shape, disk(0.3))
    };
    let system = RigidBodies::new(vec![body], &FEET.map(pair), vec![], [0.0, 0.0, -G]).unwrap();
    let mut before = energy(&system, system.q0(), system.u0());
    run(&system, 1e-3, 1.0, |stepper| {
        let now = energy(&system, stepper.q(), stepper.u());
        assert!(now <= before + 1e-15, "{} J more at t = {}", now - before, stepper.time());
        before = now;
    });
    assert!(before < 1e-1);
}

/// A run that goes on from a state equals the one that was not interrupted, to the bit.
#[test]
fn a_run_on_a_turntable_goes_on() {
    let system = rider(TURN, 0.3, &FEET, 0.0);
    let mut whole = stepper(&system, 1e-3);
    run_on(&mut whole, 0.05, &mut |_| {});
    let mut part = Stepper::new(&system, EXACT, 1e-12, 1e-3, &whole.state()).unwrap();
    for _ in 0..50 {
        whole.step().unwrap();
        part.step().unwrap();
        assert_eq!((whole.q(), whole.u()), (part.q(), part.u()));
    }
}

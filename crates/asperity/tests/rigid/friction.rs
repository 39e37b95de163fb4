//! Sliding, sticking, moving surfaces.

use asperity::contact::Phase;
use asperity::system::rigid::{Body, Pair, PlanarBody, Plane, RigidBodies, Shape};

use crate::support::*;

const GRAVITY: [f64; 3] = [0.0, 0.0, -G];

fn point(body: usize, plane: Plane) -> Shape {
    Shape::PointPlane { body, point: [0.0; 3], plane }
}

/// `t = v₀/(μg)`, `d = v₀²/(2μg)`.
#[test]
fn a_block_slides_to_a_stop() {
    let (v, mu) = (2.0, 0.3);
    let spatial = Body { velocity: [1.2, 1.6, 0.0], ..Body::new(0.7, [0.1, 0.2, 0.25]) };
    let planar = PlanarBody { velocity: [v, 0.0], ..PlanarBody::new(0.7, 0.1) };
    let floor = Pair::new(point(0, Plane::floor()), disk(mu));
    let line = Pair::new(point(0, ground()), line(mu));
    for system in [
        RigidBodies::new(vec![spatial], &[floor], vec![], GRAVITY).unwrap(),
        RigidBodies::new(vec![planar], &[line], vec![], [0.0, -G, 0.0]).unwrap(),
    ] {
        let dt = 1e-3;
        let mut stopped = f64::NAN;
        let state = run(&system, dt, 1.0, |s| {
            if stopped.is_nan() && s.phase(0) == Phase::Stick {
                stopped = s.time();
            }
        });
        assert!((stopped - v / (mu * G)).abs() < 2.0 * dt, "{stopped}");
        let distance = state.q[0].hypot(if system.is_planar() { 0.0 } else { state.q[1] });
        assert!((distance - v * v / (2.0 * mu * G)).abs() < 1e-3 * dt, "{distance}");
        assert!(state.u.iter().all(|u| u.abs() < 1e-14));
    }
}

/// Below the friction angle a box stays where it is, for a minute.
#[test]
fn a_box_rests_on_an_incline() {
    let (angle, half) = (0.3_f64, [0.1, 0.07, 0.05]);
    let (s, c) = angle.sin_cos();
    // Turned about y, the centre of mass above the incline through the origin.
    let body = Body {
        position: [half[2] * s, 0.0, half[2] * c],
        orientation: [(0.5 * angle).cos(), 0.0, (0.5 * angle).sin(), 0.0],
        ..Body::cuboid(3.0, half)
    };
    let plane = Plane::new([0.0; 3], [s, 0.0, c], [c, 0.0, -s]);
    let shape = Shape::BoxPlane { body: 0, half_sizes: half, plane };
    let system =
        RigidBodies::new(vec![body], &[Pair::new(shape, disk(0.4))], vec![], GRAVITY).unwrap();
    for dt in [1e-3, 1e-2] {
        let mut drift = 0.0_f64;
        run(&system, dt, 60.0, |stepper| {
            let moved = stepper.q().iter().zip(system.q0()).map(|(q, q0)| (q - q0).abs());
            drift = drift.max(moved.fold(0.0, f64::max));
        });
        assert!(drift < 1e-12, "dt = {dt}: {drift:e}");
    }
}

/// Above the friction angle it slides with `g (sin − μ cos)`.
#[test]
fn a_box_slides_down_an_incline() {
    let (angle, half, mu) = (0.5_f64, [0.1, 0.07, 0.02], 0.3);
    let (s, c) = angle.sin_cos();
    let body = Body {
        position: [half[2] * s, 0.0, half[2] * c],
        orientation: [(0.5 * angle).cos(), 0.0, (0.5 * angle).sin(), 0.0],
        ..Body::cuboid(3.0, half)
    };
    let plane = Plane::new([0.0; 3], [s, 0.0, c], [c, 0.0, -s]);
    let shape = Shape::BoxPlane { body: 0, half_sizes: half, plane };
    let system =
        RigidBodies::new(vec![body], &[Pair::new(shape, disk(mu))], vec![], GRAVITY).unwrap();
    let state = run(&system, 1e-3, 1.0, |_| {});
    let speed = state.u[0] * c - state.u[2] * s;
    assert!((speed - G * (s - mu * c)).abs() < 1e-9, "{speed}");
}

/// A belt carries a body along; a turntable too, while friction can hold it on its circle.
#[test]
fn moving_surfaces_carry_bodies_along() {
    let body = Body { position: [0.2, 0.0, 0.0], ..Body::new(1.0, [0.1; 3]) };
    let belt = Plane { velocity: [0.5, 0.2].into(), ..Plane::floor() };
    let law = Pair::new(point(0, belt), disk(0.4));
    let system = RigidBodies::new(vec![body.clone()], &[law], vec![], GRAVITY).unwrap();
    let mut sticks = f64::NAN;
    let state = run(&system, 1e-3, 1.0, |s| {
        if sticks.is_nan() && s.phase(0) == Phase::Stick {
            sticks = s.time();
        }
    });
    assert!((sticks - 0.5_f64.hypot(0.2) / (0.4 * G)).abs() < 2e-3, "{sticks}");
    assert!((state.u[0] - 0.5).abs() < 1e-12 && (state.u[1] - 0.2).abs() < 1e-12);

    // ω²r = .8 < μg: it stays on its circle once it has the speed.
    let table = Plane { spin: 2.0.into(), ..Plane::floor() };
    let body = Body { velocity: [0.0, 0.4, 0.0], ..body };
    let law = Pair::new(point(0, table.clone()), disk(0.4));
    let system = RigidBodies::new(vec![body.clone()], &[law], vec![], GRAVITY).unwrap();
    let radius = |dt: f64| {
        let state = run(&system, dt, 3.0, |s| assert_eq!(s.phase(0), Phase::Stick));
        let (x, y) = (state.q[0], state.q[1]);
        assert!((y.atan2(x) - 6.0_f64.sin().atan2(6.0_f64.cos())).abs() < 20.0 * dt);
        (x.hypot(y) - 0.2).abs()
    };
    let errors = [radius(1e-3), radius(5e-4)];
    assert!(errors[1] < 1e-3, "{errors:?}");
    // With too little friction it leaves.
    let law = Pair::new(point(0, table), disk(0.05));
    let system = RigidBodies::new(vec![body], &[law], vec![], GRAVITY).unwrap();
    let state = run(&system, 1e-3, 1.0, |_| {});
    assert!(state.q[0].hypot(state.q[1]) > 0.3);
}

/// A block on a plank that slides on a smooth floor: momentum goes from one to the other.
#[test]
fn a_plane_may_belong_to_a_body() {
    let half = [1.0, 0.5, 0.05];
    let plank =
        Body { position: [0.0, 0.0, 0.05], velocity: [1.0, 0.0, 0.0], ..Body::cuboid(2.0, half) };
    let load = Body { position: [0.0, 0.0, 0.1], ..Body::new(1.0, [1.0; 3]) };
    let top = Plane { point: [0.0, 0.0, 0.05], body: Some(0), ..Plane::floor() };
    let bottom = Shape::BoxPlane { body: 0, half_sizes: half, plane: Plane::floor() };
    let pairs = [Pair::new(point(1, top), disk(0.2)), Pair::new(bottom, disk(1e-12))];
    let system = RigidBodies::new(vec![plank, load], &pairs, vec![], GRAVITY).unwrap();
    let mut stops = f64::NAN;
    let state = run(&system, 1e-3, 1.0, |s| {
        if stops.is_nan() && s.phase(0) == Phase::Stick {
            stops = s.time();
        }
    });
    for body in 0..2 {
        assert!((state.u[6 * body] - 2.0 / 3.0).abs() < 1e-9, "{:?}", state.u);
    }
    // Relative deceleration μg(1 + m/M).
    assert!((stops - 1.0 / (0.2 * G * 1.5)).abs() < 2e-3, "{stops}");
}

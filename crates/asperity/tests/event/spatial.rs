//! Bodies that turn in space against closed forms, invariants and time stepping.

use asperity::event::{EventKind, Motion, Options, Outcome, integrate};
use asperity::law::FrictionLaw;
use asperity::set::{Convex, Ellipse, Vector};
use asperity::simulate;
use asperity::system::rigid::{Body, Pair, Plane, RigidBodies, Shape};
use nalgebra::{Matrix3, Rotation3, Vector3};

use crate::support::*;

const G: f64 = 9.81;

fn disk(mu: f64) -> FrictionLaw<2> {
    FrictionLaw::isotropic(mu).unwrap()
}

fn own_start(system: &RigidBodies, t_end: f64) -> Options {
    options(system.q0(), system.u0(), t_end)
}

/// Coordinates and velocities of a sample.
fn sample(motion: &Motion, k: usize) -> (&[f64], &[f64]) {
    let (n, m) = (motion.samples.coordinates, motion.samples.dof);
    (&motion.samples.q[k * n..(k + 1) * n], &motion.samples.u[k * m..(k + 1) * m])
}

/// Steps of this length to the end of a motion; the largest difference of its coordinates.
fn step_error(system: &RigidBodies, motion: &Motion, t_end: f64, dt: f64) -> f64 {
    let steps = (t_end / dt).round() as usize;
    let options = simulate::Options::new(dt, t_end).unwrap();
    let options = options.with_steps(steps).with_tolerance(1e-11).with_save_every(steps);
    let run = simulate::simulate(system, &options).unwrap();
    assert!(matches!(run.outcome, simulate::Outcome::Finished), "{:?}", run.outcome);
    let samples = &run.trajectory.samples;
    let stepped = &samples.q[samples.q.len() - samples.coordinates..];
    let (q, _) = sample(motion, motion.samples.len() - 1);
    stepped.iter().zip(q).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Time stepping converges to a motion at first order.
#[track_caller]
fn check_first_order(system: &RigidBodies, motion: &Motion, t_end: f64, dt: f64) {
    let (order, error) = observed_order(system, motion, t_end, dt);
    assert!(error < 0.1 && (0.8..1.4).contains(&order), "{error:e}: order {order}");
}

/// The observed order of time stepping with the steps `dt` and `dt/4`, and the error with the latter.
fn observed_order(system: &RigidBodies, motion: &Motion, t_end: f64, dt: f64) -> (f64, f64) {
    let errors = [dt, 0.25 * dt].map(|dt| step_error(system, motion, t_end, dt));
    ((errors[0] / errors[1]).log2() / 2.0, errors[1])
}

#[test]
fn a_free_symmetric_top_turns_as_the_closed_form_says() {
    let (a, c) = (0.02, 0.03);
    let start = Rotation3::new(Vector3::new(0.3, -1.1, 0.6));
    let spin = Vector3::new(1.3, -0.4, 7.0);
    let quaternion = nalgebra::UnitQuaternion::from_rotation_matrix(&start);
    let body = Body {
        orientation: [quaternion.w, quaternion.i, quaternion.j, quaternion.k],
        angular_velocity: spin.into(),
        velocity: [1.0, -2.0, 0.5],
        ..Body::new(2.0, [a, a, c])
    };
    let system = RigidBodies::new(vec![body], &[], vec![], [0.0; 3]).unwrap();
    let t_end = 20.0;
    let motion = run(&system, &own_start(&system, t_end).with_sample(0.5));
    let momentum = start * Vector3::new(a * spin.x, a * spin.y, c * spin.z);
    for k in 0..motion.samples.len() {
        let t = motion.samples.t[k];
        let (q, u) = sample(&motion, k);
        let own = Rotation3::new(Vector3::z() * ((1.0 - c / a) * spin.z * t));
        let expected: Matrix3<f64> = (Rotation3::new(momentum * (t / a)) * start * own).into();
        let off = (system.pose(q, 0).unwrap().rotation - expected).amax();
        assert!(off < 1e-9, "{off:e} at {t}");
        let omega = Vector3::from_column_slice(&u[3..]);
        let kept = expected * Vector3::new(a * omega.x, a * omega.y, c * omega.z);
        assert!((kept - momentum).amax() < 1e-10, "{kept} {momentum}");
        close(q[0], t, 1e-11 * t_end);
    }
}

#[test]
fn a_tumbling_body_keeps_energy_and_momentum() {
    let inertia = Vector3::new(0.01, 0.02, 0.03);
    // About the axis of middle inertia, which is unstable: it turns over again and again.
    let body = Body { angular_velocity: [1e-3, 10.0, 1e-3], ..Body::new(1.0, inertia.into()) };
    let system = RigidBodies::new(vec![body], &[], vec![], [0.0; 3]).unwrap();
    let motion = run(&system, &own_start(&system, 10.0));
    let state = |k: usize| {
        let (q, u) = sample(&motion, k);
        let omega = Vector3::from_column_slice(&u[3..]);
        let momentum = inertia.component_mul(&omega);
        (momentum.dot(&omega), system.pose(q, 0).unwrap().rotation * momentum, omega.y)
    };
    let (energy, momentum, _) = state(0);
    let mut turned_over = false;
    for k in 0..motion.samples.len() {
        let (now, kept, y) = state(k);
        assert!((now / energy - 1.0).abs() < 1e-9, "{now} {energy}");
        assert!((kept - momentum).amax() < 1e-9 * momentum.norm(), "{kept} {momentum}");
        turned_over |= y < -9.0;
    }
    assert!(turned_over);
}

/// A ball that slides without spin at first: friction turns it until it rolls with 5/7 of its velocity.
#[test]
fn a_ball_slides_until_it_rolls() {
    let (mu, radius, speed) = (0.2, 0.1, 3.0);
    let body = Body {
        position: [0.0, 0.0, radius],
        velocity: [speed, 0.0, 0.0],
        ..Body::ball(1.5, radius)
    };
    let sphere = Shape::SpherePlane { body: 0, centre: [0.0; 3], radius, plane: Plane::floor() };
    let pairs = [Pair::new(sphere, disk(mu))];
    let system = RigidBodies::new(vec![body], &pairs, vec![], [0.0, 0.0, -G]).unwrap();
    let motion = run(&system, &own_start(&system, 2.0));
    let rolls = 2.0 * speed / (7.0 * mu * G);
    close(first(&motion, EventKind::Stick).time, rolls, 1e-9);
    assert_eq!(motion.events.len(), 1, "{:?}", motion.events);
    let (q, u) = sample(&motion, motion.samples.len() - 1);
    close(u[0], 5.0 / 7.0 * speed, 1e-9);
    let path = speed * rolls - 0.5 * mu * G * rolls * rolls + 5.0 / 7.0 * speed * (2.0 - rolls);
    close(q[0], path, 1e-8);
    close(q[2], radius, 1e-12);
}

/// A ball with spin about a slanted axis on an anisotropic floor: its path bends.
#[test]
fn a_spinning_ball_on_an_anisotropic_floor_agrees_with_time_stepping() {
    let ellipse: Convex<2> = Ellipse::new(Vector::<2>::new(0.4, 0.2)).unwrap().into();
    let body = Body {
        position: [0.0, 0.0, 0.1],
        velocity: [1.0, 0.5, 0.0],
        angular_velocity: [20.0, -15.0, 30.0],
        ..Body::ball(1.0, 0.1)
    };
    let sphere =
        Shape::SpherePlane { body: 0, centre: [0.0; 3], radius: 0.1, plane: Plane::floor() };
    let pairs = [Pair::new(sphere, FrictionLaw::associated(ellipse))];
    let system = RigidBodies::new(vec![body], &pairs, vec![], [0.0, 0.0, -G]).unwrap();
    let motion = run(&system, &own_start(&system, 1.0));
    assert!(motion.events.iter().any(|event| event.kind == EventKind::Stick));
    check_first_order(&system, &motion, 1.0, 2e-3);
}

/// A top whose foot slides on the floor.
#[test]
fn a_spinning_top_with_a_sliding_foot_agrees_with_time_stepping() {
    let height = 0.05;
    let tilt = Rotation3::new(Vector3::new(0.4, 0.0, 0.0));
    let quaternion = nalgebra::UnitQuaternion::from_rotation_matrix(&tilt);
    let foot = Vector3::new(0.0, 0.0, -height);
    let body = Body {
        position: [0.0, 0.0, -(tilt * foot).z],
        orientation: [quaternion.w, quaternion.i, quaternion.j, quaternion.k],
        angular_velocity: [0.0, 0.0, 150.0],
        velocity: [0.3, 0.0, 0.0],
        ..Body::new(0.1, [5e-5, 5e-5, 4e-5])
    };
    let point = Shape::PointPlane { body: 0, point: foot.into(), plane: Plane::floor() };
    let pairs = [Pair::new(point, disk(0.1))];
    let system = RigidBodies::new(vec![body], &pairs, vec![], [0.0, 0.0, -G]).unwrap();
    let motion = run(&system, &own_start(&system, 0.3));
    for k in 0..motion.samples.len() {
        let (q, _) = sample(&motion, k);
        let pose = system.pose(q, 0).unwrap();
        close(pose.point(&foot).z, 0.0, 1e-11);
    }
    check_first_order(&system, &motion, 0.3, 1e-4);
}

/// A box that stands on an edge falls to its face: until then it is a pendulum about the edge.
#[test]
fn a_box_tips_over_an_edge() {
    let half: [f64; 3] = [0.2, 0.1, 0.3];
    // Leaning over the edge beyond its balance.
    let angle = (half[0] / half[2]).atan() + 0.05;
    let edge = Rotation3::new(Vector3::y() * angle) * Vector3::new(half[0], 0.0, -half[2]);
    let quaternion = nalgebra::UnitQuaternion::from_axis_angle(&Vector3::y_axis(), angle);
    let body = Body {
        position: [-edge.x, 0.0, -edge.z],
        orientation: [quaternion.w, quaternion.i, quaternion.j, quaternion.k],
        ..Body::cuboid(2.0, half)
    };
    let shape = Shape::BoxPlane { body: 0, half_sizes: half, plane: Plane::floor() };
    let pairs = [Pair::new(shape, disk(2.0))];
    let system = RigidBodies::new(vec![body], &pairs, vec![], [0.0, 0.0, -G]).unwrap();
    let options = own_start(&system, 1.5);
    let motion = run(&system, &options);
    let energy = |k: usize| {
        let (q, u) = sample(&motion, k);
        system.kinetic_energy(u).unwrap() + system.potential_energy(0.0, q).unwrap()
    };
    let falls = first(&motion, EventKind::Impact).time;
    let before = (0..motion.samples.len()).take_while(|&k| motion.samples.t[k] < falls);
    for k in before {
        close(energy(k) / energy(0), 1.0, 1e-9);
    }
    // It comes to rest on its face.
    let (q, u) = sample(&motion, motion.samples.len() - 1);
    close(q[2], half[0], 1e-9);
    assert!(u.iter().all(|u| u.abs() < 1e-9), "{u:?}");
    let mut until = options;
    until.t_end = 0.9 * falls;
    let falling = run(&system, &until);
    // The edge sticks, so that time stepping is of second order.
    let (order, error) = observed_order(&system, &falling, 0.9 * falls, 0.9 * falls / 250.0);
    assert!(error < 1e-6 && (1.8..2.2).contains(&order), "{error:e}: order {order}");
}

/// A section of a body in space is a hyperplane of its own coordinates and velocities.
#[test]
fn sections_are_those_of_the_system() {
    let body = Body { angular_velocity: [0.0, 0.0, 2.0], ..Body::new(1.0, [1.0; 3]) };
    let system = RigidBodies::new(vec![body], &[], vec![], [0.0; 3]).unwrap();
    // The fourth component of the quaternion is sin(φ/2).
    let mut normal = [0.0; 13];
    normal[6] = 1.0;
    let (t, state) = cross(&system, &own_start(&system, 10.0), &normal, 0.5);
    close(t, std::f64::consts::PI / 6.0, 1e-11);
    close(state[6], 0.5, 1e-12);
    // An orientation of length zero is refused, of any other one normalised.
    let refused = own_start(&system, 1.0).with_start(&[0.0; 7], system.u0());
    let error = integrate(&system, &refused).unwrap_err();
    assert_eq!(error.argument, "q0");
    let twice =
        own_start(&system, 1.0).with_start(&[0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0], system.u0());
    let result = integrate(&system, &twice).unwrap();
    assert!(matches!(result.outcome, Outcome::Finished));
    close(last_q(&result.motion)[3], 1.0_f64.cos(), 1e-11);
}

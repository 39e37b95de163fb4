//! The directions that anisotropic friction refers to.

use std::sync::Arc;

use asperity::law::FrictionLaw;
use asperity::set::{Convex, Superellipse, Vector};
use asperity::solver::Solver;
use asperity::stepper::{StepError, Stepper};
use asperity::system::rigid::{Body, Frame, Pair, Plane, RigidBodies, Shape, Spring};
use asperity::system::{TimeFunction, sliding_point};
use nalgebra::{Rotation3, UnitQuaternion, Vector3};

use crate::support::*;

/// Table 1 of \[WL19\], at 9.3 N.
fn measured() -> FrictionLaw<2> {
    let set = |a: f64, b: f64, s: f64| Superellipse::new(Vector::<2>::new(a, b), s).unwrap();
    let direction = Convex::try_from(set(1.84, 1.19, 2.51)).unwrap();
    FrictionLaw::new(set(4.99 / 9.3, 4.25 / 9.3, 2.94).into(), direction).unwrap()
}

fn start(angle: f64) -> [f64; 3] {
    let (s, c) = angle.sin_cos();
    [1.52 * c, 1.52 * s, 0.0]
}

fn slider(plane: Plane, frame: Frame, body: Body) -> RigidBodies {
    let shape = Shape::PointPlane { body: 0, point: [0.0; 3], plane };
    let pair = Pair { frame, ..Pair::new(shape, measured()) };
    RigidBodies::new(vec![body], &[pair], vec![], [0.0, 0.0, -G]).unwrap()
}

fn disk_of_18_grams(velocity: [f64; 3]) -> Body {
    Body { velocity, ..Body::new(0.018, [1e-6; 3]) }
}

/// A slider ends where the point mass of the paper does, whatever carries the grooves.
#[test]
fn grooves_deflect_a_slider_as_they_do_a_point_mass() {
    let dt = 1e-4;
    for degrees in [32.0_f64, 58.0] {
        let v = start(degrees.to_radians());
        let point = sliding_point(0.018, measured(), G).unwrap();
        let mut stepper =
            Stepper::new(&point, EXACT, 1e-12, dt, &State::new(0.0, &[0.0; 2], &v[..2])).unwrap();
        run_on(&mut stepper, 0.4, &mut |_| {});
        let expected = (stepper.q()[0], stepper.q()[1]);

        // Grooves of the plane, along its axis.
        let axes = slider(Plane::floor(), Frame::Plane, disk_of_18_grams(v));
        // Grooves of the plane, turned by 20° by a function.
        let turn = 20f64.to_radians();
        let field = Frame::Field(Arc::new(move |_| turn));
        let turned =
            slider(Plane::floor(), field, disk_of_18_grams(start(degrees.to_radians() + turn)));
        // Grooves of the body, which is turned itself.
        let body = Body {
            orientation: [(0.5 * turn).cos(), 0.0, 0.0, (0.5 * turn).sin()],
            ..disk_of_18_grams(start(degrees.to_radians() + turn))
        };
        let own = slider(Plane::floor(), Frame::Body { axis: [1.0, 0.0, 0.0] }, body);
        for (system, turn) in [(axes, 0.0), (turned, turn), (own, turn)] {
            let q = run(&system, dt, 0.4, |_| {}).q;
            let (s, c) = f64::sin_cos(turn);
            let end = (c * q[0] + s * q[1], c * q[1] - s * q[0]);
            let apart = (end.0 - expected.0).hypot(end.1 - expected.1);
            assert!(apart < 1e-9, "{degrees}°: {end:?} {expected:?}");
        }
    }
}

/// A function that has no angle ends the run before a solver sees what is not a number.
#[test]
fn a_frame_that_is_not_a_number_ends_the_run() {
    let field = Frame::Field(Arc::new(|x: [f64; 2]| if x[0] > 0.02 { f64::NAN } else { 0.0 }));
    let system = slider(Plane::floor(), field, disk_of_18_grams([1.0, 0.2, 0.0]));
    let mut stepper = stepper(&system, 1e-3);
    let error = (0..200).find_map(|_| stepper.step().err());
    assert!(matches!(error, Some(StepError::NotFiniteContact { contact: 0, .. })), "{error:?}");
    assert!((stepper.q()[0] - 0.02).abs() < 2e-3);
}

/// Grooves that circle a point: the frame and the same frame by a function; at the point itself the
/// plane's axis.
#[test]
fn circular_grooves_point_away_from_the_centre() {
    let plane = Plane { point: [0.3, -0.1, 0.0], ..Plane::floor() };
    let body = disk_of_18_grams([0.9, 0.7, 0.0]);
    let polar = slider(plane.clone(), Frame::Polar, body.clone());
    let field = Frame::Field(Arc::new(|x: [f64; 2]| x[1].atan2(x[0])));
    let field = slider(plane, field, body);
    let (a, b) = (run(&polar, 1e-3, 0.2, |_| {}), run(&field, 1e-3, 0.2, |_| {}));
    let apart = a.q.iter().zip(&b.q).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart < 1e-12, "{apart:e}");
    let geometry = polar.contact_geometry(0.0, &a.q, 0).unwrap();
    let away = Vector3::new(a.q[0] - 0.3, a.q[1] + 0.1, 0.0).normalize();
    assert!((geometry.e1 - away).norm() < 1e-14);
    assert!((geometry.normal.cross(&geometry.e1) - geometry.e2).norm() < 1e-15);
    let at_centre = [0.3, -0.1, 0.0, 1.0, 0.0, 0.0, 0.0];
    assert_eq!(polar.contact_geometry(0.0, &at_centre, 0).unwrap().e1, Vector3::x());
}

/// Bodies, planes, springs and weight, all turned by the same rotation.
fn scene(turn: &UnitQuaternion<f64>) -> RigidBodies {
    let r = turn.to_rotation_matrix();
    let vector = |v: [f64; 3]| -> [f64; 3] { (r * Vector3::from(v)).into() };
    let turned =
        |load: &TimeFunction<3>| -> TimeFunction<3> { load.constant().map(vector).unwrap().into() };
    let body = |body: Body, tilt: Vector3<f64>| {
        let q = turn * UnitQuaternion::from_rotation_matrix(&Rotation3::new(tilt));
        Body {
            position: vector(body.position),
            velocity: vector(body.velocity),
            force: turned(&body.force),
            torque: turned(&body.torque),
            orientation: [q.w, q.i, q.j, q.k],
            ..body
        }
    };
    let half = [0.1, 0.07, 0.05];
    let falling = Body {
        position: [0.0, 0.0, 0.15],
        velocity: [1.0, 0.3, 0.0],
        angular_velocity: [1.0, 2.0, -0.5],
        torque: [0.01, 0.0, 0.02].into(),
        ..Body::cuboid(1.0, half)
    };
    let rolling = Body {
        position: [0.4, 0.05, 0.06],
        velocity: [-0.5, 0.0, 0.0],
        force: [0.0, 0.1, 0.0].into(),
        ..Body::ball(0.5, 0.06)
    };
    let floor = Plane::new([0.0; 3], vector([0.0, 0.0, 1.0]), vector([1.0, 0.2, 0.0]));
    let belt = Plane { velocity: [0.2, -0.1].into(), spin: 0.5.into(), ..floor.clone() };
    let side = Plane {
        point: [0.1, 0.0, 0.0],
        body: Some(0),
        ..Plane::new([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])
    };
    let pairs = [
        Pair::new(Shape::BoxPlane { body: 0, half_sizes: half, plane: belt }, measured()),
        Pair { frame: Frame::Polar, ..Pair::new(sphere(1, 0.06, floor), measured()) },
        restituting(Pair::new(sphere(1, 0.06, side), measured()), 0.3, 0.0),
    ];
    let spring = Spring {
        body: 0,
        point: [0.1, 0.0, 0.02],
        other: Some(1),
        other_point: [0.0, 0.06, 0.0],
        stiffness: 20.0,
        damping: 0.1,
        length: 0.2.into(),
    };
    let bodies = vec![body(falling, Vector3::new(0.3, -0.2, 0.5)), body(rolling, Vector3::zeros())];
    RigidBodies::new(bodies, &pairs, vec![spring], vector([0.3, 0.0, -G])).unwrap()
}

#[test]
fn a_turned_world_moves_alike() {
    let turn = UnitQuaternion::from_rotation_matrix(&Rotation3::new(Vector3::new(0.4, -1.1, 0.7)));
    let (one, two) = (scene(&UnitQuaternion::identity()), scene(&turn));
    let mut impacts = 0;
    // The box comes to rest on four corners, for which sweeps alone take too many.
    let auto = Solver::AUTO;
    let end = |system: &RigidBodies, see: &mut dyn FnMut(&Stepper<'_>)| {
        let (q0, u0) = (system.q0(), system.u0());
        let mut stepper =
            Stepper::new(system, auto, 1e-12, 1e-3, &State::new(0.0, q0, u0)).unwrap();
        run_on(&mut stepper, 0.3, see);
        State::new(0.0, stepper.q(), stepper.u())
    };
    let a = end(&one, &mut |s| impacts += usize::from(s.problem().rows() > 0));
    let b = end(&two, &mut |_| {});
    assert!(impacts > 50, "{impacts}");
    for body in 0..2 {
        let place = |q: &[f64]| Vector3::new(q[7 * body], q[7 * body + 1], q[7 * body + 2]);
        let apart = (turn * place(&a.q) - place(&b.q)).norm();
        assert!(apart < 1e-9, "body {body}: {apart:e}");
        for k in 6 * body + 3..6 * body + 6 {
            assert!((a.u[k] - b.u[k]).abs() < 1e-7, "Ω of body {body}");
        }
    }
}

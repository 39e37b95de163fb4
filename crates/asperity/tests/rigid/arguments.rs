//! Bad input is refused with the argument's name.

use asperity::ArgumentError;
use asperity::contact::NormalForce;
use asperity::simulate::{Options, simulate};
use asperity::stepper::{StepError, Stepper};
use asperity::system::rigid::{Body, Frame, Pair, PlanarBody, Plane, RigidBodies, Shape, Spring};

use crate::support::*;

fn refused(system: Result<RigidBodies, ArgumentError>) -> (&'static str, String) {
    match system {
        Err(error) => (error.argument, error.message),
        other => panic!("not refused: {other:?}"),
    }
}

fn bodies(body: Body) -> Result<RigidBodies, ArgumentError> {
    RigidBodies::new(vec![Body::new(1.0, [1.0; 3]), body], &[], vec![], [0.0; 3])
}

fn pairs(pair: Pair) -> Result<RigidBodies, ArgumentError> {
    RigidBodies::new(vec![Body::new(1.0, [1.0; 3])], &[pair], vec![], [0.0; 3])
}

#[test]
fn bodies_are_checked() {
    let good = Body::new(1.0, [1.0, 1.0, 1.5]);
    assert!(bodies(good.clone()).is_ok());
    let rounded = [[1.0, 0.1, 0.0], [0.1 + 1e-16, 1.0, 0.0], [0.0, 0.0, 1.0]];
    assert!(bodies(Body { inertia: rounded, ..good.clone() }).is_ok());
    for (body, argument) in [
        (Body { mass: 0.0, ..good.clone() }, "mass"),
        (Body { mass: f64::NAN, ..good.clone() }, "mass"),
        (Body::new(1.0, [1.0, 1.0, 2.5]), "inertia"),
        (Body::new(1.0, [1.0, 1.0, 0.0]), "inertia"),
        (
            Body { inertia: [[1.0, 0.2, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], ..good.clone() },
            "inertia",
        ),
        (Body { orientation: [0.0; 4], ..good.clone() }, "orientation"),
        (Body { position: [0.0, f64::INFINITY, 0.0], ..good.clone() }, "position"),
        (Body { torque: [f64::NAN; 3].into(), ..good.clone() }, "torque"),
    ] {
        let (name, message) = refused(bodies(body));
        assert_eq!(name, argument);
        assert!(message.starts_with("of body 1 "), "{message}");
    }
}

#[test]
fn pairs_are_checked() {
    let on = |plane| Shape::PointPlane { body: 0, point: [0.0; 3], plane };
    let good = Pair::new(on(Plane::floor()), disk(0.3));
    assert!(pairs(good.clone()).is_ok());
    let floor = Plane::floor();
    let spheres = Shape::SphereSphere {
        body: 0,
        centre: [0.0; 3],
        radius: 1.0,
        other: 0,
        other_centre: [0.0; 3],
        other_radius: 1.0,
    };
    for (pair, argument) in [
        (Pair::new(on(Plane { normal: [0.0; 3], ..floor.clone() }), disk(0.3)), "normal"),
        (Pair::new(on(Plane { axis: [0.0, 0.0, 2.0], ..floor.clone() }), disk(0.3)), "axis"),
        (Pair::new(on(Plane { body: Some(4), ..floor.clone() }), disk(0.3)), "plane.body"),
        (Pair::new(on(Plane { body: Some(0), ..floor.clone() }), disk(0.3)), "body"),
        (Pair::new(spheres, disk(0.3)), "body"),
        (Pair::new(sphere(0, -1.0, floor.clone()), disk(0.3)), "radius"),
        (Pair::new(on(floor), line(0.3)), "law"),
        (Pair { normal_force: NormalForce::Prescribed(-1.0), ..good.clone() }, "normal_force"),
        (Pair { normal_restitution: 1.5, ..good.clone() }, "normal_restitution"),
        (Pair { tangential_restitution: f64::NAN, ..good.clone() }, "tangential_restitution"),
        (Pair { patch_radius: Some(0.1), ..good.clone() }, "patch_radius"),
        (Pair { frame: Frame::Body { axis: [0.0; 3] }, ..good.clone() }, "axis"),
    ] {
        assert_eq!(refused(pairs(pair)).0, argument);
    }
    let spheres = Shape::SphereSphere {
        body: 0,
        centre: [0.0; 3],
        radius: 1.0,
        other: 1,
        other_centre: [0.0; 3],
        other_radius: 1.0,
    };
    let pair = Pair { frame: Frame::Polar, ..Pair::new(spheres, disk(0.3)) };
    let two = vec![Body::new(1.0, [1.0; 3]); 2];
    assert_eq!(refused(RigidBodies::new(two, &[pair], vec![], [0.0; 3])).0, "frame");
}

#[test]
fn planar_systems_are_planar() {
    let system = |plane, gravity| {
        let pair = Pair::new(sphere(0, 0.1, plane), line(0.3));
        RigidBodies::new(vec![PlanarBody::new(1.0, 0.1)], &[pair], vec![], gravity)
    };
    assert!(system(ground(), [0.0, -G, 0.0]).is_ok());
    assert_eq!(refused(system(ground(), [0.0, 0.0, -G])).0, "gravity");
    assert_eq!(refused(system(Plane::floor(), [0.0, -G, 0.0])).0, "plane");
    assert_eq!(refused(system(Plane { spin: 1.0.into(), ..ground() }, [0.0, -G, 0.0])).0, "spin");
}

#[test]
fn springs_and_states_are_checked() {
    let spring = Spring {
        body: 0,
        point: [0.0; 3],
        other: None,
        other_point: [0.0; 3],
        stiffness: -1.0,
        damping: 0.0,
        length: 0.0.into(),
    };
    let body = vec![Body::new(1.0, [1.0; 3])];
    let system = |spring| RigidBodies::new(body.clone(), &[], vec![spring], [0.0; 3]);
    assert_eq!(refused(system(spring.clone())).0, "stiffness");
    assert_eq!(
        refused(system(Spring { other: Some(1), stiffness: 1.0, ..spring.clone() })).0,
        "other"
    );

    let system = system(Spring { stiffness: 1.0, ..spring }).unwrap();
    let options = Options::new(1e-3, 0.01).unwrap().with_solver(EXACT);
    assert_eq!(options.steps, 10);
    let options = options.with_start(&[0.0; 6], &[0.0; 6]);
    let error = simulate(&system, &options).unwrap_err();
    assert_eq!(error.to_string(), "q0: must have 7 entries, has 6");
    let options = options.with_start(&[0.0; 7], &[0.0; 6]);
    let error = simulate(&system, &options).unwrap_err();
    assert_eq!(error.to_string(), "q0: the quaternion 0, (w, x, y, z), must not be of length zero");
    let options = options.with_start(&[0.0, 0.0, 0.0, 3.0, 0.0, 0.0, -4.0], &[0.0; 6]);
    let run = simulate(&system, &options).unwrap();
    let trajectory = run.trajectory;
    assert!((trajectory.samples.q[3] - 0.6).abs() + (trajectory.samples.q[6] + 0.8).abs() < 1e-15);
    assert_eq!((trajectory.samples.coordinates, trajectory.samples.dof), (7, 6));
    assert_eq!((trajectory.samples.q.len(), trajectory.samples.u.len()), (7 * 11, 6 * 11));
}

#[test]
fn a_stepper_refuses_what_is_no_state_of_the_system() {
    let system = bodies(Body::new(1.0, [1.0; 3])).unwrap();
    let (q, u) = (system.q0().to_vec(), system.u0().to_vec());
    let broken = |values: &[f64]| values.iter().map(|_| f64::NAN).collect::<Vec<_>>();
    assert!(Stepper::new(&system, EXACT, 1e-9, 1e-3, &State::new(0.0, &q, &u)).is_ok());
    for (argument, tolerance, dt, q, u) in [
        ("q0", 1e-9, 1e-3, vec![0.0], vec![]),
        ("q0", 1e-9, 1e-3, broken(&q), u.clone()),
        ("u0", 1e-9, 1e-3, q.clone(), vec![]),
        ("u0", 1e-9, 1e-3, q.clone(), broken(&u)),
        ("tolerance", 0.0, 1e-3, q.clone(), u.clone()),
        ("tolerance", f64::NAN, 1e-3, q.clone(), u.clone()),
        ("dt", 1e-9, -1e-3, q.clone(), u.clone()),
        ("dt", 1e-9, f64::INFINITY, q.clone(), u.clone()),
    ] {
        let error =
            Stepper::new(&system, EXACT, tolerance, dt, &State::new(0.0, &q, &u)).unwrap_err();
        let StepError::Options(error) = error else { panic!("{error:?}") };
        assert_eq!(error.argument, argument);
    }
}

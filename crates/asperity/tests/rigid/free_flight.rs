//! Without contacts: momenta, energy, order.

use asperity::stepper::{State, StepError, Stepper};
use asperity::system::SystemError;
use asperity::system::rigid::{Body, PlanarBody, RigidBodies, Spring};
use nalgebra::{Rotation3, Vector3};

use crate::support::*;

/// Spins about the middle axis, which it does not stay with (Dzhanibekov).
fn top(moments: [f64; 3]) -> Body {
    Body {
        velocity: [0.3, -0.2, 0.5],
        angular_velocity: [0.01, 6.0, 0.02],
        orientation: [0.9, 0.1, -0.3, 0.2],
        ..Body::new(2.0, moments)
    }
}

#[test]
fn a_tumbling_top_keeps_its_momenta_and_its_energy() {
    let system = RigidBodies::new(vec![top([0.02, 0.05, 0.06])], &[], vec![], [0.0; 3]).unwrap();
    // About the centre of mass: its path takes up rounding in every step.
    let centre = |q: &[f64]| Vector3::new(q[0], q[1], q[2]);
    let momenta = |q: &[f64], u: &[f64]| {
        (system.momentum(u).unwrap(), system.angular_momentum(q, u, &centre(q)).unwrap())
    };
    let start = momenta(system.q0(), system.u0());
    let energy = system.kinetic_energy(system.u0()).unwrap();
    let (mut norm, mut drift, mut flips, mut worst) = (0.0_f64, 0.0_f64, 0, 0.0_f64);
    let mut side = 1.0;
    let dt = 2e-3;
    run(&system, dt, 60.0, |stepper| {
        let (q, u) = (stepper.q(), stepper.u());
        norm = norm.max((q[3..].iter().map(|c| c * c).sum::<f64>().sqrt() - 1.0).abs());
        let now = momenta(q, u);
        assert_eq!(now.0, start.0);
        drift = drift.max((now.1 - start.1).norm() / start.1.norm());
        worst = worst.max((system.kinetic_energy(u).unwrap() / energy - 1.0).abs());
        if u[4] * side < -3.0 {
            (side, flips) = (-side, flips + 1);
        }
    });
    assert!(flips >= 4, "{flips}");
    assert!(norm < 4e-16, "{norm:e}");
    // Over 30 000 steps.
    assert!(drift < 1e-14, "{drift:e}");
    assert!(worst < 1e-4, "{worst:e}");
}

/// The energy error does not grow with time, and shrinks with the square of the step.
#[test]
fn free_rotation_is_of_second_order() {
    let system = RigidBodies::new(vec![top([0.02, 0.05, 0.06])], &[], vec![], [0.0; 3]).unwrap();
    let end = |dt: f64| run(&system, dt, 2.0, |_| {}).u;
    let reference = end(1e-4);
    let error = |dt: f64| {
        let u = end(dt);
        u.iter().zip(&reference).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    let errors = [error(1e-2), error(5e-3)];
    assert!((order(errors) - 2.0).abs() < 0.2, "{errors:?}");
    let worst = |t_end: f64| {
        let (mut worst, start) = (0.0_f64, system.kinetic_energy(system.u0()).unwrap());
        run(&system, 1e-2, t_end, |s| {
            worst = worst.max((system.kinetic_energy(s.u()).unwrap() - start).abs());
        });
        worst
    };
    assert!(worst(40.0) < 1.2 * worst(10.0));
}

/// Steady precession of a symmetric top without torque: `Ω₁ + iΩ₂` turns with `(J₃ − J₁)Ω₃/J₁`.
#[test]
fn a_symmetric_top_precesses() {
    let body = Body { angular_velocity: [1.0, 0.0, 8.0], ..Body::new(1.0, [0.03, 0.03, 0.05]) };
    let system = RigidBodies::new(vec![body], &[], vec![], [0.0; 3]).unwrap();
    let error = |dt: f64| {
        let u = run(&system, dt, 3.0, |_| {}).u;
        let (s, c) = (3.0_f64 * 8.0 * 2.0 / 3.0).sin_cos();
        (u[3] - c).hypot(u[4] - s)
    };
    let errors = [error(1e-3), error(5e-4)];
    assert!(errors[1] < 1e-3 && (order(errors) - 2.0).abs() < 0.2, "{errors:?}");
}

/// Two bodies on a spring of natural length zero: each oscillates harmonically about the centre.
#[test]
fn bodies_on_a_spring_oscillate() {
    let at = |x: f64| Body { position: [x, 0.0, 0.0], ..Body::new(2.0, [1.0; 3]) };
    let spring = Spring {
        body: 0,
        point: [0.0; 3],
        other: Some(1),
        other_point: [0.0; 3],
        stiffness: 9.0,
        damping: 0.0,
        length: 0.0.into(),
    };
    let system =
        RigidBodies::new(vec![at(1.0), at(-1.0)], &[], vec![spring.clone()], [0.0; 3]).unwrap();
    let start = energy(&system, system.q0(), system.u0());
    assert!((start - 0.5 * 9.0 * 4.0).abs() < 1e-12);
    let state = run(&system, 1e-3, 2.0, |_| {});
    // ω² = 2k/m.
    assert!((state.q[0] - 6.0_f64.cos()).abs() < 1e-5, "{}", state.q[0]);
    assert!((state.q[7] + 6.0_f64.cos()).abs() < 1e-5);
    assert!((energy(&system, &state.q, &state.u) / start - 1.0).abs() < 1e-5);
    // A pull off the centre of mass turns: momenta about the world's origin are still kept.
    let spring = Spring { point: [0.1, 0.4, -0.2], damping: 0.3, length: 0.5.into(), ..spring };
    let bodies = vec![Body { angular_velocity: [0.3, 0.2, 1.0], ..at(1.0) }, at(-1.0)];
    let system = RigidBodies::new(bodies, &[], vec![spring], [0.0; 3]).unwrap();
    let about = Vector3::zeros();
    let start = system.angular_momentum(system.q0(), system.u0(), &about).unwrap();
    let state = run(&system, 1e-3, 2.0, |_| {});
    let end = system.angular_momentum(&state.q, &state.u, &about).unwrap();
    assert!((end - start).norm() < 1e-12, "{end} {start}");
    assert!(system.momentum(&state.u).unwrap().norm() < 1e-12);
}

/// A body that turns too far in a step ends the run, and the state is the one before that step.
#[test]
fn bodies_that_turn_too_far_in_a_step_end_the_run() {
    let direction = Vector3::new(0.6, 0.3, 0.7).normalize();
    for (angle, fits) in [(0.1, true), (1.0, true), (5.0, false), (8.0, false), (100.0, false)] {
        let omega = direction * (angle / 0.1);
        let body = Body { angular_velocity: omega.into(), ..Body::new(1.0, [1.0, 2.0, 2.5]) };
        let system = RigidBodies::new(vec![body], &[], vec![], [0.0; 3]).unwrap();
        let start = system.kinetic_energy(system.u0()).unwrap();
        let mut stepper = stepper(&system, 0.1);
        let mut ended = None;
        for _ in 0..200 {
            let before = stepper.state();
            match stepper.step() {
                Ok(_) => {
                    let swing = system.kinetic_energy(stepper.u()).unwrap() / start - 1.0;
                    assert!(swing.abs() < 0.1, "{angle} {swing}");
                }
                Err(error) => {
                    assert_eq!(stepper.state(), before);
                    ended = Some(error);
                    break;
                }
            }
        }
        assert_eq!(ended.is_none(), fits, "{angle} {ended:?}");
        if let Some(error) = ended {
            let rotation = |e: &StepError| {
                matches!(e, StepError::System(SystemError::Rotation { body: 0, .. }))
            };
            assert!(rotation(&error), "{error}");
        }
    }
    // A wheel about its axis may turn as far as it likes.
    let wheel = Body { angular_velocity: [0.0, 0.0, 1e3], ..Body::new(1.0, [1.0, 1.0, 2.0]) };
    let system = RigidBodies::new(vec![wheel], &[], vec![], [0.0; 3]).unwrap();
    assert_eq!(run(&system, 0.1, 1.0, |_| {}).u, system.u0());
}

/// Slender bodies in turned axes, about any axis: the end of a run is a start.
#[test]
fn runs_of_slender_bodies_go_on_from_their_end() {
    for least in [1e-2, 1e-4, 1e-6, 1e-8] {
        for seed in 0..8 {
            let angles = Vector3::new(0.3, -0.8, 0.5) * (1.0 + f64::from(seed));
            let axes = Rotation3::new(angles).into_inner();
            let moments = nalgebra::Matrix3::from_diagonal(&Vector3::new(least, 1.0, 1.0));
            let tensor = axes * moments * axes.transpose();
            for (axis, speed) in [(0, 10.0), (0, 1e2), (1, 1.0), (1, 1e2)] {
                let mut body = Body::new(1.0, [1.0; 3]);
                body.inertia = std::array::from_fn(|i| std::array::from_fn(|j| tensor[(i, j)]));
                body.angular_velocity = (axes.column(axis) * speed).into();
                let system = RigidBodies::new(vec![body], &[], vec![], [0.0; 3]).unwrap();
                let mut stepper = stepper(&system, 1e-3);
                for _ in 0..5 {
                    stepper.step().unwrap();
                }
                let end = stepper.state();
                let mut next = Stepper::new(&system, EXACT, 1e-12, 1e-3, &end)
                    .unwrap_or_else(|error| panic!("{least} {seed} {axis} {speed}: {error}"));
                stepper.step().unwrap();
                next.step().unwrap();
                assert_eq!(next.state(), stepper.state());
            }
        }
    }
}

/// Momenta are carried where they are stepped: those of bodies of unequal moments.
#[test]
fn states_carry_the_momenta_that_are_stepped() {
    let torque = || [0.0, 0.0, 1.0].into();
    let ball = Body { torque: torque(), ..Body::new(1.0, [0.004; 3]) };
    let top = Body { torque: torque(), ..Body::new(1.0, [0.2, 0.4, 0.5]) };
    let system = RigidBodies::new(vec![ball.clone(), top], &[], vec![], [0.0; 3]).unwrap();
    let mut both = stepper(&system, 1e-2);
    run_on(&mut both, 1.0, &mut |_| {});
    let momenta = both.state().momenta;
    assert!(momenta.len() == 3 && (momenta[2] - 1.0).abs() < 1e-12, "{momenta:?}");
    // They are compared with those of the velocities beside them.
    for momenta in [vec![0.0; 3], vec![1.0], vec![0.0, 0.0, f64::NAN]] {
        let state = State { momenta, ..both.state() };
        let error = Stepper::new(&system, EXACT, 1e-10, 1e-2, &state).unwrap_err();
        assert!(error.to_string().starts_with("start: "), "{error}");
    }
    let of = |system: &RigidBodies| {
        let mut stepper = stepper(system, 1e-2);
        stepper.step().unwrap();
        stepper.state().momenta.len()
    };
    assert_eq!(of(&RigidBodies::new(vec![ball], &[], vec![], [0.0; 3]).unwrap()), 0);
    let planar = PlanarBody::new(1.0, 0.1);
    assert_eq!(of(&RigidBodies::new(vec![planar], &[], vec![], [0.0; 3]).unwrap()), 0);
}

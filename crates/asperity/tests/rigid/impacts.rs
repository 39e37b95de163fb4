//! Impacts: the rotating ball, the rocking block, colliding spheres.

use asperity::contact::Phase;
use asperity::system::rigid::{Body, Pair, PlanarBody, RigidBodies, Shape};

use crate::support::*;

/// m = 1, R = .1, J = .004, dropped from y = 1, μ = .2.
fn planar_ball(spin: f64, e: f64) -> RigidBodies {
    let body =
        PlanarBody { position: [0.0, 1.0], angular_velocity: spin, ..PlanarBody::new(1.0, 0.004) };
    let pair = restituting(Pair::new(sphere(0, 0.1, ground()), line(0.2)), e, 0.0);
    RigidBodies::new(vec![body], &[pair], vec![], [0.0, -G, 0.0]).unwrap()
}

fn spatial_ball(spin: f64, e: f64) -> RigidBodies {
    let body = Body {
        position: [0.0, 1.0, 0.0],
        angular_velocity: [0.0, 0.0, spin],
        ..Body::new(1.0, [0.004; 3])
    };
    let pair = restituting(Pair::new(sphere(0, 0.1, ground()), disk(0.2)), e, 0.0);
    RigidBodies::new(vec![body], &[pair], vec![], [0.0, -G, 0.0]).unwrap()
}

const IMPACT: (f64, f64) = (0.428_352_9, 4.202_142_3);

#[test]
fn a_dropped_ball_meets_the_ground_in_time() {
    for dt in [1e-3, 1e-4] {
        let (mut time, mut speed) = (f64::NAN, f64::NAN);
        let system = planar_ball(0.0, 0.0);
        let mut before = 0.0;
        run(&system, dt, 0.5, |stepper| {
            if time.is_nan() && stepper.u()[1] == 0.0 {
                (time, speed) = (stepper.time(), before);
            }
            before = stepper.u()[1];
        });
        assert!((time - IMPACT.0).abs() <= 2.0 * dt, "{time}");
        assert!((-speed - IMPACT.1).abs() <= 2.0 * dt * G, "{speed}");
    }
}

/// The bounces of e = ½ pile up at 1.2850588 s; each of the ln(1/Δt) ones that are seen is off by a step.
#[test]
fn a_bouncing_ball_comes_to_rest_in_time() {
    let rest = |dt: f64| {
        let (system, mut moved) = (planar_ball(0.0, 0.5), 0.0);
        let state = run(&system, dt, 1.5, |stepper| {
            if stepper.phase(0) == Phase::Open {
                moved = stepper.time();
            }
        });
        assert!(state.u[1].abs() < 1e-15);
        moved
    };
    for dt in [1e-3, 1e-4, 2e-5] {
        let t = rest(dt);
        assert!((t - 1.285_058_8).abs() < 16.0 * dt, "dt = {dt}: {t}");
    }
}

/// Spin 50: slides after the impact and rolls from .728120 s on; spin 10: rolls at once.
#[test]
fn a_spinning_ball_slides_and_rolls() {
    for (dt, spatial) in [(1e-3, false), (1e-4, false), (1e-4, true)] {
        let system = if spatial { spatial_ball(50.0, 0.0) } else { planar_ball(50.0, 0.0) };
        let turning = |u: &[f64]| if spatial { u[5] } else { u[2] };
        let (mut after, mut rolling) = (None, f64::NAN);
        let state = run(&system, dt, 1.0, |stepper| {
            let phase = stepper.phase(0);
            if phase == Phase::Slip && after.is_none() {
                after = Some((stepper.u()[0], turning(stepper.u())));
            }
            if phase == Phase::Stick && rolling.is_nan() {
                rolling = stepper.time();
            }
        });
        let (vx, omega) = after.unwrap();
        assert!((vx.abs() - 0.840_428).abs() < 4.0 * dt * G, "{vx}");
        assert!((omega - 28.989_288).abs() < 100.0 * dt * G, "{omega}");
        assert!((rolling - 0.728_120).abs() < 4.0 * dt, "{rolling}");
        assert!((state.u[0].abs() - 10.0 / 7.0).abs() < 1e-12, "{}", state.u[0]);
        assert!((turning(&state.u) * 0.1 + state.u[0]).abs() < 1e-12);

        let system = if spatial { spatial_ball(10.0, 0.0) } else { planar_ball(10.0, 0.0) };
        let mut slipped = false;
        let state = run(&system, dt, 0.6, |s| slipped |= s.phase(0) == Phase::Slip);
        assert!(!slipped && (state.u[0].abs() - 2.0 / 7.0).abs() < 1e-12);
    }
}

/// Quarter periods and amplitudes of a block that rocks without slip.
#[test]
fn a_block_rocks_as_housner_says() {
    let (b, h, phi) = (0.0125_f64, 0.05_f64, 8f64.to_radians());
    let (r, alpha) = (b.hypot(h), b.atan2(h));
    let mass = 1.0;
    // On its right corner, tilted: the corner at the origin.
    let centre = [r * (phi - alpha).sin(), r * (alpha - phi).cos()];
    let body = PlanarBody {
        position: [-centre[0].abs().copysign(alpha - phi), centre[1]],
        angle: -phi,
        ..PlanarBody::new(mass, mass * (b * b + h * h) / 3.0)
    };
    let shape = Shape::BoxPlane { body: 0, half_sizes: [b, h, 0.0], plane: ground() };
    let system =
        RigidBodies::new(vec![body], &[Pair::new(shape, line(100.0))], vec![], [0.0, -G, 0.0])
            .unwrap();
    let expected = [8.0, 6.07183, 4.76791, 3.80877];
    let errors = |dt: f64| {
        let (mut crossing, mut peaks, mut before) = (f64::NAN, vec![8.0], [-phi, 0.0]);
        run(&system, dt, 1.2, |stepper| {
            let (angle, rate) = (stepper.q()[2], stepper.u()[2]);
            if crossing.is_nan() && angle >= 0.0 {
                let part = before[0] / (before[0] - angle);
                crossing = stepper.time() - dt + part * dt;
            }
            if rate * before[1] < 0.0 && angle.abs() > 0.01 {
                peaks.push(angle.abs().to_degrees());
            }
            before = [angle, rate];
        });
        let amplitudes = peaks.iter().zip(expected).map(|(p, e)| (p - e).abs());
        assert!(peaks.len() >= 4, "{peaks:?}");
        ((crossing - 0.124_652_3).abs(), amplitudes.fold(0.0, f64::max))
    };
    let (coarse, fine) = (errors(2e-4), errors(2.5e-5));
    assert!(fine.0 < 2.0 * 2.5e-5 && coarse.0 < 2.0 * 2e-4, "{coarse:?} {fine:?}");
    assert!(fine.1 < 0.02 && fine.1 < 0.4 * coarse.1, "{coarse:?} {fine:?}");
}

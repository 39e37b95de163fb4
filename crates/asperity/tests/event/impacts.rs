//! Unilateral contacts: bouncing, rolling and rocking, and Painlevé's rod.

use asperity::contact::Phase;
use asperity::event::{EventKind, Options};
use asperity::law::FrictionLaw;
use asperity::system::rigid::{Pair, PlanarBody, Plane, RigidBodies, Shape};

use crate::support::*;

const G: f64 = 9.81;

fn ground() -> Plane {
    Plane::line([0.0; 2], [0.0, 1.0])
}

fn system(body: PlanarBody, shape: Shape, mu: f64, e: f64, gravity: f64) -> RigidBodies {
    let law = FrictionLaw::<1>::isotropic(mu).unwrap();
    let pair = Pair { normal_restitution: e, ..Pair::new(shape, law) };
    RigidBodies::new(vec![body], &[pair], vec![], [0.0, -gravity, 0.0]).unwrap()
}

fn from_start(system: &RigidBodies, t_end: f64) -> Options {
    options(system.q0(), system.u0(), t_end)
}

/// m = 1, R = .1, J = .004, dropped from y = 1, μ = .2.
fn ball(spin: f64, e: f64) -> RigidBodies {
    let body =
        PlanarBody { position: [0.0, 1.0], angular_velocity: spin, ..PlanarBody::new(1.0, 0.004) };
    let shape = Shape::SpherePlane { body: 0, centre: [0.0; 3], radius: 0.1, plane: ground() };
    system(body, shape, 0.2, e, G)
}

#[test]
fn a_bouncing_ball_comes_to_rest() {
    let ball = ball(0.0, 0.5);
    let motion = run(&ball, &from_start(&ball, 1.5));
    let impacts = times(&motion, EventKind::Impact);
    let fall = (1.8 / G).sqrt();
    for (k, time) in impacts.iter().enumerate() {
        close(*time, fall * (3.0 - 2.0 * 0.5f64.powi(k as i32)), 1e-10);
    }
    assert!(impacts.len() > 15);
    close(*impacts.last().unwrap(), 1.285_058_8, 1e-6);
    assert_eq!(motion.events.last().unwrap().phase, Some(Phase::Stick));
    assert!(last_u(&motion).iter().all(|u| u.abs() < 1e-15));
}

#[test]
fn a_spinning_ball_slides_and_rolls() {
    let fast = ball(50.0, 0.0);
    let motion = run(&fast, &from_start(&fast, 1.0));
    close(first(&motion, EventKind::Impact).time, 0.428_352_9, 1e-7);
    close(first(&motion, EventKind::Stick).time, 0.728_120, 1e-6);
    close(last_u(&motion)[0], -10.0 / 7.0, 1e-11);
    let at = motion
        .samples
        .t
        .iter()
        .rposition(|&t| t == first(&motion, EventKind::Impact).time)
        .unwrap();
    close(motion.samples.u[3 * at], -0.840_428, 1e-6);
    close(motion.samples.u[3 * at + 2], 28.989_288, 1e-5);
    let slow = ball(10.0, 0.0);
    let motion = run(&slow, &from_start(&slow, 1.0));
    assert_eq!(motion.events.len(), 1);
    close(last_u(&motion)[0], -2.0 / 7.0, 1e-12);
}

#[test]
fn a_block_rocks_as_housner_says() {
    let (b, h, phi) = (0.0125_f64, 0.05_f64, 8f64.to_radians());
    let (r, alpha) = (b.hypot(h), b.atan2(h));
    let position = [r * (alpha - phi).sin(), r * (alpha - phi).cos()];
    let inertia = (b * b + h * h) / 3.0;
    let body = PlanarBody { position, angle: -phi, ..PlanarBody::new(1.0, inertia) };
    let shape = Shape::BoxPlane { body: 0, half_sizes: [b, h, 0.0], plane: ground() };
    let block = system(body, shape, 100.0, 0.0, G);
    let motion = run(&block, &from_start(&block, 0.5));
    let impacts = times(&motion, EventKind::Impact);
    close(impacts[0], 0.124_652_3, 1e-7);
    let ratio = |time: f64| {
        let [before, after] = [
            motion.samples.t.iter().position(|&t| t == time).unwrap(),
            motion.samples.t.iter().rposition(|&t| t == time).unwrap(),
        ];
        motion.samples.u[3 * after + 2] / motion.samples.u[3 * before + 2]
    };
    assert!(impacts.len() > 2);
    for time in impacts {
        close(ratio(time), 1.0 - 1.5 * (b / h).atan().sin().powi(2), 1e-8);
    }
    // Turning points are where the angular velocity vanishes.
    let (mut q, mut u, mut sign) = (block.q0().to_vec(), block.u0().to_vec(), -1.0);
    for amplitude in [6.071_83, 4.767_91, 3.808_77] {
        // A quarter of the way on it is far from the section.
        let on = run(&block, &options(&q, &u, 0.02));
        let start = options(last_q(&on), last_u(&on), 1.0);
        let (_, state) = cross(&block, &start, &[0.0, 0.0, 0.0, 0.0, 0.0, sign], 0.0);
        close(state[2].abs().to_degrees(), amplitude, 1e-5);
        (q, u) = (state[..3].to_vec(), state[3..].to_vec());
        sign = -sign;
    }
}

/// m = s = 1, J = 1/3, g = 10, μ = 5/3 from 31° with 30 m/s: at 45° the normal force grows without bound. The
/// numbers given for it, 3.760599 and 11.992264, are those of a slightly earlier time.
#[test]
fn painleves_rod_is_stopped_without_collision() {
    let phi = 31f64.to_radians();
    let body = PlanarBody {
        position: [0.0, phi.sin()],
        angle: -phi,
        velocity: [30.0, 0.0],
        ..PlanarBody::new(1.0, 1.0 / 3.0)
    };
    let shape = Shape::PointPlane { body: 0, point: [1.0, 0.0, 0.0], plane: ground() };
    let rod = system(body, shape, 5.0 / 3.0, 0.0, 10.0);
    let motion = run(&rod, &from_start(&rod, 0.9));
    let stop = first(&motion, EventKind::ImpactWithoutCollision);
    close(stop.time, 0.814_549_7, 1e-7);
    let before = motion.samples.t.iter().position(|&t| t == stop.time).unwrap();
    close(-motion.samples.q[3 * before + 2], 45f64.to_radians(), 1e-11);
    close(-motion.samples.u[3 * before + 2], 3.760_599, 1e-5);
    close(motion.samples.u[3 * before], 11.992_264, 1e-5);
    // The tip stands still afterwards.
    let after = motion.samples.t.iter().rposition(|&t| t == stop.time).unwrap();
    let (u, angle) = (&motion.samples.u[3 * after..], motion.samples.q[3 * after + 2]);
    close(u[0] - u[2] * angle.sin(), 0.0, 1e-9);
    close(u[1] + u[2] * angle.cos(), 0.0, 1e-9);
}

//! Impacts of spheres and boxes: closed forms, energy.

use asperity::solver::{Solver, Status};
use asperity::stepper::Stepper;
use asperity::system::System;
use asperity::system::rigid::{Body, Pair, Partners, Plane, RigidBodies, Shape};

use crate::common::Random;
use crate::support::*;

fn balls(velocity: [f64; 3], offset: f64, mu: f64, e: f64) -> RigidBodies {
    let ball = |mass: f64, x: f64, y: f64, velocity: [f64; 3]| Body {
        position: [x, y, 0.0],
        velocity,
        ..Body::ball(mass, 0.1)
    };
    let bodies = vec![ball(1.0, 0.0, 0.0, velocity), ball(3.0, 0.3, offset, [0.0; 3])];
    let shape = Shape::SphereSphere {
        body: 1,
        centre: [0.0; 3],
        radius: 0.1,
        other: 0,
        other_centre: [0.0; 3],
        other_radius: 0.1,
    };
    let pair = restituting(Pair::new(shape, disk(mu)), e, 0.0);
    RigidBodies::new(bodies, &[pair], vec![], [0.0; 3]).unwrap()
}

#[test]
fn central_impacts_of_spheres_are_newtons() {
    for e in [0.0, 0.5, 1.0] {
        let state = run(&balls([2.0, 0.0, 0.0], 0.0, 0.3, e), 1e-3, 0.2, |_| {});
        assert!((state.u[0] - 2.0 * (1.0 - 3.0 * e) / 4.0).abs() < 1e-12);
        assert!((state.u[6] - 2.0 * (1.0 + e) / 4.0).abs() < 1e-12);
        assert!(state.u[1].abs() < 1e-15 && state.u[3..6].iter().all(|w| w.abs() < 1e-15));
    }
}

/// Off centre: the tangential percussion stops the slip, or is μ times the normal one.
#[test]
fn oblique_impacts_of_spheres_stick_or_slip() {
    for (mu, sticks) in [(0.05, false), (2.0, true)] {
        let (e, dt) = (0.5, 1e-5);
        let system = balls([2.0, 0.0, 0.0], 0.1, mu, e);
        let mut geometry = None;
        let state = run(&system, dt, 0.12, |s| {
            if geometry.is_none() && s.problem().rows() > 0 {
                geometry = Some(system.contact_geometry(s.time(), s.q(), 0).unwrap());
            }
        });
        // Where the centres are .2 apart: sin of the angle is ½.
        let (sine, cosine) = (0.5, 0.75_f64.sqrt());
        let normal = geometry.unwrap().normal;
        assert!((normal.x - cosine).abs() < 1e-3 && (normal.y - sine).abs() < 1e-3);
        // Effective masses: 1/m + 1/M along the normal, and 7/2 of that along the tangent.
        let inverse = 1.0 + 1.0 / 3.0;
        let p_n = (1.0 + e) * 2.0 * cosine / inverse;
        let p_t = if sticks { 2.0 * sine / (3.5 * inverse) } else { mu * p_n };
        let expected = [p_n * cosine + p_t * sine, p_n * sine - p_t * cosine];
        for (k, expected) in expected.into_iter().enumerate() {
            assert!((3.0 * state.u[6 + k] - expected).abs() < 1e-3, "{:?}", state.u);
        }
        // Both balls spin by the torque of the same percussion.
        let spin = 0.1 * p_t / (0.4 * 0.01);
        assert!((state.u[5].abs() - spin).abs() < 0.02 * spin + 1e-9, "{:?}", state.u);
        assert!((state.u[11].abs() - spin / 3.0).abs() < 0.02 * spin);
    }
}

/// A box in a room without weight, thrown by chance.
fn room(half: [f64; 3], e_n: f64, e_t: f64, seed: u64) -> RigidBodies {
    let mut random = Random::new(seed);
    let mut within = |size: f64| [0; 3].map(|_| random.within(-size, size));
    let body = Body {
        position: within(0.1),
        velocity: within(4.0),
        angular_velocity: within(20.0),
        orientation: [1.0, within(1.0)[0], within(1.0)[1], within(1.0)[2]],
        ..Body::cuboid(1.0, half)
    };
    let mut pairs = Vec::new();
    for side in 0..6 {
        let (mut normal, mut axis) = ([0.0; 3], [0.0; 3]);
        normal[side % 3] = if side < 3 { 1.0 } else { -1.0 };
        axis[(side + 1) % 3] = 1.0;
        let plane = Plane::new(normal.map(|n| -0.4 * n), normal, axis);
        let shape = Shape::BoxPlane { body: 0, half_sizes: half, plane };
        pairs.push(restituting(Pair::new(shape, disk(0.4)), e_n, e_t));
    }
    RigidBodies::new(vec![body], &pairs, vec![], [0.0; 3]).unwrap()
}

/// The largest relative growth of the energy in a step with contacts, and the number of such steps.
fn growth(system: &RigidBodies, dt: f64) -> (f64, usize) {
    let solver = Solver::AUTO;
    let mut stepper =
        Stepper::new(system, solver, 1e-12, dt, &State::new(0.0, system.q0(), system.u0()))
            .unwrap();
    let (mut worst, mut impacts, mut before) =
        (0.0_f64, 0, system.kinetic_energy(system.u0()).unwrap());
    let start = before;
    for _ in 0..2000 {
        let report = stepper.step().unwrap();
        assert_eq!(report.status, Status::Converged, "{report:?}");
        let now = system.kinetic_energy(stepper.u()).unwrap();
        if stepper.problem().rows() > 0 {
            impacts += 1;
            worst = worst.max((now - before) / start);
        }
        before = now;
    }
    (worst, impacts)
}

/// Where all coefficients agree, impacts take energy: exactly so for a cube, whose Ω does not change in
/// free flight, and to the second order of the step for other boxes.
#[test]
fn impacts_do_not_bring_energy() {
    let mut impacts = 0;
    for seed in 0..12 {
        let e = [0.0, 0.5, 1.0][seed as usize % 3];
        let (cube, some) = growth(&room([0.1; 3], e, e, seed), 1e-3);
        assert!(cube < 1e-11, "seed {seed}: {cube:e}");
        let (other, more) = growth(&room([0.1, 0.07, 0.05], e, e, seed), 1e-3);
        assert!(other < 1e-3, "seed {seed}: {other:e}");
        let (finer, _) = growth(&room([0.1, 0.07, 0.05], e, e, seed), 1e-4);
        assert!(finer < 2e-5, "seed {seed}: {finer:e}");
        impacts += some + more;
    }
    assert!(impacts > 500, "{impacts}");
}

/// Kane's paradox: where they differ, impacts may bring energy.
#[test]
fn unequal_restitution_may_bring_energy() {
    let growth = |seed: u64| growth(&room([0.1; 3], 0.9, 0.0, seed), 1e-3).0;
    let most = (0..8).map(growth).fold(0.0, f64::max);
    assert!(most > 1e-3, "{most:e}");
}

/// Every contact, and every contact of a box, has a label.
#[test]
fn contacts_know_their_pairs() {
    let system = room([0.1; 3], 0.0, 0.0, 1);
    assert_eq!(system.contacts().len(), 48);
    let label = |contact| system.label(contact).map(|label| (label.pair, label.number));
    assert_eq!([0, 21, 99].map(label), [Some((0, 0)), Some((2, 5)), None]);
    assert_eq!(system.partners(21), Some(Partners { body: 0, other: None }));
}

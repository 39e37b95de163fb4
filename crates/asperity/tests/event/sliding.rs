//! Motions of one phase: the order of the method, blocks that come to rest, paths that bend.

use asperity::event::EventKind;
use asperity::law::{FrictionLaw, Law};
use asperity::set::{Ball, Convex, Ellipse, Star, Superellipse, Vector};
use asperity::system::{Contact, LinearSystem, sliding_point};
use nalgebra::DMatrix;

use crate::support::*;

/// ẍ + x = 0 with few steps: errors fall with h⁹, tolerances with their power 0.6/6 per step.
#[test]
fn an_oscillator_keeps_its_phase() {
    let one = DMatrix::identity(1, 1);
    let system = LinearSystem::new(one.clone(), one.clone(), 0.0 * one, vec![0.0], vec![]).unwrap();
    for (tolerance, bound) in [(1e-6, 1e-5), (1e-9, 1e-8), (1e-12, 2e-11)] {
        let motion = run(&system, &options(&[1.0], &[0.0], 100.0).with_tolerance(tolerance));
        close(last_q(&motion)[0], 100f64.cos(), bound);
        close(last_u(&motion)[0], -(100f64.sin()), bound);
    }
}

#[test]
fn blocks_stop_in_time_and_place() {
    let (mu, g, mass) = (0.4, 9.81, 2.0);
    let laws: [Law; 3] = [
        FrictionLaw::<1>::isotropic(mu).unwrap().into(),
        FrictionLaw::<2>::isotropic(mu).unwrap().into(),
        FrictionLaw::<3>::associated(Ball::new(mu).unwrap().into()).into(),
    ];
    for law in laws {
        let p = law.dimension();
        let contact = Contact::with_force(law, DMatrix::identity(p, p), mass * g);
        let (one, zero) = (DMatrix::identity(p, p), DMatrix::zeros(p, p));
        let system =
            LinearSystem::new(one * mass, zero.clone(), zero, vec![0.0; p], vec![contact]).unwrap();
        let u0 = &[1.2, -0.5, 0.3][..p];
        let v0 = u0.iter().map(|v| v * v).sum::<f64>().sqrt();
        let motion = run(&system, &options(&vec![0.0; p], u0, 2.0));
        let stop = first(&motion, EventKind::Stick);
        close(stop.time, v0 / (mu * g), 1e-12);
        for (q, u) in last_q(&motion).iter().zip(u0) {
            close(*q, u / v0 * v0 * v0 / (2.0 * mu * g), 1e-12);
        }
        assert!(last_u(&motion).iter().all(|&u| u == 0.0));
        assert_eq!(motion.events.len(), 1);
    }
}

/// With an elliptic D the components of the slip keep |v₁/v₁₀| = |v₂/v₂₀|^((p₁/p₂)²), whatever C.
#[test]
fn bent_paths_keep_their_invariants() {
    let ellipse = |a, b| Convex::<2>::from(Ellipse::new(Vector::<2>::new(a, b)).unwrap());
    let square = Star::from(Superellipse::new(Vector::<2>::new(0.5, 0.4), 3.0).unwrap());
    for reservoir in [Star::from(ellipse(0.6, 0.3)).rotated(0.4).unwrap(), square] {
        let law = FrictionLaw::new(reservoir, ellipse(1.0, 0.7)).unwrap();
        let system = sliding_point(1.0, law, 9.81).unwrap();
        let u0 = [1.0, 0.8];
        let motion = run(&system, &options(&[0.0; 2], &u0, 1.0));
        let exponent = (1.0_f64 / 0.7).powi(2);
        let mut seen = 0;
        for u in motion.samples.u.chunks(2).filter(|u| u[0].hypot(u[1]) > 1e-9) {
            let (first, second) = (u[0] / u0[0], u[1] / u0[1]);
            close(first, second.powf(exponent), 1e-10);
            seen += usize::from(u[0] < 0.9);
        }
        assert!(seen > 10);
    }
}

/// The samples of a grid are of full order, and the last one is the end.
#[test]
fn samples_lie_on_the_motion() {
    let law = FrictionLaw::isotropic(0.5).unwrap();
    let system = sliding_point(1.0, law, 10.0).unwrap();
    let grid = options(&[0.0; 2], &[2.0, 0.0], 0.5).with_sample(0.07);
    let motion = run(&system, &grid);
    assert_eq!(motion.samples.t.len(), 9);
    assert_eq!(*motion.samples.t.last().unwrap(), 0.5);
    for (t, q) in motion.samples.t.iter().zip(motion.samples.q.chunks(2)) {
        let t = t.min(0.4);
        close(q[0], 2.0 * t - 2.5 * t * t, 1e-12);
    }
}

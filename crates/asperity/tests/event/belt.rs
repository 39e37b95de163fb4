//! Limit cycles on belts.

use asperity::event::EventKind;
use asperity::law::{Fall, FrictionLaw, Stribeck};
use asperity::set::{Convex, Ellipse, Star, Vector};
use asperity::system::{Contact, LinearSystem, mass_on_belt};
use nalgebra::{DMatrix, Matrix2, Vector2};

use crate::support::*;

/// k = m = F_S = 1, v = .2, F = F_S/(1 + 3|γ|).
fn stribeck() -> LinearSystem {
    let rate = Stribeck::new(Fall::Hyperbolic, 1.0 / 3.0, 0.0, 1.0, 0.0).unwrap();
    let law = FrictionLaw::<1>::isotropic(1.0).unwrap().with_rate(rate);
    let one = DMatrix::identity(1, 1);
    let contact = Contact { velocity: vec![-0.2], ..Contact::with_force(law, one.clone(), 1.0) };
    LinearSystem::new(one.clone(), one, DMatrix::zeros(1, 1), vec![0.0], vec![contact]).unwrap()
}

/// Semi-axes 30 N and 10 N at 30°, D 3:1, belt of 1 m/s at 50° (\[WL19\] Fig. 17).
fn ellipses() -> LinearSystem {
    let ellipse = |a, b| Convex::<2>::from(Ellipse::new(Vector::<2>::new(a, b)).unwrap());
    let reservoir = Star::from(ellipse(30.0, 10.0)).rotated(30f64.to_radians()).unwrap();
    let law = FrictionLaw::new(reservoir, ellipse(3.0, 1.0)).unwrap();
    let angle = 50f64.to_radians();
    let belt = Vector2::new(angle.cos(), angle.sin());
    mass_on_belt(1.0, Matrix2::identity(), law, 1.0, belt).unwrap()
}

#[test]
fn the_stribeck_block_sticks_and_slips_as_computed_before() {
    let motion = run(&stribeck(), &options(&[1.0], &[0.2], 40.0));
    let (slips, sticks) = (times(&motion, EventKind::Slip), times(&motion, EventKind::Stick));
    close(sticks[1] - slips[1], 4.296_000, 5e-7);
    close(slips[2] - sticks[1], 7.705_032, 5e-7);
    close(slips[2] - slips[1], 12.001_031, 5e-7);
    let (_, turn) = cross(&stribeck(), &options(&[1.0], &[0.2], 5.0), &[0.0, -1.0], 0.0);
    close(turn[0], 1.133_944, 1e-6);
}

/// The cycle attracts: after 500 s the phases repeat.
#[test]
fn the_mass_on_the_belt_finds_its_cycle() {
    let motion = run(&ellipses(), &options(&[20.2, 2.7], &[0.0; 2], 600.0));
    let slips = times(&motion, EventKind::Slip);
    let period = slips[slips.len() - 1] - slips[slips.len() - 2];
    close(period, 28.703, 1e-3);
    let stick = times(&motion, EventKind::Stick).into_iter().find(|&t| t > slips[slips.len() - 2]);
    close((slips[slips.len() - 1] - stick.unwrap()) / period, 0.689, 1e-3);
    let late = motion.samples.t.iter().position(|&t| t > 550.0).unwrap();
    for (k, (low, high)) in [(13.093, 26.918), (-4.148, 15.565)].into_iter().enumerate() {
        let x = motion.samples.q[2 * late..].iter().skip(k).step_by(2);
        let (least, most) = x.fold((f64::MAX, f64::MIN), |(a, b), &x| (a.min(x), b.max(x)));
        assert!(least > low - 2e-3 && most < high + 2e-3 && most - least > 0.9 * (high - low));
    }
}

/// What comes of sharper tolerances lies within the coarser ones.
#[test]
fn event_times_converge() {
    let events = |tolerance| {
        let options = options(&[20.2, 2.7], &[0.0; 2], 38.0).with_tolerance(tolerance);
        run(&ellipses(), &options).events
    };
    let exact = events(3e-14);
    assert_eq!(exact.len(), 6);
    for tolerance in [1e-8, 1e-10, 1e-12] {
        for (event, exact) in events(tolerance).iter().zip(&exact) {
            assert_eq!((event.kind, event.ambiguous), (exact.kind, exact.ambiguous));
            // Before the last stick the sliding direction turns fast: errors grow some hundred times.
            close(event.time, exact.time, 5e3 * tolerance + 1e-11);
        }
    }
}

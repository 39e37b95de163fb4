//! Velocities beside loads, on both sides of every border.

use nalgebra::DMatrix;

use super::*;
use crate::law::{FrictionLaw, Law};

/// Contacts on lines with these normal loads, which influence no others; `ρ = 1`.
fn problem(loads: &[f64]) -> ContactProblem {
    let rows = 2 * loads.len();
    let law = || Law::from(FrictionLaw::<1>::isotropic(0.5).unwrap());
    let all = loads.iter().map(|_| (law(), NormalForce::Unilateral));
    let free = loads.iter().flat_map(|load| [*load, 0.0]).collect();
    ContactProblem::new(DMatrix::identity(rows, rows), free, all).unwrap()
}

fn approach(problem: &ContactProblem, percussions: &[f64], velocities: &[f64]) -> Approach {
    let whole = |values: &[f64]| values.iter().flat_map(|v| [*v, 0.0]).collect::<Vec<f64>>();
    let (percussion, velocity) = (whole(percussions), whole(velocities));
    let measured = Measured { problem, percussion: &percussion, velocity: &velocity };
    Approach::of(&measured, 0..percussions.len(), 1e-9)
}

/// A contact moves with a hundredth of its own load, or a part of the largest one.
#[test]
fn velocities_are_compared_with_loads() {
    let problem = problem(&[-1.0, -1e-2, 1e-9]);
    for (velocities, flawed) in [
        ([-0.9e-2, -0.9e-4, -0.9e-5], None),
        ([-1.1e-2, 0.0, 0.0], Some(0)),
        ([0.0, -1.1e-4, 0.0], Some(1)),
        ([0.0, 0.0, -1.1e-5], Some(2)),
        // Contacts that push do not separate.
        ([1.1e-2, 0.0, 0.0], Some(0)),
        // That which moves with most of what is allowed is named.
        ([-1.1e-2, -1.3e-4, -1.2e-5], Some(1)),
    ] {
        let found = approach(&problem, &[2.0; 3], &velocities);
        assert_eq!(found.growth, 2.0);
        let expected = flawed.map(|contact| Flaw { contact, unbounded: false });
        assert_eq!(found.flaw(), expected, "{velocities:?}");
    }
    // Contacts that are open separate.
    assert_eq!(approach(&problem, &[0.0; 3], &[1.0; 3]).flaw(), None);
}

/// Percussions that have grown run away where contacts move, and beyond all bounds whatever these do.
#[test]
fn percussions_run_away_where_contacts_move() {
    let problem = problem(&[-1.0, -1.0]);
    for (growth, velocity, unbounded) in [
        (0.9e5, -0.02, Some(false)),
        (0.9e5, -0.009, None),
        (1.1e5, -0.009, Some(false)),
        (1.1e6, -0.009, Some(true)),
        (1.1e6, -0.9e-4, None),
        (0.9e12, -0.9e-4, None),
        (1.1e12, 0.0, Some(true)),
        (f64::NAN, 0.0, Some(true)),
    ] {
        let flaw = approach(&problem, &[1.0, growth], &[0.0, velocity]).flaw();
        let expected = unbounded.map(|unbounded| Flaw { contact: 1, unbounded });
        assert_eq!(flaw, expected, "{growth:e} {velocity}");
    }
}

/// What rounding explains is no movement.
#[test]
fn rounding_is_no_movement() {
    let problem = problem(&[-1.0, -1e-9]);
    let velocity = 0.9 * ROUNDING * 1e11;
    assert_eq!(approach(&problem, &[1e11, 1.0], &[-velocity, 0.0]).flaw(), None);
    let flaw = Some(Flaw { contact: 0, unbounded: true });
    assert_eq!(approach(&problem, &[1e11, 1.0], &[-10.0 * velocity, 0.0]).flaw(), flaw);
    // Nor do percussions carry a load that is less than their rounding, but for a share of the largest load.
    let flaw = Some(Flaw { contact: 1, unbounded: true });
    assert_eq!(approach(&problem, &[0.0, 1e11], &[0.0, -1.1e-4]).flaw(), flaw);
    assert_eq!(approach(&problem, &[0.0, 1e11], &[0.0, -0.9e-4]).flaw(), None);
}

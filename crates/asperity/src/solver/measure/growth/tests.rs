//! What contacts do whose percussions have grown, on both sides of every border.

use nalgebra::DMatrix;

use super::*;
use crate::law::{FrictionLaw, Law};

/// Contacts on lines, of which each and the next push each other: `G_NN` is 1, and −1 between them; the tangential
/// entries are `tangential`.
fn pushing(contacts: usize, tangential: f64, loads: &[f64], restitution: &[f64]) -> ContactProblem {
    let rows = 2 * contacts;
    let delassus = DMatrix::from_fn(rows, rows, |i, j| match (i, j) {
        _ if i == j => [1.0, tangential][i % 2],
        _ if i % 2 == 0 && j % 2 == 0 && i / 4 == j / 4 => -1.0,
        _ => 0.0,
    });
    let law = || Law::from(FrictionLaw::<1>::isotropic(0.5).unwrap());
    let all = (0..contacts).map(|_| (law(), NormalForce::Unilateral));
    let free = loads.iter().flat_map(|load| [*load, 0.0]).collect();
    let before: Vec<f64> = restitution.iter().flat_map(|e| [*e, 0.0]).collect();
    let ones = vec![1.0; contacts];
    let problem = ContactProblem::new(delassus, free, all).unwrap();
    problem.with_restitution(&ones, &ones, &before).unwrap()
}

/// The growth of normal percussions with normal velocities `ξ`.
fn growth(problem: &ContactProblem, percussions: &[f64], velocities: &[f64]) -> Option<Growth> {
    let whole = |values: &[f64]| values.iter().flat_map(|v| [*v, 0.0]).collect::<Vec<f64>>();
    let xi = whole(velocities);
    let velocity: Vec<f64> = xi.iter().zip(problem.restitution()).map(|(v, e)| v - e).collect();
    of(problem, &whole(percussions), &velocity, &mut Groups::default())
}

/// Two contacts with the load −1 and the growth `factor`: percussions `factor/2`.
fn of_two(factor: f64, velocities: [f64; 2]) -> Option<GrowthKind> {
    let problem = pushing(2, 100.0, &[-1.0, -1.0], &[0.0; 2]);
    let found = growth(&problem, &[0.5 * factor; 2], &velocities)?;
    assert!((found.factor / factor - 1.0).abs() < 1e-14, "{found:?}");
    Some(found.kind)
}

#[test]
fn kinds_of_growth_change_at_their_borders() {
    use GrowthKind::{Approaching, Boundless, Grown, Separating, Suspicious};
    let (little, more) = (0.009, 0.011);
    // Approaches of both contacts, as part of their loads.
    for (factor, velocity, expected) in [
        (99.0, -more, None),
        (101.0, -more, Some(Approaching)),
        (101.0, -little, Some(Grown)),
        (101.0, -1e-12, Some(Grown)),
        (101.0, -1e-14, None),
        (101.0, 0.0, None),
        (101.0, little, None),
        (101.0, more, Some(Separating)),
        (99.0, more, None),
        (0.9e4, -little, Some(Grown)),
        (1.1e4, -little, Some(Suspicious)),
        (1.1e4, 0.0, None),
        (1.1e4, little, None),
        (0.9e10, 0.0, None),
        (1.1e10, 0.0, Some(Suspicious)),
        (1.1e10, little, Some(Suspicious)),
        (1.1e10, more, Some(Separating)),
        (2.7e12, 0.0, Some(Suspicious)),
        (2.9e12, 0.0, Some(Boundless)),
        (2.9e12, -0.0102, Some(Boundless)),
        (2.9e12, -0.0104, Some(Approaching)),
        (2.9e12, 0.02, Some(Boundless)),
        // Rounding explains it, but it may be an approach.
        (1e13, -0.02, Some(Boundless)),
    ] {
        assert_eq!(of_two(factor, [velocity; 2]), expected, "{factor:e} {velocity}");
    }
    // The mean counts.
    assert_eq!(of_two(101.0, [-0.019, 0.0]), Some(Grown));
    assert_eq!(of_two(101.0, [0.0, -0.021]), Some(Approaching));
    assert_eq!(of_two(101.0, [0.021, 0.0]), Some(Separating));
    assert_eq!(of_two(101.0, [0.5, -0.021]), Some(Approaching));
}

/// Of loads that nearly cancel, a part of what is left of them counts.
#[test]
fn approaches_are_compared_with_what_loads_leave() {
    let problem = pushing(2, 100.0, &[-1.0, 0.96], &[0.0; 2]);
    for (velocity, expected) in [(-0.0018, GrowthKind::Grown), (-0.0022, GrowthKind::Approaching)] {
        let found = growth(&problem, &[200.0; 2], &[velocity; 2]).unwrap();
        assert_eq!(found.kind, expected, "{velocity}");
        assert!((found.factor - 400.0 / 0.98).abs() < 1e-10, "{found:?}");
    }
}

/// The contact with the largest power is named, of the group that does the worst.
#[test]
fn the_contact_that_approaches_most_is_named() {
    let problem = pushing(4, 100.0, &[-1.0; 4], &[0.0; 4]);
    let name = |percussions: [f64; 4], velocities: [f64; 4]| {
        growth(&problem, &percussions, &velocities).map(|found| (found.kind, found.contact))
    };
    let (approaching, separating) = (GrowthKind::Approaching, GrowthKind::Separating);
    assert_eq!(name([100.0; 4], [-0.1, -0.2, 0.0, 0.0]), Some((approaching, 1)));
    assert_eq!(name([100.0; 4], [-0.2, -0.1, 0.0, 0.0]), Some((approaching, 0)));
    assert_eq!(name([100.0; 4], [-0.2, -0.1, -0.1, -0.3]), Some((approaching, 3)));
    assert_eq!(name([100.0; 4], [0.2, 0.1, 0.0, 0.0]), Some((separating, 0)));
    assert_eq!(name([100.0; 4], [0.9, 0.1, 0.0, -0.03]), Some((approaching, 3)));
    assert_eq!(name([100.0, 100.0, 400.0, 1.0], [-0.2, 0.0, -0.1, 0.0]), Some((approaching, 2)));
    // Who does not push does not count.
    assert_eq!(name([100.0, 100.0, 0.0, -1.0], [0.0, 0.0, -9.0, -9.0]), None);
    assert_eq!(name([0.0; 4], [-9.0; 4]), None);
}

/// Loads that are rounding beside others of the problem say nothing of growth without bound.
#[test]
fn growth_is_not_measured_by_loads_that_are_rounding() {
    let kind = |other: f64, factor: f64, velocity: f64| {
        let problem = pushing(3, 100.0, &[-1.0, -1.0, other], &[0.0; 3]);
        let percussions = [0.5 * factor, 0.5 * factor, 0.0];
        // What is large beside all loads is looked at.
        let large = (GROWN * problem.global_rho() * problem.load_norm()).powi(2);
        assert!(percussions.iter().map(|p| p * p).sum::<f64>() > large);
        growth(&problem, &percussions, &[velocity, velocity, 1.0]).map(|found| found.kind)
    };
    for (factor, expected) in [(2e11, GrowthKind::Suspicious), (3e12, GrowthKind::Boundless)] {
        assert_eq!(kind(0.9e10, factor, 0.0), Some(expected));
        assert_eq!(kind(-0.9e10, factor, 0.0), Some(expected));
    }
    assert_eq!(kind(0.9e12, 3e13, 0.0), Some(GrowthKind::Boundless));
    assert_eq!(kind(1.1e12, 3e13, 0.0), None);
    assert_eq!(kind(-1.1e12, 3e13, 0.0), None);
    assert_eq!(kind(1.1e12, 3e13, -0.02), Some(GrowthKind::Suspicious));
}

/// One contact alone is not squeezed, but friction that pulls it in may hold percussions of any size: they are compared
/// with its load.
#[test]
fn one_contact_grows_without_bound_beside_its_load() {
    let problem = pushing(1, 100.0, &[-1.0], &[0.0]);
    let kind = |p: f64, velocity: f64| growth(&problem, &[p], &[velocity]).map(|found| found.kind);
    assert_eq!(kind(0.9e10, 0.0), None);
    assert_eq!(kind(1.1e10, 0.0), Some(GrowthKind::Boundless));
    assert_eq!(kind(1e3, 0.5), Some(GrowthKind::Separating));
    assert_eq!(kind(2e4, 0.5), Some(GrowthKind::Boundless));
    // Another contact of its group may push, too.
    let two = pushing(2, 100.0, &[-1.0, -1.0], &[0.0; 2]);
    let found = growth(&two, &[2e4, 0.0], &[0.5, 0.5]).map(|found| found.kind);
    assert_eq!(found, Some(GrowthKind::Separating));
    assert_eq!(kind(1e11, -0.02), Some(GrowthKind::Approaching));
    let running = |kind| Growth { kind, contact: 3, factor: 1.0 }.running();
    assert_eq!(running(GrowthKind::Suspicious), None);
    assert_eq!(running(GrowthKind::Boundless), Some(3));
    assert_eq!(running(GrowthKind::Approaching), Some(3));
}

/// Loads hold what restitution and contacts of prescribed normal percussion bring.
#[test]
fn loads_are_those_without_unilateral_percussions() {
    let bounces = pushing(2, 100.0, &[-0.4, -0.4], &[-0.6, -0.6]);
    assert_eq!(growth(&bounces, &[50.5; 2], &[-0.009; 2]).unwrap().kind, GrowthKind::Grown);
    assert_eq!(growth(&bounces, &[49.5; 2], &[-0.02; 2]), None);
    assert!((growth(&bounces, &[60.0; 2], &[-0.02; 2]).unwrap().factor - 120.0).abs() < 1e-12);
    // A contact on a line of prescribed percussion 1 whose friction −3 brings 0.5·(−3) beside −1.
    let delassus = DMatrix::from_row_slice(3, 3, &[1.0, 0.0, 0.5, 0.0, 1.0, 0.0, 0.5, 0.0, 1.0]);
    let law = || Law::from(FrictionLaw::<1>::isotropic(5.0).unwrap());
    let contacts = [(law(), NormalForce::Unilateral), (law(), NormalForce::Prescribed(1.0))];
    let problem = ContactProblem::new(delassus, vec![-1.0, 0.0, 0.0], contacts).unwrap();
    let mut groups = Groups::default();
    let found = of(&problem, &[500.0, 0.0, -3.0], &[-0.1, 0.0, 0.0], &mut groups).unwrap();
    assert!((found.factor - 501.5 / 2.5).abs() < 1e-10, "{found:?}");
    assert_eq!((found.kind, found.contact), (GrowthKind::Approaching, 0));
}

/// Growth is asked for where a contact that pushes moves against its load, or percussions are large.
#[test]
fn small_percussions_are_not_looked_at() {
    // ρ = 1: percussions up to 100·√2 are small beside both loads.
    let problem = pushing(2, 1.0, &[-1.0, -1.0], &[0.0; 2]);
    assert_eq!(growth(&problem, &[90.0; 2], &[-0.009; 2]), None);
    assert_eq!(growth(&problem, &[110.0; 2], &[-0.009; 2]).unwrap().kind, GrowthKind::Grown);
    assert_eq!(growth(&problem, &[90.0; 2], &[-0.011; 2]).unwrap().kind, GrowthKind::Approaching);
    assert_eq!(growth(&problem, &[90.0; 2], &[0.0, -0.025]).unwrap().kind, GrowthKind::Approaching);
    assert_eq!(growth(&problem, &[90.0; 2], &[-0.025, 0.0]).unwrap().kind, GrowthKind::Approaching);
    assert!(is_large(&problem, &[101.0, 0.0, 101.0, 0.0]));
    assert!(!is_large(&problem, &[99.0, 0.0, 99.0, 0.0]));
    assert!(is_large(&problem, &[f64::NAN, 0.0, 0.0, 0.0]));
    let half = pushing(2, 3.0, &[-1.0, -1.0], &[0.0; 2]);
    assert!(is_large(&half, &[51.0, 0.0, 51.0, 0.0]) && !is_large(&half, &[49.0, 0.0, 49.0, 0.0]));
}

/// The same, contact after contact.
#[test]
fn sizes_of_contacts_add_up() {
    // Loads of 1 and ρ = 2 of each: the size is 200 for one and 200·√2 for both.
    let size = |p: f64, xi: f64| Size::of(&[p, 0.0], Some((xi, -1.0)), (p * p, 1.0), 2.0);
    assert!(size(201.0, 0.0).may_have_grown() && !size(199.0, 0.0).may_have_grown());
    assert!(size(1.0, 0.011).may_have_grown() && !size(1.0, 0.009).may_have_grown());
    assert!(size(1.0, -0.011).may_have_grown() && !size(0.0, -0.011).may_have_grown());
    assert!(!size(-300.0, -1.0).may_have_grown() && size(f64::NAN, 0.0).is_large());
    let prescribed = |p: f64| Size::of(&[p, 0.0], None, (p * p, 1.0), 2.0);
    assert!(!prescribed(1e9).may_have_grown());
    let both = |a: Size, b: Size| {
        let mut sum = Size::default();
        [a, b].iter().for_each(|size| sum.add(size));
        sum.may_have_grown()
    };
    assert!(both(size(201.0, 0.0), size(201.0, 0.0)) && !both(size(199.0, 0.0), size(199.0, 0.0)));
    assert!(both(prescribed(300.0), size(1.0, 0.0)) && !both(prescribed(280.0), size(1.0, 0.0)));
    assert!(both(size(1.0, 0.02), prescribed(1.0)) && both(prescribed(1.0), size(1.0, 0.02)));
    let other = Size::of(&[1.0; 4], None, (300.0 * 300.0, 1.0), 0.5);
    // Six rows with the trace 1 + 8: ρ = 2/3, times 100·√2.
    assert!(both(other, size(1.0, 0.0)));
    let other = Size::of(&[1.0; 4], None, (93.0 * 93.0, 1.0), 0.5);
    assert!(!both(other, size(1.0, 0.0)));
    let other = Size::of(&[1.0; 4], None, (96.0 * 96.0, 1.0), 0.5);
    assert!(both(other, size(1.0, 0.0)));
}

/// Which contacts influence each other is found once for an operator, and again for the next one.
#[test]
fn groups_are_forgotten_with_their_operator() {
    let loads = vec![-1.0, 0.0, -1.0, 0.0];
    let law = || Law::from(FrictionLaw::<1>::isotropic(0.5).unwrap());
    let contacts = || (0..2).map(|_| (law(), NormalForce::Unilateral));
    let apart = ContactProblem::new(DMatrix::identity(4, 4), loads, contacts()).unwrap();
    let pair = pushing(2, 1.0, &[-1.0; 2], &[0.0; 2]);
    let (percussion, velocity) = ([150.0, 0.0, 10.0, 0.0], [-0.02, 0.0, -0.02, 0.0]);
    let mut groups = Groups::default();
    // Both bring 160 to each of them; apart one brings 150 and the other 10.
    for (problem, factor) in [(&pair, 160.0), (&apart, 150.0), (&pair, 160.0)] {
        groups.forget();
        for _ in 0..2 {
            let found = of(problem, &percussion, &velocity, &mut groups).unwrap();
            assert!((found.factor / factor - 1.0).abs() < 1e-14, "{found:?}");
        }
    }
}

/// Sums of rows and columns never call bounded what has grown, in chains of contacts on lines or in planes, light and heavy
/// ones, with restitution, and spare most of those that have not the products of `G`.
#[test]
fn what_is_bounded_without_products_has_not_grown() {
    let mut seed = 1_u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1_u64 << 53) as f64
    };
    let (mut bounded, mut grown, mut neither) = (0, 0, 0);
    for case in 0..4000 {
        let contacts = 1 + case % 7;
        let sizes: Vec<f64> = (0..contacts).map(|_| 10.0_f64.powf(2.0 * random() - 1.0)).collect();
        let size = 2 + case / 7 % 2;
        let rows = size * contacts;
        let delassus = DMatrix::from_fn(rows, rows, |i, j| {
            let (a, b) = (i / size, j / size);
            let heft = sizes[a] * sizes[b];
            match a.abs_diff(b) {
                0 => heft * [0.2 * (random() - 0.5), 1.0 + random()][usize::from(i == j)],
                // Every third pair of neighbours is apart.
                1 if a.min(b) % 3 != 2 => heft * (random() - 0.5),
                _ => 0.0,
            }
        });
        let law = || match size {
            2 => Law::from(FrictionLaw::<1>::isotropic(0.5).unwrap()),
            _ => Law::from(FrictionLaw::<2>::isotropic(0.5).unwrap()),
        };
        let all = (0..contacts).map(|_| (law(), NormalForce::Unilateral));
        let free = (0..rows).map(|_| random() - 0.5).collect();
        let before: Vec<f64> = (0..rows).map(|_| random() - 0.5).collect();
        let restitution = vec![0.3; contacts];
        let problem = ContactProblem::new(delassus, free, all).unwrap();
        let problem = problem.with_restitution(&restitution, &restitution, &before).unwrap();
        let scale = 10.0_f64.powf(6.0 * random() - 1.0);
        let percussion: Vec<f64> = (0..rows).map(|_| scale * (random() - 0.3).max(0.0)).collect();
        let velocity = problem.velocities(&percussion).unwrap();
        let measured = Measured { problem: &problem, percussion: &percussion, velocity: &velocity };
        let mut groups = Groups::default();
        groups.know(&problem);
        let is_bounded = groups.are_bounded(&measured);
        let growth = of_unbounded(&measured, &mut groups);
        assert!(!is_bounded || growth.is_none(), "{case}: {growth:?}");
        bounded += usize::from(is_bounded);
        grown += usize::from(growth.is_some());
        neither += usize::from(!is_bounded && growth.is_none());
    }
    assert!(bounded > 500 && grown > 500 && neither < 500, "{bounded} {grown} {neither}");
}

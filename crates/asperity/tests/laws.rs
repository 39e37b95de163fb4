//! Friction laws against their definitions.

mod common;

use asperity::law::{FrictionLaw, LawError};
use asperity::set::{Ball, Convex, ConvexSet, Ellipse, Interval, Star, StarSet, Vector};
use common::{Random, V, laws};

#[test]
fn forces_lie_on_the_reservoir_and_obey_normality() {
    for (name, law) in laws() {
        let mut random = Random::new(5);
        for _ in 0..1000 {
            let slip = V::new(random.normal(), random.normal());
            let force = law.force(&slip, 3.0).unwrap();
            let x = -force / 3.0;
            assert!((law.reservoir().gauge(&x) - 1.0).abs() < 1e-9, "{name}");
            // γ ∈ N_D(−αλ) by Fenchel's equality.
            let z = x * law.alpha(&x);
            let gap = law.direction().support(&slip) - z.dot(&slip);
            assert!(gap.abs() < 1e-9 * slip.norm(), "{name}: {gap:e}");
            assert!(law.dissipation(&slip, 3.0) > 0.0, "{name}");
            assert!((law.dissipation(&slip, 3.0) + force.dot(&slip)).abs() < 1e-12, "{name}");
            assert_eq!(
                law.slip_direction(&(force * 0.9), 3.0, 1e-9).unwrap(),
                V::zeros(),
                "{name}"
            );
            let outside = law.slip_direction(&(force * 1.1), 3.0, 1e-9);
            assert!(matches!(outside, Err(LawError::OutsideReservoir { .. })), "{name}");
        }
        assert_eq!(law.force(&V::zeros(), 1.0), Err(LawError::AtRest));
    }
}

#[test]
fn sliding_direction_inverts_the_force_of_smooth_laws() {
    for (name, law) in laws().into_iter().take(4) {
        let mut random = Random::new(6);
        for _ in 0..1000 {
            let slip = V::new(random.normal(), random.normal()).normalize();
            let force = law.force(&slip, 2.0).unwrap();
            let back = law.slip_direction(&force, 2.0, 1e-9).unwrap();
            assert!((back - slip).norm() < 1e-6, "{name}: {back} for {slip}");
        }
    }
}

#[test]
fn jacobian_is_the_slope_of_the_force() {
    for (name, law) in laws().into_iter().take(4) {
        let mut random = Random::new(7);
        for _ in 0..200 {
            let slip = V::new(random.normal(), random.normal()).normalize();
            if slip.x.abs().min(slip.y.abs()) < 0.05 {
                continue;
            }
            let jacobian = law.jacobian(&slip, 2.0).unwrap();
            // The force is homogeneous of degree zero.
            assert!((jacobian * slip).norm() < 1e-9 * jacobian.norm(), "{name}");
            for i in 0..2 {
                let h = V::ith(i, 1e-6);
                let ahead = law.force(&(slip + h), 2.0).unwrap();
                let behind = law.force(&(slip - h), 2.0).unwrap();
                let slope = (ahead - behind) / 2e-6;
                assert!((slope - jacobian.column(i)).norm() < 1e-5 * jacobian.norm(), "{name}");
            }
        }
    }
}

#[test]
fn direction_set_is_the_largest_inside_the_reservoir() {
    for (name, law) in laws() {
        let mut largest: f64 = 0.0;
        for k in 0..20_000 {
            let angle = std::f64::consts::TAU * k as f64 / 20_000.0;
            let d = V::new(angle.cos(), angle.sin());
            largest = largest.max(law.reservoir().gauge(&d) / law.direction().gauge(&d));
        }
        assert!(largest <= 1.0 + 1e-9 && largest > 1.0 - 1e-4, "{name}: {largest}");
        let same = FrictionLaw::new(law.reservoir().clone(), law.direction().clone()).unwrap();
        assert_eq!(same, law, "{name}: normalising twice changes the law");
    }
}

#[test]
fn forward_and_backward_sliding_may_differ() {
    let interval = Interval::new(Vector::<1>::new(-0.2), Vector::<1>::new(0.5)).unwrap();
    let law = FrictionLaw::associated(interval.into());
    assert_eq!(law.force(&Vector::<1>::new(2.0), 10.0).unwrap()[0], -5.0);
    assert_eq!(law.force(&Vector::<1>::new(-2.0), 10.0).unwrap()[0], 2.0);
}

/// A set of a crate user with nothing but a gauge: three lobes.
#[derive(Debug)]
struct Clover;

impl StarSet<2> for Clover {
    fn gauge(&self, x: &V) -> f64 {
        let angle = x.y.atan2(x.x);
        x.norm() / (0.3 + 0.05 * (3.0 * angle).cos())
    }
}

#[test]
fn sets_of_the_user_make_laws() {
    let custom = Star::Custom(asperity::set::CustomStar(std::sync::Arc::new(Clover)));
    let law = FrictionLaw::collinear(custom).unwrap();
    assert!((law.direction().gauge(&V::new(0.25, 0.0)) - 1.0).abs() < 1e-6);
    let force = law.force(&V::new(1.0, 0.0), 1.0).unwrap();
    assert!((force - V::new(-0.35, 0.0)).norm() < 1e-12);
}

#[test]
fn degenerate_sets_are_refused() {
    #[derive(Debug)]
    struct Flat;
    impl StarSet<2> for Flat {
        fn gauge(&self, x: &V) -> f64 {
            if x.y == 0.0 { x.x.abs() } else { f64::INFINITY }
        }
    }
    let custom = Star::Custom(asperity::set::CustomStar(std::sync::Arc::new(Flat)));
    let disk: Convex<2> = Ball::new(1.0).unwrap().into();
    let error = FrictionLaw::new(custom, disk).unwrap_err();
    assert_eq!(error.argument(), "reservoir");
    assert!(Ellipse::new(V::new(0.0, 1.0)).is_err());
    assert!(Ball::new(f64::NAN).is_err());
}

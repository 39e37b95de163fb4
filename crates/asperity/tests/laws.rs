//! Friction laws against their definitions.

mod common;

use asperity::law::{Fall, FlowSets, FrictionLaw, Law, LawError, Stribeck, flow_sets};
use asperity::set::{
    Ball, Convex, ConvexSet, Cuboid, CustomConvex, Ellipse, Ellipsoid, Interval, SetError, Star,
    StarSet, Superellipse, Vector, Verdict,
};
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
    let error = FrictionLaw::new(custom, disk.clone()).unwrap_err();
    assert_eq!(error.argument(), "reservoir");
    // Without bound on one side.
    #[derive(Debug)]
    struct Half;
    impl StarSet<2> for Half {
        fn gauge(&self, x: &V) -> f64 {
            x.x.max(0.0)
        }
    }
    let custom = Star::Custom(asperity::set::CustomStar(std::sync::Arc::new(Half)));
    assert_eq!(FrictionLaw::new(custom, disk).unwrap_err().argument(), "reservoir");
    assert!(Ellipse::new(V::new(0.0, 1.0)).is_err());
    assert!(Ball::new(f64::NAN).is_err());
}

/// The message names what was given: a number that is too large is not one that is no number.
#[test]
fn slips_that_are_not_finite_are_refused_with_their_value() {
    let law = FrictionLaw::<2>::isotropic(0.5).unwrap();
    let refused = |x: f64, y: f64| match law.force(&V::new(x, y), 1.0) {
        Err(LawError::Set(SetError::Parameter { argument: "slip", value, .. })) => value,
        other => panic!("{other:?}"),
    };
    for other in [0.0, 1.0, -2.0, f64::INFINITY, f64::MAX] {
        for infinite in [f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(refused(infinite, other), f64::INFINITY);
            assert_eq!(refused(other, infinite), f64::INFINITY);
        }
        assert!(refused(f64::NAN, other).is_nan() && refused(other, f64::NAN).is_nan());
    }
    assert!(law.force(&V::new(f64::MAX, f64::MAX), 1.0).is_ok());
}

fn flat_ellipse(a: f64, b: f64, degrees: f64) -> Convex<2> {
    let ellipse = Convex::from(Ellipse::new(V::new(a, b)).unwrap());
    ellipse.rotated(degrees.to_radians()).unwrap()
}

#[test]
fn rates_are_their_formulae() {
    let (speed, ratio, exponent, viscous) = (0.2, 0.6, 1.5, 0.3);
    for fall in [Fall::Exponential, Fall::Hyperbolic] {
        let rate = Stribeck::new(fall, speed, ratio, exponent, viscous).unwrap();
        assert_eq!(rate.speed(), speed);
        assert_eq!(rate.factor(0.0), 1.0);
        for v in [1e-3, 0.1, 0.2, 0.5, 3.0] {
            let x = f64::powf(v / speed, exponent);
            let s = match fall {
                Fall::Exponential => (-x).exp(),
                _ => 1.0 / (1.0 + x),
            };
            assert!((rate.factor(v) - (0.6 + 0.4 * s + 0.3 * v)).abs() < 1e-15);
            let h = 1e-6 * v;
            let slope = (rate.factor(v + h) - rate.factor(v - h)) / (2.0 * h);
            assert!((rate.slope(v) - slope).abs() < 1e-7 * slope.abs().max(1.0), "{fall:?} {v}");
        }
        // Far beyond the fall only the viscous part is left.
        assert!((rate.slope(1e6) - 0.3).abs() < 1e-6);
    }
    let bad = |speed, ratio, exponent, viscous| {
        Stribeck::new(Fall::Hyperbolic, speed, ratio, exponent, viscous).unwrap_err().argument()
    };
    assert_eq!(bad(0.0, 0.0, 1.0, 0.0), "speed");
    assert_eq!(bad(f64::INFINITY, 0.0, 1.0, 0.0), "speed");
    assert_eq!(bad(1.0, -0.1, 1.0, 0.0), "ratio");
    assert_eq!(bad(1.0, 0.0, 0.0, 0.0), "exponent");
    assert_eq!(bad(1.0, 0.0, 1.0, -1.0), "viscous");
    assert_eq!(bad(1.0, 0.0, 1.0, f64::NAN), "viscous");
    assert!(Stribeck::new(Fall::Hyperbolic, 1.0, 0.0, 1.0, 0.0).is_ok());
}

#[test]
fn forces_and_slopes_of_rated_laws_carry_the_factor() {
    let rate = Stribeck::new(Fall::Exponential, 0.5, 0.4, 1.0, 0.2).unwrap();
    let make = || {
        FrictionLaw::new(flat_ellipse(0.6, 0.3, 30.0).into(), flat_ellipse(2.0, 1.0, 0.0)).unwrap()
    };
    let (plain, rated) = (make(), make().with_rate(rate));
    assert!(plain.rate().is_none() && plain != rated && rated == make().with_rate(rate));
    let slip = V::new(0.3, -0.5);
    let factor = rate.factor(slip.norm());
    let force = rated.force(&slip, 2.0).unwrap();
    assert!((force - plain.force(&slip, 2.0).unwrap() * factor).norm() < 1e-15);
    assert!((rated.dissipation(&slip, 2.0) + force.dot(&slip)).abs() < 1e-15);
    assert_eq!(rated.dissipation(&V::zeros(), 2.0), 0.0);
    let jacobian = rated.jacobian(&slip, 2.0).unwrap();
    for i in 0..2 {
        let h = V::ith(i, 1e-6);
        let slope = (rated.force(&(slip + h), 2.0).unwrap()
            - rated.force(&(slip - h), 2.0).unwrap())
            / 2e-6;
        assert!((slope - jacobian.column(i)).norm() < 1e-8, "{slope} {jacobian}");
    }
    assert_eq!(rated.jacobian(&V::zeros(), 1.0), Err(LawError::AtRest));
    assert_eq!(rated.slip_direction(&force, 2.0, 1e-9), Err(LawError::SpeedUnknown));
    assert_eq!(rated.rotated(0.3).unwrap().rate(), Some(&rate));
    for normal_force in [0.0, -1.0, f64::NAN] {
        assert!(plain.slip_direction(&force, normal_force, 1e-9).is_err());
    }
}

#[test]
fn laws_turn_with_their_sets() {
    let law =
        FrictionLaw::new(flat_ellipse(0.6, 0.3, 30.0).into(), flat_ellipse(2.0, 1.0, 0.0)).unwrap();
    let turned = law.rotated(0.7).unwrap();
    let turn = nalgebra::Rotation2::new(0.7);
    for slip in [V::new(1.0, 0.2), V::new(-0.3, 0.8)] {
        let force = turn * law.force(&slip, 3.0).unwrap();
        assert!((turned.force(&(turn * slip), 3.0).unwrap() - force).norm() < 1e-12);
    }
}

/// C = ellipse 2:1, D = disk: the smallest ratio of radii is ½.
#[test]
fn normalisation_is_reported() {
    let law = FrictionLaw::collinear(flat_ellipse(0.6, 0.3, 0.0).into()).unwrap();
    assert!((law.direction_scale() - 0.3).abs() < 1e-9);
    assert!((law.alpha_min() - 0.5).abs() < 1e-9);
    assert!((law.alpha(&V::new(0.6, 0.0)) - 0.5).abs() < 1e-9);
    assert!((law.alpha(&V::new(0.0, 0.3)) - 1.0).abs() < 1e-9);
    assert!(!law.is_associated() && law.isotropic_coefficient().is_none());
    let twin =
        FrictionLaw::new(flat_ellipse(0.6, 0.3, 0.0).into(), flat_ellipse(1.2, 0.6, 0.0)).unwrap();
    assert!(twin.is_associated() && (twin.direction_scale() - 0.5).abs() < 1e-9);
    let isotropic = FrictionLaw::<2>::isotropic(0.4).unwrap();
    assert!(isotropic.is_associated());
    assert_eq!(isotropic.isotropic_coefficient(), Some(0.4));
    let any = Law::from(FrictionLaw::collinear(flat_ellipse(0.6, 0.3, 0.0).into()).unwrap());
    assert_eq!(any.dimension(), 2);
    assert!((any.alpha_min() - 0.5).abs() < 1e-9 && any.rate().is_none());
    assert_ne!(any, Law::from(isotropic));
}

#[test]
fn kinds_of_laws_are_told_with_witnesses() {
    let ellipse = || flat_ellipse(0.6, 0.3, 0.0);
    let associated = FrictionLaw::associated(ellipse());
    assert!(associated.associativity().holds && associated.monotonicity().holds);
    assert!(associated.dissipativity().holds);
    // The largest deflection between normal and position of an ellipse 2:1: tan = (2 − ½)/2.
    let verdict = associated.collinearity();
    assert!(!verdict.holds);
    assert!((verdict.defect - (0.75f64).atan().sin()).abs() < 1e-4, "{verdict:?}");
    let z = associated.direction().support_point(&verdict.witness[0]).normalize();
    assert!((z.perp(&verdict.witness[0]).abs() - verdict.defect).abs() < 1e-12);

    let collinear = FrictionLaw::collinear(ellipse().into()).unwrap();
    assert!(collinear.collinearity().holds && collinear.dissipativity().holds);
    let verdict = collinear.associativity();
    assert!(!verdict.holds && (verdict.defect - 0.5).abs() < 1e-6, "{verdict:?}");
    let monotone = collinear.monotonicity();
    assert!(!monotone.holds && monotone.defect > 0.0);
    // (γ − γ*)·(λ − λ*) > 0.
    let [slip, force, still, other] = monotone.witness[..] else { panic!("{monotone:?}") };
    assert!((slip - still).dot(&(force - other)) > 0.0);

    // Friction that falls with speed is not monotone, whatever the sets are.
    let rate = Stribeck::new(Fall::Exponential, 0.5, 0.4, 1.0, 0.0).unwrap();
    let falling = FrictionLaw::<2>::isotropic(0.4).unwrap().with_rate(rate);
    let verdict = falling.monotonicity();
    assert!(!verdict.holds && verdict.defect > 0.0);
    let [slip, force, faster, weaker] = verdict.witness[..] else { panic!("{verdict:?}") };
    assert!((slip - faster).dot(&(force - weaker)) > 0.0);
    let rising = Stribeck::new(Fall::Exponential, 0.5, 1.0, 1.0, 0.1).unwrap();
    let law = FrictionLaw::<2>::isotropic(0.4).unwrap().with_rate(rising);
    assert!(law.monotonicity().holds);

    // On a line every law is associated and collinear.
    let line = FrictionLaw::associated(Convex::from(
        Interval::new(Vector::<1>::new(-0.2), Vector::<1>::new(0.4)).unwrap(),
    ));
    assert_eq!(line.associativity(), Verdict::exact(true));
    assert_eq!(line.collinearity(), Verdict::exact(true));
    // So are closed forms in the plane and in space.
    let disk = FrictionLaw::<2>::isotropic(0.4).unwrap();
    assert_eq!(disk.associativity(), Verdict::exact(true));
    assert_eq!(disk.collinearity(), Verdict::exact(true));
    assert_eq!(FrictionLaw::<3>::isotropic(0.4).unwrap().collinearity(), Verdict::exact(true));
}

/// Unit vectors at equidistant angles, half a step off the axes.
fn around(count: usize) -> impl Iterator<Item = V> {
    (0..count).map(move |k| {
        let angle = std::f64::consts::TAU * (k as f64 + 0.5) / count as f64;
        V::new(angle.cos(), angle.sin())
    })
}

fn slip_force(law: &FrictionLaw<2>, e: &V) -> V {
    -law.force(e, 1.0).unwrap()
}

/// The largest value over all sliding directions.
fn largest(value: impl Fn(&V) -> f64) -> f64 {
    around(100_000).map(|e| value(&e)).fold(f64::NEG_INFINITY, f64::max)
}

/// D = disk of radius ½, C = ellipse 2:1: sliding at 45° the associated law dissipates most and this one 1/1.25 of it,
/// `k_C²(e) h_C²(e) = c⁴ + s⁴ + c²s²(a²/b² + b²/a²)`.
#[test]
fn witnesses_of_collinear_laws_are_those_of_the_closed_form() {
    let ellipse = flat_ellipse(0.6, 0.3, 0.0);
    let law = FrictionLaw::collinear(ellipse.clone().into()).unwrap();
    let verdict = law.monotonicity();
    assert!((verdict.defect - 0.2).abs() < 1e-6 && !verdict.holds && !verdict.exact, "{verdict:?}");
    let [slip, force, still, other] = verdict.witness[..] else { panic!("{verdict:?}") };
    assert!((slip.norm() - 1.0).abs() < 1e-12 && (slip.x.abs() - slip.y.abs()).abs() < 1e-9);
    assert!((force + slip_force(&law, &slip)).norm() < 1e-12 && still == V::zeros());
    assert!((ellipse.gauge(&other) - 1.0).abs() < 1e-12);
    assert!((slip.dot(&-other) - ellipse.support(&slip)).abs() < 1e-12);
    // The associated law's force is farthest from this one's where the witness is.
    let verdict = law.associativity();
    let apart = |e: &V| (slip_force(&law, e) - ellipse.support_point(e)).norm();
    assert!((verdict.defect - 0.5).abs() < 1e-9 && !verdict.exact);
    assert!(apart(&verdict.witness[0]) > largest(apart) - 1e-5, "{verdict:?}");
}

/// Of a reservoir that is not convex the farthest point is found among its own.
#[test]
fn witnesses_of_laws_with_a_star_shaped_reservoir_dissipate_less_than_they_could() {
    let star = Star::from(Superellipse::new(V::new(0.5, 0.3), 0.6).unwrap());
    let law = FrictionLaw::collinear(star.clone()).unwrap();
    let best = |e: &V| f64::max(0.5 * e.x.abs(), 0.3 * e.y.abs());
    let lack = |e: &V| 1.0 - slip_force(&law, e).dot(e) / best(e);
    let verdict = law.monotonicity();
    assert!((verdict.defect - largest(lack)).abs() < 1e-4, "{verdict:?}");
    let [slip, force, still, other] = verdict.witness[..] else { panic!("{verdict:?}") };
    assert!((lack(&slip) - verdict.defect).abs() < 1e-9 && still == V::zeros());
    assert!((force + slip_force(&law, &slip)).norm() < 1e-12);
    // The tips of the axes.
    assert!(
        (slip.dot(&-other) - best(&slip)).abs() < 1e-12 && (star.gauge(&other) - 1.0).abs() < 1e-9
    );
    let verdict = law.associativity();
    let tip = |e: &V| match 0.5 * e.x.abs() > 0.3 * e.y.abs() {
        true => V::new(0.5 * e.x.signum(), 0.0),
        false => V::new(0.0, 0.3 * e.y.signum()),
    };
    let apart = |e: &V| (slip_force(&law, e) - tip(e)).norm();
    assert!(apart(&verdict.witness[0]) > largest(apart) - 2e-3, "{verdict:?}");
}

/// Each verdict against the definition, for laws of every kind.
#[test]
fn verdicts_agree_with_their_definitions() {
    for (name, law) in laws() {
        let deflection = |e: &V| slip_force(&law, e).normalize().perp(e).abs();
        let verdict = law.collinearity();
        let worst = around(20_000).map(|e| deflection(&e)).fold(0.0, f64::max);
        assert!((verdict.defect - worst).abs() < 0.02, "{name}: {verdict:?} {worst}");
        assert_eq!(verdict.holds, worst < 1e-9, "{name}: {verdict:?}");
        if let [e] = verdict.witness[..] {
            assert!((deflection(&e) - verdict.defect).abs() < 1e-9, "{name}: {verdict:?}");
        }
        let verdict = law.associativity();
        assert_eq!(verdict.holds, law.is_associated(), "{name}");
        let ratio = |d: &V| law.reservoir().gauge(d) / law.direction().gauge(d);
        let tips = law.reservoir().corners();
        let smallest = around(20_000).chain(tips).map(|d| ratio(&d)).fold(1.0, f64::min);
        assert!((verdict.defect - (1.0 - smallest)).abs() < 1e-3, "{name}: {verdict:?}");
        assert!((law.alpha_min() - smallest).abs() < 1e-3 && law.alpha_min() <= smallest + 1e-9);
        assert_eq!(law.monotonicity().holds, law.is_associated(), "{name}");
        assert_eq!(law.dissipativity(), Verdict::exact(true), "{name}");
        // \[WL19\] (56) at some place.
        let x = V::new(0.13, -0.04);
        let alpha = law.direction().gauge(&x) - law.reservoir().gauge(&x) + 1.0;
        assert!((law.alpha(&x) * alpha - 1.0).abs() < 1e-14, "{name}");
    }
}

/// In space the normal of an ellipsoid is farthest from its position in the plane of its longest and shortest axes.
#[test]
fn deflections_in_space_are_those_of_the_extreme_axes() {
    let set = Convex::from(Ellipsoid::new(Vector::<3>::new(0.6, 0.3, 0.2)).unwrap());
    let law = FrictionLaw::associated(set);
    let verdict = law.collinearity();
    assert!(!verdict.holds && (verdict.defect - (4.0f64 / 3.0).atan().sin()).abs() < 5e-3);
    let e = verdict.witness[0];
    assert!(e.y.abs() < 0.1 && (e.norm() - 1.0).abs() < 1e-12, "{e}");
    assert_eq!(law.associativity(), Verdict::exact(true));
}

/// A direction set of a user whose farthest point is the nearest one.
#[derive(Debug)]
struct Mirrored;

impl StarSet<2> for Mirrored {
    fn gauge(&self, x: &V) -> f64 {
        x.norm() / 0.3
    }
}

impl ConvexSet<2> for Mirrored {
    fn support_point(&self, y: &V) -> V {
        y.normalize() * -0.3
    }
}

#[test]
fn sets_that_break_their_promise_do_not_dissipate() {
    let broken = Convex::Custom(CustomConvex(std::sync::Arc::new(Mirrored)));
    let verdict = FrictionLaw::associated(broken).dissipativity();
    assert!(!verdict.holds && (verdict.defect - 0.3).abs() < 1e-12, "{verdict:?}");
    assert!((verdict.witness[0].norm() - 1.0).abs() < 1e-12);
}

/// The steepest fall of `f(v) = .4 + .6 e^{−2v}` over a quarter of the speed, and the forces of both speeds.
#[test]
fn friction_that_falls_is_refuted_at_its_steepest_fall() {
    for viscous in [0.0, 0.05] {
        let rate = Stribeck::new(Fall::Exponential, 0.5, 0.4, 1.0, viscous).unwrap();
        let law = FrictionLaw::associated(flat_ellipse(0.6, 0.3, 0.0)).with_rate(rate);
        let fall = |v: f64| rate.factor(v) - rate.factor(1.25 * v);
        let steepest = (0..40_000).map(|k| fall(1e-4 * f64::from(k))).fold(0.0, f64::max);
        let verdict = law.monotonicity();
        assert!(!verdict.holds && verdict.defect <= steepest, "{verdict:?}");
        assert!(verdict.defect > 0.98 * steepest, "{verdict:?} {steepest}");
        let [slip, force, faster, weaker] = verdict.witness[..] else { panic!("{verdict:?}") };
        assert!((fall(slip.norm()) - verdict.defect).abs() < 1e-12);
        assert!((faster - slip * 1.25).norm() < 1e-12 && slip.norm() > 0.0);
        assert!((law.force(&slip, 1.0).unwrap() - force).norm() < 1e-12);
        assert!((law.force(&faster, 1.0).unwrap() - weaker).norm() < 1e-12);
    }
    // Friction that only rises leaves the sets to decide, at so small a speed that it does not count.
    let rising = Stribeck::new(Fall::Exponential, 0.5, 1.5, 1.0, 0.1).unwrap();
    let law = FrictionLaw::collinear(flat_ellipse(0.6, 0.3, 0.0).into()).unwrap().with_rate(rising);
    let verdict = law.monotonicity();
    assert!(!verdict.holds && (verdict.defect - 0.2).abs() < 1e-6, "{verdict:?}");
    let [slip, force, still, other] = verdict.witness[..] else { panic!("{verdict:?}") };
    assert!((law.force(&slip, 1.0).unwrap() - force).norm() < 1e-5 && still == V::zeros());
    assert!((slip - still).dot(&(force - other)) > 0.0);
}

/// `f` is the sum of a part that never rises and one that never falls, whose slope is known.
#[test]
fn rates_have_a_falling_and_a_rising_part() {
    for fall in [Fall::Exponential, Fall::Hyperbolic] {
        for (ratio, viscous, rises) in [
            (0.4, 0.0, false),
            (0.4, 0.3, true),
            (1.0, 0.0, false),
            (1.6, 0.0, true),
            (1.6, 0.3, true),
        ] {
            let rate = Stribeck::new(fall, 0.2, ratio, 1.5, viscous).unwrap();
            assert_eq!(rate.rises(), rises, "{rate:?}");
            assert_eq!((rate.falling(0.0), rate.rising(0.0)), (1.0, 0.0));
            let (mut falling, mut rising) = (1.0, 0.0);
            for k in 1..400 {
                let v = 0.005 * f64::from(k);
                assert!(rate.falling(v) <= falling && rate.rising(v) >= rising, "{rate:?} {v}");
                (falling, rising) = (rate.falling(v), rate.rising(v));
                assert!((falling + rising - rate.factor(v)).abs() < 1e-15, "{rate:?} {v}");
                let h = 1e-6;
                let slope = (rate.rising(v + h) - rate.rising(v - h)) / (2.0 * h);
                assert!((rate.rising_slope(v) - slope).abs() < 1e-8, "{rate:?} {v}: {slope}");
            }
            // Beyond all speeds the dry part has one end and the rest is viscous.
            assert!((rate.factor(1e4) - (ratio + viscous * 1e4)).abs() < 1e-6);
            for v in [1e3, 1e6, 1e200] {
                assert!((rate.slope(v) - viscous).abs() < 1e-6, "{rate:?} {v}");
            }
        }
    }
}

/// Laws of every kind: the derivative is that of the force wherever two differences agree that there is one.
#[test]
fn jacobians_of_all_laws_are_slopes() {
    let mut random = Random::new(17);
    for (name, law) in laws() {
        let mut compared = 0;
        for _ in 0..60 {
            let size = 10f64.powf(random.within(-2.0, 2.0));
            let slip = V::new(random.normal(), random.normal()).normalize() * size;
            let difference = |h: f64| {
                let at = |i: usize, h: f64| law.force(&(slip + V::ith(i, h * size)), 1.5).unwrap();
                [0, 1].map(|i| (at(i, h) - at(i, -h)) / (2.0 * h * size))
            };
            let (coarse, fine) = (difference(1e-4), difference(2.5e-5));
            let scale = fine[0].norm().max(fine[1].norm()).max(0.1 / size);
            let agree = (0..2).all(|i| (coarse[i] - fine[i]).norm() < 1e-4 * scale);
            let jacobian = law.jacobian(&slip, 1.5).unwrap();
            if !agree || !jacobian.iter().all(|v| v.is_finite()) {
                continue;
            }
            compared += 1;
            for (column, difference) in jacobian.column_iter().zip(fine) {
                let off = (difference - column).norm();
                assert!(off < 1e-3 * scale, "{name}: {off:e} of {scale:e} at {slip}");
            }
        }
        assert!(compared >= 20, "{name}: {compared}");
    }
}

/// Where *D* is flat the force jumps along the flat as the direction of sliding turns: against the turn.
#[test]
fn jacobians_are_infinite_across_flats_only() {
    let infinite = f64::INFINITY;
    let rectangle =
        FrictionLaw::associated(Convex::from(Cuboid::symmetric(V::new(0.5, 0.3)).unwrap()));
    let jacobian = rectangle.jacobian(&V::new(2.0, 0.0), 1.0).unwrap();
    assert_eq!(jacobian, nalgebra::Matrix2::new(0.0, 0.0, 0.0, -infinite));
    let jacobian = rectangle.jacobian(&V::new(0.0, -2.0), 1.0).unwrap();
    assert_eq!(jacobian, nalgebra::Matrix2::new(-infinite, 0.0, 0.0, 0.0));
    // The force moves along bdry C, whose side at (c, s) has the normal (c, s).
    let set = Convex::from(Cuboid::symmetric(V::new(0.5, 0.3)).unwrap());
    let reservoir = set.rotated(30f64.to_radians()).unwrap();
    let jacobian = FrictionLaw::new(reservoir.into(), set).unwrap();
    let jacobian = jacobian.jacobian(&V::new(1.0, 0.0), 1.0).unwrap();
    assert_eq!(jacobian, nalgebra::Matrix2::new(0.0, infinite, 0.0, -infinite));
    // At a corner the force does not change at all.
    let jacobian = rectangle.jacobian(&V::new(1.0, 1.0), 1.0).unwrap();
    assert_eq!(jacobian, nalgebra::Matrix2::zeros());
    // In space there is no number to be had.
    let cuboid = Cuboid::symmetric(Vector::<3>::new(0.5, 0.3, 0.2)).unwrap();
    let law = FrictionLaw::associated(Convex::from(cuboid));
    let jacobian = law.jacobian(&Vector::<3>::new(1.0, 0.0, 0.0), 1.0).unwrap();
    assert!(jacobian.iter().any(|v| !v.is_finite()));
}

/// The force is homogeneous of degree 0, its derivative of degree −1, down to the smallest numbers.
#[test]
fn tiny_slips_lose_no_digits() {
    let law =
        FrictionLaw::new(flat_ellipse(0.6, 0.3, 30.0).into(), flat_ellipse(2.0, 1.0, 0.0)).unwrap();
    let slip = V::new(0.3, -0.5);
    let (force, jacobian) = (law.force(&slip, 2.0).unwrap(), law.jacobian(&slip, 2.0).unwrap());
    for size in [1e-300, 1e-150, 1e150] {
        assert!((law.force(&(slip * size), 2.0).unwrap() - force).norm() < 1e-14);
        let scaled = law.jacobian(&(slip * size), 2.0).unwrap() * size;
        assert!((scaled - jacobian).norm() < 1e-13 * jacobian.norm(), "{size:e}");
    }
    let error = law.jacobian(&(slip * 1e-309), 2.0).unwrap_err();
    assert_eq!(error.argument(), "slip");
}

/// Forces within the tolerance of the boundary slide, others stick or are refused.
#[test]
fn sliding_directions_are_told_within_the_tolerance() {
    let law = FrictionLaw::<2>::isotropic(0.5).unwrap();
    let at = |gauge: f64, tolerance: f64| law.slip_direction(&V::new(-gauge, 0.0), 2.0, tolerance);
    assert_eq!(at(0.95, 0.1).unwrap(), V::new(1.0, 0.0));
    assert_eq!(at(1.05, 0.1).unwrap(), V::new(1.0, 0.0));
    assert_eq!(at(0.85, 0.1).unwrap(), V::zeros());
    assert_eq!(at(1.15, 0.1), Err(LawError::OutsideReservoir { gauge: 1.15 }));
    assert!(at(f64::NAN, 0.1).is_err());
    // The tolerance itself is within.
    for (gauge, tolerance) in [(1.0, 0.0), (0.75, 0.25), (1.25, 0.25)] {
        assert_eq!(at(gauge, tolerance).unwrap(), V::new(1.0, 0.0), "{gauge}");
    }
}

/// A direction set that is the reservoir but for its size, found by another way, is the reservoir to the bit; one that
/// differs a little is not.
#[test]
fn direction_sets_equal_up_to_rounding_are_the_reservoir() {
    let reservoir = flat_ellipse(0.6, 0.3, 40.0);
    let law = FrictionLaw::new(reservoir.clone().into(), flat_ellipse(1.8, 0.9, 40.0)).unwrap();
    assert!(law.is_associated() && *law.direction() == reservoir);
    assert!((law.direction_scale() - 1.0 / 3.0).abs() < 1e-12);
    for near in [flat_ellipse(1.8, 0.9 + 1e-9, 40.0), flat_ellipse(1.8, 0.9, 40.0 + 1e-7)] {
        let law = FrictionLaw::new(reservoir.clone().into(), near).unwrap();
        assert!(!law.is_associated() && law.alpha_min() < 1.0 && law.alpha_min() > 1.0 - 1e-6);
        assert!(!law.monotonicity().holds || law.associativity().defect < 1e-9);
    }
    // Of unit scale but for rounding: no bit changes.
    let disk: Convex<2> = Ball::new(0.3).unwrap().into();
    let law = FrictionLaw::new(reservoir.into(), disk.clone()).unwrap();
    assert_eq!((law.direction_scale(), law.direction()), (1.0, &disk));
}

/// A law takes another value of its own direction set as it is, and no other set.
#[test]
fn laws_hold_the_direction_set_that_they_are_given_again() {
    let reservoir = flat_ellipse(0.6, 0.3, 40.0);
    let law = FrictionLaw::new(reservoir.into(), flat_ellipse(3.0, 2.0, 0.0)).unwrap();
    let scale = law.direction_scale();
    let own = flat_ellipse(3.0 * scale, 2.0 * scale, 1e-15);
    let again = law.with_direction(own.clone()).unwrap();
    assert_eq!((again.direction(), again.direction_scale()), (&own, 1.0));
    assert!((again.alpha_min() - law.alpha_min()).abs() < 1e-12 && !again.is_associated());
    for other in [flat_ellipse(3.0, 2.0, 0.0), flat_ellipse(3.0 * scale, 2.01 * scale, 0.0)] {
        assert!(matches!(law.with_direction(other), Err(LawError::Set(_))));
    }
}

#[test]
fn laws_of_all_dimensions_say_what_they_are() {
    let rate = Stribeck::new(Fall::Hyperbolic, 1.0, 0.5, 1.0, 0.0).unwrap();
    let line = || FrictionLaw::<1>::isotropic(0.4).unwrap();
    let space = || {
        let set = Ellipsoid::new(Vector::<3>::new(0.6, 0.3, 0.2)).unwrap();
        FrictionLaw::collinear(Star::from(Convex::from(set))).unwrap()
    };
    let laws = [
        Law::from(line()),
        Law::from(line().with_rate(rate)),
        Law::from(FrictionLaw::<2>::isotropic(0.4).unwrap()),
        Law::from(FrictionLaw::<2>::isotropic(0.4).unwrap().with_rate(rate)),
        Law::from(space()),
        Law::from(space().with_rate(rate)),
    ];
    for (i, law) in laws.iter().enumerate() {
        assert_eq!(law.dimension(), 1 + i / 2);
        assert_eq!(law.rate(), [None, Some(&rate)][i % 2]);
        let alpha_min = [1.0, 1.0, 1.0 / 3.0][i / 2];
        assert!((law.alpha_min() - alpha_min).abs() < 1e-3, "{}", law.alpha_min());
        for (j, other) in laws.iter().enumerate() {
            assert_eq!(law == other, i == j, "{i} {j}");
        }
    }
    assert_eq!(Law::from(line()), Law::from(line()));
    assert_eq!(Law::from(space()), Law::from(space()));
}

/// f(φ) of diag(μ₁, μ₂): C has the semi-axes μᵢ, D the ratio √(μ₁/μ₂).
#[test]
fn flow_rules_give_their_sets() {
    let (mu1, mu2) = (0.3, 0.1);
    let phi: Vec<f64> = (0..720).map(|k| std::f64::consts::TAU * f64::from(k) / 720.0).collect();
    let force: Vec<V> = phi.iter().map(|a| V::new(mu1 * a.cos(), mu2 * a.sin())).collect();
    let sets = flow_sets(&phi, &force, 0.01, 0.01).unwrap();
    assert!((sets.report.closure - 1.0).abs() < 1e-9, "{:?}", sets.report);
    assert_eq!(sets.report.convexity_defect, 0.0);
    assert!((sets.report.smallest_resistance - mu2).abs() < 1e-12);
    for (theta, radius) in sets.theta.iter().zip(&sets.radius) {
        let gauge = f64::hypot(radius * theta.cos() / mu1, radius * theta.sin() / mu2);
        assert!((gauge - 1.0).abs() < 1e-12);
    }
    for (phi, height) in sets.phi.iter().zip(&sets.support) {
        let exact = f64::hypot(phi.cos(), phi.sin() / 3f64.sqrt());
        assert!((height - exact).abs() < 1e-7, "{phi}: {height} for {exact}");
    }
    assert!((sets.support.iter().copied().fold(0.0, f64::max) - 1.0).abs() < 1e-15);
    assert!(sets.theta.is_sorted() && sets.phi.is_sorted());
}

/// diag(.3, .1) + .05 skew: r_D(2π)/r_D(0) = 6.13.
#[test]
fn flow_rules_without_a_direction_set_are_refused() {
    let phi: Vec<f64> = (0..720).map(|k| std::f64::consts::TAU * f64::from(k) / 720.0).collect();
    let rule = |f: &dyn Fn(f64) -> V| -> Vec<V> { phi.iter().map(|&a| f(a)).collect() };
    let skew = |a: f64| V::new(0.3 * a.cos() + 0.05 * a.sin(), 0.1 * a.sin() - 0.05 * a.cos());
    let error =
        |phi: &[f64], force: &[V]| flow_sets(phi, force, 0.01, 0.01).unwrap_err().to_string();
    let message = error(&phi, &rule(&skew));
    assert!(
        message.contains("must close") || message.contains("6.13") || message.contains("0.163"),
        "{message}"
    );
    let pulls = error(&phi, &rule(&|a| V::new(a.cos(), -0.1 * a.sin())));
    assert!(pulls.contains("must oppose sliding"), "{pulls}");
    // A force that turns back: θ = φ + 0.6 sin 3φ falls.
    let back = error(
        &phi,
        &rule(&|a: f64| {
            let theta = a + 0.6 * (3.0 * a).sin();
            V::new(theta.cos(), theta.sin())
        }),
    );
    assert!(back.contains("must have a convex direction set"), "{back}");
    let disk = rule(&|a| V::new(a.cos(), a.sin()));
    assert!(error(&phi[..7], &disk[..7]).contains("at least 8"));
    assert!(error(&phi, &disk[1..]).contains("one row per direction"));
    assert!(error(&phi[..500], &disk[..500]).contains("gap above"));
    let mut twice = phi.clone();
    twice[5] = twice[4];
    assert!(error(&twice, &disk).contains("must rise"));
    let mut bad = disk.clone();
    bad[3].x = f64::NAN;
    assert!(error(&phi, &bad).contains("must be finite"));
    // A small defect is repaired and told.
    let theta = |a: f64| a + 0.34 * (3.0 * a).sin();
    let slightly = rule(&|a| V::new(theta(a).cos(), theta(a).sin()));
    let sets = flow_sets(&phi, &slightly, 0.1, 0.1).unwrap();
    assert!(sets.report.convexity_defect > 0.0 && sets.report.convexity_defect < 0.1);
    assert!(sets.report.repair >= sets.report.convexity_defect);
    assert!(sets.theta.is_sorted());
}

/// Sliding directions of unequal steps, from some first one on, within one turn.
fn irregular(count: usize, first: f64) -> Vec<f64> {
    let even = |k: usize| std::f64::consts::TAU * k as f64 / count as f64;
    (0..count).map(|k| first + even(k) + 0.25 * (2.0 * even(k) + first).sin()).collect()
}

/// `f(φ) = ψ`-turned radius of a law whose D is the ellipse `p` and whose C is the disk.
fn forces_of_an_elliptic_direction(phi: &[f64], [p, q]: [f64; 2]) -> Vec<V> {
    let z = |a: f64| V::new(p * p * a.cos(), q * q * a.sin());
    phi.iter().map(|&a| z(a).normalize() * 0.4).collect()
}

/// The support function between unequal steps is found with an error of the fourth order, wherever the turn begins.
#[test]
fn direction_sets_of_flow_rules_converge_with_the_fourth_order() {
    let [p, q] = [1.0, 0.6];
    let error = |count: usize, first: f64| {
        let phi = irregular(count, first);
        let force = forces_of_an_elliptic_direction(&phi, [p, q]);
        let sets = flow_sets(&phi, &force, 0.05, 0.0).unwrap();
        assert!(sets.phi.len() >= 1440);
        let exact = |a: f64| f64::hypot(p * a.cos(), q * a.sin());
        let off = |(a, h): (&f64, &f64)| (h - exact(*a)).abs();
        // h is normalised by its maximum, here p.
        let off = sets.phi.iter().zip(&sets.support).map(off).fold(0.0, f64::max);
        for (theta, radius) in sets.theta.iter().zip(&sets.radius) {
            assert!((radius - 0.4).abs() < 1e-15 && *theta >= 0.0);
        }
        assert_eq!((sets.theta.len(), sets.report.convexity_defect), (count, 0.0));
        assert!((sets.report.repair - sets.report.closure.ln().abs().exp_m1()).abs() < 1e-15);
        off.max(sets.report.closure.ln().abs())
    };
    for first in [0.0, 1.0, -2.5] {
        let errors = [40, 80, 160].map(|count| error(count, first));
        assert!(errors[0] < 1e-4 && errors[2] < errors[0] / 100.0, "{errors:?}");
    }
}

/// A rule that turns with its first direction gives the turned sets, wherever the list begins: the seam is nowhere.
#[test]
fn flow_rules_have_no_seam() {
    let count = 60;
    let phi: Vec<f64> = irregular(count, 0.0);
    let mut force = forces_of_an_elliptic_direction(&phi, [1.0, 0.5]);
    // Two neighbours out of order: θ turns back between them.
    let turn = |x: V, by: f64| nalgebra::Rotation2::new(by) * x;
    (force[20], force[21]) = (turn(force[20], 0.15), turn(force[21], -0.15));
    let theta = |k: usize| force[k].y.atan2(force[k].x);
    let fall = theta(20) - theta(21);
    assert!(fall > 0.02);
    let given = flow_sets(&phi, &force, 0.1, 0.4).unwrap();
    assert!((given.report.convexity_defect - fall).abs() < 1e-12, "{:?}", given.report);
    let closing = given.report.closure.ln().abs().exp_m1();
    assert!((given.report.repair - closing - fall.tan()).abs() < 1e-12, "{:?}", given.report);
    for start in [1, 19, 20, 21, 22, 59] {
        let by = phi[start];
        let shifted = |k: usize| match start + k {
            i if i < count => (phi[i] - by, turn(force[i], -by)),
            i => (phi[i - count] - by + std::f64::consts::TAU, turn(force[i - count], -by)),
        };
        let (phi, force): (Vec<f64>, Vec<V>) = (0..count).map(shifted).unzip();
        let turned = flow_sets(&phi, &force, 0.1, 0.4).unwrap();
        let (a, b) = (given.report, turned.report);
        assert!((a.closure - b.closure).abs() < 1e-12 && (a.repair - b.repair).abs() < 1e-12);
        assert!((a.convexity_defect - b.convexity_defect).abs() < 1e-12, "{start}: {b:?}");
        assert!((a.smallest_resistance - b.smallest_resistance).abs() < 1e-12);
        assert_eq!(given.support.len(), turned.support.len());
        let radii = |sets: &FlowSets| sets.radius.iter().sum::<f64>();
        assert!((radii(&given) - radii(&turned)).abs() < 1e-12);
        let mut compared = 0;
        for (angle, height) in turned.phi.iter().zip(&turned.support) {
            let near = |other: &f64| {
                let off = (angle + by - other).rem_euclid(std::f64::consts::TAU);
                off.min(std::f64::consts::TAU - off) < 1e-9
            };
            let same = given.phi.iter().zip(&given.support).find(|(other, _)| near(other));
            let Some((_, other)) = same else { continue };
            compared += 1;
            // What does not close is spread over the turn from the first direction on.
            assert!((height - other).abs() < 2.0 * closing + 1e-9, "{start}: {height} {other}");
        }
        assert!(compared + 5 > given.phi.len(), "{start}: {compared}");
    }
}

/// `f = e + εe⊥` winds up: `r_D(2π)/r_D(0) = exp(2πε)`. Spread over the turn nothing is left of it.
#[test]
fn what_does_not_close_is_spread_over_the_turn() {
    for twist in [1e-3, -2e-3] {
        let phi = irregular(50, 0.3);
        let force: Vec<V> = phi
            .iter()
            .map(|a| V::new(a.cos(), a.sin()) + V::new(-a.sin(), a.cos()) * twist)
            .collect();
        let sets = flow_sets(&phi, &force, 0.1, 0.0).unwrap();
        let closure = (std::f64::consts::TAU * twist).exp();
        assert!((sets.report.closure - closure).abs() < 1e-12, "{:?}", sets.report);
        assert!((sets.report.repair - closure.ln().abs().exp_m1()).abs() < 1e-12);
        assert!((sets.report.smallest_resistance - 1.0).abs() < 1e-15);
        // The spiral that is left has a constant angle to its radius and no change of the latter.
        assert!(sets.support.iter().all(|h| (h - 1.0).abs() < 1e-5), "{:?}", sets.support);
        let refused = flow_sets(&phi, &force, 0.9 * closure.ln().abs(), 0.0).unwrap_err();
        assert!(refused.to_string().contains(&format!("{closure:.6}")), "{refused}");
        assert!(flow_sets(&phi, &force, 1.1 * closure.ln().abs(), 0.0).is_ok());
    }
}

/// Rectangles: the force stands at a corner while the direction turns by a right angle, then jumps. *D* has flats where it
/// jumps and corners where it stands; of *C* the straight sides between the corners are taken.
#[test]
fn flow_rules_of_rectangles_are_exact() {
    let (a, b) = (0.5, 0.3);
    let right = std::f64::consts::FRAC_PI_2;
    let gap = 1e-6;
    let phi: Vec<f64> = (0..4)
        .flat_map(|k| [gap, 0.3, 0.8, 1.2, right - gap].map(|angle| angle + right * f64::from(k)))
        .collect();
    let force: Vec<V> =
        phi.iter().map(|p| V::new(a * p.cos().signum(), b * p.sin().signum())).collect();
    let sets = flow_sets(&phi, &force, 1e-4, 1e-12).unwrap();
    assert!((sets.report.closure - 1.0).abs() < 1e-5, "{:?}", sets.report);
    // Four corners, and seven points on every side.
    assert_eq!(sets.theta.len(), 32);
    assert!(sets.theta.windows(2).all(|pair| pair[1] - pair[0] > 1e-3));
    for (theta, radius) in sets.theta.iter().zip(&sets.radius) {
        let x = V::new(radius * theta.cos(), radius * theta.sin());
        assert!((f64::max(x.x.abs() / a, x.y.abs() / b) - 1.0).abs() < 1e-12, "{x}");
    }
    let highest = f64::hypot(a, b);
    for (angle, height) in sets.phi.iter().zip(&sets.support) {
        let exact = (a * angle.cos().abs() + b * angle.sin().abs()) / highest;
        assert!((height - exact).abs() < 1e-5, "{angle}: {height} for {exact}");
    }
    assert!(sets.phi.windows(2).all(|pair| pair[1] > pair[0]));
}

/// What a list of directions may be, to its limits.
#[test]
fn directions_of_flow_rules_are_checked_to_their_limits() {
    let right = std::f64::consts::FRAC_PI_2;
    let disk = |phi: &[f64]| phi.iter().map(|a| V::new(a.cos(), a.sin())).collect::<Vec<_>>();
    let make = |phi: &[f64]| flow_sets(phi, &disk(phi), 0.01, 0.01);
    let eight: Vec<f64> = (0..8).map(|k| 0.5 * right * f64::from(k)).collect();
    let sets = make(&eight).unwrap();
    assert!(sets.radius.iter().chain(&sets.support).all(|r| (r - 1.0).abs() < 1e-12));
    // At most so far apart: between neighbours and around the turn.
    let with_gap = |gap: f64, first: f64| -> Vec<f64> {
        let rest = 4.0 * right - gap;
        (0..9).map(|k| first + rest * f64::from(k) / 8.0).collect()
    };
    assert!(make(&with_gap(right - 1e-6, 0.0)).is_ok());
    let error = make(&with_gap(right + 1e-6, 0.0)).unwrap_err();
    assert!(error.to_string().contains("gap above") && error.argument() == "phi", "{error}");
    let mut inner = with_gap(0.1, 0.0);
    inner.retain(|a| !(1.0..2.5).contains(a));
    inner.insert(1, 0.1);
    inner.insert(2, 0.2);
    assert!(make(&inner).unwrap_err().to_string().contains("gap above"));
    // At least so far apart.
    let near = |step: f64| [vec![0.0, step], eight[1..].to_vec()].concat();
    assert!(make(&near(2e-7)).is_ok());
    assert!(make(&near(0.5e-7)).unwrap_err().to_string().contains("must rise"));
    // More than one turn.
    let turn = |last: f64| [eight.clone(), vec![last]].concat();
    assert!(make(&turn(4.0 * right - 2e-7)).is_ok());
    assert!(make(&turn(4.0 * right)).unwrap_err().to_string().contains("must rise"));
}

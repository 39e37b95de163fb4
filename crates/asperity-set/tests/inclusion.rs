//! The largest set of a shape inside another, against all directions one by one.

mod common;

use std::f64::consts::TAU;

use asperity_set::{
    Ball, CappedRectangle, Convex, Cuboid, Ellipsoid, Matrix, PolarCurve, Star, StarSet,
    Superellipsoid, Vector, largest_ratio, largest_scale_inside, ratio_in_closed_form,
};
use common::*;
use proptest::prelude::*;

/// Directions that are tried one by one.
const TRIED: usize = 3000;

/// The largest ratio of two gauges over directions all around, crowded where either set is slender.
fn tried(a: &dyn StarSet<2>, b: &dyn StarSet<2>) -> f64 {
    let ratio = |d: &V| a.gauge(d) / b.gauge(d);
    let mut largest = 0.0_f64;
    for set in [a, b] {
        let end = |d: V| 1.0 / set.gauge(&d);
        let size = V::new(end(V::new(1.0, 0.0)), end(V::new(0.0, 1.0)));
        for k in 0..TRIED / 2 {
            let (sine, cosine) = (TAU * k as f64 / (TRIED / 2) as f64).sin_cos();
            let slender = V::new(size.x * cosine, size.y * sine);
            largest = largest.max(ratio(&V::new(cosine, sine))).max(ratio(&slender));
        }
    }
    let corners = a.corners().into_iter().chain(b.corners());
    corners.map(|x| ratio(&x)).fold(largest, f64::max)
}

proptest! {
    #![proptest_config(cases(0.02))]

    /// No direction has a larger ratio than the one that is found, and that one has it.
    #[test]
    fn the_largest_ratio_is_that_of_all_directions(a in star(), b in star()) {
        let (ratio, at) = largest_ratio(&a, &b);
        // The last digit of a direction is 1e-16^s at a cusp of exponent s.
        let rounding = if a.as_convex().is_some() && b.as_convex().is_some() { 1e-7 } else { 2e-2 };
        prop_assert!(close(ratio, a.gauge(&at) / b.gauge(&at), rounding), "{ratio} {at}");
        prop_assert!((at.norm() - 1.0).abs() < 1e-12);
        let tried = tried(&a, &b);
        prop_assert!(ratio >= tried * (1.0 - 1e-9), "{ratio} instead of {tried}");
    }

    #[test]
    fn the_largest_scale_inside_touches_and_stays_inside(inner in convex(), outer in star()) {
        let scale = largest_scale_inside(&inner, &outer);
        let tried = tried(&outer, &inner);
        prop_assert!(scale * tried <= 1.0 + 1e-9, "{scale} instead of {}", 1.0 / tried);
        let (ratio, _) = largest_ratio(&outer, &inner);
        prop_assert!(close(scale, 1.0 / ratio, 1e-7), "{scale} {}", 1.0 / ratio);
    }
}

/// Beside the corner of a needle the ratio to a ball is largest on both sides, and least at the corner between them.
#[test]
fn the_larger_of_two_maxima_beside_a_corner_is_found() {
    let needle = Superellipsoid::new(V::new(0.11169561398793218, 2.0423289466208883), 1.0).unwrap();
    for (p, q) in [(-0.23942908475456526, 0.22599164726759402), (-0.1, 0.05), (0.0, 0.3)] {
        let map = Matrix::<2>::new(1.0, p, q, 1.0 + p * q);
        let outer = Star::from(needle).mapped(&map).unwrap();
        let [first, second] = [0, 1].map(|i| map.column(i) * needle.semi_axes()[i]);
        // The distance of the nearer pair of its sides, each between two corners, from the origin.
        let distance = |side: V| (first.x * second.y - first.y * second.x).abs() / side.norm();
        let nearest = distance(first - second).min(distance(first + second));
        let found = largest_scale_inside(&Ball::UNIT, &outer);
        assert!(close(found, nearest, 1e-9), "{found} instead of {nearest}");
    }
}

/// Nor is the point of a needle that is farthest away its tip, but lies on both sides of it.
#[test]
fn the_farthest_point_of_a_needle_lies_beside_its_tip() {
    let axes = V::new(0.18630193764733524, 11.67473380317603);
    for exponent in [2.5, 3.0, 4.182359812651839, 8.0] {
        // Where the normal is along the position, x/a is this part of y/b.
        let part = (axes.x / axes.y).powf(2.0 / (exponent - 2.0));
        let tip = V::new(axes.x * part, axes.y) / (1.0 + part.powf(exponent)).powf(1.0 / exponent);
        let needle = Star::from(Superellipsoid::new(axes, exponent).unwrap());
        let turned = Matrix::<2>::new(
            0.97983002585355,
            -0.19983273114240233,
            0.19983273114240233,
            0.97983002585355,
        );
        let needle = needle.mapped(&turned).unwrap();
        let inner = needle.as_convex().unwrap();
        let found = largest_scale_inside(inner, &Ball::UNIT);
        assert!(close(found, 1.0 / tip.norm(), 1e-13), "{exponent}: {found} {}", 1.0 / tip.norm());
    }
}

/// Both ends of the cap of a needle have a largest ratio, nearer to each other than directions that are equidistant.
#[test]
fn the_larger_of_two_maxima_on_the_cap_of_a_needle_is_found() {
    let needle = CappedRectangle::new(0.04233170973617401, 28.768983854508217, 1.0).unwrap();
    let needle = convex_of(Star::from(needle));
    // Beside the tip the ratio to a disk that lies off the origin has its maxima at both sides of the cap.
    let angles: Vec<f64> = (0..48).map(|k| TAU * f64::from(k) / 48.0).collect();
    for offset in [-1e-4, 1e-4] {
        let radius: Vec<f64> = angles.iter().map(|t| 1.0 / (1.0 + offset * t.cos())).collect();
        let outer = PolarCurve::new(&angles, &radius).unwrap();
        let (ratio, at) = largest_ratio(&outer, &needle);
        assert!(ratio >= tried(&outer, &needle) * (1.0 - 1e-12), "{ratio} at {at}");
        let scale = largest_scale_inside(&needle, &outer);
        assert!(close(scale, 1.0 / ratio, 1e-12), "{scale} {}", 1.0 / ratio);
    }
}

/// A set of which nothing is known but its gauge and its corners.
#[derive(Debug)]
struct Plain<'a, const P: usize>(&'a Star<P>);

impl<const P: usize> StarSet<P> for Plain<'_, P> {
    fn gauge(&self, x: &Vector<P>) -> f64 {
        self.0.gauge(x)
    }

    fn corners(&self) -> Vec<Vector<P>> {
        self.0.corners()
    }
}

/// Of so many pairs there are closed forms: of ellipsoids whatever their axes, of boxes and powers along the same axes, of
/// images under the same map.
fn known<const P: usize>() -> impl Strategy<Value = (Star<P>, Star<P>)> {
    let ellipsoid = || {
        (semi_axes::<P>(8.0), -0.5..0.5, -0.5..0.5).prop_map(|(a, p, q)| {
            let map = Matrix::from_fn(|i, j| [p, 1.0, q][usize::from(i >= j) + usize::from(i > j)]);
            let set = Convex::from(Ellipsoid::new(a).unwrap());
            Star::from(set.mapped(&map).unwrap())
        })
    };
    let powers = || {
        let power = (semi_axes::<P>(8.0), log_uniform(0.3, 100.0))
            .prop_map(|(a, s)| Star::from(Superellipsoid::new(a, s).unwrap()));
        let cuboid = (semi_axes::<P>(8.0), semi_axes::<P>(8.0))
            .prop_map(|(a, b)| Star::from(Convex::from(Cuboid::new(-a, b).unwrap())));
        let ball =
            log_uniform(0.1, 10.0).prop_map(|r| Star::from(Convex::from(Ball::new(r).unwrap())));
        prop_oneof![2 => power, 1 => cuboid, 1 => ball]
    };
    let images = (powers(), powers(), -0.5..0.5, -0.5..0.5).prop_map(|(a, b, p, q)| {
        let map = Matrix::from_fn(|i, j| [p, 1.0, q][usize::from(i >= j) + usize::from(i > j)]);
        (a.mapped(&map).unwrap(), b.mapped(&map).unwrap())
    });
    prop_oneof![(ellipsoid(), ellipsoid()), (powers(), powers()), images]
}

/// The closed form is the ratio in its direction, and none that a search finds is larger.
fn check_closed_form<const P: usize>(a: &Star<P>, b: &Star<P>) -> Result<(), TestCaseError> {
    let Some((ratio, at)) = ratio_in_closed_form(a, b) else {
        // Balls become ellipsoids, which have no closed form beside other images.
        let balls = [a, b].iter().any(|set| matches!(set, Star::Convex(Convex::Ellipsoid(_))));
        prop_assert!(balls, "no closed form");
        return Ok(());
    };
    // Beside a cusp of exponent s the last digit of a direction is 1e-16^s.
    let there = a.gauge(&at) / b.gauge(&at);
    let cusped = a.as_convex().is_none() || b.as_convex().is_none();
    prop_assert!(close(ratio, there, if cusped { 1e-3 } else { 1e-12 }), "{ratio} {there}");
    let (found, _) = largest_ratio(&Plain(a), &Plain(b));
    prop_assert!(found <= ratio * (1.0 + 1e-12), "{found} above {ratio}");
    prop_assert!(
        found >= ratio * (1.0 - if cusped { 1e-3 } else { 1e-9 }),
        "{found} below {ratio}"
    );
    Ok(())
}

proptest! {
    #![proptest_config(cases(0.005))]

    #[test]
    fn closed_forms_on_a_line((a, b) in known::<1>()) {
        check_closed_form(&a, &b)?;
    }

    #[test]
    fn closed_forms_in_the_plane((a, b) in known::<2>()) {
        check_closed_form(&a, &b)?;
    }

    #[test]
    fn closed_forms_in_space((a, b) in known::<3>()) {
        check_closed_form(&a, &b)?;
    }
}

/// Where one direction is nearly as good as all on a circle around, the search follows the ridge to its top.
#[test]
fn the_largest_ratio_of_slender_ellipsoids_lies_on_a_ridge() {
    let flat = Ellipsoid::new(Vector::<3>::new(1.0, 0.2036915679387676, 1.0)).unwrap();
    let axes = Matrix::<3>::from_columns(&[
        Vector::<3>::new(0.8378665923207339, -0.3573834428277002, -0.4126216769214401),
        Vector::<3>::new(0.5428448895554746, 0.625039484675225, 0.5609323207664485),
        Vector::<3>::new(0.05743691631995876, -0.6939760207597588, 0.7177034786414963),
    ]);
    let semi_axes = Vector::<3>::new(8.353040869784662, 0.1319429465703741, 2.5192132064596175);
    let slender = Ellipsoid::turned(semi_axes, axes).unwrap();
    check_closed_form(&Convex::from(flat).into(), &Convex::from(slender).into()).unwrap();
}

/// The ratio of gauges with cusps along the same axis rises beside it, as the sharper one does, and falls again: here it is
/// largest at an angle of some 1e-18, which is no rounding there.
#[test]
fn the_largest_ratio_lies_right_beside_a_cusp() {
    let cusped = |a: f64, b: f64, s: f64| -> Star<2> {
        Superellipsoid::new(V::new(a, b), s).unwrap().into()
    };
    let capped = Star::from(Convex::from(CappedRectangle::new(1.0, 1.0, 1.0).unwrap()));
    let first = cusped(0.39981898037184993, 0.21016094160098595, 0.3222327684942054);
    let second = cusped(0.06509121686289154, 21.375659334425233, 0.3808935345074954);
    // Beside this cusp the other members of both sets are far away.
    let (largest, at) = ratio_in_closed_form(&first, &second).unwrap();
    assert!(at.x != 0.0 && at.x.abs() < 1e-16 && at.y.abs() > 0.9, "{at}");
    let a = Star::intersection(&[first, capped.clone()]).unwrap();
    let b = Star::union(&[second, capped]).unwrap();
    let (ratio, at) = largest_ratio(&a, &b);
    assert!(close(ratio, largest, 1e-14), "{ratio} instead of {largest} at {at}");
    assert!(tried(&a, &b) <= ratio);
}

//! Properties that every set must have, over random sets of every kind.
//!
//! `PROPTEST_CASES=100000 cargo test -p asperity-set --release` is the long profile.

mod common;

use std::collections::BTreeSet;
use std::f64::consts::TAU;

use asperity_set::{
    CappedRectangle, Convex, ConvexSet, Ellipsoid, Matrix, PolarCurve, Star, StarSet,
    Superellipsoid,
};
use common::*;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

/// A kind that no strategy makes would be tested by nothing.
#[test]
fn every_kind_of_set_is_among_the_cases() {
    let mut runner = TestRunner::deterministic();
    let mut seen = BTreeSet::new();
    for _ in 0..2000 {
        seen.extend(kinds(&star().new_tree(&mut runner).unwrap().current()));
        let in_space = convex_in_space().new_tree(&mut runner).unwrap().current();
        seen.extend(kinds(&Star::Convex(in_space)));
    }
    assert_eq!(seen.into_iter().collect::<Vec<_>>(), KINDS);
}

proptest! {
    #![proptest_config(cases(1.0))]

    /// Multiples by a power of two are exact. Others round the direction, which the steepness of the gauge magnifies, beside a cusp
    /// without a bound: nothing worse than nine digits passes.
    #[test]
    fn gauge_is_homogeneous_and_one_on_the_boundary(set in star(), d in direction(), s in multiples()) {
        let (gauge, gradient) = set.gauge_jet(&d);
        let exact = s.log2().round().exp2();
        prop_assert!(close(set.gauge(&(d * exact)), exact * gauge, 1e-13));
        let rounding = (1e-15 * gradient.norm() / gauge).clamp(1e-13, 1e-9);
        prop_assert!(close(set.gauge(&(d * s)), s * gauge, rounding));
        prop_assert!(close(set.gauge(&point_of(&set, &d, 1.0)), 1.0, 10.0 * rounding));
        prop_assert_eq!(set.gauge(&V::zeros()), 0.0);
        prop_assert!(close(set.radius(&(d * s)), set.radius(&d), rounding));
    }

    /// Of samples in pairs that are close together, the curve bends up to a thousand times as much as its gauge is large. This
    /// must not cost digits.
    #[test]
    fn gauge_through_close_samples_keeps_its_digits(
        pairs in prop::collection::vec((log_uniform(1e-3, 0.5), -0.1..0.1), 6..20),
        d in direction(), s in multiples(),
    ) {
        let step = TAU / pairs.len() as f64;
        let (mut angle, mut radius) = (Vec::new(), Vec::new());
        for (k, (distance, slope)) in pairs.iter().enumerate() {
            angle.extend([k as f64 * step, (k as f64 + distance) * step]);
            radius.extend([1.0, 1.0 + slope * distance]);
        }
        let set = PolarCurve::new(&angle, &radius).unwrap();
        let (gauge, gradient) = set.gauge_jet(&d);
        let steepness = gradient.norm() / gauge;
        prop_assert!(close(set.gauge(&(d * s)), s * gauge, 4e-15 * steepness), "{angle:?} {radius:?}");
        for (angle, radius) in angle.iter().zip(&radius) {
            let d = V::new(angle.cos(), angle.sin());
            prop_assert!(close(set.gauge(&d) * radius, 1.0, 4e-15 * steepness.max(4.0)), "{angle} {radius}");
        }
    }

    #[test]
    fn gradient_obeys_euler_and_has_degree_zero(set in star(), d in direction(), s in multiples()) {
        let x = point_of(&set, &d, s);
        let gradient = set.gauge_gradient(&x).unwrap();
        prop_assert!(close(gradient.dot(&x), set.gauge(&x), 1e-9), "{gradient} {x}");
        let (gauge, same) = set.gauge_jet(&x);
        prop_assert_eq!(gradient, same);
        prop_assert!(close(gauge, set.gauge(&x), 1e-14));
        prop_assert!(set.gauge_gradient(&V::zeros()).is_none());
        let normal = set.as_convex().map_or(same, |convex| convex.normal(&x));
        prop_assert!((normal.normalize() - gradient.normalize()).norm() <= 1e-12, "{normal} {x}");
    }

    #[test]
    fn gradient_is_the_slope_of_the_gauge(
        a in (0.2..5.0, 0.2..5.0), s in prop_oneof![0.3..0.9, 1.1..20.0], t in 0.1..1.4, angle in -4.0..4.0
    ) {
        let set = Star::from(Superellipsoid::new(V::new(a.0, a.1), s).unwrap()).rotated(angle).unwrap();
        let x = V::new(f64::cos(t + angle), f64::sin(t + angle));
        let gradient = set.gauge_gradient(&x).unwrap();
        for i in 0..2 {
            let h = 1e-5 * V::ith(i, 1.0);
            let slope = (set.gauge(&(x + h)) - set.gauge(&(x - h))) / 2e-5;
            prop_assert!((slope - gradient[i]).abs() < 1e-5 * gradient.norm().max(1.0));
        }
    }

    #[test]
    fn support_is_sublinear(set in convex(), a in direction(), b in direction(), s in multiples()) {
        let sum = a + b;
        prop_assert!(set.support(&sum) <= (set.support(&a) + set.support(&b)) * (1.0 + 1e-13));
        prop_assert!(close(set.support(&(a * s)), s * set.support(&a), 1e-13));
        prop_assert_eq!(set.support(&V::zeros()), 0.0);
    }

    /// Polarity `x·y ≤ k(x) h(y)`, with equality at the support point, where `y` is normal (Fenchel).
    #[test]
    fn support_and_gauge_are_polar(set in convex(), x in direction(), y in direction()) {
        prop_assert!(x.dot(&y) <= set.gauge(&x) * set.support(&y) * (1.0 + 1e-12));
        let farthest = set.support_point(&y);
        prop_assert!(close(farthest.dot(&y), set.support(&y), 1e-12));
        prop_assert!(close(set.gauge(&farthest), 1.0, 1e-7));
        let boundary = point_of(&set, &x, 1.0);
        let normal = set.gauge_gradient(&boundary).unwrap();
        prop_assert!(close(set.support(&normal), 1.0, 1e-9), "h(∇k) = {}", set.support(&normal));
    }

    #[test]
    fn hessian_is_the_slope_of_the_support_point(
        a in (0.2..5.0, 0.2..5.0), s in 1.2..12.0, t in 0.1..1.4, angle in -4.0..4.0
    ) {
        let plain = Convex::try_from(Superellipsoid::new(V::new(a.0, a.1), s).unwrap()).unwrap();
        for set in [plain, Ellipsoid::new(V::new(a.0, a.1)).unwrap().into()] {
            let set = set.rotated(angle).unwrap();
            let y = V::new(f64::cos(t + angle), f64::sin(t + angle));
            let hessian = set.support_hessian(&y);
            prop_assert!((hessian * y).norm() < 1e-9 * hessian.norm());
            prop_assert!((hessian - hessian.transpose()).norm() < 1e-12 * hessian.norm());
            prop_assert!(hessian.trace() > 0.0);
            let h = 1e-6;
            for i in 0..2 {
                let d = V::ith(i, h);
                let slope = (set.support_point(&(y + d)) - set.support_point(&(y - d))) / (2.0 * h);
                prop_assert!((slope - hessian.column(i)).norm() < 1e-4 * hessian.norm() + 1e-8);
            }
        }
    }

    /// `x = prox(z)` iff `x` lies in the set and `(z − x)·(x* − x) ≤ 0`, that is `h(z − x) = x·(z − x)`.
    #[test]
    fn projection_satisfies_its_variational_inequality(set in convex(), d in direction(), k in multiples()) {
        let z = point_of(&set, &d, k);
        let x = set.project(&z);
        prop_assert!(set.gauge(&x) <= 1.0 + 1e-11, "outside: {}", set.gauge(&x));
        if set.gauge(&z) <= 1.0 {
            prop_assert!((x - z).norm() <= 1e-15 * z.norm());
            return Ok(());
        }
        let normal = z - x;
        let gap = set.support(&normal) - x.dot(&normal);
        // An error δ of x is one of the normal too, which counts with the size of the set. The rounding
        // of z is an error x may have, for the projection does not expand.
        let size: f64 = [V::x(), V::y(), -V::x(), -V::y()].iter().map(|e| set.support(e)).sum();
        let error = 1e-12 * x.norm() + 4e-15 * z.norm();
        prop_assert!(gap <= error * (normal.norm() + size),
            "gap {:e} at x {} n {}", gap / (x.norm() * normal.norm()), x, normal);
        let again = set.project(&x);
        prop_assert!((again - x).norm() <= 1e-11 * x.norm());
    }

    #[test]
    fn projection_from_a_start_is_the_same(set in convex(), d in direction(), k in 1.0..4.0, e in direction()) {
        let z = point_of(&set, &d, k);
        let x = set.project(&z);
        for start in [x, x + 1e-3 * x.norm() * e, point_of(&set, &e, 1.0)] {
            let again = set.project_from(&z, &start);
            prop_assert!((again - x).norm() <= 1e-12 * z.norm().max(x.norm()), "{:e}", (again - x).norm() / x.norm());
        }
    }

    #[test]
    fn projection_does_not_expand(set in convex(), a in direction(), b in direction(), s in 0.1..5.0, t in 0.1..5.0) {
        let (y, z) = (point_of(&set, &a, s), point_of(&set, &b, t));
        let (py, pz) = (set.project(&y), set.project(&z));
        prop_assert!((py - pz).norm() <= (y - z).norm() * (1.0 + 1e-9) + 1e-12 * py.norm());
    }

    /// (12): `y ∈ N(x) ⇔ x = prox(x + ry)`.
    #[test]
    fn normal_cone_and_projection_agree(set in convex(), d in direction(), r in log_uniform(1e-3, 1e3)) {
        let x = point_of(&set, &d, 1.0);
        let cone = set.normal_cone(&x, 1e-13).unwrap();
        prop_assert!(!cone.generators().is_empty());
        for normal in cone.generators() {
            let z = x + normal * (r * x.norm());
            prop_assert!((set.project(&z) - x).norm() <= 1e-6 * x.norm());
        }
        prop_assert!(set.normal_cone(&(x * 0.5), 1e-9).unwrap().generators().is_empty());
        prop_assert!(set.normal_cone(&(x * 1.5), 1e-9).is_none());
    }

    #[test]
    fn rotation_and_scaling_carry_over(set in convex(), d in direction(), angle in -4.0..4.0_f64, c in log_uniform(1e-3, 1e3)) {
        let turn = Matrix::<2>::new(angle.cos(), -angle.sin(), angle.sin(), angle.cos());
        let moved = set.rotated(angle).unwrap().scaled(c).unwrap();
        prop_assert!(close(moved.gauge(&(turn * d * c)), set.gauge(&d), 1e-7));
        prop_assert!(close(moved.support(&(turn * d)), c * set.support(&d), 1e-7));
    }

    /// Rule (9): `y ∈ N_C(x) ⇔ Aᵀy ∈ N_{A⁻¹C}(A⁻¹x)`.
    #[test]
    fn linear_images_follow_rule_nine(set in plain(30.0), y in direction(), p in -0.7..0.7, q in -0.7..0.7) {
        let map = Matrix::<2>::new(1.0, p, q, 1.0 + p * q);
        let image = set.mapped(&map).unwrap();
        let x = set.support_point(&map.tr_mul(&y));
        prop_assert!(close(image.support(&y), (map * x).dot(&y), 1e-10));
        prop_assert!(close(image.gauge(&(map * y)), set.gauge(&y), 1e-7));
    }
}

/// Caps that are shorter than the last digit of the length end in a straight side, whose normal is along the runner.
#[test]
fn gradients_of_runners_with_the_shortest_caps_obey_euler() {
    for cap in [1e-3, 1e-9, 1e-17, 1e-36] {
        let set = CappedRectangle::new(0.04, 0.45, cap).unwrap();
        let beside =
            (0..200).map(|k| V::new((0.1 * f64::from(k)).cos(), (0.1 * f64::from(k)).sin()));
        let edges = [1.0 - 1e-15, 1.0 - 1e-9, 0.5, 0.0, 1.0].map(|v| V::new(0.04, 0.45 * v));
        for x in beside.chain(edges) {
            let (gauge, gradient) = set.gauge_jet(&x);
            assert!((gradient.dot(&x) - gauge).abs() <= 1e-12 * gauge, "{cap:e} {x} {gradient}");
            // A gradient of the gauge supports the set: h(∇k) = 1.
            assert!((set.support(&gradient) - 1.0).abs() <= 1e-12, "{cap:e} {x} {gradient}");
        }
    }
}

/// Gauge and projection agree to the bit on what is inside.
#[test]
fn points_that_the_gauge_holds_are_their_own_projection() {
    let slender =
        Convex::from(Ellipsoid::new(V::new(21.752277746128367, 0.05145699979310336)).unwrap());
    for set in [slender.clone(), slender.rotated(2.4155).unwrap()] {
        for k in 0..10_000 {
            let z = point_of(&set, &V::new(f64::from(k).cos(), f64::from(k).sin()), 1.0);
            let x = set.project(&z);
            assert!(set.gauge(&z) > 1.0 || x == z, "{x} of {z}");
        }
    }
}

//! Slopes, cones and verdicts, over random sets of every kind.

mod common;

use asperity_set::{
    Convex, ConvexSet, Star, StarSet, Vector, convexity, strict_convexity, symmetry, tangent_cone,
};
use common::*;
use proptest::prelude::*;

proptest! {
    #![proptest_config(cases(1.0))]

    /// Where the gradient turns between the two points of a difference quotient, nothing is asked.
    #[test]
    fn gradient_of_every_set_is_the_slope_of_its_gauge(set in star(), d in direction(), e in direction()) {
        let x = point_of(&set, &d, 1.0);
        let step = e * (1e-6 * x.norm());
        let [ahead, behind] = [x + step, x - step].map(|x| set.gauge_jet(&x));
        let (slope, gradient) = (0.5 * (ahead.0 - behind.0), set.gauge_gradient(&x).unwrap());
        if [ahead.1, behind.1].iter().any(|g| (g - gradient).norm() > 1e-3 * gradient.norm()) {
            return Ok(());
        }
        prop_assert!(
            (slope - gradient.dot(&step)).abs() <= 1e-3 * gradient.norm() * step.norm() + 1e-12,
            "{slope:e} instead of {:e}", gradient.dot(&step)
        );
    }

    #[test]
    fn hessian_of_every_set_is_the_slope_of_its_support_point(set in convex(), y in direction(), e in direction()) {
        let step = e * 1e-6;
        let (size, hessian) = (set.support_point(&y).norm(), set.support_hessian(&y));
        let [ahead, behind] = [y + step, y - step].map(|y| set.support_hessian(&y));
        let smooth = [hessian, ahead, behind].iter().all(|h| h.iter().all(|v| v.is_finite()));
        let turns = (ahead - hessian).norm().max((behind - hessian).norm());
        if !smooth || turns > 0.05 * hessian.norm() {
            return Ok(());
        }
        let slope = (set.support_point(&(y + step)) - set.support_point(&(y - step))) * 0.5;
        // A flat or a straight edge between the two points, seen from corners on both sides.
        let across = |n: &Vector<2>| (n.normalize() - y.normalize()).norm() <= 2.0 * step.norm() / y.norm();
        if set.flat_normals().iter().any(across) || slope.norm() > 1e-2 * size {
            return Ok(());
        }
        prop_assert!((slope - hessian * step).norm() <= 0.05 * (hessian * step).norm() + 1e-9 * size,
            "{slope} instead of {}", hessian * step);
        prop_assert!((hessian * y).norm() <= 1e-7 * hessian.norm() + 1e-9 * size);
    }

    /// Every vector is the sum of its projections onto the normal and the tangent cone, which are orthogonal.
    #[test]
    fn normal_and_tangent_cones_are_polar(set in convex(), d in direction(), y in direction(), corner in 0..20_usize) {
        let corners = set.corners();
        let x = if corners.is_empty() { point_of(&set, &d, 1.0) } else { corners[corner % corners.len()] };
        let normals = set.normal_cone(&x, 1e-9).unwrap();
        let tangents = normals.polar();
        let (n, t) = (normals.project(&y), tangents.project(&y));
        prop_assert!((n + t - y).norm() < 1e-6, "{n} {t}");
        prop_assert!(n.dot(&t).abs() < 1e-6);
        // Seen from x, the set lies within the tangent cone.
        let inside = point_of(&set, &y, 1.0) - x;
        prop_assert!(tangents.distance(&inside) <= 1e-6 * inside.norm().max(x.norm()));
        let parts = tangent_cone(&Star::Convex(set.clone()), &x, 1e-9).unwrap();
        prop_assert_eq!(parts, vec![tangents]);
    }

    /// The tangent cone of a star-shaped set holds what the set holds nearby, also at corners that point in.
    #[test]
    fn tangent_cones_of_star_shaped_sets_hold_the_set(
        set in star(), d in direction(), e in direction(), corner in 0..20_usize
    ) {
        let corners = set.corners();
        let x = if corners.is_empty() { point_of(&set, &d, 1.0) } else { corners[corner % corners.len()] };
        let parts = tangent_cone(&set, &x, 1e-9).unwrap();
        let near = x + e * (1e-7 * x.norm());
        let near = near / set.gauge(&near).max(1.0);
        // Nothing is asked where the boundary bends within the step: cusps, thin sets.
        let normal = |x: &V| set.gauge_jet(x).1.normalize();
        let ends = [x + (near - x) * 1e-3, near].map(|x| normal(&x));
        let step = near - x;
        let distance = parts.iter().map(|part| part.distance(&step)).fold(f64::INFINITY, f64::min);
        let bends = (ends[0] - ends[1]).norm() > 1e-2 || step.norm() < 1e-9 * x.norm()
            || matches!(set, Star::Superellipsoid(_) | Star::Image(_));
        prop_assert!(bends || distance <= 0.1 * step.norm(), "{distance:e} of {:e}", step.norm());
    }

    /// `Ψ*_C(y) − xᵀy ≥ 0` on the set, with equality if and only if `y` is normal at `x` (Fenchel).
    #[test]
    fn fenchel_gap_vanishes_at_normals_only(set in convex(), d in direction(), y in direction()) {
        let x = point_of(&set, &d, 1.0);
        let gap = set.support(&y) - x.dot(&y);
        prop_assert!(gap >= -1e-12 * x.norm());
        if (set.support_point(&y) - x).norm() > 1e-3 * x.norm() && set.normal_cone(&x, 1e-9).unwrap().distance(&y) > 1e-2 {
            prop_assert!(gap > 0.0);
        }
        let cone = set.normal_cone(&x, 1e-9).unwrap();
        for n in cone.generators() {
            prop_assert!((set.support(n) - x.dot(n)).abs() <= 1e-7 * x.norm());
        }
    }
}

proptest! {
    // Verdicts by samples look at thousands of points.
    #![proptest_config(cases(0.01))]

    #[test]
    fn verdicts_come_with_a_witness(set in star()) {
        let verdict = convexity(&set);
        prop_assert_eq!(verdict.holds, verdict.witness.is_empty());
        prop_assert!(verdict.holds || set.as_convex().is_none());
        if let [a, b] = verdict.witness[..] {
            // At the tip of a cusp the gauge magnifies rounding errors.
            let cusp = set.corners().iter().any(|c| set.gauge(c) > 1.0 + 1e-9);
            let inside = |x| set.gauge(x) <= 1.0 + if cusp { 1e-2 } else { 1e-9 };
            prop_assert!(inside(&a) && inside(&b));
            prop_assert!(set.gauge(&((a + b) * 0.5)) >= 1.0 - 1e-12);
        }
        let strict = strict_convexity(&set);
        prop_assert!(!strict.holds || verdict.holds);
        if let ([a, b], true) = (&strict.witness[..], verdict.holds) {
            prop_assert!((set.gauge(&((a + b) * 0.5)) - 1.0).abs() < 1e-6);
            // Of intersections segments are found by samples, which take sides of superellipses for straight.
            let exact = set.as_convex().filter(|set| !matches!(set, Convex::Intersection(_)));
            if let Some(convex) = exact {
                let (along, normals) = ((b - a).normalize(), convex.flat_normals());
                let across = |n: &Vector<2>| n.normalize().dot(&along).abs() < 1e-6;
                prop_assert!(normals.iter().any(across), "{along} is along none of {normals:?}");
            }
        }
        let symmetric = symmetry(&set);
        prop_assert_eq!(symmetric.holds, symmetric.witness.is_empty());
        if let [x] = symmetric.witness[..] {
            prop_assert!((set.gauge(&-x) - set.gauge(&x)).abs() > 1e-10);
        }
    }
}

//! The largest set of a shape inside another, against all directions one by one.

mod common;

use std::f64::consts::TAU;

use asperity_set::{StarSet, largest_ratio, largest_scale_inside};
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

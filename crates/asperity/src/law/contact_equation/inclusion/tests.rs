//! Slip of forces near the boundary of their set.

use asperity_set::{Convex, Ellipse, Star, Superellipse, Vector};

use super::*;

/// However rounding moves a percussion off bdry *C*, in slip it is no farther from a pair that obeys the law than
/// rounding, and a velocity that is turned is as far as it is turned, beside cusps as well.
#[test]
fn slip_is_near_whatever_rounding_does() {
    let superellipse = |s| Superellipse::new(Vector::<2>::new(1.0, 0.5), s).unwrap();
    let ellipse = Convex::from(Ellipse::new(Vector::<2>::new(1.0, 0.4)).unwrap());
    for (exponent, size) in [(0.5, 1.0), (0.8, 1.0), (0.5, 1e6), (0.8, 1e-6)] {
        let reservoir = Star::from(superellipse(exponent)).rotated(0.4).unwrap();
        let law = FrictionLaw::new(reservoir.scaled(size).unwrap(), ellipse.clone()).unwrap();
        for k in 0..64 {
            let (sine, cosine) = (0.1 * f64::from(k) + 0.03).sin_cos();
            let ray = Vector::<2>::new(cosine, sine);
            let on_border = ray / law.reservoir().gauge(&ray);
            let normal = law.direction().normal(&ray).normalize();
            for ulps in -6..=6 {
                let x = on_border * (1.0 + f64::from(ulps) * f64::EPSILON);
                let off = slip_beside(&law, &x, &(normal * size));
                assert!(off <= 1e-12 * size, "{exponent} {size} {k} {ulps}: {off:e}");
                let across = Vector::<2>::new(-normal.y, normal.x) * (0.1 * size);
                let off = slip_beside(&law, &x, &(normal * size + across));
                assert!((off / (0.1 * size) - 1.0).abs() < 1e-9, "{exponent} {k}: {off:e}");
            }
        }
    }
}

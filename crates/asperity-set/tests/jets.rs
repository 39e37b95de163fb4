//! The derivative of the projection, over random sets of every kind.

mod common;

use asperity_set::{Convex, ConvexSet, Matrix, Vector};
use common::*;
use proptest::prelude::*;
use proptest::test_runner::TestCaseResult;

/// `slack` is the relative error of the set's projection.
fn derivative<const P: usize>(
    set: &Convex<P>,
    d: &Vector<P>,
    e: &Vector<P>,
    k: f64,
    slack: f64,
) -> TestCaseResult {
    let z = point_of(set, d, k);
    let start = point_of(set, e, 1.0);
    let (x, jacobian) = set.project_jet(&z, &start);
    let plain = set.project(&z);
    prop_assert!((x - plain).norm() <= (1e-12 + slack) * z.norm(), "{x} {plain}");
    if k < 1.0 - 1e-9 {
        prop_assert_eq!(jacobian, Matrix::<P>::identity());
        return Ok(());
    }
    prop_assert!((jacobian - jacobian.transpose()).amax() <= 1e-14, "{jacobian}");
    let values = eigenvalues(&jacobian);
    prop_assert!(values.iter().all(|v| (-1e-9..=1.0 + 1e-9).contains(v)), "{values:?}");
    let away = z - x;
    if away.norm() <= 1e-6 * x.norm() {
        return Ok(());
    }
    prop_assert!((jacobian * away.normalize()).norm() <= 1e-7, "{jacobian} {away}");
    // Where two steps differ the projection has a kink or bends too much for differences.
    let slope = |step: f64| {
        let shift = e * (step * z.norm());
        (set.project(&(z + shift)) - set.project(&(z - shift))) / (2.0 * step * z.norm())
    };
    let (fine, coarse) = (slope(1e-5), slope(3e-5));
    // Nor do they see the infinite curvature of a superellipse on its axes, which is met at a single point.
    let on_axis = d.iter().any(|v| *v == 0.0);
    if (fine - coarse).norm() <= 1e-7 && !(on_axis && P > 1) {
        let defect = (jacobian * e - fine).norm();
        prop_assert!(defect <= 1e-6 + 1e3 * slack, "{defect:e} {jacobian} {fine}");
    }
    Ok(())
}

fn eigenvalues<const P: usize>(matrix: &Matrix<P>) -> Vec<f64> {
    let matrix = nalgebra::DMatrix::from_column_slice(P, P, matrix.as_slice());
    matrix.symmetric_eigenvalues().iter().copied().collect()
}

fn distances() -> impl Strategy<Value = f64> {
    prop_oneof![0.1..1.0, 1.0..4.0, log_uniform(1e-9, 1e3).prop_map(|g| 1.0 + g)]
}

proptest! {
    #![proptest_config(cases(0.5))]

    #[test]
    fn in_the_plane(set in convex(), d in direction(), e in direction(), k in distances()) {
        derivative(&set, &d, &e, k, 0.0)?;
    }

    #[test]
    fn on_a_line(set in plain::<1>(100.0), k in distances(), forward in any::<bool>()) {
        let d = Vector::<1>::new(if forward { 1.0 } else { -1.0 });
        derivative(&set, &d, &d, k, 0.0)?;
    }
}

proptest! {
    #![proptest_config(cases(0.2))]

    #[test]
    fn in_space(
        set in convex_in_space(), d in direction_in_space(), e in direction_in_space(), k in distances()
    ) {
        derivative(&set, &d, &e, k, 0.0)?;
    }
}

proptest! {
    // Their projections are iterations of up to milliseconds.
    #![proptest_config(cases(0.01))]

    #[test]
    fn of_images_and_combinations_in_space(
        set in slow_in_space(), d in direction_in_space(), e in direction_in_space(), k in 0.5..20.0
    ) {
        derivative(&set, &d, &e, k, 1e-8)?;
    }
}

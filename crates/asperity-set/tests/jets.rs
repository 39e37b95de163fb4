//! The derivative of the projection, over random sets of every kind.

mod common;

use asperity_set::{
    Ball, Convex, ConvexSet, Cuboid, Ellipsoid, Matrix, Star, Superellipsoid, Vector,
};
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

/// On the edge of a ball and an ellipsoid the nearest point slides along the edge, which bends as both boundaries do.
#[test]
fn along_an_edge_in_space() {
    let ball = Convex::from(Ball::new(0.5288843547241534).unwrap());
    let axes = Vector::<3>::new(0.779245100138201, 2.2052537410499173, 0.4144884297547543);
    let ellipsoid = Convex::from(Ellipsoid::new(axes).unwrap());
    let set = Star::intersection(&[ball.into(), ellipsoid.into()]).unwrap();
    let set = set.as_convex().unwrap();
    let d = Vector::<3>::new(0.6994335008600209, 0.05667115591307055, 0.7124473018842669);
    let e = Vector::<3>::new(-0.26789229985565655, 0.5835584748692021, -0.7666115196671505);
    derivative(set, &d, &e, 13.696239874260627, 0.0).unwrap();
}

/// The Jacobian of a sum follows from those of its members, also where one of them is a box but for its last digits.
#[test]
fn of_a_sum_of_flat_and_round_sets() {
    let axes = Vector::<3>::new(0.44348430693521057, 1.170705965475045, 0.43700635603343335);
    let rounded = Star::from(Superellipsoid::new(axes, 402.33946744864676).unwrap());
    let [near, far, above] = [0.4435786120985275, 1.2464551210126644, 0.3159100943211465];
    let (lower, upper) =
        (Vector::<3>::new(-near, -near, -far), Vector::<3>::new(near, near, above));
    let cuboid = Convex::from(Cuboid::new(lower, upper).unwrap());
    let axes = Vector::<3>::new(1.2904836752424138, 0.7455527839530447, 1.2904836752424138);
    let ellipsoid = Convex::from(Ellipsoid::new(axes).unwrap());
    let sum = Star::minkowski_sum(&[rounded, cuboid.into(), ellipsoid.into()]).unwrap();
    let d = Vector::<3>::new(0.5429260969168385, 0.8335961805267259, -0.10172836918923865);
    let e = Vector::<3>::new(0.26557301353813184, -0.9566214965882225, 0.11977598567987069);
    derivative(sum.as_convex().unwrap(), &d, &e, 3.0942727582413605, 0.0).unwrap();
}

/// Beside the corners of a superellipsoid of a high exponent curvatures differ by four decades.
#[test]
fn of_a_sum_of_sets_with_sharp_edges() {
    let axes = Vector::<3>::new(2.3382357181268474, 0.8724710332918261, 0.5773502691896257);
    let sharp = Star::from(Superellipsoid::new(axes, 108.04071420915275).unwrap());
    let lower = Vector::<3>::new(-4.437643573228184, -0.5520384665803179, -1.6442998515969964);
    let upper = Vector::<3>::new(1.6442998515969964, 4.922509934528827, 0.9589201967415013);
    let cuboid = Convex::from(Cuboid::new(lower, upper).unwrap());
    let ball = Convex::from(Ball::new(0.5968082650060341).unwrap());
    let sum = Star::minkowski_sum(&[sharp, cuboid.into(), ball.into()]).unwrap();
    let d = Vector::<3>::new(-0.825038423607959, -0.41113228459694456, 0.38766202307240644);
    let e = Vector::<3>::new(0.3711979873232261, 0.0, -0.9285537433057852);
    derivative(sum.as_convex().unwrap(), &d, &e, 1.434848638756329, 1e-10).unwrap();
}

/// Along the edges of a rounded octahedron rounding grows in the flat direction after a few iterations.
#[test]
fn of_a_rounded_octahedron() {
    let axes = Vector::<3>::new(1.873489526222804, 4.742177605956779, 1.0763931718294617);
    let octahedron = Star::from(Superellipsoid::new(axes, 1.0).unwrap());
    let ball = Convex::from(Ball::new(0.8542594304272629).unwrap());
    let sum = Star::minkowski_sum(&[ball.into(), octahedron]).unwrap();
    let d = Vector::<3>::new(-0.55101106559902, -0.6635491127068356, -0.5060527448926679);
    let e = Vector::<3>::new(1.0, 0.0, 0.0);
    derivative(sum.as_convex().unwrap(), &d, &e, 2.344910255057173, 1e-10).unwrap();
}

/// The nearest point lies on what an edge of the octahedron sweeps: where the octahedron's own point is along its edge, the
/// other members decide.
#[test]
fn of_a_sum_with_edges_of_an_octahedron() {
    let slender = Vector::<3>::new(0.8761873450804801, 4.420542388834843, 1.8609945907501215);
    let round = Vector::<3>::new(1.2412016763344282, 1.3284508487432631, 1.403288050725085);
    let axes = Vector::<3>::new(2.7319439385858524, 1.1941319291506403, 4.776687151838691);
    let [slender, round] =
        [slender, round].map(|a| Star::from(Convex::from(Ellipsoid::new(a).unwrap())));
    let octahedron = Star::from(Superellipsoid::new(axes, 1.0).unwrap());
    let sum = Star::minkowski_sum(&[slender, round, octahedron]).unwrap();
    let set = sum.as_convex().unwrap();
    let e = Vector::<3>::new(1.0, 0.0, 0.0);
    for n in 0..40 {
        let d = Vector::<3>::new(
            0.31136914398530163,
            -0.945906066170267,
            -0.09116452246433915 + 1e-3 * n as f64,
        );
        derivative(set, &d, &e, 1.4351171547850246, 0.0).unwrap();
    }
}

//! The same properties in three dimensions.

mod common;

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use asperity_set::{
    Ball, Convex, ConvexSet, Cuboid, CustomConvex, Ellipsoid, Matrix, MinkowskiSum, Star, StarSet,
    Superellipsoid, Vector, convexity,
};
use common::*;
use proptest::prelude::*;
use proptest::test_runner::TestCaseResult;

type W = Vector<3>;

fn gauge_and_support(set: &Convex<3>, d: &W, e: &W, s: f64) -> TestCaseResult {
    let x = point_of(set, d, 1.0);
    prop_assert!(close(set.gauge(&x), 1.0, 1e-11));
    prop_assert!(close(set.gauge(&(x * s)), s, 1e-11));
    let gradient = set.gauge_gradient(&x).unwrap();
    prop_assert!(close(gradient.dot(&x), 1.0, 1e-9));
    prop_assert!(close(set.support(&gradient), 1.0, 1e-7), "h(∇k) = {}", set.support(&gradient));
    prop_assert!(d.dot(e) <= set.gauge(d) * set.support(e) * (1.0 + 1e-10));
    let farthest = set.support_point(e);
    prop_assert!(close(farthest.dot(e), set.support(e), 1e-10));
    prop_assert!(close(set.gauge(&farthest), 1.0, 1e-7), "{}", set.gauge(&farthest));
    let sum = set.support(&(d + e));
    prop_assert!(sum <= (set.support(d) + set.support(e)) * (1.0 + 1e-10));
    prop_assert!(close(set.support(&(e * s)), s * set.support(e), 1e-10));
    Ok(())
}

/// `slack` is what a projection may miss, relative to the sizes that occur.
fn projection(set: &Convex<3>, d: &W, e: &W, k: f64, slack: f64) -> TestCaseResult {
    let z = point_of(set, d, k);
    let x = set.project(&z);
    prop_assert!(set.gauge(&x) <= 1.0 + slack, "{}", set.gauge(&x) - 1.0);
    if set.gauge(&z) <= 1.0 {
        // On the boundary the digits of its support points decide.
        prop_assert!((x - z).norm() <= 4e-15 * z.norm());
        return Ok(());
    }
    let normal = z - x;
    if normal.norm() <= 1e-14 * x.norm() {
        return Ok(());
    }
    let gap = set.support(&normal) - x.dot(&normal);
    let size = x.norm() + normal.norm();
    prop_assert!(gap <= slack * size * (size + set.support(&normal.normalize())), "gap {gap:e}");
    prop_assert!((set.project(&x) - x).norm() <= 10.0 * slack * size);
    let other = point_of(set, e, k);
    let apart = (set.project(&other) - x).norm();
    prop_assert!(apart <= (other - z).norm() + 10.0 * slack * (size + other.norm()));
    Ok(())
}

fn cones(set: &Convex<3>, d: &W, e: &W) -> TestCaseResult {
    let corners = set.corners();
    let x = corners.first().copied().unwrap_or_else(|| point_of(set, d, 1.0));
    let normals = set.normal_cone(&x, 1e-9).unwrap();
    let tangents = normals.polar();
    let (n, t) = (normals.project(e), tangents.project(e));
    prop_assert!((n + t - e).norm() < 1e-6 && n.dot(&t).abs() < 1e-6, "{n} {t}");
    for normal in normals.generators() {
        prop_assert!((set.support(normal) - x.dot(normal)).abs() <= 1e-6 * x.norm());
    }
    prop_assert!(convexity(&Star::Convex(set.clone())).holds);
    Ok(())
}

fn hessian(set: &Convex<3>, y: &W, e: &W) -> TestCaseResult {
    let step = e * 1e-6;
    let hessians = [*y, y + step, y - step].map(|y| set.support_hessian(&y));
    let smooth = hessians.iter().all(|h| h.iter().all(|v| v.is_finite()));
    let hessian = hessians[0];
    let turns = (hessians[1] - hessian).norm().max((hessians[2] - hessian).norm());
    if !smooth || turns > 0.05 * hessian.norm() {
        return Ok(());
    }
    let [before, here, after] = [y - step, *y, y + step].map(|y| set.support_point(&y));
    // The support point of a polytope jumps, to one side of a kink that the step crosses.
    let bend = (after - here * 2.0 + before).norm();
    if bend > 0.1 * (after - before).norm() {
        return Ok(());
    }
    let (slope, size) = ((after - before) * 0.5, here.norm());
    prop_assert!((slope - hessian * step).norm() <= 0.05 * (hessian * step).norm() + 1e-8 * size);
    prop_assert!((hessian * y).norm() <= 1e-6 * hessian.norm() + 1e-8 * size);
    Ok(())
}

proptest! {
    // Four kinds.
    #![proptest_config(cases(0.2))]

    #[test]
    fn sets_with_closed_forms(
        set in convex_in_space(), d in direction_in_space(), e in direction_in_space(), k in multiples()
    ) {
        gauge_and_support(&set, &d, &e, k)?;
        projection(&set, &d, &e, k, 1e-11)?;
        cones(&set, &d, &e)?;
        hessian(&set, &d, &e)?;
    }
}

proptest! {
    // Skew images, intersections and sums are projected onto by iterations of up to milliseconds.
    #![proptest_config(cases(0.03))]

    #[test]
    fn images_and_combinations(
        set in slow_in_space(), d in direction_in_space(), e in direction_in_space(), k in log_uniform(0.1, 50.0)
    ) {
        gauge_and_support(&set, &d, &e, k)?;
        projection(&set, &d, &e, k, 1e-8)?;
        cones(&set, &d, &e)?;
    }
}

/// One of the accelerated steps onto this skew box leads back to where it came from, which is not the nearest point.
#[test]
fn projection_onto_a_skew_box_does_not_end_on_the_way() {
    let lower = W::new(-1.8152180909024411, -0.626219066574728, -1.0);
    let cuboid = Convex::from(Cuboid::new(lower, W::repeat(1.0)).unwrap());
    let (p, q) = (-0.4931161398109118, -0.48272268846571686);
    let shear = Matrix::<3>::new(1.0, p, 0.0, q, 1.0 + p * q, p, 0.0, 0.0, 1.0);
    let set = cuboid.mapped(&shear).unwrap();
    let direction = W::new(-0.36908000217406445, -0.11635800122850345, 0.9220850110186697);
    let z = point_of(&set, &direction, 6.337460761519843);
    let x = set.project(&z);
    let gap = set.support(&(z - x)) - x.dot(&(z - x));
    assert!(gap <= 1e-12 * z.norm_squared(), "{gap:e}");
}

/// The edge of this octahedron with another member lies right beside one of its own edges.
#[test]
fn projections_near_an_edge_of_one_member_stay_inside() {
    let power = |axes, exponent| Star::from(Superellipsoid::new(axes, exponent).unwrap());
    let octahedron = power(W::new(1.6843623638769252, 1.1741513365794762, 3.488266282131246), 1.0);
    let axes = W::new(1.5872755748195428, 1.0844064191771121, 1.5872755748195428);
    let set = Star::intersection(&[octahedron, power(axes, 1.5647985048444546)]).unwrap();
    let set = set.as_convex().unwrap();
    let d = W::new(-0.41498321691650203, 0.901935282994122, -0.11958961061875084);
    let x = set.project(&point_of(set, &d, 21.557415701481816));
    assert!(set.gauge(&x) <= 1.0 + 1e-12, "{}", set.gauge(&x) - 1.0);
}

/// Along the normal of a facet all of what other members leave of the facet is farthest: the gradients that the search for one
/// point of it follows there are rounding errors.
#[test]
fn support_along_the_normal_of_a_facet_is_that_of_the_facet() {
    let power = |axes, exponent| Star::from(Superellipsoid::new(axes, exponent).unwrap());
    let axes = W::new(0.36760727717699027, 0.5054080149510273, 1.262562722243783);
    let octahedron = power(W::new(0.5999993285655115, 0.9085416612033878, 1.8943042162472838), 1.0);
    let set = Star::intersection(&[power(axes, 135.6214730634045), octahedron]).unwrap();
    let set = set.as_convex().unwrap();
    let d = W::new(0.4146067428661209, -0.10136251637380994, -0.904337817988563);
    let normal = set.gauge_gradient(&point_of(set, &d, 1.0)).unwrap();
    let support = set.support(&normal);
    assert!((support - 1.0).abs() <= 1e-14, "{support}");
}

/// However skew the map is, what is left of the variational inequality is small: between 1e-11 and 1e-10 of the
/// sizes for an octahedron under the largest shear, which a tolerance of 1e-11 refused.
#[test]
fn projections_onto_skew_images_end_at_the_nearest_point() {
    let axes = W::new(1.3, 0.4, 0.8);
    let sets = [
        Star::from(Convex::from(Cuboid::new(-axes, W::new(0.7, 0.9, 0.2)).unwrap())),
        Star::from(Superellipsoid::new(axes, 1.0).unwrap()),
        Star::from(Superellipsoid::new(axes, 1.5).unwrap()),
        Star::from(Superellipsoid::new(axes, 6.0).unwrap()),
        Star::from(Superellipsoid::new(axes, 700.0).unwrap()),
    ];
    for shear in [0.5, 10.0, 1e2, 1e4, 1e6] {
        let map = Matrix::<3>::new(1.0, 0.3, shear, 0.0, 1.0, -0.4 * shear, 0.2, 0.0, 1.0);
        for (number, set) in sets.iter().enumerate() {
            let image = set.mapped(&map).unwrap();
            let image = image.as_convex().unwrap();
            for k in 0..60 {
                let angle = 0.7 + 2.4 * f64::from(k);
                let z = W::new(shear * angle.cos(), 0.4 * shear * angle.sin(), (0.3 * angle).cos());
                let z = z * (2.0 / image.gauge(&z).min(2.0)) * (1.0 + 0.05 * f64::from(k));
                let x = image.project(&z);
                let (normal, size) = (z - x, z.norm() + x.norm());
                let left = image.support(&normal) - x.dot(&normal);
                let name = format!("set {number}, shear {shear:e}, {k}: {left:e}");
                assert!(image.gauge(&x) <= 1.0 + 1e-9, "{name}, k = {}", image.gauge(&x));
                assert!(left <= 1e-10 * size * (normal.norm() + 1e-8 * size), "{name}");
            }
        }
    }
}

/// The turn about an axis in space by an angle.
fn turn(axis: &W, angle: f64) -> Matrix<3> {
    let cross = axis.cross_matrix();
    Matrix::<3>::identity() + cross * angle.sin() + cross * cross * (1.0 - angle.cos())
}

/// The point of all half-spaces `nᵀx ≤ 1` nearest to `z`, outside of some: of the points nearest to `z` on one, two
/// or three of the planes the only one that lies in all half-spaces with no plane that pulls.
fn nearest_of_faces(normals: &[W], z: &W) -> W {
    let count = normals.len();
    let mut best = (f64::INFINITY, *z);
    for i in 0..count {
        for j in 0..=i {
            for k in 0..=j {
                let mut chosen = vec![normals[i]];
                if j < i {
                    chosen.push(normals[j]);
                    if k < j {
                        chosen.push(normals[k]);
                    }
                } else if k < j {
                    continue;
                }
                let n = nalgebra::Matrix3xX::from_columns(&chosen);
                let gram = n.transpose() * &n;
                let excess = n.transpose() * z - nalgebra::DVector::repeat(chosen.len(), 1.0);
                let Some(pull) = gram.lu().solve(&excess) else { continue };
                let x = z - &n * &pull;
                let outside = normals.iter().map(|n| n.dot(&x) - 1.0).fold(0.0, f64::max);
                let worst = outside.max(-pull.min() * x.norm() / z.norm());
                if worst < best.0 {
                    best = (worst, W::new(x[0], x[1], x[2]));
                }
            }
        }
    }
    best.1
}

proptest! {
    #![proptest_config(cases(0.02))]

    /// Thin boxes turned against each other, of axis ratios up to 1e5.
    #[test]
    fn projection_onto_an_intersection_of_thin_boxes_is_that_of_their_faces(
        boxes in prop::collection::vec(
            (semi_axes::<3>(300.0), direction_in_space(), -3.0..3.0), 2..4
        ),
        d in direction_in_space(),
        k in log_uniform(1.01, 1e3),
    ) {
        let mut normals = Vec::new();
        let sets: Vec<Star<3>> = boxes
            .iter()
            .map(|(widths, axis, angle)| {
                let turn = turn(axis, *angle);
                for i in 0..3 {
                    let normal = turn.column(i) / widths[i];
                    normals.extend([normal, -normal]);
                }
                let set: Convex<3> = Cuboid::symmetric(*widths).unwrap().into();
                Star::Convex(set.mapped(&turn).unwrap())
            })
            .collect();
        let set = Star::intersection(&sets).unwrap();
        let set = set.as_convex().unwrap();
        let z = point_of(set, &d, k);
        let (x, wanted) = (set.project(&z), nearest_of_faces(&normals, &z));
        let digits = 1e-10 * wanted.norm() + 1e-14 * z.norm();
        prop_assert!((x - wanted).norm() <= digits, "{} of {}", (x - wanted).norm(), x.norm());
        prop_assert!(set.gauge(&x) <= 1.0 + 1e-12);
    }
}

/// Boxes and octahedra, also rounded by a ball, are sums whose projection is known: that onto the box or octahedron itself.
#[test]
fn projections_onto_sums_with_edges_are_exact() {
    let ball = |radius| Convex::from(Ball::new(radius).unwrap());
    let lower = W::new(-1.0, -0.5, -2.0);
    let cuboid = Convex::from(Cuboid::new(lower, W::new(0.01, 0.3, 1.0)).unwrap());
    let octahedron = Superellipsoid::new(W::new(1.0, 0.4, 0.02), 1.0).unwrap();
    let octahedron = Star::from(octahedron).as_convex().unwrap().clone();
    for core in [cuboid, octahedron] {
        for (radius, slack) in [(None, 1e-14), (Some(0.2), 1e-14)] {
            let members: Vec<Convex<3>> =
                std::iter::once(core.clone()).chain(radius.map(ball)).collect();
            let sum = MinkowskiSum::new(members).unwrap();
            for k in 0..200 {
                let (turn, height) = (2.4 * f64::from(k), f64::from(k) / 100.0 - 0.995);
                let wide = (1.0 - height * height).sqrt();
                let z = W::new(wide * turn.cos(), wide * turn.sin(), height) * 4.0;
                let below = core.project(&z);
                let known = below + (z - below).normalize() * radius.unwrap_or(0.0);
                let off = (sum.project(&z) - known).norm();
                assert!(off <= slack * z.norm(), "{off:e} at {z} of {sum:?}");
            }
        }
    }
}

/// `x = prox(z)` is the point farthest along `z − x`; where the boundary is round that holds to the last digits. The
/// value of the dual alone tells half of them.
#[test]
fn projections_onto_round_sums_have_all_digits() {
    let axes = W::new(0.6164493750163073, 1.15611516280694, 0.36392294734180614);
    let ellipsoid = Convex::from(Ellipsoid::new(axes).unwrap());
    let axes = W::new(0.8574622817596662, 1.2259737204980925, 0.7451927645811306);
    let rounded = Star::from(Superellipsoid::new(axes, 7.836969821495049).unwrap());
    let sum = MinkowskiSum::new(vec![ellipsoid, rounded.as_convex().unwrap().clone()]).unwrap();
    let normal = W::new(0.7565696214610139, 0.45084272419478416, -0.47364886352968694);
    for k in 0..200 {
        let z = normal * (4.0 + 0.1 * f64::from(k));
        let x = sum.project(&z);
        let off = (sum.support_point(&(z - x)) - x).norm();
        assert!(off <= 1e-14 * z.norm(), "{off:e} of {} at {k}", z.norm());
    }
}

/// Sums of a rounded set and a flat one, for which neither the dual nor support points tell more than half of the digits.
fn rounded_and_flat() -> Vec<MinkowskiSum<3>> {
    let power = |axes, exponent| {
        let set = Star::from(Superellipsoid::new(axes, exponent).unwrap());
        set.as_convex().unwrap().clone()
    };
    let cuboid = |lower, upper| Convex::from(Cuboid::new(lower, upper).unwrap());
    let members = [
        vec![
            Ball::new(1.5681843490288174).unwrap().into(),
            power(W::new(0.8213572194002123, 5.4068867657276005, 4.9926158239988325), 11.1),
            cuboid(W::new(-1.9, -1.6, -1.3), W::new(1.6, 0.9, 1.95)),
        ],
        vec![
            power(W::new(23.195160320778633, 5.867459045590237, 0.6911575489186824), 13.5),
            cuboid(W::new(-0.13, -1.11, -0.11), W::new(3.9, 6.4, 0.88)),
        ],
        vec![
            power(W::new(0.5207913761206571, 2.554244763747763, 1.1213771808448196), 16.4),
            power(W::new(46.528232711103506, 3.0046512398861855, 1.4740889939540314), 1.0),
        ],
    ];
    members.map(|members| MinkowskiSum::new(members).unwrap()).to_vec()
}

/// Of a point that is hardly outside, what is nearest is known to the distance, not to the size of the set: it is no farther
/// than the point on the ray and than those of tangent planes, and what is projected once stays.
#[test]
fn projections_of_points_hardly_outside_are_no_farther_than_they_need_to_be() {
    for sum in rounded_and_flat() {
        for d in asperity_set::directions::<3>(60) {
            for power in 4..16 {
                let excess = 0.1_f64.powi(power);
                let z = d * ((1.0 + excess) / sum.gauge(&d));
                let (gauge, gradient) = sum.gauge_jet(&z);
                // The foot of the perpendicular onto the tangent plane is nearest where the boundary is flat up to there.
                // Elsewhere the foot is outside, and where its ray leaves the sum is a point of it that is hardly farther.
                let foot = z - gradient * ((gauge - 1.0) / gradient.norm_squared());
                let known = (z - foot / sum.gauge(&foot).max(1.0)).norm();
                let known = known.min((z - z / gauge).norm());
                let rounding = 1e-14 * z.norm();
                // The point that comes with a Jacobian may be outside by what is left of Newton's method for the members.
                let ways = [(sum.project(&z), 1e-12), (sum.project_jet(&z, &z).0, 1e-10)];
                for (x, outside) in ways {
                    let distance = (z - x).norm();
                    let name =
                        format!("{distance:e} instead of {known:e} at {d} outside by {excess:e}");
                    assert!(distance <= 1.0001 * known + rounding, "{name}");
                    assert!(sum.gauge(&x) <= 1.0 + outside, "{name}");
                    assert!((sum.project(&x) - x).norm() <= 1e-10 * x.norm(), "{name}");
                }
            }
        }
    }
}

/// A set that counts how often it is asked for support points.
#[derive(Debug)]
struct Counted {
    set: Convex<3>,
    count: AtomicUsize,
}

impl StarSet<3> for Counted {
    fn gauge(&self, x: &W) -> f64 {
        self.set.gauge(x)
    }
}

impl ConvexSet<3> for Counted {
    fn support_point(&self, y: &W) -> W {
        self.count.fetch_add(1, Ordering::Relaxed);
        self.set.support_point(y)
    }

    fn support_jet(&self, y: &W) -> (W, Matrix<3>) {
        self.count.fetch_add(1, Ordering::Relaxed);
        self.set.support_jet(y)
    }
}

/// Newton's method where sums are round, a few triangles where they are flat; the ellipsoid method takes from 400
/// support points on.
#[test]
fn gauges_of_sums_take_few_support_points() {
    let cuboid = Convex::from(Cuboid::symmetric(W::new(0.5, 0.3, 0.2)).unwrap());
    let turn = *nalgebra::Rotation3::from_euler_angles(0.3, 0.5, 0.7).matrix();
    let turned = cuboid.mapped(&Matrix::<3>::from(turn)).unwrap();
    let ellipsoid = Convex::from(Ellipsoid::new(W::new(0.6, 0.3, 0.2)).unwrap());
    let ball = Convex::from(Ball::new(0.2).unwrap());
    let pairs = [
        (cuboid.clone(), turned.clone(), 40.0),
        (ellipsoid.clone(), ball.clone(), 10.0),
        (ellipsoid, turned, 400.0),
        (cuboid, ball, 400.0),
    ];
    for (first, second, most) in pairs {
        let counted = Arc::new(Counted { set: first, count: AtomicUsize::new(0) });
        let custom = Convex::Custom(CustomConvex(counted.clone()));
        let sum = MinkowskiSum::new(vec![custom, second]).unwrap();
        let directions = asperity_set::directions::<3>(500);
        for d in &directions {
            let (gauge, gradient) = sum.gauge_jet(d);
            assert!((gradient.dot(d) - gauge).abs() <= 1e-14 * gauge);
            assert!((sum.support(&gradient) - 1.0).abs() <= 1e-12);
        }
        let mean = counted.count.load(Ordering::Relaxed) as f64 / directions.len() as f64;
        assert!(mean <= most, "{mean} of {sum:?}");
    }
}

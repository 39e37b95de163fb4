//! Answers of laws of all dimensions, written out or against differences.

use asperity_set::{Ball, Cuboid, Ellipsoid, Interval};

use super::*;
use crate::law::Fall;
use crate::random::random;

fn ellipsoid<const P: usize>(axes: [f64; P]) -> Convex<P> {
    Ellipsoid::new(Vector::<P>::from(axes)).unwrap().into()
}

fn rate() -> Stribeck {
    Stribeck::new(Fall::Exponential, 0.5, 0.6, 1.0, 0.2).unwrap()
}

/// Laws of all dimensions, associated and not, with a factor of the speed and without.
fn laws() -> Vec<Law> {
    let interval = |low, high| {
        Convex::from(Interval::new(Vector::<1>::new(low), Vector::<1>::new(high)).unwrap())
    };
    let line = FrictionLaw::new(interval(-0.4, 0.7).into(), interval(-1.0, 1.0)).unwrap();
    let turned = ellipsoid([0.6, 0.3]).rotated(0.4).unwrap();
    let plane = || FrictionLaw::new(turned.clone().into(), ellipsoid([0.5, 0.4])).unwrap();
    let space =
        || FrictionLaw::new(ellipsoid([0.6, 0.3, 0.2]).into(), ellipsoid([0.5, 0.4, 0.6])).unwrap();
    vec![
        line.with_rate(rate()).into(),
        plane().into(),
        plane().with_rate(rate()).into(),
        FrictionLaw::associated(ellipsoid([0.6, 0.3])).into(),
        space().into(),
        space().with_rate(rate()).into(),
    ]
}

/// `∂f/∂x` by central differences, row by row.
fn differences(f: impl Fn(&[f64]) -> Components, x: &[f64]) -> [Components; 3] {
    let mut out = [[0.0; 3]; 3];
    for j in 0..x.len() {
        let step = 1e-6;
        let at = |sign: f64| {
            let mut moved = x.to_vec();
            moved[j] += sign * step;
            f(&moved)
        };
        let (ahead, behind) = (at(1.0), at(-1.0));
        (0..3).for_each(|i| out[i][j] = (ahead[i] - behind[i]) / (2.0 * step));
    }
    out
}

#[track_caller]
fn near(found: [Components; 3], expected: [Components; 3], what: &str) {
    for (a, b) in found.iter().flatten().zip(expected.iter().flatten()) {
        assert!((a - b).abs() < 1e-7 * (1.0 + b.abs()), "{what}: {found:?} {expected:?}");
    }
}

/// With the point of *D* that goes with the slip, the force is that of the law, nothing is left over, and derivatives are
/// those of differences; aside of it the rest is that of the projection.
#[test]
fn points_of_the_direction_set_are_unknowns_of_their_own() {
    let mut seed = 4_u64;
    for (k, law) in laws().iter().enumerate() {
        let p = law.dimension();
        for _ in 0..30 {
            let slip: Vec<f64> = (0..p).map(|_| random(&mut seed)).collect();
            let speed = slip.iter().map(|v| v * v).sum::<f64>().sqrt();
            let force = law.sliding(&slip).unwrap();
            near(
                law.jacobian(&slip, 1.0).unwrap(),
                differences(|v| law.sliding(v).unwrap(), &slip),
                "∂λ/∂γ",
            );
            let doubled = law.jacobian(&slip, 2.0).unwrap();
            let single = law.jacobian(&slip, 1.0).unwrap();
            near(doubled, single.map(|row| row.map(|v| 2.0 * v)), "twice");
            let normal = law.normal(&force);
            let z = law.direction_point(&force);
            for i in 0..3 {
                let along = if i < p { slip[i] / speed } else { 0.0 };
                assert!((normal[i] - along).abs() < 1e-12, "{k}: {normal:?} {slip:?}");
            }
            let size = z.iter().map(|v| v * v).sum::<f64>().sqrt();
            let at = law.at_point(&z[..p], &slip).unwrap();
            assert!((at.r - size / speed).abs() < 1e-14 * at.r, "{k}");
            for i in 0..3 {
                assert!((at.sliding[i] - force[i]).abs() < 1e-14, "{k}: {at:?} {force:?}");
                assert!(at.defect[i].abs() < 1e-13, "{k}: {at:?}");
            }
            // Anywhere else: what each answer depends on.
            let z: Vec<f64> = z[..p].iter().map(|v| v + 0.1 * random(&mut seed) * size).collect();
            let at = law.at_point(&z, &slip).unwrap();
            near(
                at.by_point,
                differences(|z| law.at_point(z, &slip).unwrap().sliding, &z),
                "∂λ/∂z",
            );
            near(
                at.by_slip,
                differences(|v| law.at_point(&z, v).unwrap().sliding, &slip),
                "∂λ/∂γ at z",
            );
            let projected = |target: &[f64]| match law {
                Law::Zero(_) => unreachable!(),
                Law::One(law) => padded(&law.direction().project(&vector(target))),
                Law::Two(law) => padded(&law.direction().project(&vector(target))),
                Law::Three(law) => padded(&law.direction().project(&vector(target))),
            };
            let target: Vec<f64> = z.iter().zip(&slip).map(|(z, v)| z + at.r * v).collect();
            let end = projected(&target);
            for i in 0..p {
                assert!((at.defect[i] - (end[i] - z[i])).abs() < 1e-12, "{k}: {at:?}");
            }
            near(at.slope, differences(projected, &target), "slope");
        }
        assert!(law.at_point(&[0.1; 3][..p], &[0.0; 3][..p]).is_none());
        assert!(law.at_point(&[0.0; 3][..p], &[0.1; 3][..p]).is_none());
        assert!(
            law.sliding(&[0.0; 3][..p]).is_none() && law.jacobian(&[0.0; 3][..p], 1.0).is_none()
        );
        assert_eq!(law.direction_point(&[0.0; 3][..p]), [0.0; 3]);
    }
}

#[test]
fn laws_say_whether_their_force_is_smooth() {
    let cuboid = |p: [f64; 2]| Convex::from(Cuboid::symmetric(Vector::<2>::from(p)).unwrap());
    let collinear = FrictionLaw::collinear(cuboid([0.5, 0.3]).into()).unwrap();
    let flat = FrictionLaw::new(ellipsoid([0.6, 0.3]).into(), cuboid([0.5, 0.3])).unwrap();
    let line = FrictionLaw::<1>::isotropic(0.5).unwrap();
    for (law, smooth, strictly) in [
        (Law::from(collinear), true, true),
        (flat.into(), false, false),
        (FrictionLaw::<2>::isotropic(0.5).unwrap().into(), true, true),
        (FrictionLaw::associated(ellipsoid([0.6, 0.3])).into(), true, true),
        (FrictionLaw::associated(Convex::<3>::from(Ball::new(0.3).unwrap())).into(), true, true),
        (line.into(), true, true),
    ] {
        assert_eq!(law.is_smooth(), smooth, "{law:?}");
        assert_eq!(law.has_strictly_convex_direction(), strictly, "{law:?}");
    }
}

/// In the coordinates of the Lorentz cone sliding forces are on its border, opposite to the slip, and products of
/// percussions and velocities that obey the law are those of both cones.
#[test]
fn ellipsoids_are_lorentz_cones_in_their_coordinates() {
    let mut seed = 9_u64;
    let symmetric = Interval::new(Vector::<1>::new(-0.5), Vector::<1>::new(0.5)).unwrap();
    let line = FrictionLaw::associated(Convex::from(symmetric));
    for law in laws()[1..].iter().cloned().chain([line.into()]) {
        let p = law.dimension();
        let cone = law.lorentz_cone().unwrap();
        for _ in 0..20 {
            let slip: Vec<f64> = (0..p).map(|_| random(&mut seed)).collect();
            let factor = law
                .rate()
                .map_or(1.0, |rate| rate.factor(slip.iter().map(|v| v * v).sum::<f64>().sqrt()));
            let force = law.sliding(&slip).unwrap();
            let of = |first: f64, rest: &dyn Fn(usize) -> f64| {
                natural_map::ContactVector::from_fn(|i, _| match i {
                    0 => first,
                    _ if i <= p => rest(i - 1),
                    _ => 0.0,
                })
            };
            let percussion = cone.t * of(1.0, &|i| force[i] / factor);
            let velocity = cone.k * of(0.3, &|i| slip[i]);
            let (across, along) = (percussion.rows(1, 3), velocity.rows(1, 3));
            assert!((across.norm() - percussion[0]).abs() < 1e-12 * percussion[0], "{percussion}");
            let cosine = across.dot(&along) / (across.norm() * along.norm());
            assert!((cosine + 1.0).abs() < 1e-12, "{law:?}: {cosine}");
            assert!((percussion[0] * velocity[0] - 0.3).abs() < 1e-13);
        }
        // Both maps have about the size one.
        let sizes = [cone.t.view((1, 1), (p, p)).norm(), cone.k.view((1, 1), (p, p)).norm()];
        assert!((sizes[0] - (p as f64).sqrt()).abs() < 1e-12, "{sizes:?}");
        if p > 1 {
            let dual = cone.t.view((1, 1), (p, p)).into_owned().try_inverse().unwrap();
            assert!((sizes[1] / dual.norm() - 1.0).abs() < 1e-12, "{sizes:?}");
        }
    }
    assert!(laws()[0].lorentz_cone().is_none());
}

//! Random sets of every kind.
#![allow(dead_code)] // Every test binary uses its own part.

use std::f64::consts::TAU;

use asperity_set::{
    Ball, CappedRectangle, Convex, CoulombContensou, Cuboid, Ellipsoid, Matrix, Planar, PolarCurve,
    Polygon, Pressure, Star, StarSet, Superellipsoid, SupportCurve, Vector, WedgeAsperity,
};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

pub type V = Vector<2>;

pub fn log_uniform(low: f64, high: f64) -> impl Strategy<Value = f64> {
    (low.ln()..high.ln()).prop_map(f64::exp)
}

/// Semi-axes within `1/spread..spread`.
pub fn semi_axes<const P: usize>(spread: f64) -> impl Strategy<Value = Vector<P>> {
    prop::collection::vec(log_uniform(1.0 / spread, spread), P)
        .prop_map(|a| Vector::from_column_slice(&a))
}

fn exponent() -> impl Strategy<Value = f64> {
    prop_oneof![Just(1.0), Just(2.0), log_uniform(1.02, 3.0), log_uniform(3.0, 1e3)]
}

/// The kinds that exist in every dimension and have closed forms.
pub fn plain<const P: usize>(spread: f64) -> impl Strategy<Value = Convex<P>> {
    let ball = log_uniform(1e-4, 1e4).prop_map(|r| Ball::new(r).unwrap().into());
    let cuboid = (semi_axes(spread), semi_axes(spread))
        .prop_map(|(lower, upper)| Cuboid::new(-lower, upper).unwrap().into());
    let ellipsoid = semi_axes(spread).prop_map(|a| Ellipsoid::new(a).unwrap().into());
    let superellipsoid = (semi_axes(spread), exponent())
        .prop_map(|(a, s)| Convex::try_from(Superellipsoid::new(a, s).unwrap()).unwrap());
    prop_oneof![ball, cuboid, ellipsoid, superellipsoid]
}

fn wedge(slopes: std::ops::Range<f64>) -> impl Strategy<Value = Star<2>> {
    (log_uniform(0.05, 2.0), slopes)
        .prop_map(|(mu, slope)| WedgeAsperity::new(mu, (slope / mu).atan()).unwrap().into())
}

/// Corners on an ellipse or, if `rough`, anywhere between it and a tenth of it.
fn polygon(rough: bool) -> impl Strategy<Value = Star<2>> {
    let corner = (0.02..1.0, if rough { 0.1..1.0 } else { 1.0..1.0 + 1e-12 });
    (prop::collection::vec(corner, 5..12), semi_axes::<2>(5.0), -4.0..4.0).prop_map(
        |(corners, axes, start)| {
            // Steps of less than half a turn each.
            let total: f64 = corners.iter().map(|c| c.0 + 0.4).sum();
            let mut angle = start;
            let vertices: Vec<V> = corners
                .iter()
                .map(|(step, radius)| {
                    angle += TAU * (step + 0.4) / total;
                    V::new(axes.x * radius * f64::cos(angle), axes.y * radius * f64::sin(angle))
                })
                .collect();
            Polygon::new(&vertices).unwrap().into()
        },
    )
}

/// A random trigonometric series `1 + Σ a_k cos(kφ + p_k)` with `Σ a_k k² = size`.
#[derive(Debug)]
struct Series(Vec<(f64, f64)>);

impl Series {
    fn at(&self, phi: f64) -> f64 {
        let term = |(k, (a, p)): (usize, &(f64, f64))| a * f64::cos((k as f64 + 1.0) * phi + p);
        1.0 + self.0.iter().enumerate().map(term).sum::<f64>()
    }
}

fn series(size: f64) -> impl Strategy<Value = Series> {
    prop::collection::vec((1e-3..1.0, 0.0..TAU), 5).prop_map(move |terms| {
        let total: f64 = terms.iter().map(|t| t.0).sum();
        let term =
            |(k, (a, p)): (usize, &(f64, f64))| (size * a / total / ((k + 1) * (k + 1)) as f64, *p);
        Series(terms.iter().enumerate().map(term).collect())
    })
}

/// Sampling angles, somewhat uneven.
fn angles() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(0.3..1.0, 12..60).prop_map(|steps| {
        let total: f64 = steps.iter().sum();
        let mut at = 0.3;
        let advance = |step: &f64| {
            at += TAU * step / total;
            at
        };
        steps.iter().map(advance).collect()
    })
}

fn polar_curve(size: f64) -> impl Strategy<Value = Star<2>> {
    (series(size), angles(), log_uniform(1e-3, 1e3)).prop_map(|(w, angles, scale)| {
        let radius: Vec<f64> = angles.iter().map(|&t| scale / w.at(t)).collect();
        PolarCurve::new(&angles, &radius).unwrap().into()
    })
}

fn support_curve() -> impl Strategy<Value = Convex<2>> {
    (series(0.9), angles(), log_uniform(1e-3, 1e3)).prop_map(|(h, angles, scale)| {
        let support: Vec<f64> = angles.iter().map(|&t| scale * h.at(t)).collect();
        SupportCurve::new(&angles, &support).unwrap().into()
    })
}

pub fn convex_of(set: Star<2>) -> Convex<2> {
    set.as_convex().expect("made to be convex").clone()
}

/// The kinds that exist in the plane only.
pub fn planar() -> impl Strategy<Value = Convex<2>> {
    let capped = (semi_axes::<2>(30.0), log_uniform(1e-2, 30.0))
        .prop_map(|(a, cap)| CappedRectangle::new(a.x, a.y, cap).unwrap().into());
    prop_oneof![
        capped,
        wedge(0.0..std::f64::consts::FRAC_1_SQRT_2).prop_map(convex_of),
        polygon(false).prop_map(convex_of),
        polar_curve(0.9).prop_map(convex_of),
        support_curve()
    ]
}

/// Sums and intersections of two or three sets of comparable size.
fn combined<const P: usize>() -> impl Strategy<Value = Convex<P>> {
    let member = || {
        (plain::<P>(3.0), log_uniform(0.5, 2.0)).prop_map(|(set, size)| {
            let radius = set.radius(&Vector::repeat(1.0));
            set.scaled(size / radius).unwrap()
        })
    };
    (prop::collection::vec(member(), 2..4), any::<bool>()).prop_map(|(sets, sum)| {
        let sets: Vec<Star<P>> = sets.into_iter().map(Star::Convex).collect();
        let made = if sum { Star::minkowski_sum(&sets) } else { Star::intersection(&sets) };
        made.unwrap().as_convex().unwrap().clone()
    })
}

/// Every kind of convex set: plain with axis ratios up to 1e8; rotated and sheared with ratios up to
/// 1e3, for the rotation of a point alone costs the ratio times the rounding error.
pub fn convex() -> impl Strategy<Value = Convex<2>> {
    let rotated = (plain(30.0), -4.0..4.0).prop_map(|(set, angle)| set.rotated(angle).unwrap());
    let sheared = (plain(30.0), -0.7..0.7, -0.7..0.7)
        .prop_map(|(set, p, q)| set.mapped(&Matrix::<2>::new(1.0, p, q, 1.0 + p * q)).unwrap());
    prop_oneof![2 => plain(1e4), 1 => rotated, 1 => sheared, 2 => planar(), 1 => combined()]
}

/// The same in space, without the slow projections onto skew images and combinations.
pub fn convex_in_space() -> impl Strategy<Value = Convex<3>> {
    let drilling = (log_uniform(0.01, 10.0), any::<bool>()).prop_map(|(mu, hertz)| {
        let pressure = if hertz { Pressure::Hertz } else { Pressure::Uniform };
        CoulombContensou::new(mu, pressure).unwrap().into()
    });
    prop_oneof![3 => plain(100.0), 1 => drilling]
}

/// Skew images, sums and intersections in space.
pub fn slow_in_space() -> impl Strategy<Value = Convex<3>> {
    let sheared = (plain(3.0), -0.5..0.5, -0.5..0.5).prop_map(|(set, p, q)| {
        let shear = Matrix::<3>::new(1.0, p, 0.0, q, 1.0 + p * q, p, 0.0, 0.0, 1.0);
        set.mapped(&shear).unwrap()
    });
    prop_oneof![sheared, combined()]
}

pub fn star() -> impl Strategy<Value = Star<2>> {
    let cusped = || {
        (semi_axes(30.0), log_uniform(0.2, 0.98))
            .prop_map(|(a, s)| Star::from(Superellipsoid::new(a, s).unwrap()))
    };
    let turned = (cusped(), -4.0..4.0).prop_map(|(set, angle)| set.rotated(angle).unwrap());
    let mixed = (cusped(), planar(), any::<bool>()).prop_map(|(a, b, both)| {
        let sets = [a, Star::Convex(b)];
        if both { Star::intersection(&sets).unwrap() } else { Star::union(&sets).unwrap() }
    });
    prop_oneof![
        6 => convex().prop_map(Star::from),
        1 => cusped(),
        1 => turned,
        1 => wedge(0.0..0.99),
        1 => polygon(true),
        1 => polar_curve(0.99).boxed(),
        2 => mixed
    ]
}

/// Names of the kinds inside; the compiler refuses an arm without a name.
pub fn kinds<const P: usize>(set: &Star<P>) -> Vec<&'static str> {
    match set {
        Star::Convex(set) => match set {
            Convex::Ball(_) => vec!["ball"],
            Convex::Cuboid(_) => vec!["cuboid"],
            Convex::Ellipsoid(_) => vec!["ellipsoid"],
            Convex::Superellipsoid(_) => vec!["superellipsoid"],
            Convex::Planar(set) => vec![planar_kind(set.set())],
            Convex::Contensou(_) => vec!["Coulomb–Contensou"],
            Convex::Intersection(_) => vec!["intersection"],
            Convex::Sum(_) => vec!["Minkowski sum"],
            Convex::Image(_) => vec!["image"],
            Convex::Custom(_) => vec![],
        },
        Star::Superellipsoid(_) => vec!["cusped superellipsoid"],
        Star::Planar(set) => vec![planar_kind(set.set()), "planar, not convex"],
        Star::Intersection(_) => vec!["intersection, not convex"],
        Star::Union(_) => vec!["union"],
        Star::Image(_) => vec!["image, not convex"],
        Star::Custom(_) => vec![],
    }
}

fn planar_kind(set: &Planar) -> &'static str {
    match set {
        Planar::CappedRectangle(_) => "capped rectangle",
        Planar::WedgeAsperity(_) => "wedge asperity",
        Planar::Polygon(_) => "polygon",
        Planar::PolarCurve(_) => "polar curve",
        Planar::SupportCurve(_) => "support curve",
    }
}

/// All names that `kinds` gives.
pub const KINDS: [&str; 18] = [
    "Coulomb–Contensou",
    "Minkowski sum",
    "ball",
    "capped rectangle",
    "cuboid",
    "cusped superellipsoid",
    "ellipsoid",
    "image",
    "image, not convex",
    "intersection",
    "intersection, not convex",
    "planar, not convex",
    "polar curve",
    "polygon",
    "superellipsoid",
    "support curve",
    "union",
    "wedge asperity",
];

pub fn direction() -> impl Strategy<Value = V> {
    let axes = prop_oneof![
        Just(V::new(1.0, 0.0)),
        Just(V::new(0.0, 1.0)),
        Just(V::new(-1.0, 0.0)),
        Just(V::new(0.0, -1.0))
    ];
    prop_oneof![9 => (-4.0..4.0_f64).prop_map(|t| V::new(t.cos(), t.sin())), 1 => axes]
}

pub fn direction_in_space() -> impl Strategy<Value = Vector<3>> {
    (-1.0..1.0_f64, 0.0..TAU).prop_map(|(z, t)| {
        let radius = (1.0 - z * z).sqrt();
        Vector::<3>::new(radius * t.cos(), radius * t.sin(), z)
    })
}

/// A point at `k` times the boundary.
pub fn point_of<const P: usize>(set: &impl StarSet<P>, direction: &Vector<P>, k: f64) -> Vector<P> {
    direction * (k / set.gauge(direction))
}

/// From deep inside to 1e12 away.
pub fn multiples() -> impl Strategy<Value = f64> {
    prop_oneof![log_uniform(1e-6, 1.0), log_uniform(1.0, 1e3), log_uniform(1e3, 1e12), Just(1.0)]
}

pub fn close(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance * a.abs().max(b.abs())
}

/// Cases per property: for each of about twenty kinds of sets 1000, always the same ones, or as many random ones
/// as `PROPTEST_CASES` says; a part of that for slow properties.
pub fn cases(part: f64) -> ProptestConfig {
    let asked: Option<f64> = std::env::var("PROPTEST_CASES").ok().and_then(|v| v.parse().ok());
    ProptestConfig {
        cases: f64::max(1.0, 20.0 * asked.unwrap_or(1000.0) * part) as u32,
        failure_persistence: None,
        rng_seed: if asked.is_some() { RngSeed::Random } else { RngSeed::Fixed(2019) },
        ..ProptestConfig::default()
    }
}

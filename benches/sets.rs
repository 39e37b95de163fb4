//! Cost of gauge, support point and projection per set, and of two projections as a ratio to hand-written
//! scalar loops.
//!
//! With the argument `points` it only prints `set operation nanoseconds` per line, the floor that
//! `python_sets.py` compares Python with.

mod report;

use std::hint::black_box;
use std::time::Instant;

use asperity_set::{
    CappedRectangle, Convex, ConvexSet, CoulombContensou, Cuboid, Ellipse, Ellipsoid, PolarCurve,
    Polygon, Pressure, Star, StarSet, Superellipse, SupportCurve, Vector, WedgeAsperity,
};

type V = Vector<2>;

const POINTS: usize = 100_000;

/// Points at 1.05 to 4 times the boundary of a set, spread over all directions.
fn points<const P: usize>(set: &Convex<P>) -> Vec<Vector<P>> {
    let golden = 0.618_033_988_749_895;
    (0..POINTS)
        .map(|k| {
            let part = |shift: f64| (golden * (k as f64 + 1.0) * shift).fract();
            let direction = Vector::<P>::from_fn(|i, _| part([1.0, 1.7, 2.3][i]) - 0.5);
            direction * ((1.05 + 2.95 * part(3.1)) / set.gauge(&direction))
        })
        .collect()
}

/// Nanoseconds per point, the best of several runs.
fn nanoseconds(mut run: impl FnMut() -> f64) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..7 {
        let start = Instant::now();
        black_box(run());
        best = best.min(start.elapsed().as_secs_f64() * 1e9 / POINTS as f64);
    }
    best
}

fn over<const P: usize, T>(
    points: &[Vector<P>],
    out: &mut Vec<T>,
    f: impl Fn(&Vector<P>) -> T,
) -> f64 {
    nanoseconds(|| {
        out.clear();
        out.extend(points.iter().map(&f));
        out.len() as f64
    })
}

/// `[gauge, support point, projection]` of one set.
fn costs<const P: usize>(set: &Convex<P>) -> [f64; 3] {
    let points = points(set);
    let (mut numbers, mut vectors) = (Vec::with_capacity(POINTS), Vec::with_capacity(POINTS));
    [
        over(&points, &mut numbers, |x| set.gauge(x)),
        over(&points, &mut vectors, |y| set.support_point(y)),
        over(&points, &mut vectors, |z| set.project(z)),
    ]
}

fn convex(set: impl Into<Star<2>>) -> Convex<2> {
    set.into().as_convex().expect("convex").clone()
}

/// The sets that `python_sets.py` makes under the same names.
fn sets() -> Vec<(&'static str, Convex<2>)> {
    let wave = |k: usize| std::f64::consts::TAU * k as f64 / 60.0;
    let angles: Vec<f64> = (0..60).map(wave).collect();
    let values: Vec<f64> = angles.iter().map(|t| 1.0 + 0.1 * (2.0 * t).cos()).collect();
    let hexagon: Vec<V> =
        (0..6).map(|k| V::new((1.05 * k as f64).cos(), (1.05 * k as f64).sin())).collect();
    let ellipse = |a: f64, b: f64| Convex::from(Ellipse::new(V::new(a, b)).unwrap());
    vec![
        ("ellipse", ellipse(3.0, 1.0)),
        ("rectangle", Cuboid::symmetric(V::new(3.0, 1.0)).unwrap().into()),
        ("superellipse", convex(Superellipse::new(V::new(3.0, 1.0), 2.94).unwrap())),
        ("capped rectangle", CappedRectangle::new(1.0, 0.5, 0.7).unwrap().into()),
        ("polygon", convex(Polygon::new(&hexagon).unwrap())),
        ("wedge asperity", convex(WedgeAsperity::new(0.8, 0.6).unwrap())),
        ("polar curve", convex(PolarCurve::new(&angles, &values).unwrap())),
        ("support curve", SupportCurve::new(&angles, &values).unwrap().into()),
        (
            "intersection",
            convex(
                Star::intersection(&[ellipse(3.0, 1.0).into(), ellipse(1.0, 3.0).into()]).unwrap(),
            ),
        ),
        (
            "Minkowski sum",
            convex(
                Star::minkowski_sum(&[ellipse(3.0, 1.0).into(), ellipse(1.0, 3.0).into()]).unwrap(),
            ),
        ),
    ]
}

fn space() -> Vec<(&'static str, Convex<3>)> {
    vec![
        ("ellipsoid", Ellipsoid::new(Vector::<3>::new(3.0, 1.0, 2.0)).unwrap().into()),
        ("Coulomb–Contensou", CoulombContensou::new(0.5, Pressure::Hertz).unwrap().into()),
    ]
}

/// The floor for the ellipse: Newton's method for `(a²u²/(t+a²)²) + (b²v²/(t+b²)²) = 1` in `t`.
fn ellipse_by_hand(a: f64, b: f64, z: &V) -> V {
    let (p, q) = (a * a, b * b);
    if z.x * z.x / p + z.y * z.y / q <= 1.0 {
        return *z;
    }
    let (u, v) = (a * z.x, b * z.y);
    let mut t = ((u * u + v * v).sqrt() - p.max(q)).max(u.abs() - p).max(v.abs() - q).max(0.0);
    for _ in 0..50 {
        let (x, y) = (u / (t + p), v / (t + q));
        let square = x * x + y * y;
        let slope = x * x / (t + p) + y * y / (t + q);
        let step = square * (square.sqrt() - 1.0) / slope;
        t += step;
        if step <= 1e-15 * (t + q) {
            break;
        }
    }
    V::new(p * z.x / (t + p), q * z.y / (t + q))
}

/// The floor for the superellipse: Newton's method for `ln(y + R) = ln v` in the logit of `y^s`, with no guard.
fn superellipse_by_hand(a: f64, b: f64, s: f64, z: &V) -> V {
    let (u, v) = (z.x.abs() / a, z.y.abs() / b);
    if u.powf(s) + v.powf(s) <= 1.0 {
        return *z;
    }
    let swap = v > u;
    let (u, v, c) = if swap { (v, u, b * b / (a * a)) } else { (u, v, a * a / (b * b)) };
    let mut w = s * (v / u).ln();
    let (mut x, mut y) = (1.0, 0.0);
    for _ in 0..100 {
        let e = w.exp();
        x = (-e.ln_1p() / s).exp();
        y = x * (w / s).exp();
        let rest = (u - x) * c * (e * x) / y;
        let share = e / (1.0 + e);
        let value = ((y + rest) / v).ln();
        if value.abs() <= 1e-14 {
            break;
        }
        let slope = y * (1.0 - share) + rest * (s - 1.0 + x * share / (u - x));
        w -= value * s * (y + rest) / slope;
    }
    let (x, y) = if swap { (y, x) } else { (x, y) };
    V::new((a * x).copysign(z.x), (b * y).copysign(z.y))
}

/// Largest distance between two projections of the same points.
fn apart(points: &[V], f: impl Fn(&V) -> V, g: impl Fn(&V) -> V) -> f64 {
    points.iter().map(|z| (f(z) - g(z)).norm()).fold(0.0, f64::max)
}

fn compare(name: &str, set: &Convex<2>, by_hand: impl Fn(&V) -> V, allowed: f64) {
    let points = points(set);
    let difference = apart(&points, |z| set.project(z), &by_hand);
    assert!(difference < 1e-9, "the floor solves another problem: {difference:e}");
    let mut out = Vec::with_capacity(POINTS);
    let (mut own, mut floor) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..3 {
        floor = floor.min(over(&points, &mut out, &by_hand));
        own = own.min(over(&points, &mut out, |z| set.project(z)));
    }
    println!("{name:28} {floor:9.1} {own:9.1} {:7.2}   {allowed}", own / floor);
    report::ratio(
        &format!("projection onto the {name}"),
        own / floor,
        "Newton's method written by hand for this set, without guards",
        "what a projection that is right for every argument costs",
    );
}

fn main() {
    let rows = sets().into_iter().map(|(name, set)| (name, costs(&set)));
    let rows = rows.chain(space().into_iter().map(|(name, set)| (name, costs(&set))));
    let operations = ["gauge", "support_point", "project"];
    if std::env::args().any(|argument| argument == "points") {
        for (name, costs) in rows {
            for (operation, cost) in operations.iter().zip(costs) {
                println!("{name}\t{operation}\t{cost}");
            }
        }
        return;
    }
    println!(
        "\nset, ns per point             {:>9} {:>13} {:>9}",
        operations[0], operations[1], operations[2]
    );
    for (name, [gauge, support_point, project]) in rows {
        println!("{name:28} {gauge:10.1} {support_point:13.1} {project:9.1}");
    }
    println!("\nprojection                     by hand      here   ratio   allowed");
    let ellipse = Convex::from(Ellipse::new(V::new(3.0, 1.0)).unwrap());
    compare("ellipse 3:1", &ellipse, |z| ellipse_by_hand(3.0, 1.0, z), 1.5);
    for s in [1.5, 2.94, 8.0] {
        let set = convex(Superellipse::new(V::new(3.0, 1.0), s).unwrap());
        let name = format!("superellipse 3:1, s = {s}");
        compare(&name, &set, |z| superellipse_by_hand(3.0, 1.0, s, z), 2.0);
    }
}

//! Random trees of sets and all that can be asked of them.

use asperity::set::{
    Convex, ConvexSet, Star, StarSet, Vector, convexity, largest_ratio, star_shape,
    strict_convexity, symmetry, tangent_cone,
};

use crate::decode::{Range, Source};

/// Largest ratio of radii up to which identities are asked for, and of sizes to one.
const SLENDER: f64 = 1e5;
const SCALE: f64 = 1e100;

/// What is made of `data` is finite or an error, and obeys the identities of convex analysis.
pub fn check(data: &[u8]) {
    let mut source = Source::new(data);
    let range = [Range::Narrow, Range::Wide, Range::Any][source.below(3)];
    match source.below(4) {
        0 => any::<1>(&mut source, range),
        1 => any::<3>(&mut source, range),
        _ => any::<2>(&mut source, range),
    }
}

fn any<const P: usize>(source: &mut Source<'_>, range: Range) {
    let Some(set) = source.star::<P>(range, 2) else { return };
    let shape = Shape::of(&set);
    // In space most is found by searches.
    for _ in 0..if P == 3 { 1 } else { 3 } {
        let x = source.direction::<P>() * source.size(range);
        gauge(&set, &x, &shape);
        if let Some(convex) = set.as_convex() {
            let y = source.direction::<P>() * source.size(range);
            support(convex, &x, &y, &shape);
            project(convex, &x, &y, &shape);
        }
    }
    if source.once_in(if P == 3 { 64 } else { 16 }) {
        slow(&set, source, range, &shape);
    }
}

/// How large and how slender a set is.
struct Shape {
    largest: f64,
    /// Largest to smallest radius, of the most slender of the sets that it is combined of, too.
    slenderness: f64,
    ordinary: bool,
}

impl Shape {
    fn of<const P: usize>(set: &Star<P>) -> Self {
        // A needle is short in most directions; its length shows in its support function.
        let (mut least, mut largest) = (f64::INFINITY, 0.0_f64);
        for direction in asperity::set::directions::<P>(64) {
            let radius = set.radius(&direction);
            let reach = set.as_convex().map_or(radius, |convex| convex.support(&direction));
            (least, largest) = (least.min(radius), largest.max(radius).max(reach));
        }
        let ordinary =
            least * SLENDER > largest && (1.0 / SCALE..SCALE).contains(&least) && largest < SCALE;
        let whole = Self { largest, slenderness: largest / least, ordinary };
        members(set).iter().map(Self::of).fold(whole, |shape, member| Self {
            slenderness: shape.slenderness.max(member.slenderness),
            ordinary: shape.ordinary && member.ordinary,
            ..shape
        })
    }

    /// Whether numbers of this size are within what is promised.
    fn reaches(&self, size: f64) -> bool {
        self.ordinary && (1.0 / SCALE..SCALE).contains(&size)
    }
}

/// The sets that a set is combined of. One that is slender beyond what is promised may hide behind others.
fn members<const P: usize>(set: &Star<P>) -> Vec<Star<P>> {
    let convex = |sets: &[Convex<P>]| sets.iter().cloned().map(Star::Convex).collect();
    match set {
        Star::Convex(Convex::Sum(sum)) => convex(sum.sets()),
        Star::Convex(Convex::Intersection(intersection)) => convex(intersection.sets()),
        Star::Intersection(intersection) => intersection.sets().to_vec(),
        Star::Union(union) => union.sets().to_vec(),
        _ => Vec::new(),
    }
}

fn gauge<const P: usize>(set: &Star<P>, x: &Vector<P>, shape: &Shape) {
    let (gauge, gradient) = set.gauge_jet(x);
    let (same, radius) = (set.gauge(x), set.radius(x));
    let _ = (set.contains(x, 1e-9), set.gauge_gradient(x), set.corners());
    if !shape.reaches(x.amax()) {
        return;
    }
    assert!(gauge.is_finite() && gauge > 0.0, "k = {gauge} at {x} of {set:?}");
    close(same, gauge, 1e-12, "gauge and gauge_jet", set);
    close(radius * gauge, x.norm(), 1e-9, "radius times gauge", set);
    // Three times a number is rounded, to which the gauge is sensitive where it is steep, and on slender sets.
    let steepness = gradient.norm() * x.norm() / gauge;
    let sensitivity = if steepness.is_finite() { steepness.max(1.0) } else { 1.0 };
    let rounding = 1e-12 * sensitivity + 1e-15 * shape.slenderness;
    close(set.gauge(&(x * 3.0)), 3.0 * gauge, rounding, "homogeneity", set);
    if gradient.iter().all(|v| v.is_finite()) {
        // Euler's identity; where radii differ much its terms cancel.
        let terms: f64 = gradient.iter().zip(x.iter()).map(|(g, x)| (g * x).abs()).sum();
        let defect = (gradient.dot(x) - gauge).abs();
        assert!(defect <= 1e-6 * gauge.max(terms), "∇k·x − k = {defect:e} at {x} of {set:?}");
    }
}

fn support<const P: usize>(set: &Convex<P>, x: &Vector<P>, y: &Vector<P>, shape: &Shape) {
    let (point, support) = (set.support_point(y), set.support(y));
    let (again, _) = set.support_jet(y);
    let _ = (set.support_hessian(y), set.support_derivative(y, x));
    if !shape.reaches(x.amax()) || !shape.reaches(y.amax()) {
        return;
    }
    let whole = Star::Convex(set.clone());
    assert!(support.is_finite() && support > 0.0, "h = {support} at {y} of {set:?}");
    let inside = set.gauge(&point);
    assert!(inside <= 1.0 + 1e-6, "support point outside: k = {inside} at {y} of {set:?}");
    // Fenchel: equality at the support point, an inequality elsewhere.
    close(point.dot(y), support, 1e-9, "x·y = h(y)", &whole);
    close(again.dot(y), support, 1e-7, "support_jet", &whole);
    let polar = x.dot(y) - set.gauge(x) * support;
    assert!(
        polar <= 1e-7 * set.gauge(x) * support,
        "x·y > k(x) h(y) by {polar:e}, x {x} y {y} of {set:?}"
    );
}

fn project<const P: usize>(set: &Convex<P>, z: &Vector<P>, start: &Vector<P>, shape: &Shape) {
    let point = set.project(z);
    let from = set.project_from(z, start);
    let (jet, _) = set.project_jet(z, start);
    let _ = set.normal_cone(&point, 1e-9);
    if !shape.reaches(z.amax()) || !shape.reaches(start.amax()) {
        return;
    }
    if let Some(cone) = set.normal_cone(&(z / set.gauge(z)), 1e-9) {
        assert!(cone.generators().iter().flat_map(|g| g.iter()).all(|v| !v.is_nan()));
    }
    let size = shape.largest + z.norm();
    for (x, name) in [(point, "project"), (from, "project_from"), (jet, "project_jet")] {
        let gauge = set.gauge(&x);
        assert!(gauge <= 1.0 + 1e-6, "{name}({z}) from {start} outside: k = {gauge} of {set:?}");
        // x = prox(z) iff h(z − x) = x·(z − x) (variational inequality).
        let normal = z - x;
        let gap = set.support(&normal) - x.dot(&normal);
        let allowed = 1e-7 * size * (normal.norm() + size * 1e-5);
        assert!(
            gap <= allowed,
            "{name}({z}) from {start} is off: {gap:e} > {allowed:e} of {set:?}"
        );
    }
}

/// What takes thousands of gauges.
fn slow<const P: usize>(set: &Star<P>, source: &mut Source<'_>, range: Range, shape: &Shape) {
    for verdict in [convexity(set), strict_convexity(set), symmetry(set)] {
        if shape.ordinary {
            assert!(!verdict.defect.is_nan(), "{verdict:?} of {set:?}");
        }
    }
    if let Some(other) = source.star::<P>(range, 1)
        && shape.ordinary
        && Shape::of(&other).ordinary
    {
        let (ratio, at) = largest_ratio(set, &other);
        assert!(ratio.is_finite() && ratio > 0.0, "{ratio} at {at} of {set:?} and {other:?}");
    }
    let x = source.direction::<P>();
    if let Some(convex) = set.as_convex() {
        let _ = convex.normal_cone(&(x / convex.gauge(&x)), 1e-9);
    }
    let _ = tangent_cone(set, &(x / set.gauge(&x)), 1e-9);
    let outline: Vec<Vector<2>> =
        (0..3 + source.below(6)).map(|_| source.vector::<2>(range)).collect();
    let _ = star_shape(&outline);
}

fn close<const P: usize>(a: f64, b: f64, tolerance: f64, what: &str, set: &Star<P>) {
    assert!(
        (a - b).abs() <= tolerance * a.abs().max(b.abs()),
        "{what}: {a:e} and {b:e} of {set:?}"
    );
}

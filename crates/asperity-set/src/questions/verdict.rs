//! Questions about a set, answered with a witness.

use std::f64::consts::TAU;

use crate::numeric::vectors::{along, cast, quarter_turn, tangents};
use crate::shapes::{OutlineFault, distinct, fault};
use crate::{Convex, ConvexSet, Planar, SetError, Star, StarSet, Vector, directions};

/// Tolerance of the questions that are decided numerically.
const TOLERANCE: f64 = 1e-9;

/// Whether a long question is to be given up; asked often, so it should be quick to answer.
pub type Cancelled<'a> = &'a dyn Fn() -> bool;

/// The answer to a question about a set.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict<const P: usize> {
    /// The answer.
    pub holds: bool,
    /// Whether a closed form decides, rather than samples.
    pub exact: bool,
    /// The largest defect that passes.
    pub tolerance: f64,
    /// How badly the property fails, without dimension; 0 if it holds exactly.
    pub defect: f64,
    /// Points that show the failure.
    pub witness: Vec<Vector<P>>,
}

impl<const P: usize> Verdict<P> {
    /// Decided by a closed form.
    pub fn exact(holds: bool) -> Self {
        Self { holds, exact: true, tolerance: 0.0, defect: 0.0, witness: Vec::new() }
    }

    /// Refuted by points.
    pub fn refuted(defect: f64, witness: Vec<Vector<P>>) -> Self {
        Self { defect: defect.max(0.0), witness, ..Self::exact(false) }
    }

    /// Decided by samples: the largest defect and the points that have it.
    pub fn sampled(defect: f64, witness: Vec<Vector<P>>) -> Self {
        let holds = defect <= TOLERANCE;
        let witness = if holds { Vec::new() } else { witness };
        Self { holds, exact: false, tolerance: TOLERANCE, defect: defect.max(0.0), witness }
    }

    fn mapped(mut self, map: &crate::Matrix<P>) -> Self {
        self.witness.iter_mut().for_each(|x| *x = map * *x);
        self
    }
}

/// Whether a set is convex. The witness is two points of the set whose middle lies outside.
pub fn convexity<const P: usize>(set: &Star<P>) -> Verdict<P> {
    convexity_unless(set, &|| false)
}

/// The same, unless `cancelled` gives it up, which is asked between evaluations of gauges: the verdict then says nothing.
pub fn convexity_unless<const P: usize>(set: &Star<P>, cancelled: Cancelled<'_>) -> Verdict<P> {
    let two = |x: Vec<Vector<P>>| {
        let middle = x.iter().sum::<Vector<P>>() * 0.5;
        Verdict::refuted(set.gauge(&middle) - 1.0, x)
    };
    match set {
        Star::Convex(_) => Verdict::exact(true),
        Star::Superellipsoid(s) if P > 1 => {
            two(vec![along(0, s.semi_axes()[0]), along(1, s.semi_axes()[1])])
        }
        Star::Superellipsoid(_) => Verdict::exact(true),
        Star::Planar(planar) => match planar.set() {
            // The curvature is least along the wedges.
            Planar::WedgeAsperity(_) => beside(set, &along(1, 1.0)),
            Planar::PolarCurve(curve) => beside(set, &cast(&curve.least_curved())),
            Planar::Polygon(polygon) => match polygon.reentrant() {
                Some(ends) => two(ends.iter().map(cast).collect()),
                None => Verdict::exact(true),
            },
            _ => Verdict::exact(true),
        },
        Star::Image(image) => convexity_unless(image.preimage(), cancelled).mapped(image.map()),
        _ => sampled_convexity(set, cancelled),
    }
}

/// A refutation by boundary points on both sides of a direction in which the boundary curves inwards:
/// the pair whose middle lies farthest outside, over all distances.
fn beside<const P: usize>(set: &Star<P>, direction: &Vector<P>) -> Verdict<P> {
    let axis: Vector<2> = cast(direction);
    let point = |angle: f64| -> Vector<P> {
        let (sine, cosine) = angle.sin_cos();
        let turned = axis * cosine + quarter_turn(&axis) * sine;
        let turned: Vector<P> = cast(&turned);
        turned / set.gauge(&turned)
    };
    let pairs = (0..60).map(|k| 1.5 * 0.8_f64.powi(k)).map(|a| [point(a), point(-a)]);
    let excess = |pair: &[Vector<P>; 2]| set.gauge(&((pair[0] + pair[1]) * 0.5)) - 1.0;
    let worst = pairs.max_by(|p, q| excess(p).total_cmp(&excess(q)));
    worst.map_or_else(
        || Verdict::exact(false),
        |pair| Verdict::refuted(excess(&pair), pair.to_vec()),
    )
}

/// By the gauge in the middle between boundary points near each other: a closed curve or surface around
/// the origin that is convex everywhere in the small is so in the large.
fn sampled_convexity<const P: usize>(set: &Star<P>, cancelled: Cancelled<'_>) -> Verdict<P> {
    let mut worst = (f64::NEG_INFINITY, Vec::new());
    for pair in neighbours(set, cancelled).into_iter().take_while(|_| !cancelled()) {
        let excess = set.gauge(&((pair[0] + pair[1]) * 0.5)) - 1.0;
        if excess > worst.0 {
            worst = (excess, pair.to_vec());
        }
    }
    Verdict::sampled(worst.0, worst.1)
}

/// Pairs of boundary points at several distances from each other.
fn neighbours<const P: usize>(set: &Star<P>, cancelled: Cancelled<'_>) -> Vec<[Vector<P>; 2]> {
    let on_boundary = |d: &Vector<P>| d / set.gauge(d);
    let goes_on = |_: &Vector<P>| !cancelled();
    match P {
        1 => Vec::new(),
        2 => {
            let mut around: Vec<Vector<P>> = directions::<P>(1440);
            around.extend(set.corners());
            let angle = |x: &Vector<P>| x[1].atan2(x[0]).rem_euclid(TAU);
            around.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
            let points: Vec<Vector<P>> =
                around.iter().map_while(|d| goes_on(d).then(|| on_boundary(d))).collect();
            let n = points.len();
            let reaches = [1, 2, 8, 32, 128, 360];
            reaches
                .iter()
                .flat_map(|reach| (0..n).map(move |i| (i, (i + reach) % n)))
                .map(|(i, j)| [points[i], points[j]])
                .collect()
        }
        _ => {
            let centres = directions::<P>(3000);
            let around = |d: &Vector<P>| {
                let [u, v] = tangents(d);
                [(u, 0.01), (v, 0.01), (u + v, 0.1), (u - v, 0.3)]
                    .map(|(t, s)| [on_boundary(&(d + t * s)), on_boundary(&(d - t * s))])
            };
            centres.iter().take_while(|d| goes_on(d)).flat_map(around).collect()
        }
    }
}

/// Whether a set is strictly convex (\[WL19\] Def. 1). The witness is two boundary points whose middle is
/// not in the interior.
pub fn strict_convexity<const P: usize>(set: &Star<P>) -> Verdict<P> {
    strict_convexity_unless(set, &|| false)
}

/// The same, unless `cancelled` gives it up: the verdict then says nothing.
pub fn strict_convexity_unless<const P: usize>(
    set: &Star<P>,
    cancelled: Cancelled<'_>,
) -> Verdict<P> {
    let convex = match set {
        Star::Convex(convex) => convex,
        _ => {
            let verdict = convexity_unless(set, cancelled);
            return if verdict.holds { sampled_strictness(set, cancelled) } else { verdict };
        }
    };
    if P == 1 {
        return Verdict::exact(true);
    }
    match convex {
        Convex::Ball(_) | Convex::Ellipsoid(_) | Convex::Contensou(_) => Verdict::exact(true),
        Convex::Cuboid(cuboid) => {
            let mut other = *cuboid.upper();
            other[1] = cuboid.lower()[1];
            Verdict::refuted(0.0, vec![*cuboid.upper(), other])
        }
        Convex::Superellipsoid(s) if s.exponent() > 1.0 => Verdict::exact(true),
        Convex::Superellipsoid(s) => {
            Verdict::refuted(0.0, vec![along(0, s.semi_axes()[0]), along(1, s.semi_axes()[1])])
        }
        Convex::Image(image) => {
            strict_convexity_unless(&Star::Convex(image.preimage().clone()), cancelled)
                .mapped(image.map())
        }
        Convex::Planar(planar) => match planar.set() {
            Planar::CappedRectangle(set) => {
                Verdict::refuted(0.0, set.flat().iter().map(cast).collect())
            }
            Planar::Polygon(polygon) => {
                let ends = polygon.vertices()[..2].iter();
                Verdict::refuted(0.0, ends.map(cast).collect())
            }
            // Flat only at the limit of convexity, in one direction, where no segment lies in the boundary.
            Planar::WedgeAsperity(_) => Verdict::exact(true),
            Planar::SupportCurve(curve) => match curve.flat() {
                Some(ends) => Verdict::refuted(0.0, ends.iter().map(cast).collect()),
                None => Verdict::exact(true),
            },
            Planar::PolarCurve(curve) => match curve.flat() {
                Some(ends) => Verdict::refuted(0.0, ends.iter().map(cast).collect()),
                None => Verdict::exact(true),
            },
        },
        Convex::Sum(sum) => {
            let strict =
                |s: &Convex<P>| strict_convexity_unless(&Star::Convex(s.clone()), cancelled);
            let members = sum.sets().iter().map(strict);
            match members.into_iter().find(|verdict| !verdict.holds) {
                Some(verdict) => segment_of_sum(convex, &verdict.witness, cancelled),
                None => Verdict::exact(true),
            }
        }
        Convex::Intersection(sets) => {
            let strict =
                |s: &Convex<P>| strict_convexity_unless(&Star::Convex(s.clone()), cancelled);
            let all = sets.sets().iter().all(|s| strict(s).holds);
            if all { Verdict::exact(true) } else { sampled_strictness(set, cancelled) }
        }
        Convex::Custom(_) => sampled_strictness(set, cancelled),
    }
}

/// A segment in one member's boundary is one in the sum's, where the sum is farthest along its normal.
fn segment_of_sum<const P: usize>(
    sum: &Convex<P>,
    segment: &[Vector<P>],
    cancelled: Cancelled<'_>,
) -> Verdict<P> {
    let (2, [a, b]) = (P, segment) else {
        return sampled_strictness(&Star::Convex(sum.clone()), cancelled);
    };
    let normal = quarter_turn(&cast::<P, 2>(&(b - a)));
    let normal = if normal.dot(&cast(a)) < 0.0 { -normal } else { normal };
    let aside = quarter_turn(&normal) * 1e-9;
    let ends = [normal - aside, normal + aside].map(|n| sum.support_point(&cast(&n)));
    Verdict::refuted(0.0, ends.to_vec())
}

/// By the gauge in the middle between boundary points: on a chord of the boundary it is one.
fn sampled_strictness<const P: usize>(set: &Star<P>, cancelled: Cancelled<'_>) -> Verdict<P> {
    let mut flattest = (f64::INFINITY, Vec::new());
    for pair in neighbours(set, cancelled).into_iter().take_while(|_| !cancelled()) {
        let sag = 1.0 - set.gauge(&((pair[0] + pair[1]) * 0.5));
        let size = (pair[0] - pair[1]).norm_squared() / pair[0].norm_squared();
        if sag / size < flattest.0 {
            flattest = (sag / size, pair.to_vec());
        }
    }
    let holds = flattest.0 > TOLERANCE;
    let witness = if holds { Vec::new() } else { flattest.1 };
    Verdict { holds, exact: false, tolerance: TOLERANCE, defect: 0.0, witness }
}

/// Whether `C = −C`. The witness is a boundary point `x` with `k(−x) ≠ k(x)`.
pub fn symmetry<const P: usize>(set: &Star<P>) -> Verdict<P> {
    symmetry_unless(set, &|| false)
}

/// The same, unless `cancelled` gives it up: the verdict then says nothing.
pub fn symmetry_unless<const P: usize>(set: &Star<P>, cancelled: Cancelled<'_>) -> Verdict<P> {
    let sampled = || {
        let probes = directions::<P>(1440).into_iter().chain(set.corners());
        let points = probes.take_while(|_| !cancelled()).map(|d| d / set.gauge(&d));
        let graded = points.map(|x| ((set.gauge(&-x) - 1.0).abs(), x));
        let worst = graded.max_by(|x, y| x.0.total_cmp(&y.0));
        let (defect, at) = worst.unwrap_or((0.0, Vector::zeros()));
        Verdict::sampled(defect, vec![at])
    };
    match set {
        Star::Superellipsoid(_) => Verdict::exact(true),
        Star::Image(image) => symmetry_unless(image.preimage(), cancelled).mapped(image.map()),
        Star::Planar(planar) if matches!(planar.set(), Planar::WedgeAsperity(_)) => {
            Verdict::exact(true)
        }
        Star::Convex(convex) => match convex {
            Convex::Ball(_)
            | Convex::Ellipsoid(_)
            | Convex::Superellipsoid(_)
            | Convex::Contensou(_) => Verdict::exact(true),
            Convex::Cuboid(cuboid) => match -cuboid.lower() == *cuboid.upper() {
                true => Verdict::exact(true),
                false => {
                    let defect = |x: &Vector<P>| (set.gauge(&-x) - 1.0).abs();
                    let faces = (0..P)
                        .flat_map(|i| [along(i, cuboid.lower()[i]), along(i, cuboid.upper()[i])]);
                    let worst = faces.max_by(|x, y| defect(x).total_cmp(&defect(y)));
                    let worst = worst.unwrap_or(Vector::zeros());
                    Verdict::refuted(defect(&worst), vec![worst])
                }
            },
            Convex::Image(image) => {
                symmetry_unless(&Star::Convex(image.preimage().clone()), cancelled)
                    .mapped(image.map())
            }
            Convex::Planar(planar)
                if matches!(
                    planar.set(),
                    Planar::WedgeAsperity(_) | Planar::CappedRectangle(_)
                ) =>
            {
                Verdict::exact(true)
            }
            Convex::Sum(sum)
                if sum
                    .sets()
                    .iter()
                    .all(|s| symmetry_unless(&Star::Convex(s.clone()), cancelled).holds) =>
            {
                Verdict::exact(true)
            }
            _ => sampled(),
        },
        _ => sampled(),
    }
}

/// Whether a closed outline bounds a set that is star-shaped with respect to the origin (\[WL19\] Def. 2).
///
/// The witness is a point of the set that the origin does not see, the nearest point of the outline if
/// the origin is not inside, or a point where the outline crosses itself.
///
/// # Errors
///
/// [`SetError::Shape`] if the outline holds less than three different points.
pub fn star_shape(outline: &[Vector<2>]) -> Result<Verdict<2>, SetError> {
    let outline = distinct(outline);
    if outline.len() < 3 {
        let message = format!("must hold at least 3 different points, has {}", outline.len());
        return Err(SetError::Shape { argument: "vertices", message });
    }
    Ok(match fault(&outline) {
        // An edge along a ray is allowed, only not in a strictly star-shaped set.
        None | Some(OutlineFault::Radial(_)) => Verdict::exact(true),
        Some(fault) => Verdict::refuted(0.0, vec![fault.witness()]),
    })
}

//! Polarity: the support function from the gauge, the gauge from the support function.
//!
//! For convex sets `h(y) = max{x·y : k(x) ≤ 1}` and `k(x) = max{x·y : h(y) ≤ 1}`: the two functions are
//! polar to each other, and one algorithm gives either from the other.

use crate::numeric::root::{Bracket, Sample};
use crate::numeric::vectors::{along, cast, cross, cross_3, quarter_turn, tangents};
use crate::{ConvexSet, Matrix, StarSet, Vector};

/// Support point of a convex set from its gauge.
pub(crate) fn support_point<const P: usize, S>(set: &S, y: &Vector<P>) -> Vector<P>
where
    S: StarSet<P> + ?Sized,
{
    farthest(&|x: &Vector<P>| set.gauge_jet(x), y)
}

/// Hessian of the support function by central differences of the support point.
pub(crate) fn support_hessian<const P: usize, S>(set: &S, y: &Vector<P>) -> Matrix<P>
where
    S: ConvexSet<P> + ?Sized,
{
    let step = f64::EPSILON.cbrt() * y.amax();
    let mut hessian = Matrix::<P>::zeros();
    for j in 0..P {
        let (mut ahead, mut behind) = (*y, *y);
        ahead[j] += step;
        behind[j] -= step;
        let width = ahead[j] - behind[j];
        let column = (set.support_point(&ahead) - set.support_point(&behind)) / width;
        hessian.set_column(j, &column);
    }
    (hessian + hessian.transpose()) * 0.5
}

/// Gauge and its gradient from the support function: the gradient is the normal with `h = 1` along which
/// `x` is farthest.
pub(crate) fn gauge_jet<const P: usize, S>(set: &S, x: &Vector<P>) -> (f64, Vector<P>)
where
    S: ConvexSet<P> + ?Sized,
{
    gauge_jet_with(set, x, |_, _| None)
}

/// [`gauge_jet`] of a set that may know, for a point and a normal near the one along which it is farthest, the latter: it is
/// asked where the set is neither round nor flat.
pub(crate) fn gauge_jet_with<const P: usize, S>(
    set: &S,
    x: &Vector<P>,
    improve: impl Fn(&Vector<P>, &Vector<P>) -> Option<Vector<P>>,
) -> (f64, Vector<P>)
where
    S: ConvexSet<P> + ?Sized,
{
    let size = x.amax();
    // Nothing is farthest along a point at infinity, nor along what is not a number.
    if !(size > 0.0 && size.is_finite()) {
        return (size, Vector::zeros());
    }
    let support_jet = |y: &Vector<P>| {
        let point = set.support_point(y);
        (y.dot(&point), point)
    };
    let quick = || {
        let unit = x / size;
        by_hessians(set, &unit).or_else(|| match by_portals(set, &unit) {
            Portal::Face(normal) => Some(normal),
            Portal::Near(normal) => improve(&unit, &normal),
        })
    };
    let gradient = match P {
        3 => quick().unwrap_or_else(|| farthest_by_widths(set, x)),
        _ => farthest(&support_jet, x),
    };
    (gradient.dot(x), gradient)
}

/// The normal with `h = 1` along which `x` is farthest, in coordinates in which the set is as wide along all axes: of a
/// needle ellipsoids leave some digits.
fn farthest_by_widths<const P: usize, S>(set: &S, x: &Vector<P>) -> Vector<P>
where
    S: ConvexSet<P> + ?Sized,
{
    let widths = Vector::<P>::from_fn(|i, _| {
        let width = set.support(&along(i, 1.0)) + set.support(&along(i, -1.0));
        // Of a set of the user it may be anything.
        if width > 0.0 && width < f64::MAX { width } else { 1.0 }
    });
    let support_jet = |y: &Vector<P>| {
        let point = set.support_point(&y.component_div(&widths)).component_div(&widths);
        (y.dot(&point), point)
    };
    farthest(&support_jet, &x.component_div(&widths)).component_div(&widths)
}

/// Newton's method for the smallest `h` on the plane `x·y = 1`, for sets that are round where `x` leaves them; `None`
/// if that does not converge at once.
fn by_hessians<const P: usize, S>(set: &S, x: &Vector<P>) -> Option<Vector<P>>
where
    S: ConvexSet<P> + ?Sized,
{
    let x = x.normalize();
    let [first, second] = tangents(&x);
    let mut t = Vector::<2>::zeros();
    for _ in 0..16 {
        let y = x + first * t.x + second * t.y;
        let (point, hessian) = set.support_jet(&y);
        let slope = Vector::<2>::new(first.dot(&point), second.dot(&point));
        let found = || Some(y / y.dot(&point));
        if slope.norm() <= 4.0 * f64::EPSILON * point.norm() {
            return found();
        }
        let across = first.dot(&(hessian * second));
        let bends = [first.dot(&(hessian * first)), second.dot(&(hessian * second))];
        let determinant = bends[0] * bends[1] - across * across;
        // The comparison also turns away what is not a number.
        if !(determinant > 1e-9 * bends[0] * bends[1]) {
            return None;
        }
        let step = Vector::<2>::new(
            across * slope.y - bends[1] * slope.x,
            across * slope.x - bends[0] * slope.y,
        ) / determinant;
        let (length, reach) = (step.norm(), 1.0 + t.norm());
        if length <= f64::EPSILON * reach {
            return found();
        }
        if !(length < f64::MAX) {
            return None;
        }
        t += step * (reach / length).min(1.0);
    }
    None
}

/// Where a ray leaves a set.
enum Portal<const P: usize> {
    /// Through a flat face with this normal, `h = 1`.
    Face(Vector<P>),
    /// Through a round piece, edge or corner, whose normal is near this one.
    Near(Vector<P>),
}

/// The flat face that the ray along `x` meets: a triangle of support points around the ray, whose normal finds the next
/// one, until no point is farther along it (portals, as collision detection knows them). On a round piece, edge or corner the
/// triangle shrinks.
fn by_portals<const P: usize, S>(set: &S, x: &Vector<P>) -> Portal<P>
where
    S: ConvexSet<P> + ?Sized,
{
    const ROUNDS: usize = 40;
    const FAT: f64 = 1e-4;
    let side = |a: &Vector<P>, b: &Vector<P>| cross_3(a, b).dot(x);
    let mut a = set.support_point(x);
    let across = cross_3(&a, x);
    if !(across.norm() > FAT * a.norm() * x.norm()) {
        return Portal::Near(*x);
    }
    let mut b = set.support_point(&across);
    if side(&a, &b) < 0.0 {
        (a, b) = (b, a);
    }
    let mut c = set.support_point(&cross_3(&a, &b));
    for _ in 0..ROUNDS {
        if side(&c, &a) < 0.0 {
            b = c;
        } else if side(&b, &c) < 0.0 {
            a = c;
        } else {
            break;
        }
        c = set.support_point(&cross_3(&a, &b));
    }
    let mut last = *x;
    for _ in 0..ROUNDS {
        let normal = cross_3(&(b - a), &(c - a));
        let point = set.support_point(&normal);
        let (size, reach) = (normal.norm(), normal.dot(&point));
        // The comparison also turns away what is not a number.
        if !(size > FAT * point.norm_squared()) {
            break;
        }
        last = normal;
        if reach - normal.dot(&a) <= 4.0 * f64::EPSILON * size * point.norm() {
            let inside = side(&a, &b) >= 0.0 && side(&b, &c) >= 0.0 && side(&c, &a) >= 0.0;
            if inside && reach > 0.0 {
                return Portal::Face(normal / reach);
            }
            break;
        }
        let [of_a, of_b, of_c] = [a, b, c].map(|v| side(&v, &point));
        if of_b >= 0.0 && of_a <= 0.0 {
            c = point;
        } else if of_c >= 0.0 && of_b <= 0.0 {
            a = point;
        } else {
            b = point;
        }
    }
    Portal::Near(last)
}

/// The point `x` with `f(x) = 1` that is farthest in direction `y ≠ 0`, from the jet (value, gradient) of
/// a convex gauge `f`.
///
/// Where a whole face is farthest, it is one point of the face.
fn farthest<const P: usize, F>(jet: &F, y: &Vector<P>) -> Vector<P>
where
    F: Fn(&Vector<P>) -> (f64, Vector<P>) + ?Sized,
{
    let y = y / y.amax();
    match P {
        1 => y / jet(&y).0,
        2 => {
            let planar = |x: &Vector<2>| {
                let (value, gradient) = jet(&cast(x));
                (value, cast(&gradient))
            };
            cast(&farthest_in_plane(&planar, &cast(&y)))
        }
        _ => farthest_in_space(jet, &y),
    }
}

/// Along the curve `f = 1`, `x·y` rises counter-clockwise where `∇f × y > 0`: a change of sign.
fn farthest_in_plane(jet: &dyn Fn(&Vector<2>) -> (f64, Vector<2>), y: &Vector<2>) -> Vector<2> {
    let y = y.normalize();
    if let Some(point) = by_newton(jet, &y) {
        return point;
    }
    let rise = |d: &Vector<2>| {
        let (value, gradient) = jet(d);
        (cross(&gradient, &y) / gradient.norm(), d / value)
    };
    let (slope, below) = rise(&y);
    if slope == 0.0 {
        return below;
    }
    // The point lies within a quarter turn of y, for x·y > 0.
    let end = quarter_turn(&y) * slope.signum();
    let (value, last) = rise(&end);
    let wrong = value == 0.0 || value.signum() == slope.signum();
    let value = if wrong { -slope } else { value };
    let mut bracket = Bracket::new(
        Sample { at: 0.0, value: slope, data: below },
        Sample { at: 1.0, value, data: last },
    );
    bracket.refine(0.5 * f64::EPSILON, 0.5 * f64::EPSILON, |weight| {
        rise(&(y * (1.0 - weight) + end * weight))
    });
    // At a corner the slope jumps, and the sample with the smallest slope may be far from it.
    let best = bracket.best.data;
    let lower = (1.0 - 1e-12) * bracket.a.data.dot(&y).max(bracket.b.data.dot(&y));
    if best.dot(&y) >= lower { best } else { bracket.a.data }
}

/// Newton's method along a smooth curve for the angle between `∇f` and the unit vector `y`, with the curvature
/// from a second gradient nearby; `None` if that does not converge at once.
fn by_newton(jet: &dyn Fn(&Vector<2>) -> (f64, Vector<2>), y: &Vector<2>) -> Option<Vector<2>> {
    let mut x = *y;
    for _ in 0..16 {
        let (value, gradient) = jet(&x);
        x /= value;
        let (n, size) = (gradient.normalize(), x.norm());
        let angle = cross(&n, y).atan2(n.dot(y));
        if angle.abs() <= 4.0 * f64::EPSILON {
            return Some(x);
        }
        let (tangent, probe) = (quarter_turn(&n), 1e-7 * size);
        let turned = jet(&(x + tangent * probe)).1;
        let step = angle * probe * turned.norm() / cross(&n, &turned);
        // The comparisons also turn away what is not a number, from gauges and support functions of users.
        if !(step.abs() >= 0.0 && size > 0.0) {
            return None;
        }
        let step = step.clamp(-0.5 * size, 0.5 * size);
        if step.abs() <= f64::EPSILON * size {
            return Some(x);
        }
        x += tangent * step;
    }
    None
}

/// The smallest `f` on the plane `x·y = 1`, in two coordinates of that plane.
fn farthest_in_space<const P: usize, F>(jet: &F, y: &Vector<P>) -> Vector<P>
where
    F: Fn(&Vector<P>) -> (f64, Vector<P>) + ?Sized,
{
    let y = y.normalize();
    let axes = tangents(&y);
    let point = |t: &Vector<2>| y + axes[0] * t.x + axes[1] * t.y;
    let in_plane = |t: &Vector<2>| {
        let (value, gradient) = jet(&point(t));
        (value, Vector::<2>::new(axes[0].dot(&gradient), axes[1].dot(&gradient)))
    };
    let (mut centre, mut radius) = (Vector::<2>::zeros(), 1.0);
    loop {
        let next = by_ellipsoids(&centre, radius, &in_plane);
        if (next - centre).norm() < 0.5 * radius || radius > 1e12 {
            let x = onto_ridge(jet, point(&next), &y);
            return x / jet(&x).0;
        }
        (centre, radius) = (next, 8.0 * radius);
    }
}

/// A point near `x` with a smaller `f(x)/x·y`, on a ridge of `f` if there is one at `x`.
///
/// The gradients on both sides of a ridge are the ends of an edge, to which the point that is looked for is normal: it is
/// that of the plane across the edge. Ellipsoids become thin across a ridge. What they leave of a distance from it counts to
/// first order, as often as the edge is longer than the set is thick, and along it they come to no end.
fn onto_ridge<const P: usize, F>(jet: &F, x: Vector<P>, y: &Vector<P>) -> Vector<P>
where
    F: Fn(&Vector<P>) -> (f64, Vector<P>) + ?Sized,
{
    // The ends of an edge are known the better the closer to the ridge they are asked for.
    const WIDTHS: [f64; 3] = [1e-4, 1e-8, 1e-12];
    // Length of an edge over the size of the set.
    const EDGE: f64 = 1e-3;
    let mut best = x;
    let (value, mut here) = jet(&best);
    let mut least = value / best.dot(y);
    for width in WIDTHS {
        let mut edge = Vector::<P>::zeros();
        for axis in tangents(&best.normalize()) {
            for step in [width * best.norm(), -width * best.norm()] {
                let to = jet(&(best + axis * step)).1 - here;
                if to.norm() > edge.norm() {
                    edge = to;
                }
            }
        }
        // The comparison also turns away what is not a number.
        if !(edge.norm() > EDGE * here.norm()) {
            continue;
        }
        let [first, second] = tangents(&edge.normalize());
        let planar = |t: &Vector<2>| {
            let (value, gradient) = jet(&(first * t.x + second * t.y));
            (value, Vector::<2>::new(first.dot(&gradient), second.dot(&gradient)))
        };
        let across = Vector::<2>::new(first.dot(y), second.dot(y));
        if !(across.norm() > 0.0) {
            continue;
        }
        let found = farthest_in_plane(&planar, &across);
        let moved = first * found.x + second * found.y;
        let (value, gradient) = jet(&moved);
        let ratio = value / moved.dot(y);
        if ratio > 0.0 && ratio < least {
            (best, least, here) = (moved, ratio, gradient);
        }
    }
    best
}

/// Minimiser of a convex function of `N ≥ 2` variables that lies within a ball, from values and subgradients alone:
/// the ellipsoid method, whose volume shrinks by a constant factor per step whatever the function.
///
/// On a face on which the function is least its subgradients are nothing but rounding errors, and ellipsoids that follow them
/// may end off the face. If a centre on the way was lower than the last one by more than rounding, it is taken instead; of a
/// smooth function the last centre has more digits.
fn by_ellipsoids<const N: usize>(
    centre: &Vector<N>,
    radius: f64,
    jet: &dyn Fn(&Vector<N>) -> (f64, Vector<N>),
) -> Vector<N> {
    const ROUNDING: f64 = 1e-12;
    let n = N as f64;
    let mut x = *centre;
    let mut shape = Matrix::<N>::identity() * (radius * radius);
    let (mut value, mut gradient) = jet(&x);
    let (mut least, mut where_least) = (value, x);
    for _ in 0..400 * (N - 1) {
        let step = shape * gradient;
        let length = gradient.dot(&step).sqrt();
        let size = shape.trace().sqrt();
        // The comparison also ends at a vanishing gradient.
        if !(length > 0.0) || size <= f64::EPSILON * (x.norm() + f64::MIN_POSITIVE) {
            break;
        }
        let step = step / length;
        x -= step / (n + 1.0);
        shape = (shape - step * step.transpose() * (2.0 / (n + 1.0))) * (n * n / (n * n - 1.0));
        shape = (shape + shape.transpose()) * 0.5;
        (value, gradient) = jet(&x);
        if value < least {
            (least, where_least) = (value, x);
        }
    }
    // The comparison also turns away what is not a number.
    if value <= least + ROUNDING * least.abs() { x } else { where_least }
}

//! Local maxima of functions of directions, of which nothing is known but values.

use std::f64::consts::PI;

use crate::numeric::vectors::{orthogonalise, tangents};
use crate::{Cancelled, Matrix, StarSet, Vector, directions};

/// Directions in which a function is looked at, per frame.
const DIRECTIONS: usize = 2000;
/// Peaks among them that are climbed.
const PEAKS: usize = 10;
/// Offsets between the indices of neighbours on a Fibonacci spiral, and how far neighbours are apart at most, where one
/// direction has a square of side one to itself.
const FIBONACCI: [usize; 12] = [1, 2, 3, 5, 8, 13, 21, 34, 55, 89, 144, 233];
const NEIGHBOURS: f64 = 1.7;
/// Sets with axis ratios below this one are looked at as they are.
const ROUND: f64 = 2.0;

/// The largest value of a function of degree zero, and a unit direction that has it; from directions all around, from
/// such in which one of these sets is round, and from corners.
pub(super) fn largest_in_space<const P: usize>(
    sets: &[&dyn StarSet<P>],
    value: &dyn Fn(&Vector<P>) -> f64,
    cancelled: Cancelled<'_>,
) -> (f64, Vector<P>) {
    let around = directions::<P>(DIRECTIONS);
    let mut best = (f64::NEG_INFINITY, Vector::zeros());
    let mut take = |found: (f64, Vector<P>)| {
        if found.0 > best.0 {
            best = found;
        }
    };
    let frames = sets.iter().filter_map(|set| slender_frame(*set, cancelled));
    for frame in std::iter::once(Matrix::identity()).chain(frames) {
        for (there, unit) in peaks(&around, &|unit| value(&(frame * unit))) {
            take(climbed(value, &frame, there, unit));
        }
    }
    let corners = sets.iter().flat_map(|set| set.corners());
    let mut corners: Vec<(f64, Vector<P>)> = corners.map(|x| (value(&x), x)).collect();
    corners.sort_by(|p, q| q.0.total_cmp(&p.0));
    for (there, corner) in corners.into_iter().take(PEAKS) {
        take(climbed(value, &Matrix::identity(), there, corner.normalize()));
    }
    (best.0, best.1.normalize())
}

/// A map under which the unit ball is about as slender as the set; `None` if the set is about as round as a ball.
pub(super) fn slender_frame<const P: usize>(
    set: &dyn StarSet<P>,
    cancelled: Cancelled<'_>,
) -> Option<Matrix<P>> {
    const ROUNDS: usize = 12;
    const PROBES: usize = 100;
    let (probes, corners) = (directions::<P>(PROBES), set.corners());
    let lengths = |axes: &Matrix<P>| Vector::<P>::from_fn(|i, _| axes.column(i).norm());
    let mut frame = Matrix::<P>::identity();
    for _ in 0..ROUNDS {
        let inverse = frame.try_inverse()?;
        let goes_on = probes.iter().take_while(|_| !cancelled());
        let mut points: Vec<Vector<P>> =
            goes_on.map(|unit| unit / set.gauge(&(frame * unit))).collect();
        points.extend(corners.iter().map(|corner| inverse * corner));
        // The farthest point, the farthest one across it, and so on.
        let mut axes = Matrix::<P>::zeros();
        for i in 0..P {
            let farthest = points
                .iter()
                .copied()
                .max_by(|p, q| p.norm_squared().total_cmp(&q.norm_squared()))?;
            axes.set_column(i, &farthest);
            let unit = farthest.normalize();
            points.iter_mut().for_each(|x| *x -= unit * unit.dot(x));
        }
        let lengths = lengths(&axes);
        // The comparison also turns away what is not a number.
        if !(lengths.min() > 0.0 && lengths.max() < f64::MAX) {
            return None;
        }
        frame *= axes / lengths.max();
        if lengths.max() < ROUND * lengths.min() {
            break;
        }
    }
    let mut axes = frame;
    orthogonalise(&mut axes);
    let lengths = lengths(&axes);
    (lengths.max() > ROUND * lengths.min()).then_some(frame)
}

/// The highest directions of a spiral that are higher than their neighbours, with their values.
fn peaks<const P: usize>(
    around: &[Vector<P>],
    value: &dyn Fn(&Vector<P>) -> f64,
) -> Vec<(f64, Vector<P>)> {
    let values: Vec<f64> = around.iter().map(value).collect();
    let reach = NEIGHBOURS * side(around.len());
    let is_neighbour = |i: usize, j: usize| (around[i] - around[j]).norm() < reach;
    let is_peak = |&i: &usize| {
        let beside = FIBONACCI.iter().flat_map(|step| [i.checked_sub(*step), Some(i + step)]);
        let mut beside = beside.flatten().filter(|&j| j < around.len() && is_neighbour(i, j));
        beside.all(|j| !(values[j] > values[i]))
    };
    let mut found: Vec<usize> = (0..around.len()).filter(is_peak).collect();
    found.sort_by(|&i, &j| values[j].total_cmp(&values[i]));
    found.truncate(PEAKS);
    found.into_iter().map(|i| (values[i], around[i])).collect()
}

/// The side of the square that a direction has to itself.
fn side(count: usize) -> f64 {
    (4.0 * PI / count as f64).sqrt()
}

/// The local maximum near a direction, by the simplex method of \[NelderMead1965\], which follows ridges, begun anew from what it
/// found until that gains nothing.
fn climbed<const P: usize>(
    value: &dyn Fn(&Vector<P>) -> f64,
    frame: &Matrix<P>,
    there: f64,
    unit: Vector<P>,
) -> (f64, Vector<P>) {
    const STARTS: usize = 8;
    let (mut best, mut unit, mut size) = (there, unit, 0.5 * side(DIRECTIONS));
    for _ in 0..STARTS {
        let [first, second] = tangents(&unit);
        let point = |t: &Vector<2>| unit + first * t.x + second * t.y;
        let (found, t) = by_simplices(&|t| value(&(frame * point(t))), best, size);
        let gain = found - best;
        (best, unit) = (found, point(&t).normalize());
        // The comparison also ends at what is not a number.
        if !(gain > 4.0 * f64::EPSILON * best.abs()) {
            break;
        }
        size = (0.5 * t.norm()).clamp(1e-6, size);
    }
    (best, frame * unit)
}

/// The largest value that a triangle finds which moves away from its lowest corner, around the origin, where the value is
/// `there`.
fn by_simplices(value: &dyn Fn(&Vector<2>) -> f64, there: f64, size: f64) -> (f64, Vector<2>) {
    const MOVES: usize = 200;
    // What is not a number is lower than anything.
    let corner = |t: Vector<2>| {
        let value = value(&t);
        (if value.is_nan() { f64::NEG_INFINITY } else { value }, t)
    };
    let mut triangle = [
        (there, Vector::<2>::zeros()),
        corner(Vector::<2>::new(size, 0.0)),
        corner(Vector::<2>::new(-0.5 * size, 0.75_f64.sqrt() * size)),
    ];
    for _ in 0..MOVES {
        triangle.sort_by(|p, q| q.0.total_cmp(&p.0));
        let [high, middle, low] = triangle;
        let width = (middle.1 - high.1).norm().max((low.1 - high.1).norm());
        if width <= 1e-14 || (high.0 - low.0 <= 2.0 * f64::EPSILON * high.0.abs() && width < 1e-7) {
            break;
        }
        let centre = 0.5 * (high.1 + middle.1);
        let at = |factor: f64| corner(centre + (low.1 - centre) * factor);
        let mirrored = at(-1.0);
        triangle[2] = if mirrored.0 > high.0 {
            let beyond = at(-2.0);
            if beyond.0 > mirrored.0 { beyond } else { mirrored }
        } else if mirrored.0 > middle.0 {
            mirrored
        } else {
            let nearer = at(if mirrored.0 > low.0 { -0.5 } else { 0.5 });
            if nearer.0 > low.0.max(mirrored.0) {
                nearer
            } else {
                triangle[1] = corner(0.5 * (high.1 + middle.1));
                corner(0.5 * (high.1 + low.1))
            }
        };
    }
    triangle.into_iter().fold((there, Vector::<2>::zeros()), |p, q| if q.0 > p.0 { q } else { p })
}

//! Directions in which the boundaries of two sets of the plane turn, and the largest value of a function over them.

use std::f64::consts::TAU;

use crate::numeric::periodic_curve::diamond;
use crate::numeric::vectors::cast;
use crate::{Form, Matrix, StarSet, Vector};

/// Directions that a set gives to a chain, per turn and kind.
const DIRECTIONS: usize = 32;
/// Directions closer than this, in quarter turns, count as one.
const SAME: f64 = 1e-13;

/// What is known of a function in a direction: on an axis of a set and at a corner it may have a minimum between two maxima
/// that are much nearer than the next directions.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
enum Place {
    Between,
    OnAxis,
    AtCorner,
}

impl<const P: usize> Form<'_, P> {
    /// Adds points in the directions in which the boundary of a planar set turns, equidistant in three ways: in the
    /// positions of the set with semi-axes one, in the shares `|xᵢ/aᵢ|^s` as they are on a circle, and in the
    /// normals; if asked for in the first quarter only. Whether the set is resolved by them.
    fn add_directions(&self, quarter: bool, out: &mut Vec<(Vector<P>, Place)>) -> bool {
        let count = if quarter { DIRECTIONS / 4 + 1 } else { DIRECTIONS };
        let mut add = |frame: &Matrix<P>, power: f64| {
            for k in 0..count {
                let (sine, cosine) = (TAU * k as f64 / DIRECTIONS as f64).sin_cos();
                // On the axes to the bit, where cusps are.
                let [cosine, sine] = [cosine, sine].map(|v| if v.abs() < 1e-9 { 0.0 } else { v });
                let bent = [cosine, sine].map(|v| v.abs().powf(power).copysign(v));
                let x = frame * Vector::from_fn(|i, _| bent[i.min(1)]);
                let on_axis = k % (DIRECTIONS / 4) == 0;
                if x.amax() > 0.0 {
                    out.push((x, if on_axis { Place::OnAxis } else { Place::Between }));
                }
            }
        };
        match *self {
            Self::Ellipsoid { from_ball, .. } => {
                add(&from_ball, 1.0);
                let unit = from_ball / from_ball.amax();
                add(&(unit * unit.transpose()), 1.0);
                true
            }
            Self::Powers { lower, upper, reciprocal } => {
                let axes = lower.sup(&upper);
                add(&Matrix::from_diagonal(&axes), 1.0);
                if reciprocal > 0.0 && reciprocal != 0.5 {
                    add(&Matrix::from_diagonal(&axes), 2.0 * reciprocal);
                }
                if reciprocal > 0.0 && reciprocal < 1.0 {
                    let conjugate = 1.0 / (1.0 - reciprocal);
                    let unit = axes / axes.max();
                    add(&Matrix::from_diagonal(&unit.map(|a| a.powf(conjugate))), conjugate - 1.0);
                }
                true
            }
            Self::Image { of, map } => {
                let first = out.len();
                let resolved = of.form().add_directions(false, out);
                out[first..].iter_mut().for_each(|(x, _)| *x = map * *x);
                resolved
            }
            Self::Any => false,
        }
    }
}

/// Points in the directions in which the boundaries of two planar sets turn, counter-clockwise.
#[derive(Debug, Clone)]
pub struct TurningDirections<const P: usize> {
    points: Vec<(Vector<P>, Place)>,
    /// Whether they go all around. Else they are those of the first quarter, as both sets are symmetric to the axes.
    around: bool,
}

impl<const P: usize> TurningDirections<P> {
    /// Those of two sets, near the boundary of `b`, corners of both among them; `None` where not enough is known of the
    /// sets, and in other dimensions.
    pub fn new(a: &dyn StarSet<P>, b: &dyn StarSet<P>) -> Option<Self> {
        if P != 2 {
            return None;
        }
        let is_symmetric = |set: &dyn StarSet<P>| {
            set.form().powers().is_some_and(|(lower, upper, _)| lower == upper)
        };
        let quarter = is_symmetric(a) && is_symmetric(b);
        let corners = a.corners().into_iter().chain(b.corners());
        let mut points: Vec<(Vector<P>, Place)> = corners.map(|x| (x, Place::AtCorner)).collect();
        if quarter {
            points.retain(|(x, _)| x.min() >= 0.0);
        }
        points.reserve(6 * DIRECTIONS);
        if ![a, b].iter().all(|set| set.form().add_directions(quarter, &mut points)) {
            return None;
        }
        let sorted = |(x, place): (Vector<P>, Place)| {
            // By a power of two, so that no direction is rounded off a cusp.
            let near = x * 2f64.powi(-b.gauge(&x).log2().round() as i32);
            (diamond(&cast(&x)), (near, place))
        };
        let mut sorted: Vec<(f64, (Vector<P>, Place))> = points.into_iter().map(sorted).collect();
        sorted.sort_unstable_by(|p, q| p.0.total_cmp(&q.0));
        sorted.dedup_by(|next, kept| {
            let same = next.0 - kept.0 <= SAME;
            // Beside a corner a function may be far from its value there.
            if same && next.1.1 > kept.1.1 {
                *kept = *next;
            }
            same
        });
        let points = sorted.into_iter().map(|(_, point)| point).collect();
        Some(Self { points, around: !quarter })
    }

    /// The largest value of a function of degree zero with the symmetries of both sets, and where it is: every local
    /// maximum is refined between its neighbours by Brent's method, and both sides of axes and corners are searched.
    pub fn largest(&self, value: impl Fn(&Vector<P>) -> f64) -> (f64, Vector<P>) {
        let Self { points, around } = self;
        let values: Vec<f64> = points.iter().map(|(x, _)| value(x)).collect();
        let last = points.len() - 1;
        let mut best = (f64::NEG_INFINITY, Vector::zeros());
        for (i, &(middle, place)) in points.iter().enumerate() {
            if values[i] > best.0 {
                best = (values[i], middle);
            }
            // Beyond the ends of a quarter, which lie on axes, lies its mirror image.
            let before = if i > 0 { Some(i - 1) } else { around.then_some(last) };
            let after = if i < last { Some(i + 1) } else { around.then_some(0) };
            let rises = [before, after].iter().flatten().any(|&j| values[j] > values[i]);
            let [before, after] = [before, after].map(|j| j.map(|j| points[j].0));
            let sides = match place {
                Place::Between if rises => continue,
                Place::Between => [[before, after], [None; 2]],
                _ => [[before, None], [None, after]],
            };
            for neighbours in sides.into_iter().filter(|sides| *sides != [None; 2]) {
                let found = refined(middle, values[i], neighbours, &value);
                if found.0 > best.0 {
                    best = found;
                }
            }
        }
        best
    }
}

/// A local maximum between a point with this value and its neighbours, on one side or both.
///
/// The maximum of a smooth function is determined to half of the digits of its place, a kink to all of them.
fn refined<const P: usize>(
    middle: Vector<P>,
    value_there: f64,
    neighbours: [Option<Vector<P>>; 2],
    value: impl Fn(&Vector<P>) -> f64,
) -> (f64, Vector<P>) {
    /// The part of the longer side by which golden section divides it.
    const GOLDEN: f64 = 0.381_966_011_250_105_1;
    const MOST: usize = 100;
    let [before, after] = neighbours.map(|x| x.map_or(Vector::zeros(), |x| x - middle));
    let point = |t: f64| middle + if t < 0.0 { before * -t } else { after * t };
    let [mut low, mut high] = [(0, -1.0), (1, 1.0)].map(|(side, end)| match neighbours[side] {
        Some(_) => end,
        None => 0.0,
    });
    // The best place, the second and the third one, within the bounds.
    let (mut best, mut second, mut third) =
        ((0.0, value_there), (0.0, value_there), (0.0, value_there));
    let (mut step, mut before_last) = (0.0_f64, 0.0_f64);
    for _ in 0..MOST {
        let centre = 0.5 * (low + high);
        let least = 1e-11 + 2.0 * f64::EPSILON * f64::abs(best.0);
        if f64::abs(best.0 - centre) <= 2.0 * least - 0.5 * (high - low) {
            break;
        }
        let golden = || if best.0 >= centre { low - best.0 } else { high - best.0 };
        let mut bold = None;
        if before_last.abs() > least {
            // The vertex of the parabola through the three.
            let r = (best.0 - second.0) * (best.1 - third.1);
            let q = (best.0 - third.0) * (best.1 - second.1);
            let (p, d) = ((best.0 - third.0) * q - (best.0 - second.0) * r, 2.0 * (q - r));
            let by_parabola = -p / d;
            let within = best.0 + by_parabola > low && best.0 + by_parabola < high;
            if d != 0.0 && within && by_parabola.abs() < 0.5 * before_last.abs() {
                bold = Some(by_parabola);
            }
        }
        let to = match bold {
            Some(by) => {
                before_last = step;
                by
            }
            None => {
                before_last = golden();
                GOLDEN * before_last
            }
        };
        step = if to.abs() >= least { to } else { least.copysign(to) };
        let at = best.0 + step;
        let new = (at, value(&point(at)));
        if new.1 >= best.1 {
            if at >= best.0 {
                low = best.0
            } else {
                high = best.0
            }
            (third, second, best) = (second, best, new);
        } else {
            if at < best.0 {
                low = at
            } else {
                high = at
            }
            if new.1 >= second.1 || second.0 == best.0 {
                (third, second) = (second, new);
            } else if new.1 >= third.1 || third.0 == best.0 || third.0 == second.0 {
                third = new;
            }
        }
        // Differences of values are rounding from here on.
        let flat = best.1 - second.1 <= f64::EPSILON * best.1.abs()
            && best.1 - third.1 <= f64::EPSILON * best.1.abs();
        if flat && second.0 != best.0 && third.0 != second.0 {
            break;
        }
    }
    (best.1, point(best.0))
}

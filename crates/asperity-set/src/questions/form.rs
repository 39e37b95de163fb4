//! What of sets is known in closed form, for questions about two of them.

use std::f64::consts::TAU;

use crate::numeric::periodic_curve::diamond;
use crate::numeric::vectors::{along, cast, orthogonalise};
use crate::{Matrix, StarSet, Vector};

/// What of a set is known in closed form.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub enum Form<'a, const P: usize> {
    /// The image of the unit ball under a map with an inverse.
    Ellipsoid {
        /// Maps the unit ball to the set.
        from_ball: Matrix<P>,
        /// Maps the set to the unit ball.
        to_ball: Matrix<P>,
    },
    /// `{x : Σ|xᵢ/aᵢ|^s ≤ 1}`, where `aᵢ` may differ with the sign of `xᵢ`; a box without an exponent.
    Powers {
        /// Semi-axes on the sides of negative coordinates, all positive.
        lower: Vector<P>,
        /// Semi-axes on the sides of positive coordinates.
        upper: Vector<P>,
        /// `1/s`, zero for a box.
        reciprocal: f64,
    },
    /// The image of a set under a regular map.
    Image {
        /// The set that is mapped.
        of: &'a dyn StarSet<P>,
        /// The map.
        map: &'a Matrix<P>,
    },
    /// Nothing.
    Any,
}

/// Directions that a set gives to a chain, per turn and kind.
const DIRECTIONS: usize = 32;
/// Directions closer than this, in quarter turns, count as one.
const SAME: f64 = 1e-13;

impl<const P: usize> Form<'_, P> {
    /// The same as a set of powers, if its axes are those of the coordinates.
    fn powers(&self) -> Option<(Vector<P>, Vector<P>, f64)> {
        match *self {
            Self::Powers { lower, upper, reciprocal } => Some((lower, upper, reciprocal)),
            Self::Ellipsoid { from_ball, .. } => {
                let axes = from_ball.diagonal();
                let parallel = Matrix::from_diagonal(&axes) == from_ball && axes.min() > 0.0;
                parallel.then_some((axes, axes, 0.5))
            }
            _ => None,
        }
    }

    /// Adds points in the directions in which the boundary of a planar set turns, equidistant in three ways: in the
    /// positions of the set with semi-axes one, in the shares `|xᵢ/aᵢ|^s` as they are on a circle, and in the
    /// normals; if asked for in the first quarter only. Whether the set is resolved by them.
    fn add_directions(&self, quarter: bool, out: &mut Vec<Vector<P>>) -> bool {
        let count = if quarter { DIRECTIONS / 4 + 1 } else { DIRECTIONS };
        let mut add = |frame: &Matrix<P>, power: f64| {
            for k in 0..count {
                let (sine, cosine) = (TAU * k as f64 / DIRECTIONS as f64).sin_cos();
                // On the axes to the bit, where cusps are.
                let [cosine, sine] = [cosine, sine].map(|v| if v.abs() < 1e-9 { 0.0 } else { v });
                let bent = [cosine, sine].map(|v| v.abs().powf(power).copysign(v));
                let x = frame * Vector::from_fn(|i, _| bent[i.min(1)]);
                if x.amax() > 0.0 {
                    out.push(x);
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
                out[first..].iter_mut().for_each(|x| *x = map * *x);
                resolved
            }
            Self::Any => false,
        }
    }
}

/// Points in the directions in which the boundaries of two planar sets turn, counter-clockwise.
#[derive(Debug, Clone)]
pub struct TurningDirections<const P: usize> {
    points: Vec<Vector<P>>,
    /// Whether they go all around. Else they are those of the first quarter, as both sets are symmetric to the axes.
    around: bool,
}

impl<const P: usize> TurningDirections<P> {
    /// Those of two sets, on the boundary of `b`, corners of both among them; `None` where not enough is known of the
    /// sets, and in other dimensions.
    pub fn new(a: &dyn StarSet<P>, b: &dyn StarSet<P>) -> Option<Self> {
        if P != 2 {
            return None;
        }
        let is_symmetric = |set: &dyn StarSet<P>| {
            set.form().powers().is_some_and(|(lower, upper, _)| lower == upper)
        };
        let quarter = is_symmetric(a) && is_symmetric(b);
        let mut points: Vec<Vector<P>> = a.corners().into_iter().chain(b.corners()).collect();
        if quarter {
            points.retain(|x| x.min() >= 0.0);
        }
        let corners = points.len();
        points.reserve(6 * DIRECTIONS);
        if ![a, b].iter().all(|set| set.form().add_directions(quarter, &mut points)) {
            return None;
        }
        let place = |(i, x): (usize, Vector<P>)| (diamond(&cast(&x)), i < corners, x / b.gauge(&x));
        let mut sorted: Vec<(f64, bool, Vector<P>)> =
            points.into_iter().enumerate().map(place).collect();
        sorted.sort_unstable_by(|p, q| p.0.total_cmp(&q.0));
        sorted.dedup_by(|next, kept| {
            let same = next.0 - kept.0 <= SAME;
            // Beside a corner a function may be far from its value there.
            if same && next.1 {
                *kept = *next;
            }
            same
        });
        let points = sorted.into_iter().map(|point| point.2).collect();
        Some(Self { points, around: !quarter })
    }

    /// The largest value of a function of degree zero with the symmetries of both sets, and where it is: every local
    /// maximum is refined between its neighbours by Brent's method.
    pub fn largest(&self, value: impl Fn(&Vector<P>) -> f64) -> (f64, Vector<P>) {
        let Self { points, around } = self;
        let values: Vec<f64> = points.iter().map(&value).collect();
        let last = points.len() - 1;
        let mut best = (f64::NEG_INFINITY, Vector::zeros());
        for i in 0..=last {
            // Beyond the ends of a quarter lies its mirror image, for which the end itself may stand.
            let before = if i > 0 {
                i - 1
            } else if *around {
                last
            } else {
                0
            };
            let after = if i < last {
                i + 1
            } else if *around {
                0
            } else {
                last
            };
            if values[i] > best.0 {
                best = (values[i], points[i]);
            }
            if values[i] >= values[before] && values[i] >= values[after] {
                let found = refined([points[before], points[i], points[after]], values[i], &value);
                if found.0 > best.0 {
                    best = found;
                }
            }
        }
        best
    }
}

/// The local maximum between three neighbours of which the middle one has the largest value.
///
/// The maximum of a smooth function is determined to half of the digits of its place, a kink to all of them.
fn refined<const P: usize>(
    [before, middle, after]: [Vector<P>; 3],
    value_there: f64,
    value: impl Fn(&Vector<P>) -> f64,
) -> (f64, Vector<P>) {
    /// The part of the longer side by which golden section divides it.
    const GOLDEN: f64 = 0.381_966_011_250_105_1;
    const MOST: usize = 100;
    let point = |t: f64| {
        if t < 0.0 { middle + (before - middle) * -t } else { middle + (after - middle) * t }
    };
    // The best place, the second and the third one, within the bounds.
    let (mut low, mut high) = (-1.0, 1.0);
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

/// `max k_a(x)/k_b(x)` where there is a closed form, and a direction that has it.
///
/// - Of ellipsoids it is the largest singular value of the map of the one's ball to that of the other.
/// - Of sets `Σ|xᵢ/aᵢ|^s ≤ 1` along the same axes the shares `tᵢ = |xᵢ/bᵢ|^(s_b)`, which add up to one on the boundary of
///   *b*, give `k_a = (Σ rᵢ^(s_a) tᵢ^(s_a/s_b))^(1/s_a)` with `rᵢ = bᵢ/aᵢ`. The largest value is, by Hölder's inequality, the
///   norm of `r` with the exponent `q`, `1/q = 1/s_a − 1/s_b`, where that is positive, at `tᵢ ∝ rᵢ^q`; else it is
///   the largest `rᵢ`.
/// - Images under the same map have the ratio of what is mapped.
pub fn ratio_in_closed_form<const P: usize>(
    a: &dyn StarSet<P>,
    b: &dyn StarSet<P>,
) -> Option<(f64, Vector<P>)> {
    let forms = (a.form(), b.form());
    if let (Form::Image { of: first, map }, Form::Image { of: second, map: same }) = forms {
        let (ratio, x) = (map == same).then(|| ratio_in_closed_form(first, second)).flatten()?;
        return Some((ratio, (map * x).normalize()));
    }
    if let (Some(a), Some(b)) = (forms.0.powers(), forms.1.powers()) {
        return Some(ratio_of_powers(a, b));
    }
    match forms {
        (Form::Ellipsoid { to_ball, .. }, Form::Ellipsoid { from_ball, .. }) => {
            let (ratio, direction) = largest_stretch(&(to_ball * from_ball));
            Some((ratio, (from_ball * direction).normalize()))
        }
        _ => None,
    }
}

type Powers<const P: usize> = (Vector<P>, Vector<P>, f64);

fn ratio_of_powers<const P: usize>(a: Powers<P>, b: Powers<P>) -> (f64, Vector<P>) {
    // The side on which *a* is narrower.
    let sides = [b.0.component_div(&a.0), b.1.component_div(&a.1)];
    let upper = |i: usize| sides[1][i] >= sides[0][i];
    let ratios = Vector::<P>::from_fn(|i, _| sides[usize::from(upper(i))][i]);
    let axes = Vector::<P>::from_fn(|i, _| if upper(i) { b.1[i] } else { -b.0[i] });
    let (largest, inverse) = (ratios.max(), a.2 - b.2);
    if !(inverse > 0.0) {
        let axis = ratios.imax();
        return (largest, along(axis, axes[axis].signum()));
    }
    let powers = (ratios / largest).map(|r| r.powf(1.0 / inverse));
    let sum = powers.sum();
    let shares = (powers / sum).map(|t| t.powf(b.2));
    (largest * sum.powf(inverse), axes.component_mul(&shares).normalize())
}

/// The largest singular value of a matrix, and the unit vector that it stretches most.
fn largest_stretch<const P: usize>(map: &Matrix<P>) -> (f64, Vector<P>) {
    let mut columns = *map;
    orthogonalise(&mut columns);
    let lengths = Vector::<P>::from_fn(|i, _| columns.column(i).norm());
    let longest = lengths.imax();
    // The left singular vector, from which the map takes its transpose to the right one.
    (lengths[longest], map.tr_mul(&(columns.column(longest) / lengths[longest])).normalize())
}

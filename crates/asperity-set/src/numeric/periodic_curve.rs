//! Smooth periodic functions of the polar angle through samples.
//!
//! A function `f` of the direction, extended to the plane with degree one, `F(x) = |x| f(arg x)`, is
//! convex if and only if `f + f″ ≥ 0`. For a support function `f + f″` is the radius of curvature, for a
//! gauge it is the curvature of the polar set. Here `ρ = f + f″` is continuous and linear between knots,
//! so that `f` is twice continuously differentiable and its convexity is seen from the knots alone. At the angle
//! `φ` from the knot `i`, where `ρ = ρ_i + σφ`, the solution of `f + f″ = ρ` is
//!
//! `f = f_i cos φ + f_i′ sin φ + ρ_i (1 − cos φ) + σ (φ − sin φ)`:
//!
//! `F(x) = gᵀx + |x| [ρ_i (1 − cos φ) + σ (φ − sin φ)]` with the gradient `g` at the knot. Straight lines and corners,
//! where `ρ` vanishes, are reproduced without error. Between knots an angle `H` apart, `ρ` may be larger than `f` by
//! `1/H²`, which is 10⁴ at a hundredth, but every term of this sum is of the size of `f`, so that `f` has all digits. With
//! `ρ` itself as the particular solution, terms of the size of `ρ` would cancel.
//!
//! The gradient moves by `dF′ = ρ e⊥ dθ` with `e = (cos θ, sin θ)`: where `F` is convex it turns counter-clockwise, and
//! the direction in which it has a given direction is found from a table of its turns at the knots. That is the
//! support point of the set `F ≤ 1` where `F` is its gauge, and the gauge where `F` is the support function.

use std::f64::consts::TAU;
use std::sync::Arc;

use crate::numeric::cyclic::Cyclic;
use crate::numeric::vectors::{cross, quarter_turn};
use crate::{SetError, Vector};

/// Samples closer than this count as one.
const SMALLEST_STEP: f64 = 1e-9;
/// Samples farther apart than this, nearly half a turn, leave the set open.
const LARGEST_STEP: f64 = 3.0;
/// Fewest samples.
const FEWEST: usize = 4;

/// Gradients whose turns (see [`diamond`]) differ by less are the same but for rounding, about ε over the distance of
/// the samples, 3e-13 for 7200 of them.
const SAME_TURN: f64 = 1e-12;

/// A piece from one knot to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Piece {
    /// Direction of the first knot.
    start: Vector<2>,
    /// Angle to the next one.
    step: f64,
    /// `ρ` at the first knot and its slope.
    rho: f64,
    slope: f64,
    /// `∇F` at the first knot.
    gradient: Vector<2>,
}

/// See the module page.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PeriodicCurve {
    pieces: Arc<[Piece]>,
    /// For each bin of `diamond(x)` the last piece that starts before it.
    bins: Arc<[u32]>,
    /// How far `∇F` has turned where each piece starts, counted from the piece before which it turns most, the number of
    /// which is `first`. Of curves with dents they mean nothing.
    turns: Arc<[f64]>,
    first: usize,
    /// The smallest `ρ`, minus infinity at a corner that turns back, and the direction of its knot.
    lowest: (f64, Vector<2>),
    /// Directions of the samples where the slope jumps.
    corners: Arc<[Vector<2>]>,
}

/// Value, slope and `f + f″` in a direction.
pub(crate) struct CurveJet {
    /// `|x| f`.
    pub(crate) value: f64,
    /// `∇F`.
    pub(crate) gradient: Vector<2>,
    /// `f + f″`.
    pub(crate) rho: f64,
}

/// Angles and values, as they were given.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Samples {
    angle: Arc<[f64]>,
    value: Arc<[f64]>,
}

impl Samples {
    pub(crate) fn new(angle: &[f64], value: &[f64]) -> Self {
        Self { angle: angle.into(), value: value.into() }
    }

    pub(crate) fn as_slices(&self) -> (&[f64], &[f64]) {
        (&self.angle, &self.value)
    }
}

impl PeriodicCurve {
    /// The curve through positive samples at angles in rad, in any order, within one turn.
    ///
    /// Where the samples are those of a convex `F`, so is the curve. If that cannot be had with a continuous
    /// `ρ` (a corner beside a flat), or if the curve would swing far beyond the samples, the slope jumps at the
    /// samples concerned.
    pub(crate) fn new(
        angle: &[f64],
        value: &[f64],
        argument: &'static str,
    ) -> Result<Self, SetError> {
        let (angle, value) = sorted(angle, value, argument)?;
        let (jump, rounding) = jumps(&angle, &value);
        let convex = jump.iter().zip(&rounding).all(|(jump, error)| jump >= &-error);
        let n = angle.len();
        let mut corner = vec![false; n];
        loop {
            let mut rho = solve(&angle, &jump, &corner);
            let mut faults = overshoots(&angle, &value, &rho, &corner);
            if convex {
                // In a dent ρ, or the jump at a corner, takes back what the neighbours bring.
                let least = |i: usize| if corner[i] { -rounding[i] } else { 0.0 };
                faults.extend((0..n).filter(|&i| rho[i] < least(i)));
            }
            let around = |i: &usize| [(i + n - 1) % n, *i, (i + 1) % n];
            faults.retain(|i| around(i).iter().any(|&j| !corner[j]));
            if faults.is_empty() {
                let mut least = (f64::INFINITY, 0);
                for i in 0..n {
                    let mut curvature = rho[i];
                    if corner[i] {
                        // Within a flat the jump vanishes; one that turns back is bent without bound.
                        corner[i] = rho[i].abs() > 64.0 * rounding[i];
                        let turns_back = corner[i] && rho[i] < 0.0;
                        curvature = if turns_back { f64::NEG_INFINITY } else { 0.0 };
                        rho[i] = 0.0;
                    }
                    if curvature < least.0 {
                        least = (curvature, i);
                    }
                }
                return Ok(Self::from_samples(&angle, &value, &rho, &corner, least));
            }
            faults.iter().flat_map(around).for_each(|j| corner[j] = true);
        }
    }

    fn from_samples(
        angle: &[f64],
        value: &[f64],
        rho: &[f64],
        corner: &[bool],
        (least, lowest): (f64, usize),
    ) -> Self {
        let (n, step) = (angle.len(), steps(angle));
        let direction = |i: usize| Vector::<2>::new(angle[i].cos(), angle[i].sin());
        let pieces: Arc<[Piece]> = (0..n)
            .map(|i| {
                let j = (i + 1) % n;
                let (start, slope) = (direction(i), (rho[j] - rho[i]) / step[i]);
                let end = Place::at(step[i]);
                let bend = Bend::of(&end).of_curve(rho[i], slope);
                let derivative = side(value[j], value[i], step[i]) - bend / end.across;
                let gradient = start * value[i] + quarter_turn(&start) * derivative;
                Piece { start, step: step[i], rho: rho[i], slope, gradient }
            })
            .collect();
        // Samples rise from angle 0 on, and so do their diamond angles.
        let count = 4 * n.next_power_of_two();
        let bins = (0..count)
            .map(|k| {
                let turn = 4.0 * k as f64 / count as f64;
                let started = pieces.partition_point(|p| diamond(&p.start) <= turn);
                if started == 0 { n as u32 - 1 } else { started as u32 - 1 }
            })
            .collect();
        let lowest = (least, direction(lowest));
        let corners = (0..n).filter(|&i| corner[i]).map(direction).collect();
        let (first, turns) = turns(&pieces);
        Self { pieces, bins, turns, first, lowest, corners }
    }

    /// Directions in which the gradient jumps.
    pub(crate) fn corners(&self) -> &[Vector<2>] {
        &self.corners
    }

    /// The gradients on pieces where `F` is linear, one for each run of such pieces.
    pub(crate) fn linear_parts(&self) -> Vec<Vector<2>> {
        let mut found: Vec<Vector<2>> = Vec::new();
        for piece in self.pieces.iter().filter(|p| p.rho == 0.0 && p.slope == 0.0) {
            let new = |x: &Vector<2>| (x - piece.gradient).norm() > 1e-9 * piece.gradient.norm();
            if found.iter().all(new) {
                found.push(piece.gradient);
            }
        }
        found
    }

    /// The smallest `f + f″` and its direction: the curve is convex if it is not negative.
    pub(crate) fn lowest(&self) -> (f64, Vector<2>) {
        self.lowest
    }

    /// The piece that holds the direction of `x`.
    #[inline]
    fn piece(&self, x: &Vector<2>) -> &Piece {
        let n = self.pieces.len();
        let bin = (diamond(x) * (0.25 * self.bins.len() as f64)) as usize;
        let mut at = self.bins[bin.min(self.bins.len() - 1)] as usize;
        // Bins are finer than the mean piece: seldom more than one step.
        for _ in 0..n {
            let next = if at + 1 == n { 0 } else { at + 1 };
            let start = &self.pieces[next].start;
            if cross(start, x) < 0.0 {
                break;
            }
            at = next;
        }
        &self.pieces[at]
    }

    /// The point `x` with `F(x) = 1` at which the gradient of the convex function `F` is along `y ≠ 0`; the middle of
    /// them where there are many.
    pub(crate) fn at_gradient(&self, y: &Vector<2>) -> Vector<2> {
        let n = self.pieces.len();
        let on_curve = |direction: Vector<2>| direction / self.value(&direction);
        let knot = |k: usize| self.pieces[(self.first + k) % n].start;
        let turn = turn(&self.pieces[self.first].gradient, y);
        let turn = if turn > 4.0 - SAME_TURN { 0.0 } else { turn };
        // The pieces that start with this gradient, and the last one that does not start later; the first one has turn 0.
        let first = self.turns.partition_point(|t| *t < turn - SAME_TURN);
        let last = self.turns.partition_point(|t| *t <= turn + SAME_TURN).max(1) - 1;
        let piece = &self.pieces[(self.first + last) % n];
        let ahead = cross(&piece.jet(&piece.direction(piece.step)).gradient, y);
        let rounding = SAME_TURN * piece.gradient.norm() * y.norm();
        // The last piece itself has this gradient, or a corner begins where it starts.
        let end = if ahead >= -rounding { last + 1 } else { last };
        if first < end && (first < last || ahead <= rounding) {
            return (on_curve(knot(first)) + on_curve(knot(end))) * 0.5;
        }
        if ahead > 0.0 { on_curve(knot(last + 1)) } else { on_curve(piece.direction_of(y)) }
    }

    /// `F(x)`.
    #[inline]
    pub(crate) fn value(&self, x: &Vector<2>) -> f64 {
        let piece = self.piece(x);
        let bend = Bend::of(&piece.place(x));
        piece.gradient.dot(x) + bend.of_curve(piece.rho, piece.slope)
    }

    /// `F`, its gradient and `f + f″`, for `x ≠ 0`.
    #[inline]
    pub(crate) fn jet(&self, x: &Vector<2>) -> CurveJet {
        let (piece, norm) = (self.piece(x), x.norm());
        let jet = piece.jet(&(x / norm));
        CurveJet { value: norm * jet.value, ..jet }
    }
}

/// A vector by its angle φ from the first knot of a piece.
struct Place {
    angle: f64,
    /// `|x| sin φ` and `|x| cos φ`.
    across: f64,
    along: f64,
    /// `|x|`.
    norm: f64,
}

impl Place {
    /// A unit vector at an angle.
    fn at(angle: f64) -> Self {
        let (across, along) = angle.sin_cos();
        Self { angle, across, along, norm: 1.0 }
    }
}

/// How far a curve departs from its tangent within the angle φ, times `|x|`, see the module page.
struct Bend {
    /// `1 − cos φ`, with `ρ = 1`.
    constant: f64,
    /// `φ − sin φ`, with `ρ = φ`.
    rising: f64,
}

impl Bend {
    /// Without cancellation at small angles.
    #[inline]
    fn of(&Place { angle, across, along, norm }: &Place) -> Self {
        /// Each term of the series of `φ − sin φ` is the one before times −φ² over one of these. Of angles up to one, what
        /// is left out is less than rounding.
        const QUOTIENTS: [f64; 8] = [20.0, 42.0, 72.0, 110.0, 156.0, 210.0, 272.0, 342.0];
        let square = angle * angle;
        let rising = if square > 1.0 {
            norm * angle - across
        } else {
            let series = QUOTIENTS.iter().rev().fold(1.0, |sum, q| 1.0 - sum * square * (1.0 / q));
            norm * angle * square * (1.0 / 6.0) * series
        };
        let constant = if along > 0.0 { across * across / (norm + along) } else { norm - along };
        Self { constant, rising }
    }

    /// With `ρ` at the start and its slope.
    #[inline]
    fn of_curve(&self, rho: f64, slope: f64) -> f64 {
        rho * self.constant + slope * self.rising
    }
}

/// A monotone measure of the polar angle in `[0, 4)` without trigonometry.
#[inline]
pub(crate) fn diamond(x: &Vector<2>) -> f64 {
    let along = x.x / (x.x.abs() + x.y.abs());
    if x.y >= 0.0 { 1.0 - along } else { 3.0 + along }
}

impl Piece {
    #[inline]
    fn place(&self, x: &Vector<2>) -> Place {
        let (across, along) = (cross(&self.start, x), self.start.dot(x));
        Place { angle: across.atan2(along), across, along, norm: x.norm() }
    }

    /// The direction at an angle from the first knot.
    fn direction(&self, angle: f64) -> Vector<2> {
        let (sine, cosine) = angle.sin_cos();
        self.start * cosine + quarter_turn(&self.start) * sine
    }

    /// `f`, `∇F = f e + f′ e⊥` and `f + f″` in a direction.
    #[inline]
    fn jet(&self, unit: &Vector<2>) -> CurveJet {
        let (place, across) = (self.place(unit), quarter_turn(unit));
        let bend = Bend::of(&place);
        let value = self.gradient.dot(unit) + bend.of_curve(self.rho, self.slope);
        let bent = self.rho * place.across + self.slope * bend.constant;
        let derivative = self.gradient.dot(&across) + bent;
        let gradient = unit * value + across * derivative;
        CurveJet { value, gradient, rho: self.rho + self.slope * place.angle }
    }

    /// The direction within the piece in which `∇F` is along `y`, `f(θ) = ∇F × y = 0`, by Newton's method with
    /// `f′ = −ρ e·y` in the bracket that the piece is.
    fn direction_of(&self, y: &Vector<2>) -> Vector<2> {
        const ITERATIONS: usize = 60;
        let (mut low, mut high) = (0.0, self.step);
        let at = |angle: f64| cross(&self.jet(&self.direction(angle)).gradient, y);
        let (before, after) = (at(low), at(high));
        let mut angle = self.step * before / (before - after);
        for _ in 0..ITERATIONS {
            // The comparison also turns away NaN.
            if !(angle > low && angle < high) {
                angle = 0.5 * (low + high);
            }
            let unit = self.direction(angle);
            let jet = self.jet(&unit);
            let value = cross(&jet.gradient, y);
            if value > 0.0 {
                low = angle;
            } else {
                high = angle;
            }
            let step = value / (jet.rho * unit.dot(y));
            if value == 0.0 || step.abs() <= f64::EPSILON * self.step || high - low <= f64::EPSILON
            {
                break;
            }
            angle += step;
        }
        self.direction(angle)
    }
}

/// How far `y` is turned from `from`, counter-clockwise, as [`diamond`] measures it.
fn turn(from: &Vector<2>, y: &Vector<2>) -> f64 {
    diamond(&Vector::<2>::new(from.dot(y), cross(from, y)))
}

/// The piece before which `∇F` turns most, which is not within a flat, and the turns from there on; they never fall.
fn turns(pieces: &[Piece]) -> (usize, Arc<[f64]>) {
    /// More than a piece can turn: rounding has put what has not turned behind where it was.
    const TOO_MUCH: f64 = 2.5;
    let n = pieces.len();
    let gradient = |k: usize| pieces[k % n].gradient;
    let before = |k: usize| match turn(&gradient(k + n - 1), &gradient(k)) {
        turn if turn < TOO_MUCH => turn,
        _ => 0.0,
    };
    let first = (0..n).max_by(|&a, &b| before(a).total_cmp(&before(b))).unwrap_or(0);
    let start = gradient(first);
    let turns = (0..n).scan(0.0, |largest: &mut f64, k| {
        let turn = turn(&start, &gradient(first + k));
        if turn > *largest && turn < *largest + TOO_MUCH {
            *largest = turn;
        }
        Some(*largest)
    });
    (first, turns.collect())
}

/// Samples by rising angle in `[0, 2π)`, checked.
fn sorted(
    angle: &[f64],
    value: &[f64],
    argument: &'static str,
) -> Result<(Vec<f64>, Vec<f64>), SetError> {
    let shape = |argument, message: String| Err(SetError::Shape { argument, message });
    if angle.len() != value.len() {
        return shape(argument, format!("must have one entry per angle ({})", angle.len()));
    }
    if angle.len() < FEWEST {
        return shape("angle", format!("must hold at least {FEWEST} angles, has {}", angle.len()));
    }
    if let Some(bad) = angle.iter().find(|a| !a.is_finite()) {
        return shape("angle", format!("must be finite, holds {bad}"));
    }
    if let Some(bad) = value.iter().find(|v| !(v.is_finite() && **v > 0.0)) {
        return shape(argument, format!("must be finite and positive, holds {bad}"));
    }
    let mut pairs: Vec<(f64, f64)> =
        angle.iter().map(|a| a.rem_euclid(TAU)).zip(value.iter().copied()).collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let n = pairs.len();
    for i in 0..n {
        let (at, next) = (pairs[i].0, pairs[(i + 1) % n].0);
        let step = (next - at).rem_euclid(TAU);
        if !(SMALLEST_STEP..=TAU - SMALLEST_STEP).contains(&step) {
            return shape("angle", format!("must not hold the same direction twice ({at} rad)"));
        }
        if step > LARGEST_STEP {
            let message =
                format!("must leave no gap above {LARGEST_STEP} rad, has one after {at} rad");
            return shape("angle", message);
        }
    }
    Ok(pairs.into_iter().unzip())
}

/// Steps to the next knot.
fn steps(angle: &[f64]) -> Vec<f64> {
    let n = angle.len();
    (0..n).map(|i| (angle[(i + 1) % n] - angle[i]).rem_euclid(TAU)).collect()
}

/// `(f_j − f_i cos h)/sin h` without cancellation at small `h`.
fn side(f_j: f64, f_i: f64, h: f64) -> f64 {
    ((f_j - f_i) + 2.0 * f_i * (0.5 * h).sin().powi(2)) / h.sin()
}

/// The jump of the slope at every sample if `ρ` vanished between them, and its rounding error. The samples
/// are those of a convex `F` if and only if no jump is negative.
fn jumps(angle: &[f64], value: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let (n, step) = (angle.len(), steps(angle));
    let largest = value.iter().copied().fold(0.0, f64::max);
    let at = |i: usize| {
        let (before, after) = ((i + n - 1) % n, (i + 1) % n);
        let jump =
            side(value[before], value[i], step[before]) + side(value[after], value[i], step[i]);
        (jump, 16.0 * f64::EPSILON * largest * (1.0 / step[before] + 1.0 / step[i]))
    };
    (0..n).map(at).unzip()
}

/// Samples after which the curve swings far beyond its neighbours: below half the smaller value, or half
/// as much again above the larger one and the straight line between them.
fn overshoots(angle: &[f64], value: &[f64], rho: &[f64], corner: &[bool]) -> Vec<usize> {
    let (n, step) = (angle.len(), steps(angle));
    let own = |i: usize| if corner[i] { 0.0 } else { rho[i] };
    let swings = |i: usize| {
        let (j, h) = ((i + 1) % n, step[i]);
        let between = |at: f64, first: f64, last: f64| {
            (first * ((1.0 - at) * h).sin() + last * (at * h).sin()) / h.sin()
        };
        [0.2, 0.4, 0.6, 0.8].iter().any(|&at| {
            let particular = own(i) * (1.0 - at) + own(j) * at;
            let curve = particular + between(at, value[i] - own(i), value[j] - own(j));
            let highest = value[i].max(value[j]).max(between(at, value[i], value[j]));
            curve < 0.5 * value[i].min(value[j]) || curve > 1.5 * highest
        })
    };
    (0..n).filter(|&i| swings(i)).collect()
}

/// `ρ` at the samples, or the jump of the slope where there is a corner.
///
/// With the hat functions `ρ` is made of, the slope is continuous at sample `i` if
/// `Σ_j ρ_j (1/sin h_ij − 1/h_ij) + ρ_i Σ_j (1/h_ij − cot h_ij)` is the jump without `ρ`, with the sums over both
/// neighbours.
fn solve(angle: &[f64], jump: &[f64], corner: &[bool]) -> Vec<f64> {
    let (n, step) = (angle.len(), steps(angle));
    let mut system = Cyclic::zeros(n);
    for i in 0..n {
        system.right[i] = jump[i];
        let (before, after) = ((i + n - 1) % n, (i + 1) % n);
        for (j, h) in [(before, step[before]), (after, step[i])] {
            system.add(i, i, if corner[i] { 0.5 } else { cotangent_defect(h) });
            if !corner[j] {
                system.add(i, j, sine_defect(h));
            }
        }
    }
    system.solve()
}

/// `1/sin h − 1/h`.
fn sine_defect(h: f64) -> f64 {
    if h < 1e-2 { h / 6.0 + 7.0 * h.powi(3) / 360.0 } else { 1.0 / h.sin() - 1.0 / h }
}

/// `1/h − cot h`.
fn cotangent_defect(h: f64) -> f64 {
    if h < 1e-2 { h / 3.0 + h.powi(3) / 45.0 } else { 1.0 / h - h.tan().recip() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Data with flats and corners stay convex, at every knot and between.
    #[test]
    fn convexity_of_the_data_is_kept() {
        for n in [7, 12, 40, 360] {
            for start in [0.0, 0.013, 3.0] {
                let angle: Vec<f64> = (0..n)
                    .map(|i| {
                        start + TAU * (f64::from(i) + 0.3 * f64::sin(f64::from(i))) / f64::from(n)
                    })
                    .collect();
                let square = |t: &f64| t.cos().abs() + t.sin().abs();
                let value: Vec<f64> = angle.iter().map(square).collect();
                let curve = PeriodicCurve::new(&angle, &value, "value").unwrap();
                assert!(curve.lowest().0 >= 0.0);
                for (angle, value) in angle.iter().zip(&value) {
                    let x = Vector::<2>::new(angle.cos(), angle.sin());
                    assert!((curve.value(&x) - value).abs() < 1e-12, "{n} {start} {angle}");
                }
                for k in 0..5000 {
                    let t = f64::from(k) / 5000.0 * TAU;
                    let at = |t: f64| curve.jet(&Vector::<2>::new(t.cos(), t.sin()));
                    let (here, there) = (at(t), at(t + 1e-3));
                    assert!(here.rho >= 0.0);
                    // Gradients of a convex function turn with the direction.
                    assert!(cross(&here.gradient, &there.gradient) >= -1e-12, "{n} {start} {t}");
                }
            }
        }
    }

    fn curve(count: usize, start: f64, value: impl Fn(f64) -> f64) -> PeriodicCurve {
        let angle: Vec<f64> = (0..count).map(|k| start + TAU * k as f64 / count as f64).collect();
        let value: Vec<f64> = angle.iter().map(|&t| value(t)).collect();
        PeriodicCurve::new(&angle, &value, "value").unwrap()
    }

    /// The point of `F ≤ 1` that is farthest along `y` is on the curve, and no other is farther, but for rounding: `ρ` is up to
    /// a hundred times `F`.
    #[test]
    fn points_with_a_gradient_are_the_farthest() {
        let circle = |_: f64| 2.0;
        let ellipse = |t: f64| (0.5 * t.cos()).hypot(3.0 * t.sin());
        let square = |t: f64| t.cos().abs() + t.sin().abs();
        let shifted = |t: f64| 1.0 - 0.6 * t.cos();
        let lens = |t: f64| (0.4 * t.cos()).hypot(2.0 * t.sin()) + 0.3 * t.sin().abs();
        let shapes: [&dyn Fn(f64) -> f64; 5] = [&circle, &ellipse, &square, &shifted, &lens];
        for (shape, value) in shapes.iter().enumerate() {
            for (count, start) in [(8, 0.0), (36, 0.0), (37, 0.1), (720, 3.0)] {
                let curve = curve(count, start, value);
                let point = |t: f64| {
                    let d = Vector::<2>::new(t.cos(), t.sin());
                    d / curve.value(&d)
                };
                let boundary: Vec<_> =
                    (0..2000).map(|k| point(f64::from(k) / 2000.0 * TAU)).collect();
                for k in 0..400 {
                    let t = f64::from(k) / 400.0 * TAU;
                    let y = Vector::<2>::new(t.cos(), t.sin()) * 7.0;
                    let x = curve.at_gradient(&y);
                    let case = format!("{shape} {count} {start} {t} {x:?}");
                    assert!(curve.value(&x) <= 1.0 + 1e-13, "{case}");
                    let farthest = boundary.iter().map(|b| b.dot(&y)).fold(0.0, f64::max);
                    assert!(x.dot(&y) >= farthest * (1.0 - 1e-13), "{case}");
                }
            }
        }
    }

    /// A whole side is farthest: its middle is the answer, as the symmetry of the set has it.
    #[test]
    fn of_a_side_the_middle_is_taken() {
        for count in [8, 48, 720, 7200] {
            let square = curve(count, 0.0, |t| t.cos().abs() + t.sin().abs());
            for (x, y) in [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)] {
                let side = Vector::<2>::new(x, y);
                let found = square.at_gradient(&side);
                assert!((found - side * 0.5).norm() < 1e-13, "{count} {side:?} {found:?}");
            }
        }
    }

    /// A curve counts as convex only where it is: the gradient turns back nowhere, at corners neither.
    #[test]
    fn corners_that_turn_back_are_no_corners_of_convex_sets() {
        let mut seed = 1_u64;
        let mut unit = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64
        };
        let (mut convex, mut dented) = (0, 0);
        for k in 0..4000 {
            let n = 4 + k % 7;
            let swing = [0.05, 0.3, 1.0][k % 3];
            let angle: Vec<f64> = (0..n).map(|_| TAU * unit()).collect();
            let value: Vec<f64> = (0..n).map(|_| 1.0 + swing * unit()).collect();
            let Ok(curve) = PeriodicCurve::new(&angle, &value, "value") else { continue };
            let jets: Vec<(Vector<2>, CurveJet)> = (0..3000)
                .map(|i| f64::from(i) * TAU / 3000.0)
                .chain(angle.iter().flat_map(|a| [a - 1e-9, a + 1e-9]))
                .map(|a| Vector::<2>::new(a.cos(), a.sin()))
                .map(|x| (x, curve.jet(&x)))
                .collect();
            // Convex functions lie above all their tangents.
            let below = |(x, jet): &(Vector<2>, CurveJet)| {
                jets.iter().any(|(_, other)| other.gradient.dot(x) > jet.value + 1e-6)
            };
            let turns_back = jets.iter().step_by(7).any(below);
            if curve.lowest().0 >= 0.0 {
                assert!(!turns_back, "{angle:?} {value:?}");
                convex += 1;
            } else {
                dented += 1;
            }
        }
        assert!(convex > 100 && dented > 100, "{convex} {dented}");
    }
}

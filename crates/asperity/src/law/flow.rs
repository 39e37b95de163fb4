//! Both sets of a law from its force over the sliding direction.
//!
//! A law `−λ/λ_N = f(φ) = l_t e(φ) + l_p e⊥(φ)` fixes its sets. *C* is the curve `f`. *D* has the normal angle
//! φ at the polar angle `θ = φ + ψ`, `tan ψ = l_p/l_t`, so that its support function and radius are
//!
//! `ln h = ∫ tan ψ dφ`, `ln r = ∫ tan ψ dθ` (\[WL19\] (71), (125)), `h = r cos ψ`.
//!
//! Half the sum of both is an integral over the walk parameter `τ = θ + φ`, in which flats (φ constant) and
//! corners (θ constant) of *D* are arcs like others: `ln h = ½∫ tan ψ dτ + ½ ln cos ψ`. *D* is convex if θ never
//! falls, and exists at all if the integral over a turn vanishes (closure).

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use asperity_set::{SetError, Vector};

/// Fewest points of the support function that is handed out.
const POINTS: usize = 1440;
/// Directions closer than this count as one.
const SAME: f64 = 1e-7;
/// The force jumps if it turns by more than this between neighbouring directions, in rad.
const JUMP: f64 = 0.3;
/// Abscissae and weights of Gauss–Legendre quadrature on [0, 1].
const GAUSS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_3, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

/// How well measured or assumed forces fit a pair of sets.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct FlowReport {
    /// `r_D(2π)/r_D(0)`, one for a law that has a direction set.
    pub closure: f64,
    /// Largest angle in rad by which θ turns back, zero for a convex *D*.
    pub convexity_defect: f64,
    /// Smallest force against the sliding direction, `min l_t`.
    pub smallest_resistance: f64,
    /// Largest relative change of `h` that made *D* closed and convex.
    pub repair: f64,
}

/// The sets of a flow rule, as samples: the reservoir `(θ, r_C)`, the direction set `(φ, h_D)`.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct FlowSets {
    /// Polar angles of *C*, rising.
    pub theta: Vec<f64>,
    /// Radii of *C*.
    pub radius: Vec<f64>,
    /// Normal angles of *D*, rising.
    pub phi: Vec<f64>,
    /// Support function of *D*, `max h = 1`.
    pub support: Vec<f64>,
    /// What had to be repaired.
    pub report: FlowReport,
}

fn refuse<T>(argument: &'static str, message: String) -> Result<T, SetError> {
    Err(SetError::Shape { argument, message })
}

/// *C* and *D* of forces `−λ/λ_N` at rising sliding directions `phi` in rad, within one turn.
///
/// Refused if some force does not oppose sliding, if `|ln closure|` exceeds `closure_tolerance` or if θ turns
/// back by more than `convexity_tolerance` in rad; smaller defects are repaired and reported.
///
/// # Errors
///
/// [`SetError::Shape`] as said, and if there is not one finite force per direction, or the directions do not rise within
/// a turn without gaps above π/2.
pub fn flow_sets(
    phi: &[f64],
    force: &[Vector<2>],
    closure_tolerance: f64,
    convexity_tolerance: f64,
) -> Result<FlowSets, SetError> {
    check(phi, force)?;
    let n = phi.len();
    let mut psi = Vec::with_capacity(n);
    let mut smallest_resistance = f64::INFINITY;
    for (angle, f) in phi.iter().zip(force) {
        let (sine, cosine) = angle.sin_cos();
        let (along, across) = (cosine * f.x + sine * f.y, cosine * f.y - sine * f.x);
        if !(along > 0.0) {
            let message =
                format!("must oppose sliding, is {along} against the direction {angle} rad");
            return refuse("force", message);
        }
        smallest_resistance = smallest_resistance.min(along);
        psi.push(across.atan2(along));
    }
    let raw: Vec<f64> = phi.iter().zip(&psi).map(|(a, b)| a + b).collect();
    let (theta, convexity_defect, at) = rising(&raw);
    if convexity_defect > convexity_tolerance {
        let message = format!(
            "must have a convex direction set, the force turns back by {convexity_defect} rad at the \
             sliding direction {} rad",
            phi[at]
        );
        return refuse("force", message);
    }
    let walk = Walk::new(phi, &theta);
    let (points, turn) = walk.support(POINTS.div_ceil(n).clamp(1, 40));
    let closure = turn.exp();
    if !(turn.abs() <= closure_tolerance) {
        let message = format!(
            "must close: no direction set goes with it, r_D(2π)/r_D(0) = {closure:.6} instead of 1"
        );
        return refuse("force", message);
    }
    let repair = turn.abs().exp_m1() + convexity_defect.tan();
    let (theta, radius) = reservoir(phi, force);
    let highest = points.iter().map(|p| p.1).fold(0.0, f64::max);
    let (phi, support) = points.into_iter().map(|(a, h)| (a, h / highest)).unzip();
    let report = FlowReport { closure, convexity_defect, smallest_resistance, repair };
    Ok(FlowSets { theta, radius, phi, support, report })
}

fn check(phi: &[f64], force: &[Vector<2>]) -> Result<(), SetError> {
    if phi.len() != force.len() {
        return refuse("force", format!("must have one row per direction ({})", phi.len()));
    }
    if phi.len() < 8 {
        return refuse("phi", format!("must hold at least 8 directions, has {}", phi.len()));
    }
    if let Some(bad) = phi.iter().chain(force.iter().flatten()).find(|v| !v.is_finite()) {
        return refuse("phi", format!("must be finite like the force, holds {bad}"));
    }
    for i in 0..phi.len() {
        let next = if i + 1 == phi.len() { phi[0] + TAU } else { phi[i + 1] };
        if !(next - phi[i] > SAME) {
            let message = format!("must rise within one turn, does not after {} rad", phi[i]);
            return refuse("phi", message);
        }
        if next - phi[i] > FRAC_PI_2 {
            let message = format!("must leave no gap above π/2, has one after {} rad", phi[i]);
            return refuse("phi", message);
        }
    }
    Ok(())
}

/// The nearest sequence (least squares, pool adjacent violators) that never falls, around the turn; the largest fall of the
/// given one and its place.
fn rising(theta: &[f64]) -> (Vec<f64>, f64, usize) {
    let n = theta.len();
    let around = |k: usize| theta[k % n] + TAU * (k / n) as f64;
    let (mut defect, mut at, mut highest) = (0.0, 0, f64::NEG_INFINITY);
    for k in 0..2 * n {
        if highest - around(k) > defect {
            (defect, at) = (highest - around(k), k % n);
        }
        highest = highest.max(around(k));
    }
    if defect == 0.0 {
        return (theta.to_vec(), 0.0, 0);
    }
    // Three turns, of which the middle one does not feel the ends.
    let mut pools: Vec<(f64, usize)> = Vec::new();
    for k in 0..3 * n {
        pools.push((around(k), 1));
        while let [.., (a, i), (b, j)] = pools[..]
            && a > b
        {
            pools.truncate(pools.len() - 2);
            pools.push(((a * i as f64 + b * j as f64) / (i + j) as f64, i + j));
        }
    }
    let flat: Vec<f64> =
        pools.iter().flat_map(|&(value, count)| std::iter::repeat_n(value, count)).collect();
    (flat[n..2 * n].iter().map(|t| t - TAU).collect(), defect, at)
}

/// *C*'s points by rising polar angle, points on one ray joined.
///
/// Where *D* is flat the force jumps from one sliding direction to the next; the forces between both occur for
/// the direction between: that part of *C* is taken as straight.
fn reservoir(phi: &[f64], force: &[Vector<2>]) -> (Vec<f64>, Vec<f64>) {
    let n = force.len();
    let mut points: Vec<(f64, f64)> = Vec::with_capacity(n);
    for (i, f) in force.iter().enumerate() {
        let (next, step) = (force[(i + 1) % n], (phi[(i + 1) % n] - phi[i]).rem_euclid(TAU));
        let turn = f.perp(&next).atan2(f.dot(&next));
        let parts = if turn > f64::max(JUMP, 10.0 * step) { 8 } else { 1 };
        points.extend((0..parts).map(|k| {
            let x = f + (next - f) * (f64::from(k) / f64::from(parts));
            (x.y.atan2(x.x).rem_euclid(TAU), x.norm())
        }));
    }
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points.dedup_by(|b, a| b.0 - a.0 < SAME);
    if points.len() > 1 && points[0].0 + TAU - points[points.len() - 1].0 < SAME {
        points.pop();
    }
    points.into_iter().unzip()
}

/// `θ(τ)` as a piecewise cubic that never falls, like `φ(τ) = τ − θ(τ)`.
struct Walk {
    /// `τ` and `θ` at the samples, the first one repeated a turn later.
    tau: Vec<f64>,
    theta: Vec<f64>,
    /// `dθ/dτ` behind and ahead of every sample.
    slope: Vec<(f64, f64)>,
}

/// Slope at sample `i` of the polynomial through it and two neighbours on either side, around the turn.
fn quartic_slope(tau: &[f64], theta: &[f64], i: usize) -> f64 {
    let n = tau.len() - 1;
    let at = |k: usize| {
        let (turns, place) = ((k / n) as f64 - 1.0, k % n);
        (tau[place] + 2.0 * TAU * turns, theta[place] + TAU * turns)
    };
    let (x, y) = at(i + n);
    let near = [i + n - 2, i + n - 1, i + n + 1, i + n + 2].map(at);
    // Lagrange's polynomials at their own node: y′ = Σ (y_j − y) w_j/w / (x_j − x).
    near.iter()
        .map(|(xj, yj)| {
            let others = near.iter().filter(|(xk, _)| xk != xj);
            let weight: f64 = others.map(|(xk, _)| (x - xk) / (xj - xk)).product();
            (yj - y) / (xj - x) * weight
        })
        .sum()
}

impl Walk {
    fn new(phi: &[f64], theta: &[f64]) -> Self {
        let n = phi.len();
        let mut tau: Vec<f64> = phi.iter().zip(theta).map(|(a, b)| a + b).collect();
        let mut theta = theta.to_vec();
        tau.push(tau[0] + 2.0 * TAU);
        theta.push(theta[0] + TAU);
        let chord = |i: usize| (theta[i + 1] - theta[i]) / (tau[i + 1] - tau[i]);
        let slope = (0..=n)
            .map(|i| {
                let (left, right) = (chord((i + n - 1) % n), chord(i % n));
                // Kept within the slopes that let neither θ nor φ fall.
                let highest = (3.0 * left.min(right)).min(1.0);
                let lowest = (1.0 - 3.0 * (1.0 - left).min(1.0 - right)).max(0.0);
                if lowest > highest {
                    return (left, right);
                }
                let slope = quartic_slope(&tau, &theta, i).clamp(lowest, highest);
                (slope, slope)
            })
            .collect();
        Self { tau, theta, slope }
    }

    /// `ψ = 2θ − τ` at the fraction `s` of interval `i`, from the cubic for θ.
    fn psi(&self, i: usize, s: f64) -> f64 {
        let width = self.tau[i + 1] - self.tau[i];
        let rise = self.theta[i + 1] - self.theta[i];
        let (first, last) = (self.slope[i].1 * width, self.slope[i + 1].0 * width);
        let cubic = first + last - 2.0 * rise;
        let square = 3.0 * rise - 2.0 * first - last;
        let theta = self.theta[i] + s * (first + s * (square + s * cubic));
        2.0 * theta - (self.tau[i] + s * width)
    }

    /// `(φ, h)` at `parts` points per interval, and `ln closure`, which is spread evenly over the turn.
    fn support(&self, parts: usize) -> (Vec<(f64, f64)>, f64) {
        let mut points: Vec<(f64, f64, f64)> = Vec::new();
        let mut integral = 0.0;
        for i in 0..self.tau.len() - 1 {
            let width = self.tau[i + 1] - self.tau[i];
            for k in 0..parts {
                let (start, share) = (k as f64 / parts as f64, 1.0 / parts as f64);
                let (tau, psi) = (self.tau[i] + start * width, self.psi(i, start));
                points.push((tau, 0.5 * (tau - psi), integral + 0.5 * psi.cos().ln()));
                let mean: f64 = GAUSS
                    .iter()
                    .map(|(at, weight)| weight * self.psi(i, start + at * share).tan())
                    .sum();
                integral += 0.5 * mean * share * width;
            }
        }
        // Spread from anywhere: the scale of *D* is free.
        let mut spread: Vec<(f64, Vector<2>)> = points
            .into_iter()
            .map(|(tau, phi, log)| {
                let height = (log - integral * tau / (4.0 * PI)).exp();
                (phi, Vector::<2>::new(height, height * (tau - 2.0 * phi).tan()))
            })
            .collect();
        // Flats of D have one place after another with the same normal: one is enough.
        spread.dedup_by(|b, a| b.0 - a.0 < SAME);
        if let [first, .., last] = spread[..]
            && first.0 + TAU - last.0 < SAME
        {
            spread.pop();
        }
        let normals: Vec<Vector<2>> =
            spread.iter().map(|(phi, _)| Vector::<2>::new(phi.cos(), phi.sin())).collect();
        let places: Vec<Vector<2>> = spread
            .iter()
            .zip(&normals)
            .map(|((_, local), e)| e * local.x + Vector::<2>::new(-e.y, e.x) * local.y)
            .collect();
        let heights = hull_heights(&normals, &places);
        (spread.iter().map(|p| p.0).zip(heights).collect(), integral)
    }
}

/// Support function of the convex hull of places in turn around the origin, along rising normals.
fn hull_heights(normals: &[Vector<2>], places: &[Vector<2>]) -> Vec<f64> {
    let n = places.len();
    let farthest = (0..n).max_by(|&i, &j| places[i].norm().total_cmp(&places[j].norm()));
    let start = farthest.unwrap_or(0);
    let mut hull: Vec<Vector<2>> = Vec::with_capacity(n + 1);
    // Corners of D repeat a place up to rounding, which would leave loops.
    let same = 1e-11 * places[start].norm();
    for next in (0..=n).map(|k| places[(start + k) % n]) {
        if hull.last().is_some_and(|last| (next - last).norm() < same) {
            continue;
        }
        while let [.., a, b] = hull[..]
            && (b - a).perp(&(next - b)) <= 0.0
        {
            hull.pop();
        }
        hull.push(next);
    }
    let closed = hull.len() > 1 && (hull[hull.len() - 1] - hull[0]).norm() < same;
    let m = hull.len() - usize::from(closed);
    let height = |normal: &Vector<2>, k: usize| normal.dot(&hull[k % m]);
    let first = &normals[0];
    let mut at = (0..m).max_by(|&i, &j| height(first, i).total_cmp(&height(first, j))).unwrap_or(0);
    let highest = |normal: &Vector<2>| {
        // Both rise around the turn, so that one walk serves all normals.
        while height(normal, at + 1) > height(normal, at) {
            at += 1;
        }
        height(normal, at)
    };
    normals.iter().map(highest).collect()
}

#[cfg(test)]
mod tests;

//! Stick with a block of any rank.

use asperity_set::{StarSet, Vector};
use nalgebra::{Matrix3, Vector3};

use super::super::block::SOUND;
use super::super::singular::Factors;
use super::{ContactMatrix, Graded, ITERATIONS, ROUNDING, SOLUTION, Single, V, VANISHING, inverse};
use crate::contact::NormalForce;

/// Largest relative defect of stick in a continuum, whose loads are what rounding leaves of larger velocities: with a tenth
/// hinges at rest carry forces that cancel (`tests/test_hinges.py`).
const CONTINUUM: f64 = 1e-10;
/// Singular values below this part of the largest may be left out, and velocities below this part of the loads count as
/// none; the defect decides in the end.
const SMALL: f64 = 1e-6;

impl<const P: usize> Single<'_, P> {
    /// The percussions of a stick solution, `GP + b = 0` with `−P_T ∈ P_N C`, whatever the rank of the block.
    ///
    /// Of a block without full rank the solutions are `P₀ + ker G`, and the admissible ones among them are a
    /// convex set if *C* is. With a block whose small singular values may or may not be rounding every rank
    /// is tried: the percussions with the least rank that solve the system up to rounding are taken, else
    /// those with the least defect. Of a continuum it is the point nearest to the shortest solution: at its far ends
    /// defects, which are relative to the percussions, are the smaller, but not the velocities.
    pub(crate) fn stick(&self) -> Option<Graded> {
        let found = match inverse(&self.g, 1.0 / SOUND) {
            Some(inverse) => {
                let p = -(inverse * self.b);
                let refined = p - inverse * self.velocity(&p);
                self.holds(&refined).then(|| self.graded(refined, false))
            }
            None => self.stick_of_any_rank(),
        };
        found.filter(|found| found.defect <= if found.degenerate { CONTINUUM } else { SOLUTION })
    }

    fn stick_of_any_rank(&self) -> Option<Graded> {
        let n = self.len();
        let scales = self.scales();
        let scaled = ContactMatrix::from_fn(|i, j| match i.max(j) < n {
            true => self.g[(i, j)] * scales[i] * scales[j],
            false => 0.0,
        });
        let load = -self.b.component_mul(&scales);
        if !(scaled.norm() < f64::MAX && load.norm() < f64::MAX) {
            return None;
        }
        let factors = Factors::new(&scaled, n);
        let relative = factors.values / factors.values[0];
        let back = |p: &V| p.component_mul(&scales);
        let known = (1..n).find(|&k| relative[k] <= VANISHING).unwrap_or(n);
        // Percussions that are huge against the loads stop the contact in name only.
        let stops = |p: V, degenerate: bool| {
            let left = self.velocity(&p).component_mul(&scales).norm();
            let stops = self.holds(&p) && left <= SMALL * load.norm();
            Some(self.graded(p, degenerate)).filter(|found| stops && found.defect < f64::INFINITY)
        };
        // What smaller singular values make of the load is rounding over rounding.
        let whole = back(&factors.solve(&scaled, &load, known));
        let mut best = if known == n { stops(whole, false) } else { None };
        let ranks = (1..n).rev().filter(|&k| k == known || k < known && relative[k] <= SMALL);
        for rank in ranks {
            let shortest = factors.solve(&scaled, &load, rank);
            let size = shortest.norm().max(f64::MIN_POSITIVE);
            let kernel: [V; 3] = std::array::from_fn(|k| match rank + k < n {
                true => back(&(factors.right.column(rank + k) * size)),
                false => V::zeros(),
            });
            let shortest = back(&shortest);
            let inside = match n - rank {
                _ if self.holds(&shortest) => Some(shortest),
                1 => self.within_line(&shortest, &kernel[0]),
                _ => self.within_space(&shortest, &kernel),
            };
            let Some(inside) = inside else { continue };
            for end in [whole, shortest] {
                let Some(found) = stops(self.towards(&inside, &end), known < n) else { continue };
                let lowest = end == shortest && found.defect <= ROUNDING;
                if lowest || best.is_none_or(|best| found.defect < best.defect) {
                    best = Some(found);
                }
            }
        }
        // A load that the large singular values alone do not hold: the others are no rounding after all.
        let has_digits = relative[n - 1] > 16.0 * f64::EPSILON;
        if known < n && has_digits && !best.is_some_and(|best| best.defect <= CONTINUUM) {
            let found = stops(back(&factors.solve(&scaled, &load, n)), false);
            return found.filter(|found| found.defect <= SOLUTION).or(best);
        }
        best
    }

    /// Units of the percussions in which the diagonal of the block is one on average; the tangential rows of a point
    /// share one, so that it does not matter how they are chosen, and drilling has its own.
    fn scales(&self) -> V {
        let first = self.first();
        let unit = |mean: f64| if mean > 0.0 { 1.0 / mean.sqrt() } else { self.rho.tangent.sqrt() };
        let planar = P.min(2);
        let tangent: f64 = (first..first + planar).map(|i| self.g[(i, i)]).sum();
        V::from_fn(|i, _| match i {
            i if i < first => self.rho.normal.sqrt(),
            i if i < first + planar => unit(tangent / planar as f64),
            i => unit(self.g[(i, i)]),
        })
    }

    /// A point of `P + span(K)` that the reservoir holds, by the least excess `k_C(−P_T) − P_N` over the angle θ of
    /// `P cos θ + K sin θ`, which reaches the far ends of the line; of sets that are not convex it may have several minima.
    fn within_line(&self, p: &V, axis: &V) -> Option<V> {
        let at = |theta: f64| p + axis * theta.tan();
        let graded = |theta: f64| {
            let here = at(theta);
            let excess = self.law.reservoir().gauge(&-self.tangent(&here)) - self.normal(&here);
            (theta.cos() * excess, theta)
        };
        let end = std::f64::consts::FRAC_PI_2 * (1.0 - 1e-9);
        let step = end / 32.0;
        let angles = (-32..32).map(|k| (f64::from(k) + 0.5) * step);
        let mut best = angles.map(graded).min_by(|a, b| a.0.total_cmp(&b.0))?;
        let (mut low, mut high) = ((best.1 - step).max(-end), (best.1 + step).min(end));
        let golden = 0.5 * (5f64.sqrt() - 1.0);
        let mut first = graded(high - golden * (high - low));
        let mut second = graded(low + golden * (high - low));
        for _ in 0..2 * ITERATIONS {
            let least = if first.0 <= second.0 { first } else { second };
            if least.0 < best.0 {
                best = least;
            }
            if best.0 < 0.0 {
                break;
            }
            if first.0 <= second.0 {
                (high, second) = (second.1, first);
                first = graded(high - golden * (high - low));
            } else {
                (low, first) = (first.1, second);
                second = graded(low + golden * (high - low));
            }
        }
        Some(at(best.1)).filter(|p| self.holds(p))
    }

    /// A point of `P + span(K)` that the reservoir holds: the ellipsoid method (\[Shor1977\]) for the excess, which is
    /// convex if *C* is, from a ball of a thousand times the size of the kernel's vectors.
    fn within_space(&self, p: &V, kernel: &[V; 3]) -> Option<V> {
        let (mut s, mut shape) = (Vector3::<f64>::zeros(), Matrix3::<f64>::identity() * 1e6);
        // The size of the ellipsoid falls to a tenth with some forty steps.
        for _ in 0..15 * ITERATIONS {
            let here = kernel.iter().zip(s.iter()).fold(*p, |p, (axis, s)| p + axis * *s);
            if self.holds(&here) {
                return Some(here);
            }
            let tangent = -self.tangent(&here);
            let (gauge, gradient) = match tangent.amax() == 0.0 {
                true => (0.0, Vector::<P>::zeros()),
                false => self.law.reservoir().gauge_jet(&tangent),
            };
            let slope = Vector3::from_fn(|i, _| {
                let lifted = match self.normal {
                    NormalForce::Prescribed(_) => 0.0,
                    NormalForce::Unilateral => kernel[i][0],
                };
                -(gradient.dot(&self.tangent(&kernel[i])) + lifted)
            });
            let step = shape * slope;
            let length = slope.dot(&step).sqrt();
            // Everywhere in the ellipsoid the excess is larger than the difference of the two.
            if !(length > gauge - self.normal(&here)) {
                return None;
            }
            let step = step / length;
            s -= step / 4.0;
            shape = (shape - step * step.transpose() * 0.5) * (9.0 / 8.0);
        }
        None
    }

    /// The point nearest to `end` on the way there from a point that the reservoir holds.
    fn towards(&self, inside: &V, end: &V) -> V {
        if self.holds(end) {
            return *end;
        }
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            let held = self.holds(&(inside + (end - inside) * middle));
            *if held { &mut low } else { &mut high } = middle;
        }
        inside + (end - inside) * low
    }
}

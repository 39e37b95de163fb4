//! Search over hulls of few points of the reservoir, for associated laws.
//!
//! On edges and faces the natural map is piecewise linear, and Newton's method runs in circles among its pieces. Among
//! the hulls of all faces there are finitely many to try; which ones they are, support points tell.

use asperity_set::{ConvexSet, Vector};

use super::{ContactMatrix, Evaluations, Single, V, solution};
use crate::contact::NormalForce;

/// Support points that are asked for: boxes and octahedra take three to six, round sets end in Newton's method, which is
/// tried after the last of them, too.
const ROUNDS: usize = 40;
/// Rounds after which Newton's method is tried, which finishes on round sets what the hulls began.
const NEWTON: usize = 4;
/// Weights and excesses that are rounding.
const ROUNDING: f64 = 1e-13;

/// Up to four points of the reservoir and those weights of theirs with which the contact slides or sticks as if their
/// hull were the reservoir.
struct Hull<const P: usize> {
    count: usize,
    points: [Vector<P>; 4],
}

/// What the hull of some of the points would do.
struct Trial {
    members: usize,
    weights: V,
    /// How far its points are along the slip, and by how much others are farther, relatively.
    along: f64,
    excess: f64,
    percussion: V,
}

impl<const P: usize> Single<'_, P> {
    /// Solutions with hulls of support points of *C* in its place, to which the support point along the slip is added
    /// as long as it lies outside: the method of \[GilbertJohnsonKeerthi1988\] in the metric of the block.
    ///
    /// With few points the condition that no point is farther along the slip is linear in the weights of those that
    /// carry the force, so that each hull is solved by trying all of its faces.
    pub(super) fn over_hulls(
        &self,
        left: &mut Evaluations,
        keep: &mut dyn FnMut(V) -> bool,
    ) -> bool {
        if !self.law.is_associated() {
            return false;
        }
        let direction = self.law.direction();
        let slip = self.tangent(&self.b);
        if slip.amax() == 0.0 {
            return false;
        }
        let mut hull = Hull { count: 1, points: [direction.support_point(&slip); 4] };
        for round in 1..=ROUNDS {
            if !left.take() {
                return false;
            }
            let Some(trial) = self.on_hull(&hull) else { return false };
            let slip = self.tangent(&self.velocity(&trial.percussion));
            let next = direction.support_point(&slip);
            let beyond = next.dot(&slip) - trial.along;
            // The comparison also ends where the contact sticks.
            let ends = !(beyond > ROUNDING * next.norm() * slip.norm());
            let newton = ends || round % NEWTON == 0;
            if newton && self.newton(trial.percussion, left).is_some_and(&mut *keep) {
                return true;
            }
            if ends {
                return keep(trial.percussion);
            }
            hull.carry(&trial, next);
        }
        false
    }

    /// The face of a hull on which the contact slides, with the least excess of the other points.
    fn on_hull(&self, hull: &Hull<P>) -> Option<Trial> {
        let mut best: Option<Trial> = None;
        for members in 1_usize..1 << hull.count {
            let Some(trial) = self.on_face(hull, members) else { continue };
            if best.as_ref().is_none_or(|best| trial.excess < best.excess) {
                best = Some(trial);
            }
        }
        best
    }

    /// Percussions `P_N = Σ wᵢ`, `−P_T = Σ wᵢ xᵢ` with `wᵢ ≥ 0` and the same `xᵢ·γ_T` for all members, and
    /// `γ_N = 0` or the given `P_N`.
    fn on_face(&self, hull: &Hull<P>, members: usize) -> Option<Trial> {
        let mut chosen = [0; 4];
        let mut count = 0;
        for i in (0..hull.count).filter(|i| members >> i & 1 == 1) {
            chosen[count] = i;
            count += 1;
        }
        let first = self.first();
        let ray = |i: usize| {
            let mut ray = V::zeros();
            if first == 1 {
                ray[0] = 1.0;
            }
            (0..P).for_each(|k| ray[first + k] = -hull.points[i][k]);
            ray
        };
        let rays: [V; 4] =
            std::array::from_fn(|k| if k < count { ray(chosen[k]) } else { V::zeros() });
        // Rows of differences, −(xᵢ − x₁)·γ_T, after the one for the normal.
        let mut tests = [V::zeros(); 4];
        for k in 1..count {
            tests[k] = rays[k] - rays[0];
        }
        let (mut matrix, mut right) = (ContactMatrix::identity(), V::zeros());
        for k in 0..count {
            for j in 0..count {
                matrix[(k, j)] = tests[k].dot(&(self.g * rays[j]));
            }
            right[k] = -tests[k].dot(&self.b);
        }
        match self.normal {
            NormalForce::Prescribed(value) => {
                // In the units of the other rows.
                let size = self.g.norm();
                (0..count).for_each(|j| matrix[(0, j)] = size);
                right[0] = size * value;
            }
            NormalForce::Unilateral => {
                for j in 0..count {
                    matrix[(0, j)] = self.g.row(0).transpose().dot(&rays[j]);
                }
                right[0] = -self.b[0];
            }
        }
        let weights = solution(&matrix, &right)?;
        let sum: f64 = weights.iter().take(count).sum();
        // The comparisons also turn away what is not a number.
        if !(sum > 0.0 && weights.iter().take(count).all(|w| *w >= -ROUNDING * sum)) {
            return None;
        }
        let mut percussion = V::zeros();
        for k in 0..count {
            percussion += rays[k] * weights[k].max(0.0);
        }
        let slip = self.tangent(&self.velocity(&percussion));
        let along = |x: &Vector<P>| x.dot(&slip);
        let own = along(&hull.points[chosen[0]]);
        let all = hull.points.iter().take(hull.count);
        let size = slip.norm() * hull.points.iter().map(|x| x.norm()).fold(0.0, f64::max);
        let excess = all.map(|x| along(x) - own).fold(0.0, f64::max) / size.max(f64::MIN_POSITIVE);
        Some(Trial { members, weights, along: own, excess, percussion })
    }
}

impl<const P: usize> Hull<P> {
    /// Keeps the points that carry the force, and takes in one more; of four the one with the least weight goes.
    fn carry(&mut self, trial: &Trial, point: Vector<P>) {
        let mut kept = [(0.0, Vector::<P>::zeros()); 4];
        let mut count = 0;
        for i in (0..self.count).filter(|i| trial.members >> i & 1 == 1) {
            kept[count] = (trial.weights[count], self.points[i]);
            count += 1;
        }
        kept[..count].sort_by(|a, b| b.0.total_cmp(&a.0));
        count = count.min(3);
        for (place, (_, x)) in self.points.iter_mut().zip(&kept[..count]) {
            *place = *x;
        }
        self.points[count] = point;
        self.count = count + 1;
    }
}

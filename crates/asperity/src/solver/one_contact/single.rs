//! One contact as a small dense problem, whatever its dimension and however ill-conditioned its block.
//!
//! The closed forms of `line.rs` and `plane/` divide by pivots of the block. Where those are small,
//! what is found there is refined here, and what is not found there is searched for here: the measure
//! of a contact decides which percussions are a solution.

mod cells;
mod hull;

use asperity_set::{Matrix, StarSet, Vector};
use nalgebra::{Matrix3, Vector3};

use super::effort::{Effort, Evaluations};
use super::singular::Factors;
use crate::contact::{ContactProblem, ContactRows, NormalForce, Phase};
use crate::law::{self, ContactMatrix, ContactPoint, ContactVector, Friction, FrictionLaw, Rho};
use crate::solver::measure::approach::UNRESOLVED;

type V = ContactVector;

// The first constants were multiplied by ¼ and 4 on 400 random contacts with blocks of any rank, singular values over
// four decades, laws of space and of sets with corners, and so were those of `hull.rs`; `REGULAR`, `SMALL` and `STOPPED`
// were divided and multiplied by ten: 387 are solved and 5 proven to have no solution, unless it is said.

/// Newton iterations from one start, halvings of a step. With 40 halvings two contacts fewer are solved.
const ITERATIONS: usize = 40;
const HALVINGS: usize = 10;
/// Proximal points.
const PROXIMAL: usize = 60;
/// Steps of refinement of a solution that is known already.
const REFINEMENTS: usize = 3;
/// Relative `‖F‖` that counts as solved.
const SOLVED: f64 = 1e-12;
/// Largest condition of a matrix that counts as regular.
const REGULAR: f64 = 1e10;
/// Largest condition with which an inverse keeps twelve digits.
const SOUND: f64 = 1e4;
/// Iterations of a singular value decomposition, of which a matrix of four rows takes some ten.
const SVD_ITERATIONS: usize = 100;

/// Relative defect that is nothing but rounding.
pub(crate) const ROUNDING: f64 = 1e-14;
/// Relative defect up to which percussions count as a solution when one is chosen, and up to which a search
/// goes on.
pub(crate) const SOLUTION: f64 = 1e-12;
pub(crate) const FOUND: f64 = 1e-11;
/// The same for stick in a continuum, whose loads are what rounding leaves of larger velocities: with a tenth 16 of the 900
/// runs of hinges at rest of `tests/test_hinges.py` carry forces that cancel, with this none.
const CONTINUUM: f64 = 1e-10;
/// Singular values below this part of the largest may be left out in stick. The result is judged by its
/// defect, so that this decides about the effort only.
const SMALL: f64 = 1e-6;
/// Velocity in stick against the loads, both in the units of `scales`.
const STOPPED: f64 = 1e-6;
/// Singular values below this part of the largest are rounding, and stick is a continuum, unless the others do not hold the
/// load; below the second one they have no digit.
const VANISHING: f64 = 1e-13;
const LAST_DIGIT: f64 = 16.0 * f64::EPSILON;

/// The contact with the velocities that the others leave it.
#[derive(Clone, Copy)]
pub(crate) struct Single<'a, const P: usize> {
    pub(crate) law: &'a FrictionLaw<P>,
    pub(crate) normal: NormalForce,
    /// `G_ii`, unused rows of a multiple of the unit matrix, in its units.
    pub(crate) g: ContactMatrix,
    pub(crate) b: V,
    rho: Rho,
    /// `ρ = rows/tr G`, the prox parameter of the measure.
    own_rho: f64,
    /// What `‖F‖` is compared with: `ρ‖b‖`.
    loads: f64,
}

/// Percussions with their relative defect.
#[derive(Clone, Copy)]
pub(crate) struct Graded {
    pub(crate) percussion: V,
    pub(crate) defect: f64,
    /// One of a continuum.
    pub(crate) degenerate: bool,
}

impl Graded {
    /// Whether the contact sticks under these percussions.
    pub(crate) fn sticks(&self) -> bool {
        self.defect <= if self.degenerate { CONTINUUM } else { SOLUTION }
    }
}

/// The shortest solution of a linear system that may be singular.
fn solution(matrix: &ContactMatrix, right: &V) -> Option<V> {
    let size = matrix.norm();
    // The comparisons also turn away NaN.
    if !(size < f64::MAX) {
        return None;
    }
    if let Some(inverse) = inverse(matrix, REGULAR) {
        return Some(inverse * right);
    }
    let svd = matrix.try_svd(true, true, f64::EPSILON, SVD_ITERATIONS)?;
    svd.solve(right, size / REGULAR).ok()
}

/// The inverse of a matrix whose condition is at most so large. With pivots: without, as of cofactors, the inverse of
/// a matrix of rank one may look harmless.
fn inverse(matrix: &ContactMatrix, condition: f64) -> Option<ContactMatrix> {
    matrix.lu().try_inverse().filter(|inverse| inverse.norm() * matrix.norm() <= condition)
}

/// Directions to the centres of the faces, edges and corners of a cube of `P` dimensions.
fn around<const P: usize>() -> impl Iterator<Item = Vector<P>> {
    let count = 3usize.pow(P as u32);
    (0..count).filter(move |&k| k != count / 2).map(|k| {
        let step = |i: u32| (k / 3usize.pow(i) % 3) as f64 - 1.0;
        Vector::<P>::from_fn(|i, _| step(i as u32))
    })
}

impl<'a, const P: usize> Single<'a, P> {
    /// Contact `i` of a problem with the velocities `held` that the others leave it.
    pub(crate) fn of(
        problem: &ContactProblem,
        i: usize,
        law: &'a FrictionLaw<P>,
        held: &[f64; 4],
    ) -> Self {
        let rows: &ContactRows = &problem.contacts()[i];
        let entry = |a: usize, b: usize| problem.delassus().own(i, a, b);
        Self::new(law, rows.normal, entry, |a| held[a])
    }

    pub(crate) fn new(
        law: &'a FrictionLaw<P>,
        normal: NormalForce,
        entry: impl Fn(usize, usize) -> f64,
        load: impl Fn(usize) -> f64,
    ) -> Self {
        let first = usize::from(normal == NormalForce::Unilateral);
        let len = first + P;
        let mean = (0..len).map(|i| entry(i, i)).sum::<f64>() / len as f64;
        let g = ContactMatrix::from_fn(|i, j| match i.max(j) < len {
            true => entry(i, j),
            false if i == j => mean,
            false => 0.0,
        });
        let b = V::from_fn(|i, _| if i < len { load(i) } else { 0.0 });
        let tangent: f64 = (first..len).map(|i| g[(i, i)]).sum();
        let rho = Rho { normal: 1.0 / g[(0, 0)], tangent: P as f64 / tangent };
        let own_rho = 1.0 / mean;
        Self { law, normal, g, b, rho, own_rho, loads: own_rho * b.norm() }
    }

    /// Number of normal rows.
    pub(crate) fn first(&self) -> usize {
        usize::from(self.normal == NormalForce::Unilateral)
    }

    fn len(&self) -> usize {
        self.first() + P
    }

    pub(crate) fn tangent(&self, v: &V) -> Vector<P> {
        let first = self.first();
        Vector::<P>::from_fn(|i, _| v[first + i])
    }

    pub(crate) fn normal(&self, p: &V) -> f64 {
        self.normal.prescribed().unwrap_or(p[0])
    }

    /// Velocities, of the unused rows zero.
    pub(crate) fn velocity(&self, p: &V) -> V {
        self.g * p + self.b
    }

    /// Whether the contact is open: no friction is asked whether it can pull it back.
    pub(crate) fn opens(&self) -> bool {
        self.normal.prescribed().map_or(self.b[0] >= 0.0, |normal| normal == 0.0)
    }

    /// Whether the reservoir holds the percussions.
    pub(crate) fn holds(&self, p: &V) -> bool {
        self.normal(p) > 0.0 && self.gauge(p) <= 1.0 + 4.0 * f64::EPSILON
    }

    pub(crate) fn gauge(&self, p: &V) -> f64 {
        self.law.reservoir().gauge(&(self.tangent(p) / -self.normal(p)))
    }

    pub(crate) fn slips(&self, p: &V) -> bool {
        self.normal(p) > 0.0 && self.gauge(p) >= 1.0 - 1e-9
    }

    /// What the contact does under percussions that solve it.
    pub(crate) fn phase(&self, p: &V) -> (Phase, Vector<P>) {
        let slip = self.tangent(&self.velocity(p));
        let still = slip.amax() <= 1e-12 * self.tangent(&self.b).amax();
        match self.normal(p) > 0.0 {
            false => (Phase::Open, slip),
            true if still || !self.slips(p) => (Phase::Stick, Vector::zeros()),
            true => (Phase::Slip, slip),
        }
    }

    /// The relative defect of percussions, as `natural_residual` has it for a problem of one contact.
    ///
    /// Percussions that are huge against the loads would make every defect small: an approach that is not
    /// small against the loads is a defect by itself, and where rounding leaves nothing of velocities there is no solution.
    pub(crate) fn defect(&self, p: &V) -> f64 {
        if self.first() == 1 {
            let brought = self.g.row(0).transpose().abs().dot(&p.abs());
            // Drilling velocities have another unit.
            if brought > UNRESOLVED * self.b.rows(0, 1 + P.min(2)).amax() {
                return f64::INFINITY;
            }
        }
        let (len, xi) = (self.len(), self.velocity(p));
        let normal = self.normal(p);
        let closing = match self.normal {
            NormalForce::Prescribed(_) => 0.0,
            NormalForce::Unilateral => normal - f64::max(0.0, normal - self.own_rho * xi[0]),
        };
        let own = self.first()..len;
        let (tangent, velocity) = (&p.as_slice()[own.clone()], &xi.as_slice()[own]);
        let friction = Friction { normal, tangent, velocity, restitution: &[0.0; P] };
        let sliding = law::inclusion_defect(self.law, friction, self.own_rho);
        let square = closing * closing + sliding;
        let scale = f64::max(p.norm_squared(), self.loads * self.loads);
        let defect = if square == 0.0 { 0.0 } else { (square / scale).sqrt() };
        let approach = if self.first() == 1 { -xi[0] / self.b.amax() } else { 0.0 };
        if approach > 1e-2 { defect.max(approach) } else { defect }
    }

    pub(crate) fn graded(&self, percussion: V, degenerate: bool) -> Graded {
        Graded { percussion, defect: self.defect(&percussion), degenerate }
    }

    /// Percussions of sliding along `v` per normal one, after 1 for that one, and its resistance `G_N·` against them.
    fn per_normal(&self, v: &Vector<P>) -> Option<(V, f64)> {
        let force = self.law.force(v, 1.0).ok()?;
        let (mut unit, first) = (V::zeros(), self.first());
        (0..P).for_each(|i| unit[first + i] = force[i]);
        if first == 0 {
            return Some((unit, 1.0));
        }
        unit[0] = 1.0;
        Some((unit, self.g.row(0).transpose().dot(&unit)))
    }

    /// Percussions of sliding along `v`, the normal one from its own row.
    pub(crate) fn slipping(&self, v: &Vector<P>) -> V {
        let Some((unit, resistance)) = self.per_normal(v) else { return V::zeros() };
        let pressed = || f64::max(0.0, -self.b[0] / resistance);
        let normal = self.normal.prescribed().unwrap_or_else(pressed);
        if normal.is_finite() { unit * normal } else { V::zeros() }
    }

    /// Sliding with a velocity along `v`: the percussions, the denominator `G_N·` of the normal one, and how far the
    /// velocity under these percussions, times the denominator, is from `v`.
    ///
    /// With `P_N = −b_N/denominator` that product has no pole where the denominator vanishes, as in `plane/`.
    fn astray(&self, v: &Vector<P>) -> Option<(V, f64, Vector<P>)> {
        let (percussion, denominator, slip) = self.sliding(v)?;
        Some((percussion, denominator, slip - v))
    }

    /// The same with the slip itself that these percussions leave, times the denominator.
    fn sliding(&self, v: &Vector<P>) -> Option<(V, f64, Vector<P>)> {
        let (unit, denominator) = self.per_normal(v)?;
        let factor = self.normal.prescribed().unwrap_or(-self.b[0]);
        let slip = self.tangent(&self.b) * denominator + self.tangent(&(self.g * unit)) * factor;
        Some((unit * factor, denominator, slip))
    }

    /// Newton's method for the slip velocity that the friction of sliding along it leaves, with differences.
    ///
    /// Beside cusps of *C* and on slender *D* the natural map has no derivative to speak of; along bdry *D* the
    /// percussions depend on the normal the less the sharper these are. Where friction nearly pulls the contact in,
    /// percussions are large and nothing else leads to them. Velocities of any length, unlike normals, tell a contact
    /// that creeps from one that is led past rest.
    fn along_slips(&self, start: &Vector<P>, left: &mut Evaluations) -> Option<V> {
        const STEP: f64 = 1e-7;
        const LEAST: f64 = 1e-4;
        let normal = start.try_normalize(0.0)?;
        let (_, _, off) = self.astray(&normal)?;
        let mut velocity = normal * (off + normal).norm();
        let (mut percussion, mut denominator, mut off) = self.astray(&velocity)?;
        'newton: for _ in 0..ITERATIONS {
            let distance = off.norm();
            let size = velocity.norm();
            if distance <= 4.0 * f64::EPSILON * size {
                break;
            }
            let mut jacobian = Matrix::<P>::zeros();
            for k in 0..P {
                if !left.take() {
                    break 'newton;
                }
                let mut beside = velocity;
                beside[k] += STEP * size;
                jacobian.set_column(k, &((self.astray(&beside)?.2 - off) / (STEP * size)));
            }
            // Along the velocity itself the derivative is −1.
            let step = -(jacobian.try_inverse()? * off);
            let mut length = 1.0;
            loop {
                // The comparison also turns away NaN.
                if !(length > LEAST) || !left.take() {
                    break 'newton;
                }
                let next = velocity + step * length;
                let there = self.astray(&next)?;
                if there.2.norm() < distance {
                    velocity = next;
                    (percussion, denominator, off) = there;
                    break;
                }
                length *= 0.5;
            }
        }
        (denominator > 0.0 && off.norm() < 1e-6 * velocity.norm()).then(|| percussion / denominator)
    }

    /// What the natural map is a function of.
    fn point<'p>(&self, p: &'p V, xi: &'p V) -> ContactPoint<'p> {
        let prescribed = self.normal.prescribed();
        let (percussion, xi) = (&p.as_slice()[..self.len()], &xi.as_slice()[..self.len()]);
        ContactPoint { prescribed, rho: self.rho, percussion, xi }
    }

    /// `F` and its Jacobian `A + B G`.
    fn linearized(&self, p: &V) -> (V, ContactMatrix) {
        let (len, xi) = (self.len(), self.velocity(p));
        let (mut f, mut a, mut b) = (V::zeros(), ContactMatrix::zeros(), ContactMatrix::zeros());
        let out = &mut f.as_mut_slice()[..len];
        let derivatives = law::Derivatives { a: &mut a, b: &mut b };
        law::natural_map(self.law, self.point(p, &xi), out, Some(derivatives));
        let mut matrix = a + b * self.g;
        (len..4).for_each(|i| matrix[(i, i)] = 1.0);
        (f, matrix)
    }

    fn map(&self, p: &V) -> V {
        let (xi, mut f) = (self.velocity(p), V::zeros());
        let out = &mut f.as_mut_slice()[..self.len()];
        law::natural_map(self.law, self.point(p, &xi), out, None);
        f
    }

    /// Damped Newton from `p`; `None` if it does not end in a zero of the natural map.
    pub(crate) fn newton(&self, mut p: V, left: &mut Evaluations) -> Option<V> {
        let (mut f, mut matrix) = self.linearized(&p);
        for _ in 0..ITERATIONS {
            let (norm, scale) = (f.norm(), self.loads.max(p.norm()));
            if norm <= 1e-15 * scale {
                return Some(p);
            }
            let step = solution(&matrix, &-f)?;
            let mut length = 1.0;
            let mut next = p + step;
            if !left.take() {
                break;
            }
            while !(self.map(&next).norm() < norm) {
                length *= 0.5;
                if length < 0.5_f64.powi(HALVINGS as i32) || !left.take() {
                    // Rounding ends the descent.
                    return (norm <= SOLVED * scale).then_some(p);
                }
                next = p + step * length;
            }
            p = next;
            (f, matrix) = self.linearized(&p);
        }
        (f.norm() <= SOLVED * self.loads.max(p.norm())).then_some(p)
    }

    /// Newton steps from percussions that are a solution but for rounding, as long as they make the defect
    /// smaller.
    pub(crate) fn refined(&self, start: Graded) -> Graded {
        let mut best = start;
        for _ in 0..REFINEMENTS {
            if best.defect <= ROUNDING {
                break;
            }
            let (f, matrix) = self.linearized(&best.percussion);
            let Some(step) = solution(&matrix, &-f) else { break };
            let next = self.graded(best.percussion + step, best.degenerate);
            // The comparison also turns away NaN.
            if !(next.defect < 0.5 * best.defect) {
                break;
            }
            best = next;
        }
        best
    }

    /// Where Newton's method leads from the percussions of sliding along a velocity.
    ///
    /// On a slender *D* the natural map hardly sees that the velocity is off the normal: the defect tells whether that is
    /// a solution.
    pub(crate) fn newton_from_slip(
        &self,
        velocity: &Vector<P>,
        effort: &mut Effort,
    ) -> Option<Graded> {
        let mut left = effort.attempt();
        if !left.are_left() {
            return None;
        }
        let end = self.newton(self.slipping(velocity), &mut left);
        let found = end.map(|p| self.refined(self.graded(p, false)));
        if !found.is_some_and(|found| found.defect <= FOUND) {
            effort.failed_attempt(left);
        }
        found
    }

    /// Newton's method where the block is singular: on `G + εI` with the load `b − εP`, which the solution of the
    /// singular problem satisfies too. Small ε are long steps.
    fn proximal_point(&self, mut p: V, left: &mut Evaluations) -> Option<V> {
        let mut small = 1.0 / self.rho.tangent;
        for _ in 0..PROXIMAL {
            if !left.are_left() {
                break;
            }
            let g = self.g + ContactMatrix::identity() * small;
            let Some(next) = (Self { g, b: self.b - p * small, ..*self }).newton(p, left) else {
                small *= 5.0;
                continue;
            };
            p = next;
            small *= 0.3;
            if let Some(found) = self.newton(p, left) {
                return Some(found);
            }
        }
        None
    }

    /// Percussions that solve the contact, by every means there is: from a start, from sliding all around, over hulls
    /// and by proximal points, as far as the effort goes. What has the least defect, which may be large.
    pub(crate) fn search(&self, first: V, effort: &mut Effort) -> Option<Graded> {
        let mut left = effort.search();
        let mut best: Option<Graded> = None;
        let mut keep = |p: V| {
            let found = self.refined(self.graded(p, false));
            if best.is_none_or(|best| found.defect < best.defect) {
                best = Some(found);
            }
            found.defect <= FOUND
        };
        let free = self.tangent(&self.b);
        let starts = [first, self.slipping(&free), V::zeros()];
        if starts.into_iter().filter_map(|p| self.newton(p, &mut left)).any(&mut keep) {
            return best;
        }
        if self.over_hulls(&mut left, &mut keep) {
            return best;
        }
        let mut cells = None;
        if self.over_cells(&mut cells, &mut left, &mut keep) {
            return best;
        }
        // In turns, so that neither takes all evaluations.
        for n in std::iter::once(free).chain(around()) {
            if !left.are_left() {
                break;
            }
            if self.along_slips(&n, &mut left).is_some_and(&mut keep) {
                return best;
            }
            if self.newton(self.slipping(&n), &mut left).is_some_and(&mut keep) {
                return best;
            }
        }
        if self.proximal_point(first, &mut left).is_some_and(&mut keep)
            || self.over_cells(&mut cells, &mut left, &mut keep)
        {
            return best;
        }
        effort.failed(left);
        best
    }

    /// The percussions of a stick solution, `GP + b = 0` with `−P_T ∈ P_N C`, whatever the rank of the block.
    ///
    /// Of a block without full rank the solutions are `P₀ + ker G`, and the admissible ones among them are a
    /// convex set if *C* is. With a block whose small singular values may or may not be rounding every rank
    /// is tried: the percussions with the least rank that solve the system up to rounding are taken, else
    /// those with the least defect. Of a continuum it is the point nearest to the shortest solution: at its far ends
    /// defects, which are relative to the percussions, are the smaller, but not the velocities.
    pub(crate) fn stick(&self, effort: &mut Effort) -> Option<Graded> {
        if let Some(inverse) = inverse(&self.g, SOUND) {
            let p = -(inverse * self.b);
            let rest = self.velocity(&p);
            let percussion = p - inverse * rest;
            // Within the reservoir nothing but the velocity is a defect, and without loads there is none.
            let defect = match rest.norm() {
                0.0 => 0.0,
                rest => self.own_rho * rest / self.loads.max(p.norm()),
            };
            return self.holds(&percussion).then_some(Graded {
                percussion,
                defect,
                degenerate: false,
            });
        }
        let mut left = effort.stick();
        let found = self.stick_of_any_rank(&mut left);
        if !found.is_some_and(|found| found.sticks()) {
            effort.failed_stick(left);
        }
        found
    }

    fn stick_of_any_rank(&self, left: &mut Evaluations) -> Option<Graded> {
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
        let back = |p: &V| p.component_mul(&scales);
        let known =
            (1..n).find(|&k| factors.values[k] <= VANISHING * factors.values[0]).unwrap_or(n);
        // What smaller singular values make of the load is rounding over rounding.
        let whole = factors.solve(&scaled, &load, known);
        // Percussions that are huge against the loads stop the contact in name only.
        let stops = |p: &V| {
            let left = self.velocity(p).component_mul(&scales).norm();
            self.holds(p) && left <= STOPPED * load.norm()
        };
        let mut best: Option<Graded> = None;
        let mut keep = |p: V, lowest: bool| {
            if !stops(&p) {
                return;
            }
            let found = self.graded(p, known < n);
            if !(found.defect < f64::INFINITY) {
                return;
            }
            let better = lowest && found.defect <= ROUNDING;
            if better || best.is_none_or(|best| found.defect < best.defect) {
                best = Some(found);
            }
        };
        if known == n {
            keep(back(&whole), false);
        }
        for rank in (1..n).rev() {
            if rank > known || rank < known && factors.values[rank] > SMALL * factors.values[0] {
                continue;
            }
            let shortest = factors.solve(&scaled, &load, rank);
            let kernel: [V; 3] = std::array::from_fn(|k| match rank + k < n {
                true => back(&factors.right.column(rank + k).into_owned()),
                false => V::zeros(),
            });
            let size = shortest.norm().max(f64::MIN_POSITIVE);
            let Some(inside) = self.within(&back(&shortest), &kernel[..n - rank], size, left)
            else {
                continue;
            };
            keep(self.towards(&inside, &back(&whole)), false);
            keep(self.towards(&inside, &back(&shortest)), true);
        }
        let has_digits = factors.values[n - 1] > LAST_DIGIT * factors.values[0];
        if known < n && has_digits && !best.is_some_and(|best| best.sticks()) {
            // A load that the large singular values alone do not hold: the others are no rounding after all.
            let found = self.graded(back(&factors.solve(&scaled, &load, n)), false);
            if stops(&found.percussion) && found.sticks() {
                return Some(found);
            }
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

    /// How far percussions are outside, `k_C(−P_T) − P_N`, positively homogeneous and for convex *C* convex; the
    /// prescribed normal percussion counts `weight` times.
    fn excess(&self, p: &V, weight: f64) -> f64 {
        let normal = match self.normal {
            NormalForce::Prescribed(value) => value * weight,
            NormalForce::Unilateral => p[0],
        };
        let tangent = -self.tangent(p);
        let gauge = if tangent.amax() == 0.0 { 0.0 } else { self.law.reservoir().gauge(&tangent) };
        gauge - normal
    }

    /// A point of `P + span(kernel)` that the reservoir holds.
    fn within(&self, p: &V, kernel: &[V], size: f64, left: &mut Evaluations) -> Option<V> {
        if self.holds(p) {
            return Some(*p);
        }
        let found = match kernel {
            [axis] => self.within_line(p, &(axis * size), left),
            _ => self.within_space(p, kernel, size, left),
        };
        found.filter(|p| self.holds(p))
    }

    /// On a line: over the angle `θ` of `P cos θ + K sin θ`, which reaches its far ends, the least excess by a
    /// scan and a golden section.
    fn within_line(&self, p: &V, axis: &V, left: &mut Evaluations) -> Option<V> {
        const SCAN: usize = 64;
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let mut at = |theta: f64| {
            if !left.take() {
                return f64::INFINITY;
            }
            let (sine, cosine) = theta.sin_cos();
            self.excess(&(p * cosine + axis * sine), cosine)
        };
        let step = std::f64::consts::PI / SCAN as f64;
        let angle = |k: usize| step * (k as f64 + 0.5) - std::f64::consts::FRAC_PI_2;
        // A value may take as long as the gauge of a set that has only a support function.
        let values: [f64; SCAN] = std::array::from_fn(|k| at(angle(k)));
        let least = (0..SCAN).min_by(|&a, &b| values[a].total_cmp(&values[b]))?;
        let limit = std::f64::consts::FRAC_PI_2 * (1.0 - 1e-9);
        let (mut low, mut high) =
            ((angle(least) - step).max(-limit), (angle(least) + step).min(limit));
        let lower = |low: f64, high: f64| high - GOLDEN * (high - low);
        let upper = |low: f64, high: f64| low + GOLDEN * (high - low);
        let (mut a, mut b) = (lower(low, high), upper(low, high));
        let (mut at_a, mut at_b) = (at(a), at(b));
        let mut best = (values[least], angle(least));
        for _ in 0..80 {
            let nearer = if at_a <= at_b { (at_a, a) } else { (at_b, b) };
            if nearer.0 < best.0 {
                best = nearer;
            }
            if best.0 < 0.0 {
                break;
            }
            if at_a <= at_b {
                (high, b, at_b) = (b, a, at_a);
                a = lower(low, high);
                at_a = at(a);
            } else {
                (low, a, at_a) = (a, b, at_b);
                b = upper(low, high);
                at_b = at(b);
            }
        }
        Some(p + axis * best.1.tan())
    }

    /// In a plane or in space: the ellipsoid method for the convex excess, from a ball of a thousand times the
    /// size of the percussions.
    fn within_space(&self, p: &V, kernel: &[V], size: f64, left: &mut Evaluations) -> Option<V> {
        const STEPS: usize = 600;
        let at = |s: &Vector3<f64>| {
            kernel.iter().zip(s.iter()).fold(*p, |p, (axis, s)| p + axis * (size * s))
        };
        let (mut s, mut shape) = (Vector3::<f64>::zeros(), Matrix3::<f64>::identity() * 1e6);
        for _ in 0..STEPS {
            if !left.take() {
                break;
            }
            let here = at(&s);
            if self.excess(&here, 1.0) <= 0.0 {
                return Some(here);
            }
            let tangent = -self.tangent(&here);
            let gradient = match tangent.amax() == 0.0 {
                true => Vector::<P>::zeros(),
                false => self.law.reservoir().gauge_jet(&tangent).1,
            };
            let slope = Vector3::from_fn(|i, _| {
                kernel.get(i).map_or(0.0, |axis| {
                    let normal = if self.first() == 1 { axis[0] } else { 0.0 };
                    -(gradient.dot(&self.tangent(axis)) + normal)
                })
            });
            let step = shape * slope;
            let length = slope.dot(&step).sqrt();
            // The comparison also ends at a vanishing gradient.
            if !(length > 0.0) {
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
            if self.holds(&(inside + (end - inside) * middle)) {
                low = middle
            } else {
                high = middle
            }
        }
        inside + (end - inside) * low
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every direction to a face, an edge or a corner of a cube, once.
    #[test]
    fn directions_are_all_around() {
        let mut all: Vec<[i8; 3]> =
            around::<3>().map(|v| [v.x, v.y, v.z].map(|c| c as i8)).collect();
        assert!(all.iter().flatten().all(|c| (-1..=1).contains(c)) && !all.contains(&[0; 3]));
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), 26);
    }
}

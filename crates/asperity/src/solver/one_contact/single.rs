//! One contact as a small dense problem, whatever its dimension and however ill-conditioned its block.
//!
//! The closed forms of `line.rs` and `plane/` divide by pivots of the block. Where those are small,
//! what is found there is refined here, and what is not found there is searched for here: the measure
//! of a contact decides which percussions are a solution.

mod net;
mod stick;

use asperity_set::{StarSet, Vector};

use super::singular::Factors;
use super::solution::LocalSolution;
use crate::contact::{ContactState, NormalForce, Phase};
use crate::law::{self, ContactMatrix, ContactPoint, ContactVector, Friction, FrictionLaw, Rho};
use crate::solver::measure::approach::UNRESOLVED;

type V = ContactVector;

/// Newton iterations from one start, proximal points.
const ITERATIONS: usize = 40;
/// Largest condition of a matrix that counts as regular.
const REGULAR: f64 = 1e10;
/// Singular values, and slip velocities, below this part of the largest are rounding.
pub(crate) const VANISHING: f64 = 1e-13;
/// Relative defect that is nothing but rounding.
pub(crate) const ROUNDING: f64 = 1e-14;
/// Relative defect up to which percussions count as a solution when one is chosen, and up to which a search goes on.
pub(crate) const SOLUTION: f64 = 1e-12;
pub(crate) const FOUND: f64 = 1e-11;

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

/// The shortest solution of a linear system that may be singular.
fn solution(matrix: &ContactMatrix, right: &V) -> Option<V> {
    let size = matrix.norm();
    // The comparison also turns away NaN.
    if !(size < f64::MAX) {
        return None;
    }
    if let Some(inverse) = inverse(matrix, REGULAR) {
        return Some(inverse * right);
    }
    let factors = Factors::new(matrix, 4);
    let rank = factors.values.iter().filter(|value| **value > size / REGULAR).count();
    Some(factors.solve(matrix, right, rank))
}

/// The inverse of a matrix whose condition is at most so large. With pivots: without, as of cofactors, the inverse of
/// a matrix of rank one may look harmless.
fn inverse(matrix: &ContactMatrix, condition: f64) -> Option<ContactMatrix> {
    matrix.lu().try_inverse().filter(|inverse| inverse.norm() * matrix.norm() <= condition)
}

impl<'a, const P: usize> Single<'a, P> {
    /// The contact with the entries of its block and the velocities that the others leave it.
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
        let rho = Rho { normal: 1.0 / g[(0, 0)], tangent: P as f64 / tangent.abs() };
        let own_rho = 1.0 / mean.abs();
        Self { law, normal, g, b, rho, own_rho, loads: own_rho * b.norm() }
    }

    /// Number of normal rows.
    fn first(&self) -> usize {
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
    fn holds(&self, p: &V) -> bool {
        self.normal(p) > 0.0 && self.gauge(p) <= 1.0 + 4.0 * f64::EPSILON
    }

    fn gauge(&self, p: &V) -> f64 {
        self.law.reservoir().gauge(&(self.tangent(p) / -self.normal(p)))
    }

    fn slips(&self, p: &V) -> bool {
        self.normal(p) > 0.0 && self.gauge(p) >= 1.0 - 1e-9
    }

    /// What the contact does under percussions that solve it.
    fn phase(&self, p: &V) -> Phase {
        let slip = self.tangent(&self.velocity(p));
        let still = slip.amax() <= SOLUTION * self.tangent(&self.b).amax();
        match self.normal(p) > 0.0 {
            false => Phase::Open,
            true if still || !self.slips(p) => Phase::Stick,
            true => Phase::Slip,
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
    fn slipping(&self, v: &Vector<P>) -> V {
        let Some((unit, resistance)) = self.per_normal(v) else { return V::zeros() };
        let active = || f64::max(0.0, -self.b[0] / resistance);
        let normal = self.normal.prescribed().unwrap_or_else(active);
        if normal.is_finite() { unit * normal } else { V::zeros() }
    }

    /// The natural map `F`.
    fn map(&self, p: &V, derivatives: Option<law::Derivatives<'_>>) -> V {
        let (len, xi, mut f) = (self.len(), self.velocity(p), V::zeros());
        let (percussion, xi) = (&p.as_slice()[..len], &xi.as_slice()[..len]);
        let prescribed = self.normal.prescribed();
        let point = ContactPoint { prescribed, rho: self.rho, percussion, xi };
        law::natural_map(self.law, point, &mut f.as_mut_slice()[..len], derivatives);
        f
    }

    /// `F` and its Jacobian `A + B G`.
    fn linearized(&self, p: &V) -> (V, ContactMatrix) {
        let (mut a, mut b) = (ContactMatrix::zeros(), ContactMatrix::zeros());
        let f = self.map(p, Some(law::Derivatives { a: &mut a, b: &mut b }));
        let mut matrix = a + b * self.g;
        (self.len()..4).for_each(|i| matrix[(i, i)] = 1.0);
        (f, matrix)
    }

    /// Damped Newton from `p`; `None` if it does not end in a zero of the natural map.
    fn newton(&self, mut p: V) -> Option<V> {
        let (mut f, mut matrix) = self.linearized(&p);
        'newton: for _ in 0..ITERATIONS {
            let norm = f.norm();
            if norm <= 1e-15 * self.loads.max(p.norm()) {
                break;
            }
            let mut step = solution(&matrix, &-f)?;
            for _ in 0..=10 {
                let next = p + step;
                if self.map(&next, None).norm() < norm {
                    p = next;
                    (f, matrix) = self.linearized(&p);
                    continue 'newton;
                }
                step *= 0.5;
            }
            // Rounding ends the descent.
            break;
        }
        (f.norm() <= SOLUTION * self.loads.max(p.norm())).then_some(p)
    }

    /// Newton steps from percussions that are a solution but for rounding, as long as they make the defect
    /// smaller.
    pub(crate) fn refined(&self, start: Graded) -> Graded {
        let mut best = start;
        while best.defect > ROUNDING {
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

    /// The solution that continues `state` as far as stick, Newton's method from sliding along a velocity and a search from
    /// these percussions find it; with drilling friction what has the least defect, which may be large. Where the contact is
    /// not `alone`, the search is short, since sweeps come back to it with other loads.
    pub(crate) fn solve(
        &self,
        state: &ContactState,
        velocity: Option<Vector<P>>,
        percussion: &[f64],
        alone: bool,
    ) -> Option<LocalSolution<P>> {
        let sticks = || self.stick().map(|found| self.solution(&found, Phase::Stick));
        if state.phase != Phase::Slip
            && let Some(stick) = sticks()
        {
            return Some(stick);
        }
        // A slipping contact goes on slipping where it can: from its last slip, Newton's method finds that.
        let slides = velocity
            .and_then(|velocity| self.newton(self.slipping(&velocity)))
            .map(|p| self.refined(self.graded(p, false)));
        let found = slides.filter(|found| found.defect <= FOUND);
        if let Some(found) = found.filter(|found| self.phase(&found.percussion) == Phase::Slip) {
            return Some(self.solution(&found, Phase::Slip));
        }
        if state.phase == Phase::Slip
            && let Some(stick) = sticks()
        {
            return Some(stick);
        }
        // In the plane all solutions are searched for instead.
        if P < 3 {
            return None;
        }
        let given = V::from_fn(|i, _| percussion.get(i).copied().unwrap_or(0.0));
        let found = found.or_else(|| {
            let all = self.search(given, alone).into_iter().chain(slides);
            all.min_by(|a, b| a.defect.total_cmp(&b.defect))
        })?;
        Some(self.solution(&found, self.phase(&found.percussion)))
    }

    /// The percussions of a solution.
    pub(crate) fn percussion(&self, solution: &LocalSolution<P>) -> V {
        let mut percussion = V::zeros();
        solution.store(&mut percussion.as_mut_slice()[..self.len()]);
        percussion
    }

    /// Percussions as a solution in which the contact does this.
    pub(crate) fn solution(&self, found: &Graded, phase: Phase) -> LocalSolution<P> {
        let Graded { percussion, degenerate, .. } = *found;
        let slip = match phase {
            Phase::Stick => Vector::zeros(),
            _ => self.tangent(&self.velocity(&percussion)),
        };
        let (normal, tangent) = (self.normal(&percussion), self.tangent(&percussion));
        LocalSolution { phase, normal, tangent, slip, degenerate, ambiguous: degenerate }
    }

    /// Percussions with the least defect that Newton's method finds from three starts, else, for a contact `alone`, from the
    /// cells of a net of slip directions and by proximal points.
    fn search(&self, first: V, alone: bool) -> Option<Graded> {
        let mut best: Option<Graded> = None;
        let mut keep = |p: V| {
            let found = self.refined(self.graded(p, false));
            if best.is_none_or(|best| found.defect < best.defect) {
                best = Some(found);
            }
            found.defect <= FOUND
        };
        let starts = [first, self.slipping(&self.tangent(&self.b)), V::zeros()];
        let mut found = starts.into_iter().filter_map(|p| self.newton(p)).any(&mut keep);
        if alone && !found {
            found = self.over_net(&mut |velocity, p| {
                self.newton(p).is_some_and(&mut keep)
                    || self.along_slips(&velocity).is_some_and(&mut keep)
            });
        }
        if alone && !found {
            self.proximal_points(first, &mut keep);
        }
        best
    }

    /// Newton's method where the block is singular: on `G + εI` with the load `b − εP`, which the solution of the
    /// singular problem satisfies too. Small ε are long steps.
    fn proximal_points(&self, mut p: V, keep: &mut dyn FnMut(V) -> bool) {
        let mut small = 1.0 / self.rho.tangent;
        for _ in 0..ITERATIONS {
            let g = self.g + ContactMatrix::identity() * small;
            let Some(next) = (Self { g, b: self.b - p * small, ..*self }).newton(p) else {
                small *= 5.0;
                continue;
            };
            p = next;
            small *= 0.3;
            if self.newton(p).is_some_and(&mut *keep) {
                break;
            }
        }
    }
}

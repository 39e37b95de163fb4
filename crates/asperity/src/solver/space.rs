//! One contact with sliding and drilling friction, `p = 3`.
//!
//! Stick is a linear system; slip has no boundary curve to walk along: Newton's method on the natural map
//! from the last percussions and from spread starts finds a solution, prox iterations lead it where it does
//! not. Several solutions are neither listed nor recognised.

use asperity_set::{StarSet, Vector};
use nalgebra::Vector4;

use super::natural_map::{self, Rho, Small};
use crate::contact::{ContactProblem, ContactRows, ContactState, NormalForce, Phase};
use crate::law::FrictionLaw;

type V = Vector4<f64>;

/// Newton iterations from one start, halvings of a step, rounds of prox iterations, iterations in one.
const ITERATIONS: usize = 40;
const HALVINGS: usize = 10;
const ROUNDS: usize = 12;
const PROX: usize = 50;
/// Proximal points.
const PROXIMAL: usize = 60;
/// Relative `‖F‖` that counts as solved.
const SOLVED: f64 = 1e-12;

/// Relative velocity that counts as none.
const STILL: f64 = 1e-13;
/// Largest condition of a matrix that counts as regular.
const REGULAR: f64 = 1e10;
const SVD_ITERATIONS: usize = 100;

/// A solution on the contact's own rows.
pub(super) struct SpaceSolution {
    pub(super) phase: Phase,
    pub(super) percussion: [f64; 4],
    pub(super) slip: [f64; 3],
}

/// The contact with the velocities that the others leave it.
#[derive(Clone, Copy)]
struct Single<'a> {
    rows: &'a ContactRows,
    law: &'a FrictionLaw<3>,
    /// `G_ii`, unused rows of the unit matrix.
    g: Small,
    b: V,
    rho: Rho,
    /// What `‖F‖` is compared with: `ρ‖b‖`.
    loads: f64,
}

/// The solution that continues `state`; `start` are the last percussions.
pub(super) fn solve(
    problem: &ContactProblem,
    contact: usize,
    law: &FrictionLaw<3>,
    (held, start): (&[f64; 4], &[f64]),
    state: &ContactState,
) -> Option<SpaceSolution> {
    let rows = &problem.contacts[contact];
    let single = Single::new(problem, contact, law, held);
    let opens = match rows.normal {
        NormalForce::Prescribed(value) => value == 0.0,
        NormalForce::Unilateral => single.b[0] >= 0.0,
    };
    if opens {
        return Some(single.open());
    }
    let stick = solution(&single.g, &-single.b);
    let sticks = stick.filter(|p| single.admits(p));
    if state.phase != Phase::Slip
        && let Some(p) = sticks
    {
        return Some(single.classified(&p));
    }
    // A slipping contact goes on slipping where it can: from its last slip, Newton's method finds that.
    let last = Vector::<3>::from_column_slice(&state.slip);
    let ahead = (last.amax() > 0.0).then(|| single.slipping(&last));
    let slides =
        ahead.and_then(|p| single.newton(p)).filter(|p| sticks.is_none() || single.slips(p));
    if let Some(p) = slides.or(sticks) {
        return Some(single.classified(&p));
    }
    let given = V::from_fn(|i, _| start.get(i).copied().unwrap_or(0.0));
    let towards = |v: Vector<3>| single.slipping(&v);
    let b_t = single.tangent(&single.b);
    let starts = [given, towards(b_t), stick.unwrap_or(given), V::zeros()];
    let found = starts.into_iter().find_map(|p| single.newton(p));
    let found = found.or_else(|| single.spread().find_map(|p| single.newton(p)));
    let found = found.or_else(|| single.prox(given)).or_else(|| single.proximal_point(given));
    found.map(|p| single.classified(&p))
}

/// The shortest solution of a linear system that may be singular.
fn solution(matrix: &Small, right: &V) -> Option<V> {
    let size = matrix.norm();
    // The comparisons also turn away NaN.
    if let Some(inverse) = matrix.try_inverse()
        && inverse.norm() * size <= REGULAR
    {
        return Some(inverse * right);
    }
    let svd =
        matrix.try_svd(true, true, f64::EPSILON, SVD_ITERATIONS).filter(|_| size < f64::MAX)?;
    svd.solve(right, size / REGULAR).ok()
}

impl<'a> Single<'a> {
    fn new(
        problem: &'a ContactProblem,
        contact: usize,
        law: &'a FrictionLaw<3>,
        held: &[f64; 4],
    ) -> Self {
        let rows = &problem.contacts[contact];
        let len = rows.len();
        let g = Small::from_fn(|i, j| match i.max(j) < len {
            true => problem.delassus.own(contact, rows.offset, i, j),
            false => f64::from(u8::from(i == j)),
        });
        let b = V::from_fn(|i, _| if i < len { held[i] } else { 0.0 });
        let first = rows.normal_rows();
        let tangent: f64 = (first..len).map(|i| g[(i, i)]).sum();
        let rho = Rho { normal: 1.0 / g[(0, 0)], tangent: 3.0 / tangent };
        let loads = problem.rho[contact] * b.norm();
        Self { rows, law, g, b, rho, loads }
    }

    fn open(&self) -> SpaceSolution {
        let slip = self.tangent(&self.b).into();
        SpaceSolution { phase: Phase::Open, percussion: [0.0; 4], slip }
    }

    fn tangent(&self, v: &V) -> Vector<3> {
        let first = self.rows.normal_rows();
        Vector::<3>::from_fn(|i, _| v[first + i])
    }

    fn normal(&self, p: &V) -> f64 {
        match self.rows.normal {
            NormalForce::Prescribed(value) => value,
            NormalForce::Unilateral => p[0],
        }
    }

    /// Whether the reservoir holds the percussions and they stop the contact, which is not certain with a singular
    /// block.
    fn admits(&self, p: &V) -> bool {
        let rounding = STILL * (self.b.norm() + self.g.norm() * p.norm());
        let still = (self.g * p + self.b).norm() <= rounding;
        self.normal(p) > 0.0 && self.gauge(p) <= 1.0 + 4.0 * f64::EPSILON && still
    }

    fn gauge(&self, p: &V) -> f64 {
        self.law.reservoir().gauge(&(self.tangent(p) / -self.normal(p)))
    }

    fn slips(&self, p: &V) -> bool {
        self.normal(p) > 0.0 && self.gauge(p) >= 1.0 - 1e-9
    }

    fn classified(&self, p: &V) -> SpaceSolution {
        let slip = self.tangent(&(self.g * p + self.b));
        let still = slip.amax() <= 1e-12 * self.tangent(&self.b).amax();
        let phase = match self.normal(p) > 0.0 {
            false => Phase::Open,
            true if still || !self.slips(p) => Phase::Stick,
            true => Phase::Slip,
        };
        let slip = if phase == Phase::Stick { [0.0; 3] } else { slip.into() };
        SpaceSolution { phase, percussion: (*p).into(), slip }
    }

    /// Percussions of sliding along `v`, the normal one from its own row.
    fn slipping(&self, v: &Vector<3>) -> V {
        let Ok(force) = self.law.force(v, 1.0) else { return V::zeros() };
        let mut unit = V::zeros();
        let first = self.rows.normal_rows();
        (0..3).for_each(|i| unit[first + i] = force[i]);
        let normal = match self.rows.normal {
            NormalForce::Prescribed(value) => value,
            NormalForce::Unilateral => {
                unit[0] = 1.0;
                let resistance = self.g.row(0).transpose().dot(&unit);
                f64::max(0.0, -self.b[0] / resistance)
            }
        };
        if normal.is_finite() { unit * normal } else { V::zeros() }
    }

    /// Percussions of sliding along directions all around.
    fn spread(&self) -> impl Iterator<Item = V> + '_ {
        (0..26).map(|k| {
            let k = if k < 13 { k } else { k + 1 };
            let step = |n: i32| f64::from(n % 3 - 1);
            self.slipping(&Vector::<3>::new(step(k), step(k / 3), step(k / 9)))
        })
    }

    /// `F` and its Jacobian `A + B G`.
    fn linearized(&self, p: &V) -> (V, Small) {
        let len = self.rows.len();
        let xi = self.g * p + self.b;
        let (mut f, mut a, mut b) = (V::zeros(), Small::zeros(), Small::zeros());
        let at = (&p.as_slice()[..len], &xi.as_slice()[..len]);
        natural_map::jet(self.rows, self.rho, at, &mut f.as_mut_slice()[..len], (&mut a, &mut b));
        let mut matrix = a + b * self.g;
        (len..4).for_each(|i| matrix[(i, i)] = 1.0);
        (f, matrix)
    }

    fn map(&self, p: &V, rho: Rho) -> V {
        let len = self.rows.len();
        let xi = self.g * p + self.b;
        let mut f = V::zeros();
        let (own, xi) = (&p.as_slice()[..len], &xi.as_slice()[..len]);
        natural_map::value(self.rows, rho, own, xi, &mut f.as_mut_slice()[..len]);
        f
    }

    /// Damped Newton from `p`; `None` if it does not end in a zero of the natural map.
    fn newton(&self, mut p: V) -> Option<V> {
        let (mut f, mut matrix) = self.linearized(&p);
        for _ in 0..ITERATIONS {
            let (norm, scale) = (f.norm(), self.loads.max(p.norm()));
            if norm <= 1e-15 * scale {
                return Some(p);
            }
            let step = solution(&matrix, &-f)?;
            let mut length = 1.0;
            let mut next = p + step;
            while !(self.map(&next, self.rho).norm() < (1.0 - 1e-4 * length) * norm) {
                length *= 0.5;
                if length < 0.5_f64.powi(HALVINGS as i32) {
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

    /// Prox iterations with steps that shrink, Newton's method after each round.
    fn prox(&self, mut p: V) -> Option<V> {
        let scale = 1.0 / (self.g.norm() * self.rho.normal.max(self.rho.tangent));
        for round in 0..ROUNDS {
            let factor = scale * 0.7_f64.powi(round as i32);
            let rho = Rho { normal: self.rho.normal * factor, tangent: self.rho.tangent * factor };
            for _ in 0..PROX {
                p -= self.map(&p, rho);
            }
            if let Some(found) = self.newton(p) {
                return Some(found);
            }
        }
        None
    }
    /// Newton's method where the block is singular: on `G + εI` with the load `b − εP`, which the solution of the
    /// singular problem satisfies too. Small ε are long steps.
    fn proximal_point(&self, mut p: V) -> Option<V> {
        let mut small = 1.0 / self.rho.tangent;
        for _ in 0..PROXIMAL {
            let g = self.g + Small::identity() * small;
            let Some(next) = (Self { g, b: self.b - p * small, ..*self }).newton(p) else {
                small *= 5.0;
                continue;
            };
            p = next;
            small *= 0.3;
            if let Some(found) = self.newton(p) {
                return Some(found);
            }
        }
        None
    }
}

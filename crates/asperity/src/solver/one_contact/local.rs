//! One contact by itself: its block of the problem, its solutions, and the choice between them.

use asperity_set::{Matrix, StarSet, Vector};

use super::block::{Block, MARGIN};
use super::single::{self, SOLUTION, Single};
use super::solution::LocalSolution;
use crate::contact::{ContactRows, ContactState, NormalForce, Phase};
use crate::law::FrictionLaw;
use crate::solver::measure::approach::UNRESOLVED;

/// Part of the percussions by which refinement may change them; more would lead to another solution.
const NEAR: f64 = 1e-3;

/// One contact with the percussions of all others held: `γ = G_ii P + b` with these data.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Local<'a, const P: usize> {
    pub(crate) law: &'a FrictionLaw<P>,
    pub(crate) block: &'a Block,
    /// Prescribed normal percussion.
    pub(crate) prescribed: Option<f64>,
    pub(crate) b_n: f64,
    pub(crate) b_t: Vector<P>,
}

/// The percussions that stick needs, whether or not the contact can transmit them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stick<const P: usize> {
    normal: f64,
    pub(crate) tangent: Vector<P>,
}

impl<const P: usize> Stick<P> {
    /// `−P_T/P_N`.
    #[inline(always)]
    pub(crate) fn load(&self) -> Vector<P> {
        self.tangent * (-1.0 / self.normal)
    }

    /// `k_C(−P_T/P_N)`.
    #[inline(always)]
    pub(crate) fn gauge(&self, law: &FrictionLaw<P>) -> f64 {
        law.reservoir().gauge(&self.load())
    }

    /// Whether the contact can transmit them, where friction has a factor.
    #[inline(always)]
    pub(crate) fn holds(&self, law: &FrictionLaw<P>, factor: f64) -> bool {
        // The comparisons also turn away NaN. Isotropic friction needs neither root nor division.
        let normal = self.normal * (factor * (1.0 + 4.0 * f64::EPSILON));
        normal > 0.0
            && match law.isotropic_coefficient() {
                Some(mu) => self.tangent.norm_squared() <= (mu * normal).powi(2),
                None => law.reservoir().gauge(&-self.tangent) <= normal,
            }
    }

    /// Whether the contact can transmit them, and whether even if they were larger by more than rounding.
    #[inline(always)]
    pub(crate) fn holds_well(&self, law: &FrictionLaw<P>) -> (bool, bool) {
        let gauge = self.gauge(law);
        let holds = self.normal > 0.0 && gauge <= 1.0 + 4.0 * f64::EPSILON;
        (holds, holds && gauge < 1.0 - SOLUTION)
    }

    /// The solution, where it holds.
    #[inline(always)]
    pub(crate) fn solution(&self) -> LocalSolution<P> {
        LocalSolution::new(Phase::Stick, self.normal, self.tangent, Vector::zeros())
    }
}

/// Vectors of R² cut to R^P.
#[inline(always)]
fn cut<const P: usize>(v: &Vector<2>) -> Vector<P> {
    Vector::from_fn(|i, _| v[i])
}

#[inline(always)]
fn cut_matrix<const P: usize>(m: &Matrix<2>) -> Matrix<P> {
    Matrix::from_fn(|i, j| m[(i, j)])
}

impl<'a, const P: usize> Local<'a, P> {
    /// The contact with the velocities `held` that the other contacts leave it.
    #[inline(always)]
    pub(crate) fn new(
        law: &'a FrictionLaw<P>,
        rows: &ContactRows,
        block: &'a Block,
        held: &[f64; 4],
    ) -> Self {
        let [normal, tangential @ ..] = held;
        let (prescribed, b_n, b_t) = match rows.normal {
            NormalForce::Prescribed(force) => {
                (Some(force), 0.0, Vector::<P>::from_fn(|i, _| held[i]))
            }
            NormalForce::Unilateral => (None, *normal, Vector::<P>::from_fn(|i, _| tangential[i])),
        };
        Self { law, block, prescribed, b_n, b_t }
    }

    /// `(c₀, A)` with the slip velocity `v(x) = c₀ − A x`, up to the factor [`denominator`](Self::denominator), which is
    /// positive where a normal force presses.
    #[inline]
    pub(crate) fn affine(&self) -> (Vector<P>, Matrix<P>) {
        let block = self.block;
        let g_tt = cut_matrix(&block.g_tt);
        match self.prescribed {
            Some(normal) => (self.b_t, g_tt * normal),
            None => {
                let (pressure, (g_nn, g_nt)) = (self.b_n.abs(), self.normal_row());
                (
                    self.b_t * g_nn + cut::<P>(&block.g_tn) * pressure,
                    self.b_t * g_nt.transpose() + g_tt * pressure,
                )
            }
        }
    }

    /// `∓(g_NN − G_NT x)` with the sign of `b_N`, one for a prescribed normal force: `P_N = |b_N|/den`, `γ = v/den`.
    #[inline]
    pub(crate) fn denominator(&self, x: &Vector<P>) -> f64 {
        if self.prescribed.is_some() {
            return 1.0;
        }
        let (g_nn, g_nt) = self.normal_row();
        g_nn - g_nt.dot(x)
    }

    /// `∓(g_NN, G_NT)`: a normal force presses where `g_NN − G_NT x` has the sign of `−b_N`.
    #[inline]
    fn normal_row(&self) -> (f64, Vector<P>) {
        let sign = -self.b_n.signum();
        (self.block.g_nn * sign, cut::<P>(&self.block.g_nt) * sign)
    }

    /// The denominator above which `c₀ − A x` over it keeps twelve digits.
    #[inline]
    pub(crate) fn least_denominator(&self) -> f64 {
        if self.prescribed.is_some() { 0.0 } else { 1e-4 * self.block.g_nn }
    }

    /// The denominator below which it is rounding, or percussions are so large that nothing is left of the digits of
    /// velocities, for forces of size `radius`: percussions without bound are no solution. Where the block has rank one,
    /// every slip velocity times the denominator vanishes together with it.
    pub(crate) fn vanishing_denominator(&self, radius: f64) -> f64 {
        if self.prescribed.is_some() {
            return 0.0;
        }
        let size = self.block.g_nn.abs() + self.block.g_nt.norm() * radius;
        let unresolved = self.b_n.abs() / (UNRESOLVED * self.b_n.abs().max(self.b_t.amax()));
        size * f64::max(16.0 * f64::EPSILON, unresolved)
    }

    /// The slip solution with `−P_T = P_N x`.
    #[inline(always)]
    pub(crate) fn slip(&self, x: &Vector<P>, v: &Vector<P>) -> LocalSolution<P> {
        let denominator = self.denominator(x);
        let normal = self.prescribed.unwrap_or(self.b_n.abs() / denominator);
        LocalSolution::new(Phase::Slip, normal, x * -normal, v * (1.0 / denominator))
    }

    /// Whether the contact opens, or has no normal force.
    pub(crate) fn opens(&self) -> bool {
        self.prescribed.map_or(self.b_n >= 0.0, |normal| normal == 0.0)
    }

    /// Open contact with the tangential velocity it then has.
    pub(crate) fn open(&self) -> LocalSolution<P> {
        LocalSolution::new(Phase::Open, 0.0, Vector::zeros(), self.b_t)
    }

    /// The stick solution, if there is one, with a block of any rank.
    #[inline]
    pub(crate) fn any_stick(&self) -> Option<LocalSolution<P>> {
        if !self.block.sound {
            let single = self.single();
            return single.stick().map(|found| single.solution(&found, Phase::Stick));
        }
        let stick = self.stick();
        stick.holds(self.law, 1.0).then(|| stick.solution())
    }

    /// The percussions with `γ = 0`, with a sound block.
    #[inline(always)]
    pub(crate) fn stick(&self) -> Stick<P> {
        let block = self.block;
        let load = self.b_t - cut::<P>(&block.g_tn) * (self.b_n * block.inverse_nn);
        let tangent = -(cut_matrix::<P>(&block.schur_inverse) * load);
        let lifted = || -(self.b_n + cut::<P>(&block.g_nt).dot(&tangent)) * block.inverse_nn;
        Stick { normal: self.prescribed.unwrap_or_else(lifted), tangent }
    }

    /// Stick with the force on the border of the reservoir, where rounding decides whether the force that stick needs
    /// is one that the contact can transmit: where normal and tangential rows are coupled, slip may end at the
    /// same force, so that nothing would be left.
    #[cold]
    #[inline(never)]
    pub(crate) fn stick_on_border(&self) -> Option<LocalSolution<P>> {
        let stick = self.stick();
        let (load, gauge) = (stick.load(), stick.gauge(self.law));
        // The comparison also turns away NaN.
        if !((gauge - 1.0).abs() <= NEAR) {
            return None;
        }
        let x = load / gauge;
        let stick = self.slip(&x, &Vector::zeros());
        let single = self.single();
        let found = single.graded(single.percussion(&stick), false);
        (stick.normal > 0.0 && found.defect <= SOLUTION)
            .then_some(LocalSolution { phase: Phase::Stick, ..stick })
    }

    /// Whether the contact can neither open nor stick, with a relative margin. Blocks without a sound inverse
    /// prove nothing, and a contact with a prescribed normal percussion always has a solution: an affine map
    /// on a compact convex set that always points away from it.
    pub(crate) fn excludes_open_and_stick(&self) -> bool {
        if self.prescribed.is_some() || !self.block.sound {
            return false;
        }
        let load = self.b_n.hypot(self.b_t.norm());
        // The comparisons also turn away NaN.
        if !(self.b_n < -MARGIN * load && load < f64::MAX) {
            return false;
        }
        let Stick { normal, tangent } = self.stick();
        let along = cut::<P>(&self.block.g_nt).dot(&tangent);
        let size = (self.b_n.abs() + along.abs()) * self.block.inverse_nn;
        let gauge = self.law.reservoir().gauge(&-tangent);
        normal < -MARGIN * size || normal > MARGIN * size && gauge > normal * (1.0 + MARGIN)
    }

    /// The contact as a dense problem, for what closed forms do not reach.
    #[cold]
    #[inline(never)]
    pub(crate) fn single(&self) -> Single<'a, P> {
        let block = self.block;
        let first = usize::from(self.prescribed.is_none());
        let entry = |i: usize, j: usize| match (i.checked_sub(first), j.checked_sub(first)) {
            (None, None) => block.g_nn,
            (None, Some(j)) => block.g_nt[j],
            (Some(i), None) => block.g_tn[i],
            (Some(i), Some(j)) => block.g_tt[(i, j)],
        };
        let load = |i: usize| i.checked_sub(first).map_or(self.b_n, |i| self.b_t[i]);
        Single::new(self.law, self.prescribed.into(), entry, load)
    }

    /// A solution to the last digits, by Newton's method on all rows together; `None` for what only looked
    /// like a solution.
    pub(crate) fn refined(&self, found: &LocalSolution<P>) -> Option<LocalSolution<P>> {
        let single = self.single();
        let percussion = single.percussion(found);
        let start = single.graded(percussion, found.degenerate);
        if start.defect <= single::ROUNDING {
            return Some(*found);
        }
        let end = single.refined(start);
        let near = (end.percussion - percussion).norm() <= NEAR * percussion.norm();
        let end = if near { end } else { start };
        let largest = if found.degenerate { 1e-7 } else { 1e-9 };
        (end.defect <= largest).then(|| single.solution(&end, found.phase))
    }

    /// The selection rule: the solution that continues the previous state.
    ///
    /// A contact that can open, opens. A slipping contact takes the slip solution whose direction is
    /// nearest to the last one, else it sticks. Any other contact sticks if it can, else it takes the
    /// slip solution nearest to the last direction, or to the free velocity if there is none.
    pub(crate) fn select<'s>(
        &self,
        all: impl Iterator<Item = &'s LocalSolution<P>> + Clone,
        state: &ContactState,
    ) -> Option<LocalSolution<P>> {
        let of = |phase: Phase| all.clone().find(|s| s.phase == phase);
        let last = Vector::<P>::from_fn(|i, _| state.slip[i]);
        let aim = if last.amax() > 0.0 { last } else { self.b_t };
        let nearness = |s: &LocalSolution<P>| s.slip.normalize().dot(&aim);
        let slips = all.clone().filter(|s| s.phase == Phase::Slip);
        let nearest = slips.max_by(|a, b| nearness(a).total_cmp(&nearness(b)));
        let closed = match state.phase {
            Phase::Slip => nearest.or_else(|| of(Phase::Stick)),
            _ => of(Phase::Stick).or(nearest),
        };
        let ambiguous = all.clone().count() > 1 || all.clone().any(|s| s.degenerate);
        of(Phase::Open).or(closed).map(|found| LocalSolution { ambiguous, ..*found })
    }
}

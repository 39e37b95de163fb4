//! One contact by itself: its block of the problem, its solutions, and the choice between them.

use asperity_set::{Matrix, StarSet, Vector};

use super::block::Block;
use crate::contact::{ContactProblem, ContactRows, ContactState, NormalForce, Phase};
use crate::law::FrictionLaw;

/// One contact with the percussions of all others held: `γ = G_ii P + b` with these data.
#[derive(Debug, Clone, Copy)]
pub(super) struct Local<'a, const P: usize> {
    pub(super) law: &'a FrictionLaw<P>,
    pub(super) block: &'a Block,
    /// Prescribed normal percussion.
    pub(super) prescribed: Option<f64>,
    pub(super) b_n: f64,
    pub(super) b_t: Vector<P>,
}

/// A solution of one contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LocalSolution<const P: usize> {
    /// What the contact does.
    pub phase: Phase,
    /// Normal percussion.
    pub normal: f64,
    /// Tangential percussion.
    pub tangent: Vector<P>,
    /// Tangential velocity `ξ`.
    pub slip: Vector<P>,
    /// Not isolated, or a double root: perturbing the data may remove or split it.
    pub degenerate: bool,
}

/// The stick solution, if it is one, and the gauge `k_C(−P_T/P_N)` of the force it needs.
pub(super) struct Stick<const P: usize> {
    /// `−P_T/P_N`.
    pub(super) load: Vector<P>,
    pub(super) solution: Option<LocalSolution<P>>,
    pub(super) gauge: f64,
}

/// A chosen solution, and whether there were others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Selection<const P: usize> {
    /// The solution.
    pub solution: LocalSolution<P>,
    /// Whether the contact has more than one solution.
    pub ambiguous: bool,
}

/// Vectors of R² cut to R^P.
#[inline(always)]
fn cut<const P: usize>(v: &Vector<2>) -> Vector<P> {
    let mut out = Vector::zeros();
    for i in 0..P {
        out[i] = v[i];
    }
    out
}

#[inline(always)]
fn cut_matrix<const P: usize>(m: &Matrix<2>) -> Matrix<P> {
    let mut out = Matrix::<P>::zeros();
    for j in 0..P {
        for i in 0..P {
            out[(i, j)] = m[(i, j)];
        }
    }
    out
}

impl<'a, const P: usize> Local<'a, P> {
    /// The problem of one contact with the other contacts' percussions held.
    #[inline(always)]
    pub(super) fn new(
        law: &'a FrictionLaw<P>,
        problem: &ContactProblem,
        contact: usize,
        block: &'a Block,
        percussion: &[f64],
    ) -> Self {
        let rows = &problem.contacts[contact];
        let held = problem.contact_velocity(contact, percussion, false);
        Self::from_held(law, rows, block, &held)
    }

    /// The contact with the velocities `held` that the other contacts leave it.
    #[inline(always)]
    pub(super) fn from_held(
        law: &'a FrictionLaw<P>,
        rows: &ContactRows,
        block: &'a Block,
        held: &[f64; 4],
    ) -> Self {
        let (prescribed, b_n) = match rows.normal {
            NormalForce::Prescribed(value) => (Some(value), 0.0),
            NormalForce::Unilateral => (None, held[0]),
        };
        let first = rows.normal_rows();
        let b_t = Vector::<P>::from_fn(|i, _| held[first + i]);
        Self { law, block, prescribed, b_n, b_t }
    }

    /// `(c₀, A)` with the slip velocity `v(x) = c₀ − A x`, up to the positive or negative factor
    /// [`denominator`](Self::denominator).
    #[inline]
    pub(super) fn affine(&self) -> (Vector<P>, Matrix<P>) {
        let block = self.block;
        let g_tt = cut_matrix(&block.g_tt);
        match self.prescribed {
            Some(normal) => (self.b_t, g_tt * normal),
            None => (
                self.b_t * block.g_nn - cut::<P>(&block.g_tn) * self.b_n,
                self.b_t * cut::<P>(&block.g_nt).transpose() - g_tt * self.b_n,
            ),
        }
    }

    /// `g_NN − G_NT x`, one for a prescribed normal force: `P_N = −b_N/den`, `γ = v/den`.
    #[inline]
    pub(super) fn denominator(&self, x: &Vector<P>) -> f64 {
        if self.prescribed.is_some() {
            1.0
        } else {
            self.block.g_nn - cut::<P>(&self.block.g_nt).dot(x)
        }
    }

    /// The sign that the denominator and `n·v` must have in slip.
    #[inline]
    pub(super) fn sign(&self) -> f64 {
        if self.prescribed.is_none() && self.b_n > 0.0 { -1.0 } else { 1.0 }
    }

    /// The slip solution with `−P_T = P_N x`.
    pub(super) fn slip(&self, x: &Vector<P>, v: &Vector<P>, degenerate: bool) -> LocalSolution<P> {
        let denominator = self.denominator(x);
        let normal = self.prescribed.unwrap_or(-self.b_n / denominator);
        let tangent = x * -normal;
        let slip = v * (1.0 / denominator);
        LocalSolution { phase: Phase::Slip, normal, tangent, slip, degenerate }
    }

    /// Open contact with the tangential velocity it then has.
    pub(super) fn open(&self) -> LocalSolution<P> {
        let (phase, tangent) = (Phase::Open, Vector::zeros());
        LocalSolution { phase, normal: 0.0, tangent, slip: self.b_t, degenerate: false }
    }

    /// The percussion with `γ = 0`, whether or not the contact can transmit it.
    #[inline(always)]
    pub(super) fn stick(&self) -> Stick<P> {
        let block = self.block;
        let inverse: Matrix<P> = cut_matrix(&block.schur_inverse);
        let load = match self.prescribed {
            Some(_) => self.b_t,
            None => self.b_t - cut::<P>(&block.g_tn) * (self.b_n / block.g_nn),
        };
        let tangent = -(inverse * load);
        let normal = self
            .prescribed
            .unwrap_or_else(|| -(self.b_n + cut::<P>(&block.g_nt).dot(&tangent)) / block.g_nn);
        let load = tangent * (-1.0 / normal);
        let gauge = self.law.reservoir().gauge(&load);
        // The comparisons also turn away NaN.
        let inside = normal > 0.0 && gauge <= 1.0 + 4.0 * f64::EPSILON;
        if !inside || block.singular && !self.sticks(normal, &tangent) {
            return Stick { load, solution: None, gauge };
        }
        let (phase, slip, degenerate) = (Phase::Stick, Vector::zeros(), block.singular);
        Stick {
            solution: Some(LocalSolution { phase, normal, tangent, slip, degenerate }),
            load,
            gauge,
        }
    }

    /// Whether these percussions do stop the slip, which is not certain with a singular block.
    fn sticks(&self, normal: f64, tangent: &Vector<P>) -> bool {
        let block = self.block;
        let slip: Vector<P> =
            cut_matrix(&block.g_tt) * tangent + cut::<P>(&block.g_tn) * normal + self.b_t;
        slip.norm() <= 1e-10 * self.b_t.norm()
    }

    /// The selection rule: the solution that continues the previous state.
    ///
    /// A contact that can open, opens. A slipping contact takes the slip solution whose direction is
    /// nearest to the last one, else it sticks. Any other contact sticks if it can, else it takes the
    /// slip solution nearest to the last direction, or to the free velocity if there is none.
    pub(super) fn select(
        &self,
        all: &[LocalSolution<P>],
        state: &ContactState,
    ) -> Option<LocalSolution<P>> {
        let of = |phase: Phase| all.iter().find(|s| s.phase == phase).copied();
        let last = Vector::<P>::from_fn(|i, _| state.slip[i]);
        let aim = if last.amax() > 0.0 { last } else { self.b_t };
        let nearness = |s: &LocalSolution<P>| s.slip.normalize().dot(&aim);
        let nearest = all
            .iter()
            .filter(|s| s.phase == Phase::Slip)
            .max_by(|a, b| nearness(a).total_cmp(&nearness(b)))
            .copied();
        let closed = match state.phase {
            Phase::Slip => nearest.or_else(|| of(Phase::Stick)),
            _ => of(Phase::Stick).or(nearest),
        };
        of(Phase::Open).or(closed)
    }
}

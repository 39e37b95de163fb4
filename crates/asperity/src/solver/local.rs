//! One contact by itself: its block of the problem, its solutions, and the choice between them.

use asperity_set::{Matrix, StarSet, Vector};
use nalgebra::DMatrix;

use super::Workspace;
use crate::contact::{ContactProblem, ContactRows, ContactState, NormalForce, Phase};
use crate::law::{FrictionLaw, Law};

/// The diagonal block of `G` for one contact, unused components zero.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block {
    pub(super) g_nn: f64,
    pub(super) g_nt: Vector<2>,
    pub(super) g_tn: Vector<2>,
    pub(super) g_tt: Matrix<2>,
    /// Inverse of the Schur complement `G_TT − G_TN G_NT/g_NN`, or of `G_TT` without a normal row; a
    /// pseudo-inverse where that is singular.
    pub(super) schur_inverse: Matrix<2>,
    pub(super) singular: bool,
    /// Whether the contact is unilateral and no friction force can pull it towards the surface.
    pub(super) pressed: bool,
    /// What is known of the slip equation before the loads are: only where the normal force is
    /// prescribed is its matrix `A` a multiple of `G_TT`.
    pub(super) shape: Shape,
}

impl Block {
    pub(super) fn new(problem: &ContactProblem, contact: usize) -> Self {
        let rows = &problem.contacts[contact];
        let p = rows.law.dimension().min(2);
        let t = rows.normal_rows();
        let g = |i: usize, j: usize| problem.delassus.own(contact, rows.offset, i, j);
        let within = |i: usize| i < p;
        let unilateral = rows.normal_rows() == 1;
        let pick = |used: bool, i: usize, j: usize| if used { g(i, j) } else { 0.0 };
        let g_nn = pick(unilateral, 0, 0);
        let g_nt = Vector::<2>::from_fn(|j, _| pick(unilateral && within(j), 0, t + j));
        let g_tn = Vector::<2>::from_fn(|i, _| pick(unilateral && within(i), t + i, 0));
        let g_tt = Matrix::<2>::from_fn(|i, j| pick(within(i) && within(j), t + i, t + j));
        let schur = if unilateral { g_tt - g_tn * g_nt.transpose() / g_nn } else { g_tt };
        let determinant = schur.determinant();
        let singular = match p {
            1 => schur.m11.abs() <= 1e-13 * g_tt.m11,
            _ => determinant.abs() <= 1e-13 * g_tt.norm_squared(),
        };
        let schur_inverse = match (p, singular) {
            (1, false) => Matrix::<2>::new(1.0 / schur.m11, 0.0, 0.0, 0.0),
            (1, true) => Matrix::zeros(),
            (_, false) => schur.try_inverse().unwrap_or_default(),
            (_, true) => pseudo_inverse(&schur),
        };
        let shape = match &rows.law {
            Law::Two(law) if !unilateral => Shape::new(&g_tt, law.bounds().smallest_sine),
            _ => Shape::General,
        };
        let radius = match &rows.law {
            Law::One(law) => law.largest_radius(),
            Law::Two(law) => law.bounds().largest_radius,
            Law::Three(law) => law.largest_radius(),
        };
        let beside = (t..rows.len()).map(|j| g(0, j) * g(0, j)).sum::<f64>().sqrt();
        let pressed = unilateral && g_nn > beside * radius;
        Self { g_nn, g_nt, g_tn, g_tt, schur_inverse, singular, pressed, shape }
    }
}

/// What the matrix `A` of the slip equation `n × (c₀ − A x) = 0` says of the number of its solutions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shape {
    /// Never more than one solution.
    Monotone,
    /// `A = aI`: one solution but for loads of certain gauges.
    Scalar,
    /// Nothing.
    General,
}

impl Shape {
    /// The O(1) certificate of uniqueness: `n × (A x') > 0` all along the boundary.
    ///
    /// The angle from `n` to the tangent `x'` of *C* has a sine of at least `m`; `A` is a rotation by δ
    /// times r plus a trace-free part of norm d, so it turns `x'` by at most `|δ| + asin(d/r)`, which
    /// must be less than `asin m`.
    #[inline]
    pub(super) fn new(a: &Matrix<2>, smallest_sine: f64) -> Self {
        let (along, across) = (0.5 * (a.m11 + a.m22), 0.5 * (a.m21 - a.m12));
        let r = along.hypot(across);
        let d = (0.5 * (a.m11 - a.m22)).hypot(0.5 * (a.m12 + a.m21));
        if !(along > 0.0 && d < r) {
            return Self::General;
        }
        let (sine_delta, cosine_delta) = (across.abs() / r, along / r);
        let sine_d = d / r;
        let cosine_d = (1.0 - sine_d * sine_d).sqrt();
        let sine = sine_delta * cosine_d + cosine_delta * sine_d;
        let cosine = cosine_delta * cosine_d - sine_delta * sine_d;
        if cosine > 0.0 && sine < smallest_sine - 1e-9 {
            Self::Monotone
        } else if sine_delta.max(sine_d) <= 1e-14 {
            Self::Scalar
        } else {
            Self::General
        }
    }
}

/// Moore–Penrose inverse with the small singular value cut off.
fn pseudo_inverse(matrix: &Matrix<2>) -> Matrix<2> {
    let dynamic = DMatrix::from_column_slice(2, 2, matrix.as_slice());
    match dynamic.pseudo_inverse(1e-6 * matrix.norm()) {
        Ok(inverse) => Matrix::<2>::from_column_slice(inverse.as_slice()),
        Err(_) => Matrix::zeros(),
    }
}

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

/// Phases and slip directions of the percussions and velocities of an iteration.
pub(super) fn classify(problem: &ContactProblem, workspace: &mut Workspace) {
    let Workspace { percussion, velocity, states, .. } = workspace;
    for (contact, state) in states.iter_mut().enumerate() {
        let (phase, slip) = phase_of(problem, contact, percussion, velocity);
        *state = state.after(phase, slip);
    }
}

/// Phase and slip velocity of a contact, whose percussions and velocities come with errors of the size of
/// an iteration's tolerance.
pub(super) fn phase_of(
    problem: &ContactProblem,
    contact: usize,
    percussion: &[f64],
    velocity: &[f64],
) -> (Phase, [f64; 3]) {
    let rows = &problem.contacts[contact];
    let own = |i: usize| {
        let i = rows.normal_rows() + i;
        problem.delassus.own(contact, rows.offset, i, i)
    };
    let normal = match rows.normal {
        NormalForce::Prescribed(value) => value,
        NormalForce::Unilateral => percussion[rows.offset],
    };
    let first = rows.tangent();
    let gauge = match &rows.law {
        Law::One(law) => reservoir_gauge(law, normal, &percussion[first..]),
        Law::Two(law) => reservoir_gauge(law, normal, &percussion[first..]),
        Law::Three(law) => reservoir_gauge(law, normal, &percussion[first..]),
    };
    let mut slip = [0.0; 3];
    let (mut moving, mut reference) = (0.0_f64, 0.0_f64);
    for (i, component) in slip.iter_mut().enumerate().take(rows.law.dimension()) {
        *component = velocity[first + i] + problem.restitution[first + i];
        moving = moving.max(component.abs());
        reference = reference
            .max(problem.free_velocity[first + i].abs())
            .max((own(i) * percussion[first + i]).abs());
    }
    // The switch of the natural map: an iteration leaves tiny percussions at contacts that open.
    let opens = rows.normal == NormalForce::Unilateral && {
        let xi = velocity[rows.offset] + problem.restitution[rows.offset];
        normal <= problem.rho[contact] * xi
    };
    let phase = if normal <= 0.0 || opens {
        Phase::Open
    } else if gauge >= 1.0 - 1e-9 && moving > 1e-13 * reference {
        Phase::Slip
    } else {
        Phase::Stick
    };
    (phase, slip)
}

fn reservoir_gauge<const P: usize>(law: &FrictionLaw<P>, normal: f64, tangent: &[f64]) -> f64 {
    law.reservoir().gauge(&Vector::<P>::from_fn(|i, _| -tangent[i] / normal))
}

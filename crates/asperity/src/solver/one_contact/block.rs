//! The diagonal block of one contact, prepared for its solution.

use asperity_set::{Matrix, Vector};

use crate::contact::ContactProblem;
use crate::law::Bounds;

/// Part of the square of its size that the determinant of a sound block has at least: the inverse then keeps
/// twelve digits.
pub(super) const SOUND: f64 = 1e-4;
/// Relative margin of every inequality of a proof: what rounding, or data that are known to nine digits, could
/// turn round proves nothing.
pub(super) const MARGIN: f64 = 1e-9;

/// The diagonal block of `G` for one contact, unused components zero.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Block {
    pub(crate) g_nn: f64,
    /// `1/g_NN`.
    pub(crate) inverse_nn: f64,
    pub(crate) g_nt: Vector<2>,
    pub(crate) g_tn: Vector<2>,
    pub(crate) g_tt: Matrix<2>,
    /// Inverse of the Schur complement `G_TT − G_TN G_NT/g_NN`, or of `G_TT` without a normal row; zero
    /// where the block is not sound.
    pub(crate) schur_inverse: Matrix<2>,
    /// Whether the inverse keeps its digits. Stick with any other block is found from its singular values.
    pub(crate) sound: bool,
    /// Whether the contact is unilateral and no friction force can pull it towards the surface.
    pub(crate) normal_dominates: bool,
    /// What is known of the slip equation before the loads are: only where the normal force is
    /// prescribed is its matrix `A` a multiple of `G_TT`.
    pub(crate) shape: Shape,
    /// Free slip velocity, per approach velocity `−b_N` or prescribed percussion, beyond which the contact has one
    /// solution, see [`least_slip`](Self::least_slip).
    pub(crate) slip_certificate: f64,
}

impl Block {
    pub(crate) fn new(problem: &ContactProblem, contact: usize) -> Self {
        let rows = &problem.contacts()[contact];
        let p = rows.law.dimension().min(2);
        let t = rows.normal_rows();
        let g = |i: usize, j: usize| problem.delassus().own(contact, i, j);
        let within = |i: usize| i < p;
        let unilateral = rows.normal_rows() == 1;
        let pick = |used: bool, i: usize, j: usize| if used { g(i, j) } else { 0.0 };
        let g_nn = pick(unilateral, 0, 0);
        let g_nt = Vector::<2>::from_fn(|j, _| pick(unilateral && within(j), 0, t + j));
        let g_tn = Vector::<2>::from_fn(|i, _| pick(unilateral && within(i), t + i, 0));
        let g_tt = Matrix::<2>::from_fn(|i, j| pick(within(i) && within(j), t + i, t + j));
        let schur = if unilateral { g_tt - g_tn * g_nt.transpose() / g_nn } else { g_tt };
        // The determinant against squares of sizes: what is left of the digits of the Schur complement. A
        // row and column of any unit in place of the normal ones leave it as it is.
        let (left, whole) = match p {
            1 => (schur.m11.abs(), g_tt.m11.abs().max(schur.m11.abs())),
            _ => (schur.determinant().abs(), g_tt.norm_squared().max(schur.norm_squared())),
        };
        // The comparison also turns away what is not a number.
        let sound = left > SOUND * whole;
        let schur_inverse = match (p, sound) {
            (_, false) => Matrix::zeros(),
            (1, true) => Matrix::<2>::new(1.0 / schur.m11, 0.0, 0.0, 0.0),
            (_, true) => schur.try_inverse().unwrap_or_default(),
        };
        let inverse_nn = if unilateral { 1.0 / g_nn } else { 0.0 };
        let (normal_dominates, shape, slip_certificate) = (false, Shape::General, f64::INFINITY);
        let mut block = Self {
            g_nn,
            inverse_nn,
            g_nt,
            g_tn,
            g_tt,
            schur_inverse,
            sound,
            normal_dominates,
            shape,
            slip_certificate,
        };
        // A contact with drilling friction opens before anything else is asked.
        if let Some(bounds) = rows.law.bounds() {
            let resistance =
                if unilateral { g_nn - g_nt.norm() * bounds.largest_radius } else { 1.0 };
            block.normal_dominates = unilateral && resistance > 0.0;
            if !unilateral && p == 2 {
                block.shape = Shape::new(&g_tt, bounds.smallest_sine);
            }
            if resistance > 0.0 {
                block.slip_certificate = block.least_slip(&bounds, resistance);
            }
        }
        block
    }

    /// The free slip velocity `‖b_T‖`, per `−b_N` or prescribed percussion, beyond which there is one solution, a slip.
    ///
    /// Under the force `x` the contact slips with `γ(x) = b_T + P_N (G_TN − G_TT x)`, where `P_N = −b_N/den(x)` is at
    /// most `P = −b_N/den` with the least denominator, the `resistance`. In the disk `‖x‖ ≤ R` about *C*
    ///
    /// - `‖γ‖ ≥ ‖b_T‖ − P S` with `S = ‖G_TN‖ + ‖G_TT‖ R`: no force stops the slip if that is positive;
    /// - `‖∂γ/∂x‖ ≤ P Λ` with `Λ = ‖G_TT‖ + ‖G_NT‖ S/den`.
    ///
    /// If `x` moves by at most `L` per angle of the normal `n` of *D*, `γ` turns by less than `n` all along the boundary
    /// where `P Λ L < ‖b_T‖ − P S`. The angle from `γ` to `n` then never falls, it grows by one turn, since `γ` does not
    /// vanish within, and it is zero once.
    fn least_slip(&self, bounds: &Bounds, resistance: f64) -> f64 {
        let Bounds { largest_radius, largest_advance, .. } = bounds;
        let tangential = self.g_tt.norm();
        let brought = self.g_tn.norm() + tangential * largest_radius;
        let steepness = tangential + self.g_nt.norm() * brought / resistance;
        (1.0 + MARGIN) * (brought + steepness * largest_advance) / resistance
    }
}

/// What the matrix `A` of the slip equation `n × (c₀ − A x) = 0` says of the number of its solutions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Shape {
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
    pub(crate) fn new(a: &Matrix<2>, smallest_sine: f64) -> Self {
        let (along, across) = (0.5 * (a.m11 + a.m22), 0.5 * (a.m21 - a.m12));
        let length = |x: f64, y: f64| (x * x + y * y).sqrt();
        let r = length(along, across);
        let d = length(0.5 * (a.m11 - a.m22), 0.5 * (a.m12 + a.m21));
        if !(along > 0.0 && d < r) {
            return Self::General;
        }
        let (sine_delta, cosine_delta) = (across.abs() / r, along / r);
        let sine_d = d / r;
        let cosine_d = (1.0 - sine_d * sine_d).sqrt();
        let sine = sine_delta * cosine_d + cosine_delta * sine_d;
        let cosine = cosine_delta * cosine_d - sine_delta * sine_d;
        if cosine > 0.0 && sine < smallest_sine - MARGIN {
            Self::Monotone
        } else if sine_delta.max(sine_d) <= 1e-14 {
            Self::Scalar
        } else {
            Self::General
        }
    }
}

//! Derivatives of projections.
//!
//! `prox` does not expand and is the gradient of a convex function: an element `J` of its generalised Jacobian
//! is symmetric with eigenvalues between 0 and 1. Outside the set it vanishes along the normal.

use crate::numeric::vectors::{cast, quarter_turn, tangents};
use crate::{ConvexSet, Matrix, Vector};

/// Distances from the set below this part of the size are rounding: the point counts as inside.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// Distances below this part of the size leave too few digits of the normal.
const NEAR: f64 = 1e-6;
/// Part of the size by which points are moved for differences.
const STEP: f64 = 6e-6;

/// Unit normal at the proximal point `x` of `z` and the distance of the two; `None` inside.
pub(crate) fn normal<const P: usize, S: ConvexSet<P> + ?Sized>(
    set: &S,
    z: &Vector<P>,
    x: &Vector<P>,
) -> Option<(Vector<P>, f64)> {
    let away = z - x;
    let (distance, size) = (away.norm(), x.norm());
    if distance <= ROUNDING * size {
        return None;
    }
    let away = if distance > NEAR * size { away } else { set.gauge_jet(x).1 };
    Some((away.normalize(), distance))
}

/// Proximal point and Jacobian by central differences in the directions of the tangents.
pub(crate) fn by_differences<const P: usize, S: ConvexSet<P> + ?Sized>(
    set: &S,
    z: &Vector<P>,
    start: &Vector<P>,
) -> (Vector<P>, Matrix<P>) {
    let x = set.project_from(z, start);
    let Some((n, _)) = normal(set, z, &x) else { return (x, Matrix::identity()) };
    let step = STEP * z.norm();
    let slope = |t: &Vector<P>| {
        let shift = t * step;
        (set.project_from(&(z + shift), &x) - set.project_from(&(z - shift), &x)) / (2.0 * step)
    };
    (x, across(&n, slope))
}

/// The Jacobian whose slopes in the directions of the tangents these are but for rounding: symmetric, its eigenvalues
/// between 0 and 1, and none across.
pub(crate) fn across<const P: usize>(
    n: &Vector<P>,
    slope: impl Fn(&Vector<P>) -> Vector<P>,
) -> Matrix<P> {
    match P {
        1 => Matrix::zeros(),
        2 => {
            let t: Vector<P> = cast(&quarter_turn(&cast(n)));
            t * t.transpose() * t.dot(&slope(&t)).clamp(0.0, 1.0)
        }
        _ => {
            let [s, t] = tangents(n);
            let (ds, dt) = (slope(&s), slope(&t));
            let across = 0.5 * (s.dot(&dt) + t.dot(&ds));
            let inner = Matrix::<2>::new(s.dot(&ds), across, across, t.dot(&dt));
            let eigen = inner.symmetric_eigen();
            let pairs = eigen.eigenvectors.column_iter().zip(eigen.eigenvalues.iter());
            pairs.fold(Matrix::zeros(), |sum, (axis, value)| {
                let axis = s * axis[0] + t * axis[1];
                sum + axis * axis.transpose() * value.clamp(0.0, 1.0)
            })
        }
    }
}

/// `H (H + d I)⁻¹` across the unit normal `n`, with the Hessian `H` of the support function at `n`, for
/// `x = ∇h(n)`, `z = x + d n`.
///
/// With the trace τ and the sum δ of the principal minors of `H/d` the inverse is a polynomial (Cayley and
/// Hamilton): `(H/d + δ (I − nnᵀ))/(1 + τ + δ)`.
pub(crate) fn from_curvature<const P: usize>(
    n: &Vector<P>,
    distance: f64,
    hessian: &Matrix<P>,
) -> Matrix<P> {
    let bend = hessian / distance;
    let minor = |i: usize, j: usize| bend[(i, i)] * bend[(j, j)] - bend[(i, j)].powi(2);
    let pairs = (0..P).flat_map(|i| (0..i).map(move |j| (i, j)));
    let minors = if P < 3 { 0.0 } else { pairs.map(|(i, j)| minor(i, j)).sum::<f64>().max(0.0) };
    let plane = Matrix::identity() - n * n.transpose();
    (bend + plane * minors) / (1.0 + bend.trace() + minors)
}

/// `S − S g gᵀS/(gᵀS g)` with a diagonal `S`: how `x` follows `z` where `S⁻¹ dx + g dβ = dz` and `g·dx = 0`.
///
/// The diagonal is taken as a sum over the other axes, which does not cancel.
#[inline]
pub(crate) fn on_level<const P: usize>(s: &Vector<P>, g: &Vector<P>) -> Matrix<P> {
    let pull = s.component_mul(g);
    let reciprocal = 1.0 / pull.dot(g);
    Matrix::from_fn(|i, j| {
        if i != j {
            return -pull[i] * pull[j] * reciprocal;
        }
        let others: f64 = (0..P).filter(|&k| k != i).map(|k| pull[k] * g[k]).sum();
        s[i] * others * reciprocal
    })
}

//! Small products and changes of vectors and matrices.

use crate::{Matrix, Vector};

/// The vector `value · eᵢ`.
pub(crate) fn along<const P: usize>(i: usize, value: f64) -> Vector<P> {
    let mut vector = Vector::zeros();
    vector[i] = value;
    vector
}

/// The same vector under another constant dimension, equal to the first one at run time.
#[inline(always)]
pub(crate) fn cast<const P: usize, const Q: usize>(x: &Vector<P>) -> Vector<Q> {
    debug_assert_eq!(P, Q);
    Vector::from_fn(|i, _| x[i])
}

#[inline(always)]
pub(crate) fn cast_matrix<const P: usize, const Q: usize>(m: &Matrix<P>) -> Matrix<Q> {
    debug_assert_eq!(P, Q);
    Matrix::from_fn(|i, j| m[(i, j)])
}

/// Counter-clockwise quarter turn.
#[inline(always)]
pub(crate) fn quarter_turn(v: &Vector<2>) -> Vector<2> {
    Vector::<2>::new(-v.y, v.x)
}

/// `a × b`.
#[inline(always)]
pub(crate) fn cross(a: &Vector<2>, b: &Vector<2>) -> f64 {
    a.x * b.y - a.y * b.x
}

/// The cross product of two vectors whose dimension is three at run time.
#[inline(always)]
pub(crate) fn cross_3<const P: usize>(a: &Vector<P>, b: &Vector<P>) -> Vector<P> {
    debug_assert_eq!(P, 3);
    Vector::from_fn(|i, _| {
        let (j, k) = ((i + 1) % P, (i + 2) % P);
        a[j] * b[k] - a[k] * b[j]
    })
}

/// Two unit vectors orthogonal to the unit vector `y` of R³ and to each other.
pub(crate) fn tangents<const P: usize>(y: &Vector<P>) -> [Vector<P>; 2] {
    let e = along::<P>(y.iamin(), 1.0);
    let first = (e - y * y.dot(&e)).normalize();
    let second = cross_3(y, &first);
    [first, second]
}

/// A planar point turned a little to one side.
pub(crate) fn aside<const P: usize>(x: &Vector<P>, side: f64) -> Vector<P> {
    cast(&(cast::<P, 2>(x) + quarter_turn(&cast(x)) * (1e-9 * side)))
}

/// Unit vectors all around: both ends of a line, equidistant angles from `e₁` on in the plane, a Fibonacci
/// spiral in space.
pub fn directions<const P: usize>(count: usize) -> Vec<Vector<P>> {
    if P == 1 {
        return [1.0, -1.0].map(Vector::repeat).to_vec();
    }
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let direction = |k: usize| {
        let (height, angle) = match P {
            2 => (0.0, std::f64::consts::TAU * k as f64 / count as f64),
            _ => (1.0 - (2 * k + 1) as f64 / count as f64, golden * k as f64),
        };
        let radius = f64::sqrt(1.0 - height * height);
        let point = [radius * angle.cos(), radius * angle.sin(), height];
        Vector::from_fn(|i, _| point[i])
    };
    (0..count).map(direction).collect()
}

/// Rotates the columns of a matrix among themselves until they are orthogonal, by Jacobi's method, which keeps short ones
/// accurate.
pub(crate) fn orthogonalise<const P: usize>(columns: &mut Matrix<P>) {
    for _ in 0..60 {
        let mut rotated = false;
        for i in 0..P {
            for j in i + 1..P {
                rotated |= orthogonalise_pair(columns, i, j);
            }
        }
        if !rotated {
            break;
        }
    }
}

/// Rotates columns `i` and `j` among themselves until they are orthogonal; whether that was needed.
fn orthogonalise_pair<const P: usize>(columns: &mut Matrix<P>, i: usize, j: usize) -> bool {
    let (ci, cj) = (columns.column(i).clone_owned(), columns.column(j).clone_owned());
    let (ni, nj) = (ci.norm(), cj.norm());
    let overlap = ci.dot(&cj);
    if overlap.abs() <= 4.0 * f64::EPSILON * ni * nj {
        return false;
    }
    let zeta = (nj - ni) * (nj + ni) / (2.0 * overlap);
    let tangent = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
    let (cosine, sine) = (1.0 / tangent.hypot(1.0), tangent / tangent.hypot(1.0));
    columns.set_column(i, &(ci * cosine - cj * sine));
    columns.set_column(j, &(ci * sine + cj * cosine));
    true
}

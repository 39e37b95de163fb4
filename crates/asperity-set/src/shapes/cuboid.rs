//! The axis-parallel box, in one dimension the interval.

use crate::numeric::vectors::along;
use crate::{Cone, ConvexSet, Form, Matrix, SetError, StarSet, Vector, error::size};

/// `{x : lowerᵢ ≤ xᵢ ≤ upperᵢ}` with `lower < 0 < upper`: the X–Y table (\[WL19\] (36)), and in one
/// dimension friction that differs between forward and backward sliding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cuboid<const P: usize> {
    lower: Vector<P>,
    upper: Vector<P>,
}

/// The one-dimensional [`Cuboid`].
pub type Interval = Cuboid<1>;

impl<const P: usize> Cuboid<P> {
    /// Box between two opposite corners, the origin strictly inside.
    ///
    /// # Errors
    ///
    /// [`SetError::Parameter`] if a corner is not finite, does not have the origin strictly inside, or has a size that none
    /// may have.
    pub fn new(lower: Vector<P>, upper: Vector<P>) -> Result<Self, SetError> {
        let refuse =
            |argument, allowed, value| Err(SetError::Parameter { argument, allowed, value });
        for i in 0..P {
            if !(lower[i].is_finite() && lower[i] < 0.0) {
                return refuse("lower", "finite and negative", lower[i]);
            }
            if !(upper[i].is_finite() && upper[i] > 0.0) {
                return refuse("upper", "finite and positive", upper[i]);
            }
            size("lower", -lower[i]).map_err(|_| SetError::Parameter {
                argument: "lower",
                allowed: "between -1e60 and -1e-60",
                value: lower[i],
            })?;
            size("upper", upper[i])?;
        }
        Ok(Self { lower, upper })
    }

    /// Box `|xᵢ| ≤ half_widthsᵢ`.
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new).
    pub fn symmetric(half_widths: Vector<P>) -> Result<Self, SetError> {
        Self::new(-half_widths, half_widths)
    }

    /// The corner with the most negative coordinates.
    pub fn lower(&self) -> &Vector<P> {
        &self.lower
    }

    /// The corner with the most positive coordinates.
    pub fn upper(&self) -> &Vector<P> {
        &self.upper
    }

    pub(crate) fn scaled(&self, factor: f64) -> Result<Self, SetError> {
        Self::new(self.lower * factor, self.upper * factor)
    }

    /// Distance from the origin to the face that `x` points at along axis `i`, with its sign.
    fn face(&self, x: &Vector<P>, i: usize) -> f64 {
        if x[i] < 0.0 { self.lower[i] } else { self.upper[i] }
    }
}

impl<const P: usize> StarSet<P> for Cuboid<P> {
    fn gauge(&self, x: &Vector<P>) -> f64 {
        (0..P).fold(0.0, |k, i| f64::max(k, x[i] / self.face(x, i)))
    }

    fn gauge_jet(&self, x: &Vector<P>) -> (f64, Vector<P>) {
        let ratio = |i: usize| x[i] / self.face(x, i);
        let axis = (1..P).fold(0, |best, i| if ratio(i) > ratio(best) { i } else { best });
        (ratio(axis), along(axis, 1.0 / self.face(x, axis)))
    }

    fn form(&self) -> Form<'_, P> {
        Form::Powers { lower: -self.lower, upper: self.upper, reciprocal: 0.0 }
    }

    fn corners(&self) -> Vec<Vector<P>> {
        (0..1 << P)
            .map(|bits: usize| {
                Vector::from_fn(
                    |i, _| if bits >> i & 1 == 0 { self.lower[i] } else { self.upper[i] },
                )
            })
            .collect()
    }
}

impl<const P: usize> ConvexSet<P> for Cuboid<P> {
    fn support_point(&self, y: &Vector<P>) -> Vector<P> {
        Vector::from_fn(|i, _| match y[i] {
            0.0 => 0.5 * (self.lower[i] + self.upper[i]),
            v if v < 0.0 => self.lower[i],
            _ => self.upper[i],
        })
    }

    fn support_jet(&self, y: &Vector<P>) -> (Vector<P>, Matrix<P>) {
        let curvature_radius = y.map(|v| if v == 0.0 { f64::INFINITY } else { 0.0 });
        (self.support_point(y), Matrix::from_diagonal(&curvature_radius))
    }

    fn project(&self, z: &Vector<P>) -> Vector<P> {
        Vector::from_fn(|i, _| z[i].clamp(self.lower[i], self.upper[i]))
    }

    fn project_jet(&self, z: &Vector<P>, _start: &Vector<P>) -> (Vector<P>, Matrix<P>) {
        let x = self.project(z);
        (x, Matrix::from_diagonal(&x.zip_map(z, |x, z| f64::from(x == z))))
    }

    fn normal_cone(&self, x: &Vector<P>, tolerance: f64) -> Option<Cone<P>> {
        let ratio = |i: usize| x[i] / self.face(x, i);
        let touched = (0..P).filter(|&i| ratio(i) >= 1.0 - tolerance);
        (self.gauge(x) <= 1.0 + tolerance)
            .then(|| Cone::new(touched.map(|i| along(i, self.face(x, i).signum()))))
    }

    fn flat_normals(&self) -> Vec<Vector<P>> {
        (0..P).flat_map(|i| [along(i, 1.0), along(i, -1.0)]).collect()
    }
}

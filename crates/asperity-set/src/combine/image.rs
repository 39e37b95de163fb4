//! Linear images of sets.

use crate::numeric::vectors::{along, cast, quarter_turn};
use crate::{Cone, ConvexSet, Form, Matrix, SetError, StarSet, Vector, error::SIZES, project};

/// The image `{A x : x ∈ S}` under a regular map: `k(x) = k_S(A⁻¹x)`, `h(y) = h_S(Aᵀy)`
/// (\[WL19\] (9)).
#[derive(Debug, Clone, PartialEq)]
pub struct Image<S, const P: usize> {
    set: S,
    map: Matrix<P>,
    inverse: Matrix<P>,
    /// The factor `c` if the map is `c` times a rotation.
    similarity: Option<f64>,
}

impl<S: StarSet<P>, const P: usize> Image<S, P> {
    /// The image of `set` under `map`.
    ///
    /// # Errors
    ///
    /// [`SetError::SingularMap`] if the map is not finite and regular, [`SetError::Parameter`] if the image has a size that
    /// none may have.
    pub fn new(set: S, map: Matrix<P>) -> Result<Self, SetError> {
        // The determinant of a map of size one is neither too large nor too small for a number.
        let (unit, size) = (map / map.amax(), map.amax());
        let inverse = unit
            .try_inverse()
            .map(|m| m / size)
            .filter(|m| m.iter().chain(map.iter()).all(|v| v.is_finite()))
            .ok_or(SetError::SingularMap)?;
        let factor = unit.column(0).norm();
        let rotation = unit / factor;
        let factor = factor * size;
        let defect = (rotation.transpose() * rotation - Matrix::identity()).amax();
        let similarity = (defect <= 4.0 * f64::EPSILON).then_some(factor);
        // The transpose is the more accurate inverse of a rotation.
        let inverse = if similarity.is_some() { rotation.transpose() / factor } else { inverse };
        let image = Self { set, map, inverse, similarity };
        let ends = (0..P).flat_map(|i| [along(i, 1.0), along(i, -1.0)]);
        let radii: Vec<f64> = ends.map(|end| 1.0 / image.gauge(&end)).collect();
        match radii.into_iter().find(|radius| !SIZES.contains(radius)) {
            Some(value) => {
                let allowed = "such that the image has a size between 1e-60 and 1e60";
                Err(SetError::Parameter { argument: "matrix", allowed, value })
            }
            None => Ok(image),
        }
    }
}

impl<S, const P: usize> Image<S, P> {
    /// The set that is mapped.
    pub fn preimage(&self) -> &S {
        &self.set
    }

    /// The linear map.
    pub fn map(&self) -> &Matrix<P> {
        &self.map
    }
}

impl<const P: usize, S: StarSet<P>> StarSet<P> for Image<S, P> {
    #[inline]
    fn gauge(&self, x: &Vector<P>) -> f64 {
        self.set.gauge(&(self.inverse * x))
    }

    #[inline]
    fn gauge_jet(&self, x: &Vector<P>) -> (f64, Vector<P>) {
        let (gauge, gradient) = self.set.gauge_jet(&(self.inverse * x));
        (gauge, self.inverse.tr_mul(&gradient))
    }

    fn form(&self) -> Form<'_, P> {
        Form::Image { of: &self.set, map: &self.map }
    }

    fn corners(&self) -> Vec<Vector<P>> {
        self.set.corners().iter().map(|corner| self.map * corner).collect()
    }
}

impl<const P: usize, S: ConvexSet<P>> ConvexSet<P> for Image<S, P> {
    #[inline]
    fn support_point(&self, y: &Vector<P>) -> Vector<P> {
        self.map * self.set.support_point(&self.map.tr_mul(y))
    }

    fn support(&self, y: &Vector<P>) -> f64 {
        self.set.support(&self.map.tr_mul(y))
    }

    #[inline]
    fn support_jet(&self, y: &Vector<P>) -> (Vector<P>, Matrix<P>) {
        let (point, hessian) = self.set.support_jet(&self.map.tr_mul(y));
        if hessian.iter().all(|v| v.is_finite()) {
            return (self.map * point, self.map * hessian * self.map.transpose());
        }
        (self.map * point, flat_hessian(y))
    }

    #[inline]
    fn support_derivative(&self, y: &Vector<P>, dy: &Vector<P>) -> (Vector<P>, Vector<P>) {
        let (y, dy) = (self.map.tr_mul(y), self.map.tr_mul(dy));
        let (point, derivative) = self.set.support_derivative(&y, &dy);
        (self.map * point, self.map * derivative)
    }

    fn project(&self, z: &Vector<P>) -> Vector<P> {
        match self.similarity {
            Some(_) => {
                let local = self.inverse * z;
                let nearest = self.set.project(&local);
                // A point inside comes back as it is.
                if nearest == local { *z } else { self.map * nearest }
            }
            // In the plane the bracket does not care how skew the map is.
            None if P <= 2 => project::onto_any(self, z),
            None if self.gauge(z) <= 1.0 => *z,
            None => {
                let near = self.near(z);
                self.improved(z, &near).map_or(near, |(x, _)| x)
            }
        }
    }

    fn project_from(&self, z: &Vector<P>, start: &Vector<P>) -> Vector<P> {
        match self.similarity {
            Some(_) => {
                self.map * self.set.project_from(&(self.inverse * z), &(self.inverse * start))
            }
            None => self.project(z),
        }
    }

    fn project_jet(&self, z: &Vector<P>, start: &Vector<P>) -> (Vector<P>, Matrix<P>) {
        if self.similarity.is_none() {
            if P == 3
                && self.gauge(z) > 1.0
                && let Some((x, jacobian)) = self.improved(z, &self.near(z))
                && let Some((n, _)) = project::jet::normal(self, z, &x)
            {
                return (x, project::jet::across(&n, |t| jacobian * t));
            }
            return project::jet::by_differences(self, z, start);
        }
        let local = self.inverse * z;
        let (nearest, jacobian) = self.set.project_jet(&local, &(self.inverse * start));
        if nearest == local {
            return (*z, Matrix::identity());
        }
        (self.map * nearest, self.map * jacobian * self.inverse)
    }

    fn normal_cone(&self, x: &Vector<P>, tolerance: f64) -> Option<Cone<P>> {
        let cone = self.set.normal_cone(&(self.inverse * x), tolerance)?;
        Some(cone.mapped(&self.inverse.transpose()))
    }

    fn flat_normals(&self) -> Vec<Vector<P>> {
        self.set.flat_normals().iter().map(|normal| self.inverse.tr_mul(normal)).collect()
    }
}

impl<const P: usize, S: ConvexSet<P>> Image<S, P> {
    /// The point nearest to a `z` outside, of round sets and where boundaries are nearly flat with half of its digits.
    fn near(&self, z: &Vector<P>) -> Vector<P> {
        let round = || project::by_dual_newton(self, z);
        let flat = || project::by_cuts(self, z);
        let found = if self.set.corners().is_empty() { round().or_else(flat) } else { flat() };
        found.unwrap_or_else(|| project::by_support_points(self, z))
    }

    /// The nearest point with more digits, and the Jacobian; `None` where rounding in the preimage of a skew map leaves
    /// fewer.
    fn improved(&self, z: &Vector<P>, near: &Vector<P>) -> Option<(Vector<P>, Matrix<P>)> {
        let found = project::onto_image(&self.set, &self.map, z, self.inverse * near)?;
        // What the variational inequality leaves, `h(z − x) − x·(z − x)`, and how far outside.
        let left = |x: &Vector<P>| {
            let normal = z - x;
            let excess = (self.gauge(x) - 1.0).max(0.0) * x.norm();
            (self.support(&normal) - x.dot(&normal)).abs() + excess * normal.norm()
        };
        let rounding = 4.0 * f64::EPSILON * z.norm() * (z - near).norm();
        (left(&found.0) <= left(near).max(rounding)).then_some(found)
    }
}

/// `∞ t tᵀ` across the normal `y`, where the boundary of a planar set is flat.
fn flat_hessian<const P: usize>(y: &Vector<P>) -> Matrix<P> {
    if P != 2 {
        return Matrix::repeat(f64::INFINITY);
    }
    let tangent: Vector<P> = cast(&quarter_turn(&cast(&y.normalize())));
    let dyad = tangent * tangent.transpose();
    dyad.map(|v| if v.abs() <= 1e-15 { 0.0 } else { v * f64::INFINITY })
}

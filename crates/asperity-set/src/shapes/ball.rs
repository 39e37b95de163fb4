//! The ball, in the plane the disk.

use crate::{ConvexSet, Form, Matrix, SetError, StarSet, Vector, error::size};

/// `{x : ‖x‖ ≤ r}` in any dimension: isotropic friction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ball {
    radius: f64,
}

/// The planar [`Ball`].
pub type Disk = Ball;

impl Ball {
    /// The unit ball.
    pub const UNIT: Self = Self { radius: 1.0 };

    /// Ball of the given radius.
    ///
    /// # Errors
    ///
    /// [`SetError::Parameter`] if the radius is not between 1e-60 and 1e60.
    pub fn new(radius: f64) -> Result<Self, SetError> {
        Ok(Self { radius: size("radius", radius)? })
    }

    /// The radius.
    pub fn size(&self) -> f64 {
        self.radius
    }

    pub(crate) fn scaled(&self, factor: f64) -> Result<Self, SetError> {
        Self::new(self.radius * factor)
    }
}

impl<const P: usize> StarSet<P> for Ball {
    fn gauge(&self, x: &Vector<P>) -> f64 {
        x.norm() / self.radius
    }

    fn gauge_jet(&self, x: &Vector<P>) -> (f64, Vector<P>) {
        let norm = x.norm();
        (norm / self.radius, x / (norm * self.radius))
    }

    fn form(&self) -> Form<'_, P> {
        let ball = Matrix::identity();
        Form::Ellipsoid { from_ball: ball * self.radius, to_ball: ball / self.radius }
    }
}

impl<const P: usize> ConvexSet<P> for Ball {
    fn support_point(&self, y: &Vector<P>) -> Vector<P> {
        y * (self.radius / y.norm())
    }

    fn support(&self, y: &Vector<P>) -> f64 {
        self.radius * y.norm()
    }

    fn support_jet(&self, y: &Vector<P>) -> (Vector<P>, Matrix<P>) {
        let norm = y.norm();
        let unit = y / norm;
        (unit * self.radius, (Matrix::identity() - unit * unit.transpose()) * (self.radius / norm))
    }

    fn support_derivative(&self, y: &Vector<P>, dy: &Vector<P>) -> (Vector<P>, Vector<P>) {
        let reciprocal = 1.0 / y.norm();
        let unit = y * reciprocal;
        let across = dy - unit * unit.dot(dy);
        (unit * self.radius, across * (self.radius * reciprocal))
    }

    fn project(&self, z: &Vector<P>) -> Vector<P> {
        let norm = z.norm();
        if norm <= self.radius { *z } else { z * (self.radius / norm) }
    }

    #[inline]
    fn project_jet(&self, z: &Vector<P>, _start: &Vector<P>) -> (Vector<P>, Matrix<P>) {
        let square = z.norm_squared();
        if square <= self.radius * self.radius {
            return (*z, Matrix::identity());
        }
        let reciprocal = 1.0 / square;
        let ratio = self.radius * reciprocal.sqrt();
        let across = Matrix::identity() - z * (z * reciprocal).transpose();
        (z * ratio, across * ratio)
    }
}

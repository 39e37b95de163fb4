//! Convex sets whose support function is measured or computed.

use crate::error::{SIZES, size_error};
use crate::numeric::periodic_curve::{PeriodicCurve, Samples};
use crate::numeric::vectors::quarter_turn;
use crate::{Cone, ConvexSet, Matrix, SetError, StarSet, Vector, project};

/// The convex set with a smooth support function through the samples `h(φ_i)`.
///
/// The radius of curvature `h + h″` of the boundary is continuous and linear between the samples. Its
/// boundary point with the normal angle `φ` is `h e + h′ e⊥`.
#[derive(Debug, Clone, PartialEq)]
pub struct SupportCurve {
    support: PeriodicCurve,
    samples: Samples,
}

impl SupportCurve {
    /// The curve through values of the support function at normal angles in rad, in any order, within one
    /// turn; refused where `h + h″ < 0`.
    ///
    /// # Errors
    ///
    /// [`SetError::Shape`] as [`PolarCurve::new`](crate::PolarCurve::new), and if the curve is not that of a convex set.
    pub fn new(angle: &[f64], support: &[f64]) -> Result<Self, SetError> {
        let positive = support.iter().filter(|h| h.is_finite() && **h > 0.0);
        if let Some(&bad) = positive.into_iter().find(|h| !SIZES.contains(h)) {
            return Err(size_error("support", bad));
        }
        let samples = Samples::new(angle, support);
        let support = PeriodicCurve::new(angle, support, "support")?;
        let (rho, at) = support.lowest();
        if rho < 0.0 {
            let angle = at.y.atan2(at.x);
            let fault = if rho.is_finite() {
                format!("its radius of curvature is {rho} at the normal angle {angle} rad")
            } else {
                format!("its slope falls back at the normal angle {angle} rad")
            };
            let message = format!("must be that of a convex set, {fault}");
            return Err(SetError::Shape { argument: "support", message });
        }
        Ok(Self { support, samples })
    }

    /// Normal angles in rad and values of the support function, as they were given.
    pub fn samples(&self) -> (&[f64], &[f64]) {
        self.samples.as_slices()
    }

    /// The ends of a straight piece of the boundary, where the support function has a corner.
    pub(crate) fn flat(&self) -> Option<[Vector<2>; 2]> {
        let normal = self.support.corners().first()?;
        let turned = quarter_turn(normal) * 1e-9;
        Some([normal - turned, normal + turned].map(|n| self.support_point(&n)))
    }
}

impl StarSet<2> for SupportCurve {
    fn gauge(&self, x: &Vector<2>) -> f64 {
        self.gauge_jet(x).0
    }

    fn gauge_jet(&self, x: &Vector<2>) -> (f64, Vector<2>) {
        let size = x.amax();
        // No normal is that of a boundary point below zero, infinity or what is not a number.
        if !(size > 0.0 && size.is_finite()) {
            return (size, Vector::zeros());
        }
        let gradient = self.support.at_gradient(x);
        (gradient.dot(x), gradient)
    }

    fn corners(&self) -> Vec<Vector<2>> {
        self.support.linear_parts()
    }
}

impl ConvexSet<2> for SupportCurve {
    #[inline]
    fn support_point(&self, y: &Vector<2>) -> Vector<2> {
        self.support.jet(y).gradient
    }

    #[inline]
    fn support(&self, y: &Vector<2>) -> f64 {
        self.support.value(y)
    }

    #[inline]
    fn support_jet(&self, y: &Vector<2>) -> (Vector<2>, Matrix<2>) {
        let jet = self.support.jet(y);
        let across = quarter_turn(y) / y.norm();
        (jet.gradient, across * across.transpose() * (jet.rho / y.norm()))
    }

    fn normal_cone(&self, x: &Vector<2>, tolerance: f64) -> Option<Cone<2>> {
        Cone::beside_corner(self, x, tolerance)
    }

    fn flat_normals(&self) -> Vec<Vector<2>> {
        self.support.corners().to_vec()
    }

    fn project(&self, z: &Vector<2>) -> Vector<2> {
        project::by_normals(self, z, None)
    }

    fn project_from(&self, z: &Vector<2>, start: &Vector<2>) -> Vector<2> {
        project::by_normals(self, z, Some(&(z - start)))
    }
}

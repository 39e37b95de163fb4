//! Star-shaped sets whose boundary is measured or computed point by point.

use crate::error::{SIZES, size_error};
use crate::numeric::periodic_curve::{PeriodicCurve, Samples};
use crate::numeric::vectors::quarter_turn;
use crate::{Cone, ConvexSet, Matrix, SetError, StarSet, Vector};

/// The set inside a smooth closed curve through the points `r(θ_i) (cos θ_i, sin θ_i)`.
///
/// The gauge on the unit circle is `w = 1/r`, with `w + w″` continuous and linear between the samples; the
/// set is convex where the points are, with corners at points where that cannot be had otherwise.
#[derive(Debug, Clone, PartialEq)]
pub struct PolarCurve {
    inverse_radius: PeriodicCurve,
    samples: Samples,
}

impl PolarCurve {
    /// The curve through radii at angles in rad, in any order, within one turn.
    ///
    /// # Errors
    ///
    /// [`SetError::Shape`] if there is not one finite and positive radius per angle, if angles come twice or leave a gap
    /// above 3 rad, or if a radius is one that no set may have.
    pub fn new(angle: &[f64], radius: &[f64]) -> Result<Self, SetError> {
        if let Some(bad) = radius.iter().find(|r| !(r.is_finite() && **r > 0.0)) {
            let message = format!("must be finite and positive, holds {bad}");
            return Err(SetError::Shape { argument: "radius", message });
        }
        if let Some(&bad) = radius.iter().find(|r| !SIZES.contains(r)) {
            return Err(size_error("radius", bad));
        }
        let inverse: Vec<f64> = radius.iter().map(|r| 1.0 / r).collect();
        let inverse_radius = PeriodicCurve::new(angle, &inverse, "radius")?;
        Ok(Self { inverse_radius, samples: Samples::new(angle, radius) })
    }

    /// Angles in rad and radii, as they were given.
    pub fn samples(&self) -> (&[f64], &[f64]) {
        self.samples.as_slices()
    }

    /// Whether `w + w″ ≥ 0`.
    pub fn is_convex(&self) -> bool {
        self.inverse_radius.lowest().0 >= 0.0
    }

    /// The ends of a straight piece of the boundary.
    pub(crate) fn flat(&self) -> Option<[Vector<2>; 2]> {
        let normal = *self.inverse_radius.linear_parts().first()?;
        let turned = quarter_turn(&normal) * 1e-9;
        Some([normal - turned, normal + turned].map(|n| self.support_point(&n)))
    }

    /// The direction in which `w + w″` is smallest.
    pub(crate) fn least_curved(&self) -> Vector<2> {
        self.inverse_radius.lowest().1
    }
}

impl StarSet<2> for PolarCurve {
    #[inline]
    fn gauge(&self, x: &Vector<2>) -> f64 {
        self.inverse_radius.value(x)
    }

    #[inline]
    fn gauge_jet(&self, x: &Vector<2>) -> (f64, Vector<2>) {
        let jet = self.inverse_radius.jet(x);
        (jet.value, jet.gradient)
    }

    fn corners(&self) -> Vec<Vector<2>> {
        self.inverse_radius.corners().iter().map(|d| d / self.gauge(d)).collect()
    }
}

/// Meaningful where [`PolarCurve::is_convex`]; [`Convex`](crate::Convex) admits no other.
impl ConvexSet<2> for PolarCurve {
    #[inline]
    fn support_point(&self, y: &Vector<2>) -> Vector<2> {
        self.inverse_radius.at_gradient(y)
    }

    /// `∇²h = t tᵀ/(κ‖y‖)` with the curvature `κ = tᵀ∇²k t/‖∇k‖` of the boundary, `∇²k = (w + w″) e⊥e⊥ᵀ/‖x‖`.
    fn support_jet(&self, y: &Vector<2>) -> (Vector<2>, Matrix<2>) {
        let x = self.support_point(y);
        let jet = self.inverse_radius.jet(&x);
        let (tangent, size) = (quarter_turn(&y.normalize()), x.norm());
        let along = tangent.dot(&quarter_turn(&x)) / size;
        let curvature = jet.rho * along * along / (size * jet.gradient.norm());
        (x, tangent * tangent.transpose() / (curvature * y.norm()))
    }

    fn normal_cone(&self, x: &Vector<2>, tolerance: f64) -> Option<Cone<2>> {
        Cone::beside_corner(self, x, tolerance)
    }

    fn flat_normals(&self) -> Vec<Vector<2>> {
        self.inverse_radius.linear_parts()
    }
}

//! The force reservoir of wedge-shaped asperities.

use crate::{ConvexSet, SetError, StarSet, Vector, error::size};

/// Reservoir of springs that slide over parallel wedges of inclination β, with friction μ on the flanks
/// (\[WL19\] (50)); `e₁` points across the wedges.
///
/// `k(x) = (cos β/μ)(x₂² + B x₁²)/√(x₁² cos²β + x₂²)`, `B = 1 − (1 + μ²) sin²β = cos²β (1 − μ² tan²β)`.
/// Star-shaped where `μ tan β < 1`, convex where `μ tan β ≤ 1/√2`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WedgeAsperity {
    mu: f64,
    beta: f64,
    cosine: f64,
    /// `B`.
    across: f64,
}

impl WedgeAsperity {
    /// Wedges of inclination `beta` in rad with friction coefficient `mu`, `0 ≤ β`, `μ tan β < 1`.
    ///
    /// # Errors
    ///
    /// [`SetError::Parameter`] if a number is out of its range.
    pub fn new(mu: f64, beta: f64) -> Result<Self, SetError> {
        size("mu", mu)?;
        let refuse = |allowed| Err(SetError::Parameter { argument: "beta", allowed, value: beta });
        if !(0.0..std::f64::consts::FRAC_PI_2).contains(&beta) {
            return refuse("at least 0 and below π/2");
        }
        let slope = mu * beta.tan();
        if slope >= 1.0 {
            return refuse("so flat that mu*tan(beta) < 1, else sliding locks");
        }
        let cosine = beta.cos();
        Ok(Self { mu, beta, cosine, across: cosine * cosine * (1.0 - slope) * (1.0 + slope) })
    }

    /// Friction coefficient of the flanks.
    pub fn mu(&self) -> f64 {
        self.mu
    }

    /// Inclination of the flanks in rad.
    pub fn beta(&self) -> f64 {
        self.beta
    }

    /// Whether `μ tan β ≤ 1/√2`.
    pub fn is_convex(&self) -> bool {
        self.mu * self.beta.tan() <= std::f64::consts::FRAC_1_SQRT_2
    }
}

impl StarSet<2> for WedgeAsperity {
    #[inline]
    fn gauge(&self, x: &Vector<2>) -> f64 {
        let size = x.amax();
        if size == 0.0 {
            return 0.0;
        }
        let (p, q) = ((x.x / size).powi(2), (x.y / size).powi(2));
        let root = (self.cosine * self.cosine * p + q).sqrt();
        size * self.cosine / self.mu * (q + self.across * p) / root
    }

    #[inline]
    fn gauge_jet(&self, x: &Vector<2>) -> (f64, Vector<2>) {
        let size = x.amax();
        let unit = x / size;
        let (p, q) = (unit.x * unit.x, unit.y * unit.y);
        let squeezed = self.cosine * self.cosine;
        let root = (squeezed * p + q).sqrt();
        let ratio = (q + self.across * p) / root;
        let factor = self.cosine / (self.mu * root);
        let slope = Vector::<2>::new(
            unit.x * (2.0 * self.across - squeezed * ratio / root),
            unit.y * (2.0 - ratio / root),
        );
        (size * self.cosine / self.mu * ratio, slope * factor)
    }
}

/// Meaningful where [`WedgeAsperity::is_convex`]; [`Convex`](crate::Convex) admits no other.
impl ConvexSet<2> for WedgeAsperity {}

//! The superellipsoid, in the plane the superellipse (Lamé curve).

mod projection;

use crate::numeric::vectors::along;
use crate::{
    Cone, ConvexSet, Form, Matrix, SetError, StarSet, Vector, error::positive, error::size, project,
};

/// `{x : Σ|xᵢ/aᵢ|^s ≤ 1}` (\[WL19\] (37)): rhombus at `s = 1`, ellipse at `s = 2`, box as `s → ∞`.
///
/// Star-shaped for every `s > 0`, convex for `s ≥ 1`. The conjugate exponent `s/(s−1)` gives the
/// support function.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Superellipsoid<const P: usize> {
    semi_axes: Vector<P>,
    exponent: f64,
}

/// Smallest exponent: the diagonal radius of thinner cusps, `P^(−1/s)`, would be below the sizes of sets.
const LEAST_EXPONENT: f64 = 0.01;

/// The planar [`Superellipsoid`].
pub type Superellipse = Superellipsoid<2>;

/// `Σwᵢ^q` in the form `largest^q · sum`, with `powers[i] = (wᵢ/largest)^q`: never overflows.
struct PowerSum<const P: usize> {
    largest: f64,
    powers: Vector<P>,
    sum: f64,
}

impl<const P: usize> PowerSum<P> {
    #[inline]
    fn new(w: &Vector<P>, q: f64) -> Self {
        let largest = w.amax();
        let powers = w.map(|wi| if wi == largest { 1.0 } else { (wi / largest).powf(q) });
        Self { largest, powers, sum: powers.sum() }
    }

    /// `(Σwᵢ^q)^(1/q)`.
    #[inline]
    fn norm(&self, q: f64) -> f64 {
        self.largest * self.sum.powf(1.0 / q)
    }

    /// `(wᵢ/norm)^(q−1)`, without a further power: `(wᵢ/largest)^q / sum · norm/wᵢ`.
    #[inline]
    fn conjugate(&self, w: &Vector<P>, norm: f64, q: f64) -> Vector<P> {
        Vector::from_fn(|i, _| match w[i] {
            0.0 => f64::from(q == 1.0),
            // Below the range of the quotient form both factors have been rounded to zero.
            wi if self.powers[i] < f64::MIN_POSITIVE => (wi / norm).powf(q - 1.0),
            wi => self.powers[i] / self.sum * (norm / wi),
        })
    }
}

impl<const P: usize> Superellipsoid<P> {
    /// Superellipsoid with semi-axes along the coordinate axes and exponent `s ≥ 0.01`.
    ///
    /// # Errors
    ///
    /// [`SetError::Parameter`] if a semi-axis is not between 1e-60 and 1e60, or the exponent not finite and at least 0.01.
    pub fn new(semi_axes: Vector<P>, exponent: f64) -> Result<Self, SetError> {
        for &a in semi_axes.iter() {
            size("semi_axes", a)?;
        }
        if positive("exponent", exponent)? < LEAST_EXPONENT {
            let (argument, allowed) = ("exponent", "at least 0.01");
            return Err(SetError::Parameter { argument, allowed, value: exponent });
        }
        Ok(Self { semi_axes, exponent })
    }

    /// Semi-axes.
    pub fn semi_axes(&self) -> &Vector<P> {
        &self.semi_axes
    }

    /// Exponent `s`.
    pub fn exponent(&self) -> f64 {
        self.exponent
    }

    /// Whether `s ≥ 1`.
    pub fn is_convex(&self) -> bool {
        self.exponent >= 1.0
    }

    pub(crate) fn scaled(&self, factor: f64) -> Result<Self, SetError> {
        Self::new(self.semi_axes * factor, self.exponent)
    }

    fn is_polytope(&self) -> bool {
        self.exponent == 1.0
    }

    /// Conjugate exponent `s/(s−1)`, for `s > 1`.
    fn conjugate_exponent(&self) -> f64 {
        self.exponent / (self.exponent - 1.0)
    }

    /// Support point, support and the weights `(wᵢ/h)^(q−1)` in the positive orthant, `wᵢ = aᵢ|yᵢ|`.
    #[inline]
    fn support_parts(&self, y: &Vector<P>) -> (Vector<P>, f64, Vector<P>) {
        let w = y.abs().component_mul(&self.semi_axes);
        let (support, weights) = if self.is_polytope() {
            let largest = w.amax();
            let ties = w.iter().filter(|&&wi| wi == largest).count() as f64;
            (largest, w.map(|wi| if wi == largest { 1.0 / ties } else { 0.0 }))
        } else {
            let q = self.conjugate_exponent();
            let power_sum = PowerSum::new(&w, q);
            let support = power_sum.norm(q);
            (support, power_sum.conjugate(&w, support, q))
        };
        let point = Vector::from_fn(|i, _| self.semi_axes[i] * weights[i] * sign(y[i]));
        (point, support, weights)
    }
}

/// Sign with `sign(0) = 0`.
#[inline]
fn sign(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { x.signum() }
}

impl<const P: usize> StarSet<P> for Superellipsoid<P> {
    #[inline]
    fn gauge(&self, x: &Vector<P>) -> f64 {
        let w = x.abs().component_div(&self.semi_axes);
        if w.amax() == 0.0 { 0.0 } else { PowerSum::new(&w, self.exponent).norm(self.exponent) }
    }

    /// `∂k/∂xᵢ = sign(xᵢ)/aᵢ (|xᵢ/aᵢ|/k)^(s−1)`; on an axis, where it is infinite for `s < 1`, the
    /// symmetric value 0.
    #[inline]
    fn gauge_jet(&self, x: &Vector<P>) -> (f64, Vector<P>) {
        let w = x.abs().component_div(&self.semi_axes);
        let power_sum = PowerSum::new(&w, self.exponent);
        let gauge = power_sum.norm(self.exponent);
        let slopes = power_sum.conjugate(&w, gauge, self.exponent);
        (gauge, Vector::from_fn(|i, _| sign(x[i]) * slopes[i] / self.semi_axes[i]))
    }

    fn form(&self) -> Form<'_, P> {
        let (lower, upper) = (self.semi_axes, self.semi_axes);
        Form::Powers { lower, upper, reciprocal: 1.0 / self.exponent }
    }

    fn corners(&self) -> Vec<Vector<P>> {
        if self.exponent > 1.0 {
            return Vec::new();
        }
        let tip = |i: usize, side: f64| along(i, side * self.semi_axes[i]);
        (0..P).flat_map(|i| [tip(i, 1.0), tip(i, -1.0)]).collect()
    }
}

/// Support, projection and normal cone are meaningful for `s ≥ 1` only; [`Convex`](crate::Convex)
/// admits no other.
impl<const P: usize> ConvexSet<P> for Superellipsoid<P> {
    fn support_point(&self, y: &Vector<P>) -> Vector<P> {
        self.support_parts(y).0
    }

    fn support(&self, y: &Vector<P>) -> f64 {
        if y.amax() == 0.0 { 0.0 } else { self.support_parts(y).1 }
    }

    /// `∂²h/∂yᵢ∂yⱼ = (q−1)/h · aᵢaⱼ sᵢsⱼ [δᵢⱼ (wᵢ/h)^(q−2) − (wᵢ/h)^(q−1) (wⱼ/h)^(q−1)]`.
    ///
    /// On the diagonal `1 − (wᵢ/h)^q` is taken as the sum of the other shares, which does not cancel.
    fn support_jet(&self, y: &Vector<P>) -> (Vector<P>, Matrix<P>) {
        let (point, support, weights) = self.support_parts(y);
        if self.is_polytope() {
            return (point, Matrix::zeros());
        }
        let q = self.conjugate_exponent();
        let factor = (q - 1.0) / support;
        let w = y.abs().component_mul(&self.semi_axes) / support;
        let mut hessian = point * point.transpose() * -factor;
        for i in 0..P {
            let others: f64 = (0..P).filter(|&j| j != i).map(|j| weights[j] * w[j]).sum();
            let ratio = match w[i] {
                0.0 if q < 2.0 => f64::INFINITY,
                0.0 => f64::from(q == 2.0),
                wi => weights[i] / wi,
            };
            hessian[(i, i)] = factor * self.semi_axes[i].powi(2) * ratio * others;
        }
        (point, hessian)
    }

    fn project(&self, z: &Vector<P>) -> Vector<P> {
        projection::onto_superellipsoid(&self.semi_axes, self.exponent, z)
    }

    fn project_from(&self, z: &Vector<P>, start: &Vector<P>) -> Vector<P> {
        projection::by_newton(self, self.exponent, z, start).unwrap_or_else(|| self.project(z))
    }

    /// `x + β∇k(x) = z`, where `∇²k` is `(s−1) diag(∂ᵢk/xᵢ)` across the normal.
    fn project_jet(&self, z: &Vector<P>, start: &Vector<P>) -> (Vector<P>, Matrix<P>) {
        if self.gauge(z) <= 1.0 {
            return (*z, Matrix::identity());
        }
        let x = self.project_from(z, start);
        let normal = self.gauge_jet(&x).1;
        let beta = normal.dot(&(z - x)).max(0.0) / normal.norm_squared();
        let curvature = beta * (self.exponent - 1.0);
        let follows = Vector::from_fn(|i, _| {
            let bend = match x[i] {
                0.0 if self.exponent < 2.0 => f64::INFINITY,
                0.0 if self.exponent > 2.0 => 0.0,
                0.0 => curvature / self.semi_axes[i].powi(2),
                xi => curvature * normal[i] / xi,
            };
            1.0 / (1.0 + bend)
        });
        (x, project::jet::on_level(&follows, &normal))
    }

    fn normal_cone(&self, x: &Vector<P>, tolerance: f64) -> Option<Cone<P>> {
        if !self.is_polytope() {
            return Cone::smooth(self, x, tolerance);
        }
        let gauge = self.gauge(x);
        if gauge > 1.0 + tolerance {
            return None;
        }
        if gauge < 1.0 - tolerance {
            return Some(Cone::new([]));
        }
        // A facet normal for every choice of signs that the vanishing coordinates leave open.
        let signs = |i: usize| match x[i] / self.semi_axes[i] {
            w if w > tolerance => vec![1.0],
            w if w < -tolerance => vec![-1.0],
            _ => vec![1.0, -1.0],
        };
        let mut normals = vec![Vector::zeros()];
        for i in 0..P {
            normals = signs(i)
                .into_iter()
                .flat_map(|s| {
                    let value = s / self.semi_axes[i];
                    normals.iter().map(move |n: &Vector<P>| {
                        let mut normal = *n;
                        normal[i] = value;
                        normal
                    })
                })
                .collect();
        }
        Some(Cone::new(normals))
    }

    fn flat_normals(&self) -> Vec<Vector<P>> {
        let facets = if self.is_polytope() { 1 << P } else { 0 };
        let sign = |bits: usize, i: usize| if bits >> i & 1 == 0 { 1.0 } else { -1.0 };
        (0..facets).map(|bits| Vector::from_fn(|i, _| sign(bits, i) / self.semi_axes[i])).collect()
    }
}

//! The natural map of one contact and its generalised Jacobian.
//!
//! With `h = P_N − ρ_N ξ_N`, or the prescribed normal percussion, the contact is open where `h ≤ 0`:
//! `F = P`. Where `h > 0`, `F_N = ρ_N ξ_N`, and the paper's iteration (\[WL19\] (69), (70)) scaled by `h` is
//!
//! `x = −P_T/h`, `y = α(x)(x + ρ_T ξ_T/h)`, `z = prox_D(y)`, `F_T = P_T + h z/α(z)`,
//!
//! with `1/α(x) = k_D(x) − k_C(x) + 1` (56) and its inverse `α(z) = k_C(z) − k_D(z) + 1` (67). `F = 0` is the
//! contact law. For isotropic friction this is the map of \[AlartCurnier1991\].

use asperity_set::{ConvexSet, Matrix, StarSet, Vector};
use nalgebra::{SMatrix, Vector4};

use crate::law::FrictionLaw;

/// Matrices over the rows of a contact, the normal row first where there is one; the rest unused.
pub(crate) type ContactMatrix = SMatrix<f64, 4, 4>;

/// Vectors over the rows of a contact, likewise.
pub(crate) type ContactVector = Vector4<f64>;

/// Prox parameters of a contact; the tangential rows share one, or the law would change.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Rho {
    pub(crate) normal: f64,
    pub(crate) tangent: f64,
}

/// What the natural map of a contact is a function of: percussions and velocities `ξ` in all its rows.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ContactPoint<'a> {
    /// The prescribed normal percussion of a contact without a normal row.
    pub(crate) prescribed: Option<f64>,
    pub(crate) rho: Rho,
    pub(crate) percussion: &'a [f64],
    pub(crate) xi: &'a [f64],
}

/// Where the derivatives of the natural map go: `dF = A dP + B dξ`.
#[derive(Debug)]
pub(crate) struct Derivatives<'a> {
    pub(crate) a: &'a mut ContactMatrix,
    pub(crate) b: &'a mut ContactMatrix,
}

/// `F` for a law of known dimension, and its derivatives where they are asked for.
#[inline(always)]
pub(crate) fn map<const P: usize>(
    law: &FrictionLaw<P>,
    at: ContactPoint<'_>,
    out: &mut [f64],
    derivatives: Option<Derivatives<'_>>,
) {
    let ContactPoint { prescribed, rho, percussion, xi } = at;
    let (first, h) = match prescribed {
        Some(value) => (0, value),
        None => (1, percussion[0] - rho.normal * xi[0]),
    };
    // The comparison also turns away NaN.
    if !(h > 0.0) {
        out.copy_from_slice(percussion);
        if let Some(Derivatives { a, b }) = derivatives {
            *a = ContactMatrix::identity();
            b.fill(0.0);
        }
        return;
    }
    let tangent = Vector::<P>::from_column_slice(&percussion[first..]);
    let slip = Vector::<P>::from_column_slice(&xi[first..]) * rho.tangent;
    let scaled = UnitFriction { x: tangent / -h, s: slip / h };
    if first == 1 {
        out[0] = rho.normal * xi[0];
    }
    let Some(Derivatives { a, b }) = derivatives else {
        let g = scaled.value(law);
        out[first..].copy_from_slice((tangent + g * h).as_slice());
        return;
    };
    let (g, by_x, by_s) = scaled.jet(law);
    out[first..].copy_from_slice((tangent + g * h).as_slice());
    // dx = −(dP_T + x dh)/h, ds = (ρ_T dξ_T − s dh)/h, dh = dP_N − ρ_N dξ_N.
    let by_h = g - by_x * scaled.x - by_s * scaled.s;
    (*a, *b) = (ContactMatrix::zeros(), ContactMatrix::zeros());
    for i in 0..P {
        for j in 0..P {
            a[(first + i, first + j)] = f64::from(u8::from(i == j)) - by_x[(i, j)];
            b[(first + i, first + j)] = rho.tangent * by_s[(i, j)];
        }
        if first == 1 {
            a[(1 + i, 0)] = by_h[i];
            b[(1 + i, 0)] = -rho.normal * by_h[i];
        }
    }
    if first == 1 {
        b[(0, 0)] = rho.normal;
    }
}

/// The tangential part for unit `h`: `x = −P_T/h` and `s = ρ_T ξ_T/h`.
struct UnitFriction<const P: usize> {
    x: Vector<P>,
    s: Vector<P>,
}

impl<const P: usize> UnitFriction<P> {
    /// `z/α(z)`.
    #[inline(always)]
    fn value(&self, law: &FrictionLaw<P>) -> Vector<P> {
        let z = law.prox_step(&self.x, |alpha| self.s * alpha).end(law);
        if law.is_associated() {
            return z;
        }
        z / (law.reservoir().gauge(&z) - law.direction().gauge(&z) + 1.0)
    }

    /// `g = z/α(z)` with its derivatives to `x` and `s`.
    #[inline(always)]
    fn jet(&self, law: &FrictionLaw<P>) -> (Vector<P>, Matrix<P>, Matrix<P>) {
        let Self { x, s } = self;
        let direction = law.direction();
        if law.is_associated() {
            let (z, slope) = direction.project_jet(&(x + s), x);
            return (z, slope, slope);
        }
        // ∇α = −α² (∇k_D − ∇k_C).
        let (excess, gradient) = difference(law, x);
        let alpha = 1.0 / (excess + 1.0);
        let w = x + s;
        let (z, slope) = direction.project_jet(&(w * alpha), &(x * alpha));
        let (at_z, gradient_z) = difference(law, &z);
        let inverse = 1.0 / (1.0 - at_z);
        // dg = dz/α(z) + z (∇k_D − ∇k_C)·dz/α(z)².
        let outer = (Matrix::identity() + z * gradient_z.transpose() * inverse) * slope * inverse;
        let by_s = outer * alpha;
        let by_x = by_s - outer * w * gradient.transpose() * (alpha * alpha);
        (z * inverse, by_x, by_s)
    }
}

/// `k_D − k_C` and its gradient, zero at the origin.
fn difference<const P: usize>(law: &FrictionLaw<P>, x: &Vector<P>) -> (f64, Vector<P>) {
    if x.amax() == 0.0 {
        return (0.0, Vector::zeros());
    }
    let (k_d, by_d) = law.direction().gauge_jet(x);
    let (k_c, by_c) = law.reservoir().gauge_jet(x);
    (k_d - k_c, by_d - by_c)
}

#[cfg(test)]
mod tests;

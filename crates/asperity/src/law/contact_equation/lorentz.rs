//! Laws whose friction cone is a Lorentz cone in suitable coordinates.
//!
//! With `C = {‖S x‖ ≤ 1}` and `N_D` along `Q_D x`, `P̂ = (P_N, S P_T)` lies in the Lorentz cone and
//! `ξ̂ = (ξ_N, R ξ_T)`, `R ∝ S Q_D⁻¹`, is opposite to `P̂_T` in slip: isotropic friction with an unsymmetric
//! operator, whatever the two ellipsoids are.

use asperity_set::{Convex, ConvexSet, Matrix, Star, Vector};

use super::natural_map::ContactMatrix;
use crate::law::FrictionLaw;

/// `P̂ = T P`, `ξ̂ = K ξ`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LorentzCone {
    pub(crate) t: ContactMatrix,
    pub(crate) k: ContactMatrix,
}

/// `T = s diag(1, S)` and `K = diag(1, R)/s` with the size `s` of the reservoir.
pub(in crate::law) fn cone<const P: usize>(law: &FrictionLaw<P>) -> Option<LorentzCone> {
    if P == 0 {
        return Some(LorentzCone { t: ContactMatrix::identity(), k: ContactMatrix::identity() });
    }
    let Star::Convex(reservoir) = law.reservoir() else { return None };
    let s = to_ball(reservoir)?;
    let d = to_ball(law.direction())?;
    let inverse = d.try_inverse()?;
    let mut r = s * (inverse * inverse.transpose());
    let dual = s.try_inverse()?.transpose();
    r *= dual.norm() / r.norm();
    let size = (P as f64).sqrt() / s.norm();
    let (mut t, mut k) = (ContactMatrix::identity(), ContactMatrix::identity());
    (t[(0, 0)], k[(0, 0)]) = (size, 1.0 / size);
    for i in 0..P {
        for j in 0..P {
            t[(1 + i, 1 + j)] = size * s[(i, j)];
            k[(1 + i, 1 + j)] = r[(i, j)] / size;
        }
    }
    Some(LorentzCone { t, k })
}

/// The map that makes the set a unit ball.
fn to_ball<const P: usize>(set: &Convex<P>) -> Option<Matrix<P>> {
    match set {
        Convex::Ball(ball) => Some(Matrix::identity() / ball.size()),
        Convex::Ellipsoid(ellipsoid) => Some(*ellipsoid.to_ball()),
        Convex::Cuboid(interval) if P == 1 => {
            let [up, down] = [1.0, -1.0].map(|sign| interval.support(&Vector::<P>::repeat(sign)));
            (up == down).then(|| Matrix::identity() / up)
        }
        _ => None,
    }
}

//! Laws whose friction cone is a Lorentz cone in suitable coordinates.
//!
//! With `C = {‖S x‖ ≤ 1}` and `N_D` along `Q_D x`, `P̂ = (P_N, S P_T)` lies in the Lorentz cone and
//! `ξ̂ = (ξ_N, R ξ_T)`, `R ∝ S Q_D⁻¹`, is opposite to `P̂_T` in slip: isotropic friction with an unsymmetric
//! operator, whatever the two ellipsoids are.

use asperity_set::{Convex, ConvexSet, Matrix, Star, Vector};
use nalgebra::Vector4;

use crate::contact::{ContactProblem, NormalForce};
use crate::law::{FrictionLaw, Law};
use crate::solver::natural_map::Small;

/// `P̂ = T P`, `ξ̂ = K ξ` for all contacts.
#[derive(Debug, Clone, Default)]
pub(super) struct Cones {
    pub(super) t: Vec<Small>,
    pub(super) k: Vec<Small>,
    pub(super) t_inverse: Vec<Small>,
}

impl Cones {
    /// Reads the laws; false if some contact has no such coordinates.
    pub(super) fn read(&mut self, problem: &ContactProblem) -> bool {
        self.t.clear();
        self.k.clear();
        self.t_inverse.clear();
        for contact in problem.contacts() {
            if contact.normal != NormalForce::Unilateral {
                return false;
            }
            let found = match &contact.law {
                Law::One(law) => coordinates(law),
                Law::Two(law) => coordinates(law),
                Law::Three(law) => coordinates(law),
            };
            let Some((t, k)) = found else { return false };
            let Some(inverse) = t.try_inverse() else { return false };
            self.t.push(t);
            self.k.push(k);
            self.t_inverse.push(inverse);
        }
        true
    }
}

/// `T = s diag(1, S)` and `K = diag(1, R)/s` with the size `s` of the reservoir.
fn coordinates<const P: usize>(law: &FrictionLaw<P>) -> Option<(Small, Small)> {
    let Star::Convex(reservoir) = law.reservoir() else { return None };
    let s = to_ball(reservoir)?;
    let d = to_ball(law.direction())?;
    let inverse = d.try_inverse()?;
    let mut r = s * (inverse * inverse.transpose());
    let dual = s.try_inverse()?.transpose();
    r *= dual.norm() / r.norm();
    let size = (P as f64).sqrt() / s.norm();
    let (mut t, mut k) = (Small::identity(), Small::identity());
    (t[(0, 0)], k[(0, 0)]) = (size, 1.0 / size);
    for i in 0..P {
        for j in 0..P {
            t[(1 + i, 1 + j)] = size * s[(i, j)];
            k[(1 + i, 1 + j)] = r[(i, j)] / size;
        }
    }
    Some((t, k))
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

/// Rows of a contact as a vector, the rest zero.
pub(super) fn own_rows(values: &[f64], offset: usize, len: usize) -> Vector4<f64> {
    Vector4::from_fn(|i, _| if i < len { values[offset + i] } else { 0.0 })
}

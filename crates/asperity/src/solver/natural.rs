//! The natural map of a whole problem, one number for all contacts.

use asperity_set::Vector;

use super::residual::{ContactVelocity, tangential_defect};
use crate::contact::{ContactProblem, NormalForce};
use crate::law::{FrictionLaw, Law};

/// `‖P − prox(P − ρξ)‖ / max(‖P‖, ρ‖b‖)` with `ρ = rows/tr G` for the whole problem, independent of units.
///
/// Isotropic unilateral contacts enter with the projection onto their friction cone, `ξ_N` enlarged by
/// `μ‖ξ_T‖` (\[DeSaxceFeng1998\], \[AcaryBremondHuber2018\]); others with the inclusions of normal and tangential
/// percussion, as in [`natural_residual`](super::natural_residual).
pub fn natural_map(problem: &ContactProblem, percussion: &[f64], velocity: &[f64]) -> f64 {
    let rho = problem.global_rho();
    let mut defect = 0.0;
    for i in 0..problem.contacts().len() {
        defect += contact_defect(problem, i, rho, percussion, velocity);
    }
    let squares = percussion.iter().map(|p| p * p).sum::<f64>();
    let scale = f64::max(squares, (rho * problem.load_norm()).powi(2));
    if defect == 0.0 { 0.0 } else { f64::sqrt(defect / scale) }
}

/// Square of the defect of a contact.
pub(super) fn contact_defect(
    problem: &ContactProblem,
    i: usize,
    rho: f64,
    percussion: &[f64],
    velocity: &[f64],
) -> f64 {
    let contact = &problem.contacts()[i];
    let xi = ContactVelocity { velocity, restitution: problem.restitution() };
    let first = contact.tangent();
    let normal = match contact.normal {
        NormalForce::Prescribed(value) => value,
        NormalForce::Unilateral => percussion[contact.offset],
    };
    if contact.normal == NormalForce::Unilateral {
        let xi_n = xi.of(contact.offset);
        let cone = match &contact.law {
            Law::One(law) => cone_defect(law, (normal, xi_n), rho, first, percussion, &xi),
            Law::Two(law) => cone_defect(law, (normal, xi_n), rho, first, percussion, &xi),
            Law::Three(law) => cone_defect(law, (normal, xi_n), rho, first, percussion, &xi),
        };
        if let Some(defect) = cone {
            return defect;
        }
    }
    let normal_defect = match contact.normal {
        NormalForce::Prescribed(_) => 0.0,
        NormalForce::Unilateral => normal - f64::max(0.0, normal - rho * xi.of(contact.offset)),
    };
    let tangential = match &contact.law {
        Law::One(law) => tangential_defect(law, normal, rho, first, percussion, &xi),
        Law::Two(law) => tangential_defect(law, normal, rho, first, percussion, &xi),
        Law::Three(law) => tangential_defect(law, normal, rho, first, percussion, &xi),
    };
    normal_defect * normal_defect + tangential
}

/// `‖r − P_K(r − ρξ̃)‖²` with `ξ̃_N = ξ_N + μ‖ξ_T‖` and the friction cone `K`, for isotropic friction.
fn cone_defect<const P: usize>(
    law: &FrictionLaw<P>,
    (normal, xi_n): (f64, f64),
    rho: f64,
    first: usize,
    percussion: &[f64],
    xi: &ContactVelocity<'_>,
) -> Option<f64> {
    let mu = law.isotropic_coefficient()?;
    let tangent = Vector::<P>::from_fn(|j, _| percussion[first + j]);
    let slip = Vector::<P>::from_fn(|j, _| xi.of(first + j));
    let z_n = normal - rho * (xi_n + mu * slip.norm());
    let z_t = tangent - slip * rho;
    let size = z_t.norm();
    let (p_n, p_t) = if size <= mu * z_n {
        (z_n, z_t)
    } else if mu * size <= -z_n {
        (0.0, Vector::zeros())
    } else {
        let p_n = (z_n + mu * size) / (1.0 + mu * mu);
        (p_n, z_t * (mu * p_n / size))
    };
    Some((normal - p_n) * (normal - p_n) + (tangent - p_t).norm_squared())
}

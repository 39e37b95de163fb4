//! The natural residual, which no solver owns.

use asperity_set::{ConvexSet, StarSet, Vector};

use crate::contact::{ContactProblem, NormalForce};
use crate::law::{FrictionLaw, Law};

/// Natural residual of a problem.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residual {
    /// `‖defect‖ / max(‖P‖, ρ‖b‖)`, independent of units.
    pub value: f64,
    /// Contact with the largest defect.
    pub worst_contact: usize,
}

/// Defect of the projections that the contact laws are, with `ρ = rows/tr G`:
///
/// `P_N − max(0, P_N − ρξ_N)` and, for `z = −αP`, `z − prox_{P_N D}(z + ργ)` (\[WL19\] (12), (69)).
///
/// It vanishes exactly at solutions: the second is zero iff `k_C(−P/P_N) ≤ 1` and `γ ∈ N_D(z)`.
pub fn natural_residual(
    problem: &ContactProblem,
    percussion: &[f64],
    velocity: &[f64],
) -> Residual {
    let rho = problem.rho;
    let (mut sum, mut worst, mut worst_contact) = (0.0, -1.0, 0);
    let xi = |row: usize| velocity[row] + problem.restitution[row];
    for (i, contact) in problem.contacts.iter().enumerate() {
        let (normal_defect, normal) = match contact.normal {
            NormalForce::Prescribed(value) => (0.0, value),
            NormalForce::Unilateral => {
                let normal = percussion[contact.offset];
                (normal - f64::max(0.0, normal - rho * xi(contact.offset)), normal)
            }
        };
        let first = contact.tangent();
        let tangential = match &contact.law {
            Law::One(law) => tangential_defect(law, normal, rho, first, percussion, xi),
            Law::Two(law) => tangential_defect(law, normal, rho, first, percussion, xi),
            Law::Three(law) => tangential_defect(law, normal, rho, first, percussion, xi),
        };
        let defect = normal_defect * normal_defect + tangential;
        sum += defect;
        // Not-a-number counts as the worst of all.
        if !(defect <= worst) {
            (worst, worst_contact) = (defect, i);
        }
    }
    let square = |values: &[f64]| values.iter().map(|v| v * v).sum::<f64>();
    let scale = square(percussion).max(rho * rho * square(&problem.free_velocity));
    let value = if sum == 0.0 { 0.0 } else { (sum / scale).sqrt() };
    Residual { value, worst_contact }
}

/// Square of the tangential defect of one contact.
fn tangential_defect<const P: usize>(
    law: &FrictionLaw<P>,
    normal: f64,
    rho: f64,
    first: usize,
    percussion: &[f64],
    xi: impl Fn(usize) -> f64,
) -> f64 {
    let tangent = Vector::<P>::from_fn(|j, _| percussion[first + j]);
    if normal <= 0.0 {
        return tangent.norm_squared();
    }
    let slip = Vector::<P>::from_fn(|j, _| xi(first + j));
    let reciprocal = 1.0 / normal;
    let x = tangent * -reciprocal;
    let direction = law.direction();
    let (k_d, k_c) = (direction.gauge(&x), law.reservoir().gauge(&x));
    let alpha = 1.0 / (k_d - k_c + 1.0);
    let z = x * alpha;
    let moved = z + slip * (rho * reciprocal);
    let projected = direction.project_from(&moved, &z);
    (z - projected).norm_squared() * normal * normal
}

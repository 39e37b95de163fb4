//! The natural residual, which no solver owns.

use asperity_set::{ConvexSet, StarSet, Vector};

use crate::contact::{ContactProblem, Delassus, NormalForce};
use crate::law::{FrictionLaw, Law};

/// Natural residual of a problem.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residual {
    /// The largest relative defect of a contact, independent of units.
    pub value: f64,
    /// Contact with the largest defect.
    pub worst_contact: usize,
}

/// `ξ = γ_E + e γ_B` row by row.
pub(super) struct ContactVelocity<'a> {
    pub(super) velocity: &'a [f64],
    pub(super) restitution: &'a [f64],
}

impl ContactVelocity<'_> {
    #[inline]
    pub(super) fn of(&self, row: usize) -> f64 {
        self.velocity[row] + self.restitution[row]
    }
}

/// Defect of the projections that the contact laws are, contact by contact:
///
/// `P_N − max(0, P_N − ρξ_N)` and, for `z = −αP`, `z − prox_{P_N D}(z + ργ)` (\[WL19\] (12), (69)),
/// with `ρ = rows/tr G` of the contact's own block.
///
/// It vanishes exactly at solutions: the second is zero iff `k_C(−P/P_N) ≤ 1` and `γ ∈ N_D(z)`. The
/// defect of a contact is taken relative to its own percussion and loads, so that a light contact
/// cannot hide the defect of a heavy one.
pub fn natural_residual(
    problem: &ContactProblem,
    percussion: &[f64],
    velocity: &[f64],
) -> Residual {
    let xi = ContactVelocity { velocity, restitution: problem.restitution() };
    let (mut worst, mut worst_contact) = (-1.0, 0);
    for (i, contact) in problem.contacts().iter().enumerate() {
        let rho = problem.rho(i);
        let (normal_defect, normal) = match contact.normal {
            NormalForce::Prescribed(value) => (0.0, value),
            NormalForce::Unilateral => {
                let normal = percussion[contact.offset];
                (normal - f64::max(0.0, normal - rho * xi.of(contact.offset)), normal)
            }
        };
        let first = contact.tangent();
        let tangential = match &contact.law {
            Law::One(law) => tangential_defect(law, normal, rho, first, percussion, &xi),
            Law::Two(law) => tangential_defect(law, normal, rho, first, percussion, &xi),
            Law::Three(law) => tangential_defect(law, normal, rho, first, percussion, &xi),
        };
        let defect = normal_defect * normal_defect + tangential;
        let relative =
            if defect == 0.0 { 0.0 } else { defect / scale(problem, i, percussion, velocity) };
        // Not-a-number counts as the worst of all.
        if !(relative <= worst) {
            (worst, worst_contact) = (relative, i);
        }
    }
    let value = if worst < 0.0 { 0.0 } else { f64::sqrt(worst) };
    Residual { value, worst_contact }
}

/// Square of what the defect of a contact is compared with: its percussion, its free velocity and the
/// velocities that the other contacts bring, the latter times ρ.
#[inline]
fn scale(problem: &ContactProblem, i: usize, percussion: &[f64], velocity: &[f64]) -> f64 {
    let (contact, rho) = (&problem.contacts()[i], problem.rho(i));
    let loads = loads(problem, i, percussion, velocity);
    let (mut own, mut brought) = (0.0, 0.0);
    for (row, load) in (contact.rows()).zip(loads) {
        own += percussion[row] * percussion[row];
        let load = load + problem.free_velocity()[row].abs() + problem.restitution()[row].abs();
        brought += load * load;
    }
    f64::max(own, rho * rho * brought)
}

/// `Σ_j |G_ij P_j|` over the rows of contact `i`; with products only, `|Σ_j G_ij P_j|`.
#[inline]
fn loads(problem: &ContactProblem, i: usize, percussion: &[f64], velocity: &[f64]) -> [f64; 4] {
    let contact = &problem.contacts()[i];
    let own = contact.rows();
    let mut loads = [0.0; 4];
    if problem.contacts().len() == 1 {
        return loads;
    }
    match problem.delassus() {
        Delassus::Dense(g) => {
            for (load, row) in loads.iter_mut().zip(own) {
                for (j, p) in percussion.iter().enumerate() {
                    *load += (g[(row, j)] * p).abs();
                }
            }
        }
        Delassus::MatrixFree(..) => {
            for (load, row) in loads.iter_mut().zip(own) {
                *load = (velocity[row] - problem.free_velocity()[row]).abs();
            }
        }
        other => {
            let Some(blocks) = other.blocks() else { return loads };
            for (j, block) in blocks.row(i) {
                let first = problem.contacts()[j].offset;
                let columns = problem.contacts()[j].len();
                for (load, row) in loads.iter_mut().zip(block.chunks_exact(columns)) {
                    let terms = row.iter().zip(&percussion[first..]);
                    *load += terms.map(|(g, p)| (g * p).abs()).sum::<f64>();
                }
            }
        }
    }
    loads
}

/// Square of the tangential defect of one contact.
#[inline]
pub(super) fn tangential_defect<const P: usize>(
    law: &FrictionLaw<P>,
    normal: f64,
    rho: f64,
    first: usize,
    percussion: &[f64],
    xi: &ContactVelocity<'_>,
) -> f64 {
    let tangent = Vector::<P>::from_fn(|j, _| percussion[first + j]);
    if normal <= 0.0 {
        return tangent.norm_squared();
    }
    let slip = Vector::<P>::from_fn(|j, _| xi.of(first + j));
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

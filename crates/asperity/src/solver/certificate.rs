//! What is wrong with percussions, in physical units.

use asperity_set::{StarSet, Vector};

use super::natural::natural_map;
use super::phase::phase_of;
use super::residual::{ContactVelocity, natural_residual, tangential_defect};
use crate::contact::{ContactProblem, NormalForce, Phase};
use crate::law::{FrictionLaw, Law};

/// The violations of the contact laws by percussions `P`, found from the problem alone.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Certificate {
    /// Natural map of the whole problem, see [`natural_map`].
    pub natural_map: f64,
    /// Largest relative defect of a contact, see [`natural_residual`], and the contact that has it.
    pub contact_residual: f64,
    /// The contact with the largest relative defect.
    pub worst_contact: usize,
    /// Largest approaching velocity `max(0, −ξ_N)` in m/s.
    pub penetration_velocity: f64,
    /// Largest `|P_N ξ_N|` in J.
    pub complementarity: f64,
    /// Largest pull `max(0, −P_N)` in N s.
    pub tension: f64,
    /// Largest part of a friction percussion beyond its reservoir, `|P_T| (1 − 1/k_C(−P_T/P_N))` above
    /// zero, in N s: by so much it is too long.
    pub cone_violation: f64,
    /// Largest defect of the inclusion `ξ_T ∈ N_D(−αP_T)` in N s.
    pub direction_violation: f64,
    /// Number of open, sticking and slipping contacts.
    pub phases: [usize; 3],
}

impl Certificate {
    /// The violations of the laws by `percussion`.
    pub fn new(problem: &ContactProblem, percussion: &[f64]) -> Self {
        let mut velocity = vec![0.0; problem.rows()];
        problem.velocity(percussion, &mut velocity);
        let residual = natural_residual(problem, percussion, &velocity);
        let mut out = Self {
            natural_map: natural_map(problem, percussion, &velocity),
            contact_residual: residual.value,
            worst_contact: residual.worst_contact,
            ..Self::default()
        };
        let xi = ContactVelocity { velocity: &velocity, restitution: problem.restitution() };
        for (i, rows) in problem.contacts().iter().enumerate() {
            let normal = match rows.normal {
                NormalForce::Prescribed(value) => value,
                NormalForce::Unilateral => {
                    let (p, xi) = (percussion[rows.offset], xi.of(rows.offset));
                    raise(&mut out.penetration_velocity, -xi);
                    raise(&mut out.complementarity, (p * xi).abs());
                    raise(&mut out.tension, -p);
                    p
                }
            };
            let at = (normal, problem.rho(i), rows.tangent());
            let (beyond, direction) = match &rows.law {
                Law::One(law) => friction(law, at, percussion, &xi),
                Law::Two(law) => friction(law, at, percussion, &xi),
                Law::Three(law) => friction(law, at, percussion, &xi),
            };
            raise(&mut out.cone_violation, beyond);
            raise(&mut out.direction_violation, direction);
            match phase_of(problem, i, percussion, &velocity).0 {
                Phase::Slip => out.phases[2] += 1,
                Phase::Stick => out.phases[1] += 1,
                _ => out.phases[0] += 1,
            }
        }
        out
    }
}

/// Not-a-number is the worst of all, and stays.
fn raise(largest: &mut f64, value: f64) {
    if !(value <= *largest) && !largest.is_nan() {
        *largest = value;
    }
}

/// The part of the friction beyond its reservoir and the defect of the inclusion.
fn friction<const P: usize>(
    law: &FrictionLaw<P>,
    (normal, rho, first): (f64, f64, usize),
    percussion: &[f64],
    xi: &ContactVelocity<'_>,
) -> (f64, f64) {
    let tangent = Vector::<P>::from_fn(|j, _| -percussion[first + j]);
    let pushing = normal.max(0.0);
    // `P_N k_C(x/P_N) = k_C(x)`, also for an open contact.
    let gauge = if tangent.amax() == 0.0 { 0.0 } else { law.reservoir().gauge(&tangent) };
    let beyond = if gauge <= pushing { 0.0 } else { tangent.norm() * (1.0 - pushing / gauge) };
    let defect = tangential_defect(law, normal, rho, first, percussion, xi);
    (beyond, defect.sqrt())
}

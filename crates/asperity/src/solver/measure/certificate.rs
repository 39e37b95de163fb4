//! What is wrong with percussions, in physical units.

use super::natural_map;
use super::natural_residual::{Measured, Worst};
use super::phase::phase;
use crate::argument::ArgumentError;
use crate::contact::{ContactProblem, NormalForce, Phase};

/// The violations of the contact laws by percussions `P`, found from the problem alone.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct Certificate {
    /// Natural map of the whole problem, see [`natural_map`](crate::solver::natural_map).
    pub natural_map: f64,
    /// Largest relative defect of a contact, see [`natural_residual`](crate::solver::natural_residual), and the contact that has it.
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
    /// Largest distance of friction percussion and velocity from a pair that obeys the law, in N s, see
    /// [`natural_residual`](crate::solver::natural_residual).
    pub direction_violation: f64,
    /// Number of open, sticking and slipping contacts.
    pub phases: [usize; 3],
}

impl Certificate {
    /// The violations of the laws by `percussion`.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] if there is not one percussion per row.
    pub fn new(problem: &ContactProblem, percussion: &[f64]) -> Result<Self, ArgumentError> {
        let velocity = problem.velocities(percussion)?;
        Ok(Self::of(&Measured { problem, percussion, velocity: &velocity }))
    }

    /// The violations of the laws by percussions whose velocities are known.
    pub(crate) fn of(measured: &Measured<'_>) -> Self {
        let Measured { problem, percussion, .. } = *measured;
        let mut out = Self { natural_map: natural_map::map(measured), ..Self::default() };
        let mut worst = Worst::NONE;
        for (i, rows) in problem.contacts().iter().enumerate() {
            if rows.normal == NormalForce::Unilateral {
                let (p, xi) = (percussion[rows.offset], measured.xi(rows.offset));
                raise(&mut out.penetration_velocity, -xi);
                raise(&mut out.complementarity, (p * xi).abs());
                raise(&mut out.tension, -p);
            }
            let friction = measured.friction(rows);
            let violation = rows.law.violation(friction, problem.rho(i));
            raise(&mut out.cone_violation, violation.excess);
            raise(&mut out.direction_violation, violation.squared_defect.sqrt());
            worst.add(measured, i);
            match phase(measured, i, friction.normal, || violation.slips) {
                Phase::Slip => out.phases[2] += 1,
                Phase::Stick => out.phases[1] += 1,
                _ => out.phases[0] += 1,
            }
        }
        let residual = worst.residual();
        (out.contact_residual, out.worst_contact) = (residual.value, residual.worst_contact);
        out
    }
}

/// Not-a-number is the worst of all, and stays.
fn raise(largest: &mut f64, value: f64) {
    if !(value <= *largest) && !largest.is_nan() {
        *largest = value;
    }
}

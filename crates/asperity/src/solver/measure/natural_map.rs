//! The natural map of a whole problem, one number for all contacts.

use super::natural_residual::{Measured, relative};
use crate::argument::ArgumentError;
use crate::contact::{ContactProblem, ContactRows, NormalForce};
use crate::vectors::{norm, unrolled};

/// `‖P − prox(P − ρξ)‖ / max(‖P‖, ρ‖b‖)` with `ρ = rows/tr G` for the whole problem, independent of units.
///
/// Isotropic unilateral contacts enter with the projection onto their friction cone, `ξ_N` enlarged by
/// `μ‖ξ_T‖` (\[DeSaxceFeng1998\], \[AcaryBremondHuber2018\]); others with the defects of normal and friction
/// percussion, as in [`natural_residual`](crate::solver::natural_residual).
///
/// # Errors
///
/// [`ArgumentError`] if there is not one percussion and one velocity `γ_E` per row.
pub fn natural_map(
    problem: &ContactProblem,
    percussion: &[f64],
    velocity: &[f64],
) -> Result<f64, ArgumentError> {
    Ok(map(&Measured::checked(problem, percussion, velocity)?))
}

/// See [`natural_map`].
pub(crate) fn map(measured: &Measured<'_>) -> f64 {
    map_with(measured, Scale::of(measured.problem))
}

/// The same with the scale of the problem, which does not depend on percussions.
pub(crate) fn map_with(measured: &Measured<'_>, scale: Scale) -> f64 {
    // Squares of percussions in one loop over all rows: contact by contact it takes longer than the defects of most.
    let contacts = measured.problem.contacts().iter();
    let defect = contacts.map(|contact| contact_defect(measured, contact, scale.rho)).sum();
    let percussion = measured.percussion.iter().map(|p| p * p).sum();
    let all = Squares { defect, percussion };
    all.relative(scale.loads.powi(2)).sqrt()
}

/// What the natural map of a whole problem is measured with.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Scale {
    /// `ρ = rows/tr G`.
    pub(crate) rho: f64,
    /// `ρ‖b + e γ_B‖`.
    pub(crate) loads: f64,
}

impl Scale {
    /// Of a problem.
    pub(crate) fn of(problem: &ContactProblem) -> Self {
        let rho = problem.global_rho();
        Self { rho, loads: rho * problem.load_norm() }
    }
}

/// The same of contacts that influence no others, as if there were only these, and what it is relative to, a percussion.
pub(crate) fn map_of(measured: &Measured<'_>, contacts: &[usize]) -> (f64, f64) {
    let (all, loads) = own_squares(measured, contacts);
    (all.relative(loads).sqrt(), all.percussion.max(loads).sqrt())
}

/// Squares of contacts that influence no others with their own prox parameter `ρ`, and that of `ρ‖b‖`.
pub(crate) fn own_squares(measured: &Measured<'_>, contacts: &[usize]) -> (Squares, f64) {
    let problem = measured.problem;
    let (mut rows, mut trace, mut loads) = (0, 0.0, 0.0);
    for &i in contacts {
        let contact = &problem.contacts()[i];
        rows += contact.len();
        trace += contact.len() as f64 / problem.rho(i);
        for row in contact.rows() {
            loads += (problem.free_velocity()[row] + problem.restitution()[row]).powi(2);
        }
    }
    let rho = rows as f64 / trace;
    (Squares::of(measured, contacts.iter().copied(), rho), rho * rho * loads)
}

/// Sums of the squares of defects and of percussions.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Squares {
    defect: f64,
    percussion: f64,
}

impl Squares {
    /// Of some contacts, with the prox parameter of the whole problem.
    pub(crate) fn of(
        measured: &Measured<'_>,
        contacts: impl Iterator<Item = usize>,
        rho: f64,
    ) -> Self {
        let mut sums = Self::default();
        for i in contacts {
            let contact = &measured.problem.contacts()[i];
            sums.defect += contact_defect(measured, contact, rho);
            for p in &measured.percussion[contact.rows()] {
                sums.percussion += p * p;
            }
        }
        sums
    }

    /// Square of the natural map of all contacts, whose loads have this square, times that of `ρ`.
    pub(crate) fn relative(&self, loads: f64) -> f64 {
        relative(self.defect, || f64::max(self.percussion, loads))
    }
}

/// Square of the defect of a contact.
fn contact_defect(measured: &Measured<'_>, contact: &ContactRows, rho: f64) -> f64 {
    match contact.law.isotropic_coefficient() {
        Some(mu) if contact.normal == NormalForce::Unilateral => {
            cone_defect(measured, contact, mu, rho)
        }
        _ => measured.defect(contact, rho),
    }
}

/// `‖r − P_K(r − ρξ̃)‖²` with `ξ̃_N = ξ_N + μ‖ξ_T‖` and the friction cone `K`, for isotropic friction.
fn cone_defect(measured: &Measured<'_>, contact: &ContactRows, mu: f64, rho: f64) -> f64 {
    let Measured { problem, percussion, velocity } = *measured;
    let (normal, rows) = (percussion[contact.offset], contact.tangential_rows());
    unrolled!(n = rows.len() => {
        let tangent = &percussion[rows.clone()][..n];
        let (velocity, restitution) =
            (&velocity[rows.clone()][..n], &problem.restitution()[rows][..n]);
        let (mut slip, mut z_t) = ([0.0; 3], [0.0; 3]);
        for k in 0..n {
            slip[k] = velocity[k] + restitution[k];
            z_t[k] = tangent[k] - slip[k] * rho;
        }
        let z_n = normal - rho * (measured.xi(contact.offset) + mu * norm(&slip[..n]));
        let z_size = norm(&z_t[..n]);
        let (p_n, part) = if z_size <= mu * z_n {
            (z_n, 1.0)
        } else if mu * z_size <= -z_n {
            (0.0, 0.0)
        } else {
            let p_n = (z_n + mu * z_size) / (1.0 + mu * mu);
            (p_n, mu * p_n / z_size)
        };
        let aside = tangent.iter().zip(&z_t).map(|(p, z)| (p - z * part) * (p - z * part));
        (normal - p_n) * (normal - p_n) + aside.sum::<f64>()
    })
}

//! Delassus operator, free velocities and laws in; percussions out.

use nalgebra::DMatrix;
use thiserror::Error;

use crate::law::Law;

/// How the normal force of a contact is found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NormalForce {
    /// The normal percussion is given; the contact has tangential rows only.
    Prescribed(f64),
    /// `0 ≤ P_N ⊥ ξ_N ≥ 0`; the normal row comes first.
    Unilateral,
}

/// One contact of a problem.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactRows {
    /// Friction law.
    pub law: Law,
    /// Normal force.
    pub normal: NormalForce,
    /// First row.
    pub offset: usize,
}

impl ContactRows {
    /// Number of normal rows, 0 or 1.
    pub fn normal_rows(&self) -> usize {
        usize::from(self.normal == NormalForce::Unilateral)
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.normal_rows() + self.law.dimension()
    }

    /// Whether the contact has no rows, which never happens.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// First tangential row.
    pub fn tangent(&self) -> usize {
        self.offset + self.normal_rows()
    }
}

/// A contact problem could not be made.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ProblemError {
    /// An array has the wrong length.
    #[error("{argument}: must have {expected} entries, has {got}")]
    Length {
        /// Name of the argument.
        argument: &'static str,
        /// Length that fits the laws.
        expected: usize,
        /// Length that was given.
        got: usize,
    },
    /// A law depends on the speed, which one step takes as given.
    #[error("laws: must not have a factor of the speed; scale the tangential columns of G by it")]
    Rated,
    /// A number is out of range.
    #[error("{argument}: must be {allowed}, got {value}")]
    Value {
        /// Name of the argument.
        argument: &'static str,
        /// The values that are allowed.
        allowed: &'static str,
        /// The value that was given.
        value: f64,
    },
}

impl ProblemError {
    /// Name of the argument that is wrong.
    pub fn argument(&self) -> &'static str {
        match self {
            Self::Length { argument, .. } | Self::Value { argument, .. } => argument,
            Self::Rated => "laws",
        }
    }
}

/// `γ_E = G P + b` with the contact laws between the percussions `P` and `ξ = γ_E + e γ_B`
/// (\[WL19\] (19), restitution as usual). Nothing in it knows the mechanical system.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactProblem {
    /// `G`, not necessarily symmetric.
    pub(crate) delassus: DMatrix<f64>,
    /// `b`.
    pub(crate) free_velocity: Vec<f64>,
    /// `e γ_B`.
    pub(crate) restitution: Vec<f64>,
    pub(crate) contacts: Vec<ContactRows>,
    /// `ρ = rows/tr G` of every contact's own block, the prox parameter of the residual.
    pub(crate) rho: Vec<f64>,
}

impl ContactProblem {
    /// A problem without restitution.
    pub fn new(
        delassus: DMatrix<f64>,
        free_velocity: Vec<f64>,
        contacts: impl IntoIterator<Item = (Law, NormalForce)>,
    ) -> Result<Self, ProblemError> {
        let mut offset = 0;
        let contacts: Vec<ContactRows> = contacts
            .into_iter()
            .map(|(law, normal)| {
                let rows = ContactRows { law, normal, offset };
                offset += rows.len();
                rows
            })
            .collect();
        check_length("free_velocity", offset, free_velocity.len())?;
        check_length("delassus", offset, delassus.nrows())?;
        check_length("delassus", offset, delassus.ncols())?;
        check_finite("delassus", delassus.as_slice())?;
        check_finite("free_velocity", &free_velocity)?;
        for contact in &contacts {
            let dimension = contact.law.dimension();
            if dimension > 2 {
                let (allowed, value) = ("laws of dimension 1 or 2", dimension as f64);
                return Err(ProblemError::Value { argument: "laws", allowed, value });
            }
            if contact.law.rate().is_some() {
                return Err(ProblemError::Rated);
            }
            if let NormalForce::Prescribed(value) = contact.normal
                && !(value.is_finite() && value >= 0.0)
            {
                let allowed = "finite and not negative";
                return Err(ProblemError::Value { argument: "normal_force", allowed, value });
            }
            for row in contact.offset..contact.offset + contact.len() {
                let value = delassus[(row, row)];
                if value <= 0.0 {
                    let allowed = "positive on its diagonal";
                    return Err(ProblemError::Value { argument: "delassus", allowed, value });
                }
            }
        }
        let (restitution, rho) = (vec![0.0; offset], vec![0.0; contacts.len()]);
        let mut problem = Self { delassus, free_velocity, restitution, contacts, rho };
        problem.update_rho();
        Ok(problem)
    }

    /// The problem with restitution: coefficients `e_N`, `e_T` per contact and velocities `γ_B` before,
    /// row by row.
    pub fn with_restitution(
        mut self,
        normal: &[f64],
        tangential: &[f64],
        initial_velocity: &[f64],
    ) -> Result<Self, ProblemError> {
        check_length("normal_restitution", self.contacts.len(), normal.len())?;
        check_length("tangential_restitution", self.contacts.len(), tangential.len())?;
        check_length("initial_velocity", self.rows(), initial_velocity.len())?;
        check_finite("normal_restitution", normal)?;
        check_finite("tangential_restitution", tangential)?;
        check_finite("initial_velocity", initial_velocity)?;
        for ((contact, e_n), e_t) in self.contacts.iter().zip(normal).zip(tangential) {
            let own = contact.offset..contact.offset + contact.len();
            let terms = self.restitution[own.clone()].iter_mut().zip(&initial_velocity[own]);
            for (k, (term, velocity)) in terms.enumerate() {
                *term = velocity * if k < contact.normal_rows() { e_n } else { e_t };
            }
        }
        Ok(self)
    }

    /// Brings `ρ` up to date with the Delassus operator.
    pub(crate) fn update_rho(&mut self) {
        for (rho, contact) in self.rho.iter_mut().zip(&self.contacts) {
            let own = contact.offset..contact.offset + contact.len();
            *rho = contact.len() as f64 / own.map(|row| self.delassus[(row, row)]).sum::<f64>();
        }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.free_velocity.len()
    }

    /// The contacts with their rows.
    pub fn contacts(&self) -> &[ContactRows] {
        &self.contacts
    }

    /// Delassus operator `G`.
    pub fn delassus(&self) -> &DMatrix<f64> {
        &self.delassus
    }

    /// Free velocities `b`.
    pub fn free_velocity(&self) -> &[f64] {
        &self.free_velocity
    }

    /// Velocity `(G P + b)` of one row.
    #[inline]
    pub fn row_velocity(&self, row: usize, percussion: &[f64]) -> f64 {
        let mut sum = self.free_velocity[row];
        for (j, p) in percussion.iter().enumerate() {
            sum += self.delassus[(row, j)] * p;
        }
        sum
    }

    /// Velocities `γ_E = G P + b`.
    #[inline]
    pub fn velocity(&self, percussion: &[f64], velocity: &mut [f64]) {
        velocity.copy_from_slice(&self.free_velocity);
        let (entries, n) = (self.delassus.as_slice(), self.rows());
        for (j, p) in percussion.iter().enumerate() {
            for (value, g) in velocity.iter_mut().zip(&entries[j * n..(j + 1) * n]) {
                *value += g * p;
            }
        }
    }
}

fn check_length(argument: &'static str, expected: usize, got: usize) -> Result<(), ProblemError> {
    if expected == got {
        return Ok(());
    }
    Err(ProblemError::Length { argument, expected, got })
}

fn check_finite(argument: &'static str, values: &[f64]) -> Result<(), ProblemError> {
    match values.iter().find(|v| !v.is_finite()) {
        Some(&value) => Err(ProblemError::Value { argument, allowed: "finite", value }),
        None => Ok(()),
    }
}

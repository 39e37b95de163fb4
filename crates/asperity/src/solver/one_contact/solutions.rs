//! All solutions of one contact, the others held.

use super::block::Block;
use super::solve::OneContact;
use crate::argument::{ArgumentError, refuse};
use crate::contact::{ContactProblem, Phase};

/// One of the solutions of a contact, on the contact's own rows.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ContactSolution {
    /// What the contact does.
    pub phase: Phase,
    /// Percussions.
    pub percussion: Vec<f64>,
    /// Velocities `γ_E`.
    pub velocity: Vec<f64>,
    /// Not isolated, or a double root: perturbing the data may remove or split it.
    pub degenerate: bool,
}

/// All solutions of one contact, the percussions of the others held: open, stick, then slips
/// counter-clockwise along bdry *D*.
///
/// There must be such a contact with p ≤ 2, one percussion per row, and an operator with entries.
///
/// # Errors
///
/// [`ArgumentError`] if one of these does not hold.
pub fn solutions(
    problem: &ContactProblem,
    contact: usize,
    percussion: &[f64],
) -> Result<Vec<ContactSolution>, ArgumentError> {
    let Some(rows) = problem.contacts().get(contact) else {
        return refuse("contact", "must be the number of a contact of the problem");
    };
    if rows.law.dimension() > 2 {
        return refuse("contact", "must have p = 1 or 2: solutions with p = 3 are not listed");
    }
    if problem.delassus().is_matrix_free() {
        return refuse("delassus", "must have entries: products alone do not list solutions");
    }
    problem.check_rows("percussion", percussion)?;
    let own = rows.rows();
    let mut all = percussion.to_vec();
    let block = Block::new(problem, contact);
    let mut found = Vec::new();
    OneContact::new(problem, contact, &block, percussion).visit_all(&mut |phase, p, degenerate| {
        all[own.clone()].copy_from_slice(p);
        let xi = problem.contact_velocity(contact, &all, true);
        let velocity = own.clone().zip(xi).map(|(row, xi)| xi - problem.restitution()[row]);
        let velocity = velocity.collect();
        found.push(ContactSolution { phase, percussion: p.to_vec(), velocity, degenerate });
    });
    Ok(found)
}

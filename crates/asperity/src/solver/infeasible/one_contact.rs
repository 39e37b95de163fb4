//! Proofs that a contact that no other contact influences has no solution.

use super::proof::{Infeasibility, InfeasibilityKind};
use crate::contact::{ContactProblem, NormalForce};
use crate::solver::one_contact::block::Block;
use crate::solver::one_contact::solve::OneContact;

/// A proof by the search of all states of a contact that no other contact influences.
pub(crate) fn prove_one_contact(
    problem: &ContactProblem,
    contact: usize,
    percussion: &[f64],
) -> Option<Infeasibility> {
    let rows = &problem.contacts()[contact];
    let mut alone = true;
    for row in rows.rows() {
        problem.each_entry(contact, row, |j, _, g| alone &= j == contact || g == 0.0);
    }
    if !alone || problem.delassus().is_matrix_free() {
        return None;
    }
    let block = Block::new(problem, contact);
    if !OneContact::new(problem, contact, &block, percussion).proves_no_solution() {
        return None;
    }
    let mut direction = vec![0.0; problem.rows()];
    let mut closing_velocity = 0.0;
    if rows.normal == NormalForce::Unilateral {
        direction[rows.offset] = 1.0;
        closing_velocity = -problem.load(contact)[0];
    }
    let kind = InfeasibilityKind::OneContact;
    let cases = Vec::new();
    Some(Infeasibility { kind, contact, direction, closing_velocity, residual: 0.0, cases })
}

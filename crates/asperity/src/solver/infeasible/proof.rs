//! What a proof that there is no solution says.

use crate::contact::ContactProblem;

/// Why a problem has no solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum InfeasibilityKind {
    /// Contacts close on each other whatever the percussions: a convex combination of their normal velocities
    /// does not depend on percussions and is negative.
    Closing,
    /// A contact that no other contact influences has no solution (Painlevé's paradox): the complete search of
    /// its open, sticking and slipping states finds none.
    OneContact,
    /// All that a few contacts can do together is divided into cases, each of which is empty.
    Cases,
}

impl InfeasibilityKind {
    /// Name of the kind.
    pub fn name(self) -> &'static str {
        match self {
            Self::Closing => "closing",
            Self::OneContact => "one_contact",
            Self::Cases => "cases",
        }
    }
}

/// An entry of a proof by cases, which are listed depth first.
#[derive(Debug, Clone, PartialEq)]
pub enum Case {
    /// The case is divided by what this contact does: its parts follow.
    Divided(usize),
    /// The vector `z` of the rows that shows the case to be empty.
    Empty(Vec<f64>),
}

/// A proof that a problem has no solution, which can be checked without a solver.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Infeasibility {
    /// What kind of proof.
    pub kind: InfeasibilityKind,
    /// The contact without a solution, or the one with the largest part in the combination.
    pub contact: usize,
    /// Weights `d` of the rows: not negative, on normal rows only, with sum one; of one contact its normal row.
    pub direction: Vec<f64>,
    /// `−d·(b + e γ_B)`, the velocity in m/s with which the contacts close.
    pub closing_velocity: f64,
    /// `max_j |(Gᵀd)_j|/s_j` over `max_i s_i d_i`, `s = √diag G`: what of the closing velocity percussions change; of bodies
    /// `max_k |(W d)_k|/max_j |W_kj|` over `max_i d_i`.
    pub residual: f64,
    /// Of a proof by cases the cases, of others none.
    pub cases: Vec<Case>,
}

/// A contact problem of a motion that has no solution.
#[derive(Debug, Clone, PartialEq)]
pub struct Unsolvable {
    /// The problem; the laws may have factors of the speed, which its operator holds then.
    pub problem: ContactProblem,
    /// The system's contacts in it.
    pub contacts: Vec<usize>,
    /// Why it has no solution.
    pub infeasibility: Infeasibility,
}

impl Unsolvable {
    /// Velocities `b + e γ_B` without percussions.
    pub fn load(&self) -> Vec<f64> {
        let restitution = self.problem.restitution().iter();
        self.problem.free_velocity().iter().zip(restitution).map(|(b, e)| b + e).collect()
    }
}

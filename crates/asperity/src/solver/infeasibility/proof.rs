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
    /// Contacts that influence each other have no solution together: each case of what they do, open, stick, slip
    /// in some sector of directions, is refuted by a combination of velocities.
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

/// A proof that a problem has no solution, which can be checked without a solver.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Infeasibility {
    /// What kind of proof.
    pub kind: InfeasibilityKind,
    /// The contact without a solution, or the one with the largest part in the combination.
    pub contact: usize,
    /// Weights `d` of the rows: not negative, on normal rows only, with sum one; of one contact, and of cases, the
    /// normal row of `contact`.
    pub direction: Vec<f64>,
    /// `−d·(b + e γ_B)`, the velocity in m/s with which the contacts close.
    pub closing_velocity: f64,
    /// `max_j |(Gᵀd)_j|/s_j` over `max_i s_i d_i`, `s = √diag G`: what of the closing velocity percussions change; of bodies
    /// with `G = Wᵀ M⁻¹ W` of the masses `M_kk = Σ_j W_kj²`; of cases, the most that any of them leaves to rounding.
    pub residual: f64,
    /// The cases, which together are all that the contacts can do; of the other kinds none.
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

/// What a contact is taken to do in a case.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum CaseState {
    /// Anything that friction can do, slipping or not.
    Any,
    /// No percussion.
    Open,
    /// No normal velocity.
    Closed,
    /// No velocity.
    Stick,
    /// Slip in a direction between two angles in rad; on a line 0 and π are the two directions.
    Slip {
        /// Where the sector begins.
        from: f64,
        /// Where it ends.
        to: f64,
    },
}

impl CaseState {
    /// Name of the state.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Any => "any",
            Self::Open => "open",
            Self::Closed => "closed",
            Self::Stick => "stick",
            Self::Slip { .. } => "slip",
        }
    }
}

/// A case without a solution.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// What every contact does.
    pub states: Vec<CaseState>,
    /// `z`, a component for each row.
    pub direction: Vec<f64>,
}

//! How a solve ended.

use super::{Residual, Workspace};

/// Status of a solve; the text says what to try.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// The residual is below the tolerance.
    Converged,
    /// The iteration limit came first.
    MaxIterations,
    /// The time limit came first.
    TimeLimit,
    /// The solver is done, but rounding keeps the residual above the tolerance.
    Inexact,
    /// A contact has no solution at all (Painlevé's paradox), the others held.
    NoSolution,
    /// The solver does not know all the laws or needs the entries of a matrix-free operator.
    NotApplicable,
}

impl Status {
    /// Name of the status.
    pub fn name(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::MaxIterations => "max_iterations",
            Self::TimeLimit => "time_limit",
            Self::Inexact => "inexact",
            Self::NoSolution => "no_solution",
            Self::NotApplicable => "not_applicable",
        }
    }
}

/// What a solver says of its result.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolveReport {
    /// How it ended.
    pub status: Status,
    /// Sweeps or iterations.
    pub iterations: usize,
    /// Relative natural residual.
    pub residual: f64,
    /// The contact with the largest residual, or the one without a solution.
    pub worst_contact: usize,
    /// Whether some contact had more than one solution.
    pub ambiguous: bool,
}

impl SolveReport {
    /// The residual alone decides whether the problem is solved; `ended` and the contact that percussions run
    /// away from say why it is not.
    pub(super) fn new(
        ended: Ended,
        iterations: usize,
        residual: Residual,
        runaway: Option<usize>,
        tolerance: f64,
        workspace: &Workspace,
    ) -> Self {
        let solved = residual.value <= tolerance;
        let (status, worst_contact) = match (ended, runaway) {
            _ if solved => (Status::Converged, residual.worst_contact),
            (Ended::NotApplicable, _) => (Status::NotApplicable, residual.worst_contact),
            (_, Some(contact)) => (Status::NoSolution, contact),
            (Ended::NoSolution(contact), _) => (Status::NoSolution, contact),
            (Ended::TimeLimit, _) => (Status::TimeLimit, residual.worst_contact),
            (Ended::Done, _) => (Status::Inexact, residual.worst_contact),
            (Ended::MaxIterations, _) => (Status::MaxIterations, residual.worst_contact),
        };
        let ambiguous = workspace.ambiguous.iter().any(|&several| several);
        Self { status, iterations, residual: residual.value, worst_contact, ambiguous }
    }
}

/// Why a solver stopped.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Ended {
    Done,
    MaxIterations,
    TimeLimit,
    NoSolution(usize),
    NotApplicable,
}

/// A method that is a phase of [`Solver::Auto`](super::Solver::Auto).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Sweeps of exact one-contact solves.
    GaussSeidel,
    /// The paper's prox iterations.
    Prox,
    /// Semismooth Newton.
    Newton,
    /// Interior point.
    InteriorPoint,
    /// Proximal point iteration.
    ProximalPoint,
    /// Alternating direction method of multipliers.
    Admm,
}

impl Method {
    /// Name of the method.
    pub fn name(self) -> &'static str {
        match self {
            Self::GaussSeidel => "gauss_seidel",
            Self::Prox => "prox",
            Self::Newton => "newton",
            Self::InteriorPoint => "interior_point",
            Self::ProximalPoint => "proximal_point",
            Self::Admm => "admm",
        }
    }
}

/// What a phase did.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stage {
    /// Its method.
    pub method: Method,
    /// Sweeps, iterations or outer steps.
    pub iterations: usize,
    /// Matrices factored.
    pub factorizations: usize,
    /// What was reached: natural map of the best percussions, of a solver without phases its residual.
    pub residual: f64,
}

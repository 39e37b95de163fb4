//! How a solve ended.

use super::measure::approach::Flaw;
use super::measure::natural_residual::{ROUNDED, Residual};

/// Status of a solve; the text says what to try.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Status {
    /// The residual is below the tolerance.
    Converged,
    /// The iteration limit was reached before.
    MaxIterations,
    /// The time limit came first.
    TimeLimit,
    /// The solver is done, but rounding keeps the residual above the tolerance.
    Inexact,
    /// The solver makes no further progress above the tolerance.
    Stalled,
    /// Percussions grow without bound while a contact goes on moving, which is named: there is probably no solution, but
    /// that is not proven.
    Unbounded,
    /// There is no solution: [`Workspace::infeasibility`](super::Workspace::infeasibility) holds the proof.
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
            Self::Stalled => "stalled",
            Self::Unbounded => "unbounded",
            Self::NoSolution => "no_solution",
            Self::NotApplicable => "not_applicable",
        }
    }
}

/// What a solver says of its result.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct SolveReport {
    /// How it ended.
    pub status: Status,
    /// Sweeps or iterations.
    pub iterations: usize,
    /// Relative natural residual.
    pub residual: f64,
    /// The contact with the largest residual, the one that goes on moving, or the one without a solution.
    pub worst_contact: usize,
    /// Whether some contact had more than one solution.
    pub ambiguous: bool,
}

impl SolveReport {
    /// What measures and proofs say of a result; why the method `ended` matters only where they decide nothing.
    #[inline]
    pub(crate) fn new(
        ended: Ended,
        iterations: usize,
        residual: Residual,
        findings: Findings,
        tolerance: f64,
    ) -> Self {
        let Findings { flaw, without_solution, ambiguous } = findings;
        let worst = residual.worst_contact;
        let small = residual.value <= tolerance;
        let (status, worst_contact) = match (ended, without_solution, flaw) {
            (_, Some(contact), _) => (Status::NoSolution, contact),
            (_, _, None) if small => (Status::Converged, worst),
            (Ended::NotApplicable, ..) => (Status::NotApplicable, worst),
            (Ended::TimeLimit, ..) => (Status::TimeLimit, worst),
            (Ended::Unbounded(contact), ..) => (Status::Unbounded, contact),
            (_, _, Some(flaw)) if small => (flaw_status(flaw), flaw.contact),
            (Ended::MaxIterations, ..) => (Status::MaxIterations, worst),
            (_, _, Some(flaw)) if flaw.unbounded => (Status::Unbounded, flaw.contact),
            (Ended::Done, ..) if residual.value <= ROUNDED => (Status::Inexact, worst),
            (Ended::Done, ..) => (Status::Stalled, worst),
            (Ended::Stalled, ..) => (Status::Stalled, worst),
            (Ended::Stuck(contact), ..) => (Status::Stalled, contact),
        };
        Self { status, iterations, residual: residual.value, worst_contact, ambiguous }
    }

    /// Takes in the residual of another measure, with which what was solved may be inexact.
    pub(crate) fn measure_again(&mut self, residual: Residual, tolerance: f64) {
        self.residual = residual.value;
        if self.status == Status::Converged && !(residual.value <= tolerance) {
            let rounded = residual.value <= ROUNDED;
            self.status = if rounded { Status::Inexact } else { Status::Stalled };
        }
    }
}

/// The status of percussions with a flaw.
pub(crate) fn flaw_status(flaw: Flaw) -> Status {
    if flaw.unbounded { Status::Unbounded } else { Status::Stalled }
}

/// What was found out about the percussions in which a solve ended.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Findings {
    /// Why percussions are no solution however small their residual is.
    pub(crate) flaw: Option<Flaw>,
    /// The contact of a proof that there is no solution.
    pub(crate) without_solution: Option<usize>,
    /// Whether some contact has several solutions.
    pub(crate) ambiguous: bool,
}

/// Why a method stopped.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Ended {
    /// There is nothing left to do.
    Done,
    /// The iteration limit of the user is reached.
    MaxIterations,
    /// The time limit is reached, or the user has cancelled.
    TimeLimit,
    /// No further progress.
    Stalled,
    /// Percussions have grown beyond what rounding can resolve while this contact goes on approaching.
    Unbounded(usize),
    /// No solution was found for this contact, the others held.
    Stuck(usize),
    /// The method does not take these laws or operators.
    NotApplicable,
}

/// What a stage of a solve was.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Method {
    /// Sweeps of exact one-contact solves.
    GaussSeidel,
    /// The same with Anderson's acceleration.
    AcceleratedGaussSeidel,
    /// Percussions of least norm with which no body moves.
    LeastNorm,
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
            Self::AcceleratedGaussSeidel => "accelerated_gauss_seidel",
            Self::LeastNorm => "least_norm",
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
#[non_exhaustive]
pub struct Stage {
    /// Its method.
    pub method: Method,
    /// Sweeps, iterations or outer steps.
    pub iterations: usize,
    /// Matrices factored.
    pub factorizations: usize,
    /// What was reached: natural map of the best percussions, of several islands the largest. Of a solver without phases, and
    /// of sweeps over all islands before some of them go on by themselves, it is the residual that decides, but for islands
    /// whose natural map is far from small, of which it is that.
    pub residual: f64,
}

impl Stage {
    /// Of a method that factors nothing and is measured by the residual.
    pub(crate) fn of(method: Method, iterations: usize, residual: Residual) -> Self {
        Self { method, iterations, factorizations: 0, residual: residual.value }
    }
}

#[cfg(test)]
mod tests;

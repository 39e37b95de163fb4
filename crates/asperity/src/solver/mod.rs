//! Solvers of contact problems.
//!
//! | solver | file | method |
//! |---|---|---|
//! | [`Solver::Auto`] | `many/phases.rs` | sweeps, Newton, interior point, proximal point: what it takes |
//! | [`Solver::Exact`] | `exact.rs`, `line.rs`, `plane/` | block Gauss–Seidel, every contact solved exactly |
//! | [`Solver::ProxJacobi`] | `prox.rs` | the iteration of \[WL19\] (20)–(22), (69), (70) |
//! | [`Solver::ProxGaussSeidel`] | `prox.rs` | the same, contact after contact |
//! | [`Solver::Newton`] | `many/newton.rs` | semismooth Newton on the natural map |
//! | [`Solver::ProximalPoint`] | `many/proximal.rs` | Newton within a proximal point iteration |
//! | [`Solver::InteriorPoint`] | `many/interior.rs` | primal-dual, elliptic laws |
//! | [`Solver::Admm`] | `many/admm.rs` | few factorisations, elliptic laws |
//!
//! The measures in `residual.rs` and `natural.rs` belong to no solver and grade them all.

mod block;
mod cases;
mod certificate;
mod effort;
mod exact;
mod growth;
mod infeasible;
mod line;
mod local;
mod many;
mod natural;
mod natural_map;
mod nonnegative;
mod phase;
mod plane;
mod prox;
mod quick;
mod report;
mod residual;
mod single;
mod singular;
mod solutions;
mod space;
mod stop;
mod threads;

pub use cases::{Case, CaseState};
pub use certificate::Certificate;
pub(crate) use exact::settle;
pub use infeasible::{Infeasibility, InfeasibilityKind, Unsolvable};
pub use natural::natural_map;
pub(crate) use plane::Rising;
pub use prox::ProxStep;
pub use report::{Method, SolveReport, Stage, Status};
pub use residual::{Residual, natural_residual};
pub use solutions::{ContactSolution, solutions};
pub use stop::{Measure, Stop};

use crate::contact::{ContactProblem, ContactState, Memory};
use block::Block;
use effort::Effort;
use growth::{Groups, Kind};
use local::LocalSolution;
use report::{Ended, Findings};
use threads::Threads;

/// A solver and its options.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Solver {
    /// Block Gauss–Seidel whose one-contact solve is exact; one contact needs one sweep.
    Exact {
        /// Sweeps after which the solver gives up.
        max_sweeps: usize,
    },
    /// The solver for everything: sweeps first, then what the problem needs.
    Auto {
        /// Whether the interior point method may be used where the laws allow it.
        interior_point: bool,
        /// Threads for work that is done contact by contact; results do not depend on it.
        threads: usize,
    },
    /// Semismooth Newton on the natural map: problems of full rank.
    Newton {
        /// Iterations after which the solver gives up.
        max_iterations: usize,
    },
    /// Newton within a proximal point iteration: problems without full rank.
    ProximalPoint {
        /// Outer steps after which the solver gives up.
        max_iterations: usize,
    },
    /// Primal-dual interior point method: unilateral contacts with ellipsoids as reservoir and direction set.
    InteriorPoint {
        /// Iterations after which the solver gives up.
        max_iterations: usize,
    },
    /// Alternating direction method of multipliers, for the same laws.
    Admm {
        /// Iterations after which the solver gives up.
        max_iterations: usize,
    },
    /// The paper's iteration: all contacts at once.
    ProxJacobi {
        /// Prox parameter.
        step: ProxStep,
        /// Iterations after which the solver gives up.
        max_iterations: usize,
    },
    /// The paper's iteration, contact after contact.
    ProxGaussSeidel {
        /// Prox parameter.
        step: ProxStep,
        /// Iterations after which the solver gives up.
        max_iterations: usize,
    },
}

/// Buffers that live as long as the problem keeps its size.
#[derive(Debug, Clone, Default)]
pub struct Workspace {
    percussion: Vec<f64>,
    /// `γ_E` at the last call.
    pub velocity: Vec<f64>,
    /// Contacts that had more than one solution at the last call.
    pub ambiguous: Vec<bool>,
    /// The proof, where the last call ended as [`Status::NoSolution`].
    pub infeasibility: Option<Infeasibility>,
    /// Diagonal blocks of `G`, prepared.
    blocks: Vec<Block>,
    planar: Vec<LocalSolution<2>>,
    linear: Vec<LocalSolution<1>>,
    states: Vec<ContactState>,
    /// What is left of the work on contacts in sweeps.
    efforts: Vec<Effort>,
    next: Vec<f64>,
    /// What [`Solver::Auto`] and its phases did at the last call.
    pub stages: Vec<Stage>,
    groups: Groups,
    many: Option<Box<many::Many>>,
}

impl Workspace {
    /// Buffers for this problem; to be called again whenever its Delassus operator or its laws change.
    pub fn prepare(&mut self, problem: &ContactProblem) {
        let (rows, contacts) = (problem.rows(), problem.contacts().len());
        self.percussion.resize(rows, 0.0);
        self.velocity.resize(rows, 0.0);
        self.next.resize(rows, 0.0);
        self.ambiguous.resize(contacts, false);
        self.states.resize(contacts, ContactState::default());
        self.efforts.resize(contacts, Effort::in_sweeps());
        self.groups.resize(contacts);
        if let Some(many) = &mut self.many {
            many.reset();
        }
        self.blocks.clear();
        self.blocks.extend((0..contacts).map(|contact| Block::new(problem, contact)));
    }

    /// Whether the buffers have the sizes of this problem.
    fn fits(&self, problem: &ContactProblem) -> bool {
        self.velocity.len() == problem.rows() && self.blocks.len() == problem.contacts().len()
    }
}

impl Solver {
    /// Solves `problem` from the percussions and states in `memory`, which receives the new ones.
    ///
    /// `workspace` holds the velocities afterwards. It must be prepared again whenever entries of the operator
    /// or laws change; one of another size is prepared here, and a memory of another size is forgotten.
    pub fn solve(
        &self,
        problem: &ContactProblem,
        stop: Stop<'_>,
        memory: &mut Memory,
        workspace: &mut Workspace,
    ) -> SolveReport {
        let (rows, contacts) = (problem.rows(), problem.contacts().len());
        if !workspace.fits(problem) {
            workspace.prepare(problem);
        }
        if memory.percussion.len() != rows || memory.states.len() != contacts {
            *memory = Memory::new(rows, contacts);
        }
        workspace.infeasibility = None;
        workspace.stages.clear();
        if problem.delassus().is_matrix_free() && !matches!(self, Self::ProxJacobi { .. }) {
            return self.without_entries(problem, stop, memory, workspace);
        }
        let threads = match self {
            Self::Auto { threads, .. } => Threads::new(*threads, contacts),
            _ => Threads::default(),
        };
        forget_runaways(problem, memory, workspace);
        if !problem.is_uncoupled() {
            // What sweeps find depends on the memory, not on what the workspace has seen before.
            workspace.states.clone_from(&memory.states);
            workspace.efforts.fill(Effort::in_sweeps());
        }
        // The workspace holds the percussions meanwhile, the memory the states of before.
        std::mem::swap(&mut workspace.percussion, &mut memory.percussion);
        let (iterations, ended) = self.run(problem, stop, &threads, memory, workspace);
        problem.velocity(&workspace.percussion, &mut workspace.velocity);
        let residual = stop.residual(problem, &workspace.percussion, &workspace.velocity);
        let mut findings = judge(problem, (stop, ended), residual, workspace);
        self.describe(problem, (stop, &threads), residual, memory, workspace);
        findings.ambiguous = workspace.ambiguous.iter().any(|&several| several);
        if let Some(method) = self.only_method(problem) {
            let (factorizations, residual) = (0, residual.value);
            workspace.stages.push(Stage { method, iterations, factorizations, residual });
        }
        std::mem::swap(&mut workspace.percussion, &mut memory.percussion);
        std::mem::swap(&mut workspace.states, &mut memory.states);
        SolveReport::new(ended, iterations, residual, findings, stop.tolerance)
    }

    /// Runs the method from the percussions in `workspace`, where the states of `memory` decide between
    /// solutions.
    fn run(
        &self,
        problem: &ContactProblem,
        stop: Stop<'_>,
        threads: &Threads,
        memory: &Memory,
        workspace: &mut Workspace,
    ) -> (usize, Ended) {
        let phase = |method: Method, max_iterations: usize, workspace: &mut Workspace| {
            many::single(problem, stop, (method, max_iterations), memory, workspace)
        };
        match *self {
            Self::Exact { max_sweeps } => {
                exact::solve(problem, stop, (max_sweeps, threads), memory, workspace)
            }
            Self::Auto { .. } if problem.is_uncoupled() => {
                exact::solve(problem, stop, (1, threads), memory, workspace)
            }
            Self::Auto { interior_point, .. } => {
                many::automatic(problem, stop, (interior_point, threads), memory, workspace)
            }
            Self::Newton { max_iterations } => phase(Method::Newton, max_iterations, workspace),
            Self::ProximalPoint { max_iterations } => {
                phase(Method::ProximalPoint, max_iterations, workspace)
            }
            Self::InteriorPoint { max_iterations } => {
                phase(Method::InteriorPoint, max_iterations, workspace)
            }
            Self::Admm { max_iterations } => phase(Method::Admm, max_iterations, workspace),
            Self::ProxJacobi { step, max_iterations } => {
                prox::jacobi(problem, stop, step, max_iterations, workspace)
            }
            Self::ProxGaussSeidel { step, max_iterations } => {
                prox::gauss_seidel(problem, stop, step, max_iterations, workspace)
            }
        }
    }

    /// Phases of the contacts, and which of them had several solutions.
    fn describe(
        &self,
        problem: &ContactProblem,
        (stop, threads): (Stop<'_>, &Threads),
        residual: Residual,
        memory: &Memory,
        workspace: &mut Workspace,
    ) {
        let exact = self.only_method(problem) == Some(Method::GaussSeidel);
        // Who has cancelled does not wait for a search of all contacts.
        let left = residual.value > stop.tolerance && stop.early();
        // A sweep marks contacts before the last ones have moved.
        if problem.delassus().is_matrix_free() || left {
            workspace.ambiguous.fill(false);
        } else if !exact || !problem.is_uncoupled() {
            exact::mark_ambiguous(problem, stop, threads, memory, workspace);
        }
        if !exact {
            workspace.states.clone_from(&memory.states);
            phase::classify(problem, workspace);
        }
    }
}

/// The report on the percussions of a memory as they are, whoever has found them.
pub(crate) fn grade(
    problem: &ContactProblem,
    stop: Stop<'_>,
    memory: &Memory,
    workspace: &mut Workspace,
) -> SolveReport {
    problem.velocity(&memory.percussion, &mut workspace.velocity);
    let residual = stop.residual(problem, &memory.percussion, &workspace.velocity);
    SolveReport::new(Ended::Done, 0, residual, Findings::default(), stop.tolerance)
}

/// Starts from zero where the percussions of before run away from this problem: they might look like a solution.
fn forget_runaways(problem: &ContactProblem, memory: &mut Memory, workspace: &mut Workspace) {
    let start = &mut memory.percussion;
    if problem.contacts().len() == 1 || !growth::is_large(problem, start) {
        return;
    }
    problem.velocity(start, &mut workspace.velocity);
    let finite = start.iter().all(|p| p.is_finite());
    if !finite
        || growth::of(problem, start, &workspace.velocity, &mut workspace.groups)
            .is_some_and(|growth| growth.running().is_some())
    {
        start.fill(0.0);
    }
}

/// Part of the loads that a residual may hide where percussions have grown, before a proof is tried that there is no
/// solution at all. Of random systems without solution proximal points end with residuals of 4e-12 at percussions
/// 1e11 times as large as the loads ask for.
const HIDDEN: f64 = 1e-6;

/// What the percussions in which a method ended say, and the proof if there is no solution.
fn judge(
    problem: &ContactProblem,
    (stop, ended): (Stop<'_>, Ended),
    residual: Residual,
    workspace: &mut Workspace,
) -> Findings {
    let Workspace { percussion, velocity, groups, infeasibility, .. } = workspace;
    let growth = growth::of(problem, percussion, velocity, groups);
    let running = growth.and_then(|growth| growth.running());
    // Velocities are as far off as the residual, relative to what percussions bring.
    let hidden = growth.is_some_and(|growth| growth.factor * residual.value > HIDDEN);
    let suspicious = hidden || growth.is_some_and(|growth| growth.kind >= Kind::Suspicious);
    let small = residual.value <= stop.tolerance;
    if small && !suspicious {
        *infeasibility = None;
        return Findings::default();
    }
    if infeasibility.is_none() && suspicious && !stop.early() {
        *infeasibility = infeasible::prove(problem, percussion);
    }
    if small && running.is_none() && infeasibility.is_none() && !hidden {
        return Findings::default();
    }
    if let (None, Ended::Stuck(contact)) = (&infeasibility, ended) {
        *infeasibility = infeasible::prove_alone(problem, contact, percussion);
    }
    let contact = match (growth, ended) {
        (_, Ended::Stuck(contact) | Ended::Unbounded(contact)) => contact,
        (Some(growth), _) => growth.contact,
        _ => residual.worst_contact,
    };
    let early = matches!(ended, Ended::TimeLimit | Ended::NotApplicable | Ended::MaxIterations);
    // What rounding explains needs no other reason.
    let rounded = running.is_none() && residual.value <= report::ROUNDED && !hidden;
    if infeasibility.is_none() && (small || !early) && !rounded && !stop.early() {
        *infeasibility = cases::prove(problem, stop, contact);
    }
    let without_solution = infeasibility.as_ref().map(|proof| proof.contact);
    Findings { running, without_solution, ambiguous: false }
}

impl Solver {
    /// A matrix-free operator: the paper's iteration in place of the default, nothing else.
    fn without_entries(
        &self,
        problem: &ContactProblem,
        stop: Stop<'_>,
        memory: &mut Memory,
        workspace: &mut Workspace,
    ) -> SolveReport {
        if let Self::Auto { .. } = self {
            let jacobi = Self::ProxJacobi { step: ProxStep::Adaptive, max_iterations: 1_000_000 };
            return jacobi.solve(problem, stop, memory, workspace);
        }
        problem.velocity(&memory.percussion, &mut workspace.velocity);
        let residual = stop.residual(problem, &memory.percussion, &workspace.velocity);
        SolveReport::new(Ended::NotApplicable, 0, residual, Findings::default(), stop.tolerance)
    }

    /// The method of a solver that has one and does not report phases.
    #[inline]
    fn only_method(&self, problem: &ContactProblem) -> Option<Method> {
        match self {
            Self::Exact { .. } => Some(Method::GaussSeidel),
            Self::Auto { .. } if problem.is_uncoupled() => Some(Method::GaussSeidel),
            Self::ProxJacobi { .. } | Self::ProxGaussSeidel { .. } => Some(Method::Prox),
            _ => None,
        }
    }
}

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
mod certificate;
mod exact;
mod line;
mod local;
mod many;
mod natural;
mod natural_map;
mod phase;
mod plane;
mod prox;
mod quick;
mod report;
mod residual;
mod single;
mod singular;
mod space;
mod stop;
mod threads;

pub use certificate::Certificate;
pub use natural::natural_map;
pub use prox::ProxStep;
pub use report::{Method, SolveReport, Stage, Status};
pub use residual::{Residual, natural_residual};
pub use stop::{Measure, Stop};

use crate::contact::{ContactProblem, ContactState, Memory, Phase};
use block::Block;
use local::LocalSolution;
use report::Ended;
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
    /// Diagonal blocks of `G`, prepared.
    blocks: Vec<Block>,
    planar: Vec<LocalSolution<2>>,
    states: Vec<ContactState>,
    next: Vec<f64>,
    /// What [`Solver::Auto`] and its phases did at the last call.
    pub stages: Vec<Stage>,
    many: Option<Box<many::Many>>,
}

impl Workspace {
    /// Buffers for this problem; to be called again whenever its Delassus operator changes.
    pub fn prepare(&mut self, problem: &ContactProblem) {
        let (rows, contacts) = (problem.rows(), problem.contacts().len());
        self.percussion.resize(rows, 0.0);
        self.velocity.resize(rows, 0.0);
        self.next.resize(rows, 0.0);
        self.ambiguous.resize(contacts, false);
        self.states.resize(contacts, ContactState::default());
        if let Some(many) = &mut self.many {
            many.reset();
        }
        self.blocks.clear();
        self.blocks.extend((0..contacts).map(|contact| Block::new(problem, contact)));
    }
}

impl Solver {
    /// Solves `problem` from the percussions and states in `memory`, which receives the new ones.
    ///
    /// `workspace` must be prepared for the problem; it holds the velocities afterwards.
    pub fn solve(
        &self,
        problem: &ContactProblem,
        stop: Stop<'_>,
        memory: &mut Memory,
        workspace: &mut Workspace,
    ) -> SolveReport {
        if problem.delassus.is_matrix_free() && !matches!(self, Self::ProxJacobi { .. }) {
            return self.without_entries(problem, stop, memory, workspace);
        }
        let threads = match self {
            Self::Auto { threads, .. } => Threads::new(*threads, problem.contacts.len()),
            _ => Threads::default(),
        };
        // A start from what was no solution might look like one.
        if problem.contacts.len() > 1
            && residual::has_grown(problem, &memory.percussion, residual::WILD)
        {
            memory.percussion.fill(0.0);
        }
        // What is found depends on the memory, not on what the workspace has seen before.
        workspace.states.clone_from(&memory.states);
        // The workspace holds the percussions meanwhile, the memory the states of before.
        std::mem::swap(&mut workspace.percussion, &mut memory.percussion);
        let before = &*memory;
        let phase = |method: Method, max_iterations: usize, workspace: &mut Workspace| {
            many::single(problem, stop, (method, max_iterations), before, workspace)
        };
        let (iterations, status) = match *self {
            Self::Exact { max_sweeps } => {
                exact::solve(problem, stop, (max_sweeps, &threads), memory, workspace)
            }
            Self::Auto { .. } if problem.is_uncoupled() => {
                exact::solve(problem, stop, (1, &threads), memory, workspace)
            }
            Self::Auto { interior_point, .. } => {
                let plan = (interior_point, &threads);
                many::automatic(problem, stop, plan, memory, workspace)
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
        };
        problem.velocity(&workspace.percussion, &mut workspace.velocity);
        let residual = stop.residual(problem, &workspace.percussion, &workspace.velocity);
        let only = self.only_method(problem);
        let exact = only == Some(Method::GaussSeidel);
        // A sweep marks contacts before the last ones have moved.
        if problem.delassus.is_matrix_free() {
            workspace.ambiguous.fill(false);
        } else if !exact || !problem.is_uncoupled() {
            exact::mark_ambiguous(problem, stop, &threads, memory, workspace);
        }
        if !exact {
            workspace.states.clone_from(&memory.states);
            phase::classify(problem, workspace);
        }
        if let Some(method) = only {
            let (factorizations, residual) = (0, residual.value);
            workspace.stages.clear();
            workspace.stages.push(Stage { method, iterations, factorizations, residual });
        }
        let report = SolveReport::new(
            status,
            iterations,
            residual,
            if residual.value <= stop.tolerance {
                None
            } else {
                residual::runaway(problem, &workspace.percussion, &workspace.velocity)
            },
            stop.tolerance,
            workspace,
        );
        std::mem::swap(&mut workspace.percussion, &mut memory.percussion);
        std::mem::swap(&mut workspace.states, &mut memory.states);
        report
    }
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
        SolveReport::new(Ended::NotApplicable, 0, residual, None, stop.tolerance, workspace)
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

/// One of the solutions of a contact, on the contact's own rows.
#[derive(Debug, Clone, PartialEq)]
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
pub fn solutions(
    problem: &ContactProblem,
    contact: usize,
    percussion: &[f64],
) -> Vec<ContactSolution> {
    let rows = &problem.contacts()[contact];
    let own = rows.offset..rows.offset + rows.len();
    let mut all = percussion.to_vec();
    let velocity = |all: &[f64]| {
        let xi = problem.contact_velocity(contact, all, true);
        own.clone().zip(xi).map(|(row, xi)| xi - problem.restitution[row]).collect()
    };
    let mut complete = |local: &LocalSolution<2>| {
        if rows.normal_rows() == 1 {
            all[rows.offset] = local.normal;
        }
        let tangent = &mut all[rows.tangent()..own.end];
        tangent.copy_from_slice(&local.tangent.as_slice()[..rows.law.dimension()]);
        ContactSolution {
            phase: local.phase,
            percussion: all[own.clone()].to_vec(),
            velocity: velocity(&all),
            degenerate: local.degenerate,
        }
    };
    exact::all_solutions(problem, contact, percussion).iter().map(&mut complete).collect()
}

//! What can be set.

use super::method::ProxStep;

/// A solver and its options.
///
/// ```
/// use asperity::contact::{ContactProblem, Memory, NormalForce};
/// use asperity::law::FrictionLaw;
/// use asperity::nalgebra::DMatrix;
/// use asperity::solver::{Solver, Status, Stop, Workspace};
///
/// let contact = (FrictionLaw::<1>::isotropic(0.5)?.into(), NormalForce::Prescribed(2.0));
/// let problem = ContactProblem::new(DMatrix::identity(1, 1), vec![3.0], [contact])?;
/// // Many solves share their buffers and remember what contacts have done.
/// let (mut memory, mut workspace) = (Memory::default(), Workspace::default());
/// let solver = Solver::Exact { max_sweeps: 100 };
/// let report = solver.solve(&problem, Stop::default(), &mut memory, &mut workspace);
/// assert_eq!(report.status, Status::Converged);
/// assert_eq!((&memory.percussion[..], workspace.velocity()), (&[-1.0][..], &[2.0][..]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Contacts that influence no others, directly or indirectly, are solved by themselves: limits of iterations hold for every
/// island.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Solver {
    /// Block Gauss–Seidel whose one-contact solve is exact; one contact needs one sweep.
    Exact {
        /// Sweeps after which the solver gives up.
        max_sweeps: usize,
    },
    /// The solver for everything: sweeps first, then what the problem needs.
    Auto {
        /// The steps that follow the first sweeps.
        steps: Steps,
        /// Threads for work that is done contact by contact and for islands side by side; results do not depend on it.
        threads: usize,
    },
    /// Semismooth Newton on the natural map: problems of full rank.
    SemismoothNewton {
        /// Iterations after which the solver gives up.
        max_iterations: usize,
    },
    /// Newton within a proximal point iteration: problems without full rank.
    ProximalPoint {
        /// Outer steps after which the solver gives up.
        max_iterations: usize,
    },
    /// Primal-dual interior point method: contacts with ellipsoids as reservoir and direction set.
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

impl Solver {
    /// [`Solver::Auto`] with all its steps, on one thread.
    pub const AUTO: Self = Self::Auto { steps: Steps::ALL, threads: 1 };
}

impl Default for Solver {
    /// [`Solver::AUTO`].
    fn default() -> Self {
        Self::AUTO
    }
}

/// A step of [`Solver::Auto`] that can be left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Step {
    Rest,
    Acceleration,
    Newton,
    Admm,
    InteriorPoint,
    ProximalPoint,
}

/// The steps of [`Solver::Auto`] that follow the first sweeps.
///
/// ```
/// use asperity::solver::{Solver, Steps};
///
/// let steps = Steps::ALL.without("admm").and_then(|steps| steps.without("interior_point"));
/// let solver = Solver::Auto { steps: steps.ok_or("no such step")?, threads: 1 };
/// assert_ne!(solver, Solver::AUTO);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Steps(u8);

impl Steps {
    /// All of them.
    pub const ALL: Self = Self((1 << Self::NAMES.len()) - 1);

    /// Their names.
    pub const NAMES: [&'static str; 6] =
        ["rest", "acceleration", "newton", "admm", "interior_point", "proximal_point"];

    /// The others; `None` where no step has this name.
    #[must_use]
    pub fn without(self, name: &str) -> Option<Self> {
        let place = Self::NAMES.iter().position(|own| *own == name)?;
        Some(Self(self.0 & !(1 << place)))
    }

    /// Whether a step is among them.
    pub(crate) fn include(self, step: Step) -> bool {
        self.0 & (1 << step as u8) != 0
    }
}

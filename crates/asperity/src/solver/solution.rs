//! What a solve returns where nothing is carried over to the next one.

use super::infeasible::Infeasibility;
use super::islands::Islands;
use super::measure::stop::Stop;
use super::report::{SolveReport, Stage};
use super::{Solver, Workspace};
use crate::contact::{ContactProblem, ContactState, Memory};

/// Percussions of a contact problem, with all that is known of them. The status in the report says whether they solve
/// it; a [`Certificate`](super::Certificate) says by how much they break the laws, whoever has found them.
#[derive(Debug, Clone, PartialEq)]
#[must_use = "the report in it says whether the problem is solved"]
#[non_exhaustive]
pub struct Solution {
    /// Percussions `P` in N s, row by row.
    pub percussion: Vec<f64>,
    /// Velocities `γ_E = G P + b` in m/s, row by row.
    pub velocity: Vec<f64>,
    /// Phase and slip velocity of every contact.
    pub states: Vec<ContactState>,
    /// Whether a contact has more than one solution while the others are held.
    pub ambiguous: Vec<bool>,
    /// How the solver ended.
    pub report: SolveReport,
    /// What the solver's methods did; islands go through them side by side, the one with the most iterations counts.
    pub stages: Vec<Stage>,
    /// The islands and how each of them was solved.
    pub islands: Islands,
    /// The proof, where there is no solution.
    pub infeasibility: Option<Infeasibility>,
}

impl Default for Solver {
    /// The solver for everything, on one thread.
    fn default() -> Self {
        Self::Auto { interior_point: true, threads: 1 }
    }
}

impl Default for Stop<'_> {
    /// Stops where no contact has a relative defect above 1e-10.
    fn default() -> Self {
        Self::at(1e-10)
    }
}

impl ContactProblem {
    /// Solves the problem from rest, with nothing remembered.
    ///
    /// ```
    /// use asperity::contact::{ContactProblem, NormalForce};
    /// use asperity::law::FrictionLaw;
    /// use asperity::nalgebra::DMatrix;
    /// use asperity::solver::{Certificate, Solver, Status, Stop};
    ///
    /// let law = FrictionLaw::<2>::isotropic(0.5)?;
    /// let contact = (law.into(), NormalForce::Unilateral);
    /// let free_velocity = vec![-1.0, 3.0, 4.0];
    /// let problem = ContactProblem::new(DMatrix::identity(3, 3), free_velocity, [contact])?;
    /// let solution = problem.solve(&Solver::default(), Stop::default());
    /// assert_eq!(solution.report.status, Status::Converged);
    /// // The contact slips: friction of 0.5 N s against the direction (3, 4)/5.
    /// let expected = [1.0, -0.3, -0.4];
    /// assert!(solution.percussion.iter().zip(expected).all(|(p, e)| (p - e).abs() < 1e-12));
    /// // From the problem and the percussions alone:
    /// assert!(Certificate::new(&problem, &solution.percussion)?.natural_map < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn solve(&self, solver: &Solver, stop: Stop<'_>) -> Solution {
        self.solve_from(solver, stop, Memory::new(self.rows(), self.contacts().len()))
    }

    /// Solves the problem from remembered percussions and states, which decide between several solutions. A memory of
    /// another size is forgotten.
    pub fn solve_from(&self, solver: &Solver, stop: Stop<'_>, memory: Memory) -> Solution {
        self.solve_in(solver, stop, memory, &mut Workspace::default())
    }

    /// The same in a workspace: that of the last solve of this problem has its analysis and its buffers, which makes the
    /// next one cheaper and changes no bit of it.
    pub fn solve_in(
        &self,
        solver: &Solver,
        stop: Stop<'_>,
        mut memory: Memory,
        workspace: &mut Workspace,
    ) -> Solution {
        let report = solver.solve(self, stop, &mut memory, workspace);
        let islands = workspace.islands(self, stop, &memory.percussion, &report);
        let Memory { percussion, states } = memory;
        let velocity = workspace.velocity().to_vec();
        Solution {
            percussion,
            velocity,
            states,
            ambiguous: workspace.ambiguous().to_vec(),
            report,
            stages: workspace.stages().to_vec(),
            islands,
            infeasibility: workspace.infeasibility().cloned(),
        }
    }
}

//! What a solve returns where nothing is carried over to the next one.

use super::infeasible::Infeasibility;
use super::island::Islands;
use super::measure::stop::Stop;
use super::report::{SolveReport, Stage};
use super::settings::Solver;
use super::solve::Workspace;
use crate::argument::{ArgumentError, refuse};
use crate::contact::{ContactProblem, ContactRows, ContactState, Memory};

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
    /// Places of the contacts among the rows.
    contacts: Vec<ContactRows>,
}

/// What a [`Solution`] says of one contact.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct SolvedContact<'a> {
    /// Normal percussion `P_N` in N s, not negative: found for a unilateral contact, otherwise the prescribed one.
    pub normal_percussion: f64,
    /// Friction percussion `P` in N s; `−P/P_N` lies in the force reservoir.
    pub tangential_percussion: &'a [f64],
    /// Normal velocity in m/s, positive where the contact opens; `None` where the normal percussion is prescribed.
    pub normal_velocity: Option<f64>,
    /// Slip velocity `γ` in m/s.
    pub tangential_velocity: &'a [f64],
    /// Phase and slip velocity, as the next solve remembers them.
    pub state: ContactState,
    /// Whether the contact has more than one solution while the others are held.
    pub ambiguous: bool,
}

impl Solution {
    /// The solution that [`Solver::solve`] has left in `memory` and `workspace` with this report.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] if the memory or the workspace is that of a problem of another size.
    pub fn new(
        problem: &ContactProblem,
        stop: Stop<'_>,
        memory: Memory,
        report: SolveReport,
        workspace: &Workspace,
    ) -> Result<Self, ArgumentError> {
        if !memory.fits(problem) {
            return refuse("memory", "must be that of a solve of this problem");
        }
        let (rows, contacts) = (workspace.velocity().len(), workspace.ambiguous().len());
        if (rows, contacts) != (problem.rows(), problem.contacts().len()) {
            return refuse("workspace", "must be that of a solve of this problem");
        }
        Ok(Self::of(problem, stop, memory, report, workspace))
    }

    fn of(
        problem: &ContactProblem,
        stop: Stop<'_>,
        memory: Memory,
        report: SolveReport,
        workspace: &Workspace,
    ) -> Self {
        let islands = workspace.islands(problem, stop, &memory.percussion, &report);
        Self {
            percussion: memory.percussion,
            velocity: workspace.velocity().to_vec(),
            states: memory.states,
            ambiguous: workspace.ambiguous().to_vec(),
            report,
            stages: workspace.stages().to_vec(),
            islands,
            infeasibility: workspace.infeasibility().cloned(),
            contacts: problem.contacts().to_vec(),
        }
    }

    /// Percussion, velocity and state of contact `i`, in the order of the problem's contacts.
    ///
    /// # Panics
    ///
    /// If there is no such contact.
    pub fn contact(&self, i: usize) -> SolvedContact<'_> {
        let contact = &self.contacts[i];
        SolvedContact {
            normal_percussion: contact.normal_percussion(&self.percussion),
            tangential_percussion: &self.percussion[contact.tangential_rows()],
            normal_velocity: contact.normal.is_unilateral().then(|| self.velocity[contact.offset]),
            tangential_velocity: &self.velocity[contact.tangential_rows()],
            state: self.states[i],
            ambiguous: self.ambiguous[i],
        }
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
    /// use asperity::contact::{ContactProblem, NormalForce, Phase};
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
    /// let contact = solution.contact(0);
    /// let friction = contact.tangential_percussion;
    /// assert_eq!((contact.state.phase, contact.normal_percussion), (Phase::Slip, 1.0));
    /// assert!((friction[0] + 0.3).abs() < 1e-12 && (friction[1] + 0.4).abs() < 1e-12);
    /// // From the problem and the percussions alone:
    /// assert!(Certificate::new(&problem, &solution.percussion)?.natural_map < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn solve(&self, solver: &Solver, stop: Stop<'_>) -> Solution {
        let mut memory = Memory::new(self.rows(), self.contacts().len());
        let mut workspace = Workspace::default();
        let report = solver.solve(self, stop, &mut memory, &mut workspace);
        Solution::of(self, stop, memory, report, &workspace)
    }
}

//! Moreau's midpoint scheme (\[WL19\] §2.3).
//!
//! `q_M = q_B + ½Δt u_B`; the contacts closed at the midpoint form the contact problem
//! `M(u_E − u_B) − hΔt = W_N P_N + W P` with the laws in `u_E` (19); `q_E = q_M + ½Δt u_E`.

mod bodies;
mod closed;
mod dense;
pub(crate) mod mass;
mod meetings;
mod rated;

use thiserror::Error;

use crate::contact::{ContactProblem, ContactState, Memory, Phase};
use crate::solver::{SolveReport, Solver, Stop, Workspace};
use crate::system::{RigidBodies, System, SystemError};
use bodies::BodyAssembly;
use closed::{Change, Closed};
use dense::Dense;

/// A step could not be made.
#[derive(Debug, Error)]
pub enum StepError {
    /// The system failed.
    #[error(transparent)]
    System(#[from] SystemError),
    /// The mass matrix has no Cholesky factor.
    #[error("mass: must be symmetric positive definite, is not at t = {time} s")]
    SingularMass {
        /// Time in s.
        time: f64,
    },
    /// The contact problem is not finite; a solver must not see it.
    #[error("directions or velocities of contact {contact} are not finite at t = {time} s")]
    NotFiniteContact {
        /// Time in s.
        time: f64,
        /// The system's contact.
        contact: usize,
    },
    /// The state is no longer finite.
    #[error("the state is no longer finite at t = {time} s, coordinate {coordinate}")]
    NotFinite {
        /// Time in s.
        time: f64,
        /// First coordinate that is not finite.
        coordinate: usize,
    },
}

/// What one contact does after a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactOutput {
    /// Phase in the step.
    pub phase: Phase,
    /// `γ_E` in m/s.
    pub slip: [f64; 3],
    /// Friction force λ in N.
    pub force: [f64; 3],
    /// Normal force λ_N in N.
    pub normal_force: f64,
}

/// How the contact problem is made.
#[derive(Debug)]
enum Assembly<'a> {
    /// With matrices of the size of the system.
    Dense(Box<Dense>),
    /// Body by body.
    Bodies(&'a RigidBodies, Box<BodyAssembly>),
}

/// The scheme with its state and all its buffers.
#[derive(Debug)]
pub struct Stepper<'a> {
    system: &'a dyn System,
    solver: Solver,
    tolerance: f64,
    dt: f64,
    steps: usize,
    q: Vec<f64>,
    u: Vec<f64>,
    closed: Closed,
    assembly: Assembly<'a>,
    memory: Memory,
    workspace: Workspace,
}

impl<'a> Stepper<'a> {
    /// The scheme at `t = 0` in the given state.
    pub fn new(
        system: &'a dyn System,
        solver: Solver,
        tolerance: f64,
        dt: f64,
        q0: &[f64],
        u0: &[f64],
    ) -> Result<Self, StepError> {
        let mut q = q0.to_vec();
        system.normalise(&mut q)?;
        let assembly = match system.rigid_bodies() {
            Some(bodies) => Assembly::Bodies(bodies, Box::new(BodyAssembly::new(bodies, &q, u0))),
            None => Assembly::Dense(Box::new(Dense::new(system))),
        };
        let mut stepper = Self {
            system,
            solver,
            tolerance,
            dt,
            steps: 0,
            q,
            u: u0.to_vec(),
            closed: Closed::new(system),
            assembly,
            memory: Memory::default(),
            workspace: Workspace::default(),
        };
        for contact in 0..stepper.closed.states.len() {
            let slip = stepper.slip(contact)?;
            if slip.iter().any(|&v| v != 0.0) {
                stepper.closed.states[contact] = ContactState::new(Phase::Slip, slip);
            }
        }
        Ok(stepper)
    }

    /// Number of steps made.
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// Time in s, counted in steps so that it does not drift.
    pub fn time(&self) -> f64 {
        self.steps as f64 * self.dt
    }

    /// Coordinates.
    pub fn q(&self) -> &[f64] {
        &self.q
    }

    /// Velocities.
    pub fn u(&self) -> &[f64] {
        &self.u
    }

    /// Phase of a contact in the last step.
    pub fn phase(&self, contact: usize) -> Phase {
        self.closed.place(contact).map_or(Phase::Open, |place| self.memory.states[place].phase)
    }

    /// Number of components of a contact's friction force.
    pub fn dimension(&self, contact: usize) -> usize {
        self.system.contacts()[contact].law.dimension()
    }

    /// The contact problem of the last step.
    pub fn problem(&self) -> &ContactProblem {
        &self.closed.problem
    }

    /// The system's contact behind a contact of the last contact problem.
    pub fn contact_of(&self, place: usize) -> usize {
        self.closed.active.get(place).copied().unwrap_or(0)
    }

    /// One step.
    pub fn step(&mut self) -> Result<SolveReport, StepError> {
        let (dt, system) = (self.dt, self.system);
        let t_mid = (self.steps as f64 + 0.5) * dt;
        let (start, closed) = ((self.q.as_slice(), self.u.as_slice()), &mut self.closed);
        let change = match &mut self.assembly {
            Assembly::Dense(dense) => dense.update(system, (t_mid, dt), start, closed)?,
            Assembly::Bodies(bodies, assembly) => assembly.update(bodies, dt, start, closed),
        };
        if change != Change::None {
            self.workspace.prepare(&self.closed.problem);
        }
        if change == Change::Contacts {
            self.closed.carry_over(&mut self.memory);
        }
        self.check_problem()?;
        let (problem, stop) = (&self.closed.problem, Stop::at(self.tolerance));
        let report = self.solver.solve(problem, stop, &mut self.memory, &mut self.workspace);
        let percussion = &self.memory.percussion;
        let (q, u) = (&mut self.q, &mut self.u);
        match &mut self.assembly {
            Assembly::Dense(dense) => dense.finish(system, percussion, dt, (q, u)),
            Assembly::Bodies(bodies, assembly) => assembly.finish(bodies, percussion, dt, (q, u)),
        }
        self.steps += 1;
        self.check_finite()?;
        Ok(report)
    }

    /// Slip velocity `γ = Wᵀu + χ` of a contact in the present state.
    fn slip(&mut self, contact: usize) -> Result<[f64; 3], StepError> {
        let (t, state) = (self.time(), (self.q.as_slice(), self.u.as_slice()));
        match &mut self.assembly {
            Assembly::Dense(dense) => Ok(dense.slip(self.system, t, state, contact)?),
            Assembly::Bodies(bodies, _) => Ok(bodies.slip(state.0, state.1, contact)),
        }
    }

    /// What a contact does after the last step.
    pub fn output(&mut self, contact: usize) -> Result<ContactOutput, StepError> {
        let phase = self.phase(contact);
        let Some(place) = self.closed.place(contact) else {
            let slip = self.slip(contact)?;
            return Ok(ContactOutput { phase, slip, force: [0.0; 3], normal_force: 0.0 });
        };
        let rows = &self.closed.problem.contacts()[place];
        let (percussion, velocity) = (&self.memory.percussion, &self.workspace.velocity);
        let (mut slip, mut force) = ([0.0; 3], [0.0; 3]);
        for i in 0..rows.law.dimension() {
            let row = rows.tangent() + i;
            let factor = match &self.assembly {
                Assembly::Dense(dense) => dense.factor(row),
                Assembly::Bodies(_, assembly) => assembly.factor(row),
            };
            slip[i] = velocity[row];
            force[i] = percussion[row] * factor / self.dt;
        }
        let normal_force = match self.system.contacts()[contact].normal_force {
            Some(value) => value,
            None => percussion[rows.offset] / self.dt,
        };
        Ok(ContactOutput { phase, slip, force, normal_force })
    }

    fn check_problem(&self) -> Result<(), StepError> {
        let problem = &self.closed.problem;
        let Some(row) = problem.free_velocity.iter().position(|v| !v.is_finite()) else {
            return Ok(());
        };
        let place = problem.contacts().partition_point(|contact| contact.offset <= row);
        let contact = self.contact_of(place.saturating_sub(1));
        Err(StepError::NotFiniteContact { time: self.time(), contact })
    }

    fn check_finite(&self) -> Result<(), StepError> {
        let broken = |state: &[f64]| state.iter().position(|v| !v.is_finite());
        match broken(&self.u).or_else(|| broken(&self.q)) {
            Some(coordinate) => Err(StepError::NotFinite { time: self.time(), coordinate }),
            None => Ok(()),
        }
    }
}

//! Moreau's midpoint scheme (\[WL19\] §2.3).
//!
//! `q_M = q_B + ½Δt u_B`; the contacts closed at the midpoint form the contact problem
//! `M(u_E − u_B) − hΔt = W_N P_N + W P` with the laws in `u_E` (19); `q_E = q_M + ½Δt u_E`.

mod assembly;
mod mass;
mod rated;

use nalgebra::DMatrix;
use thiserror::Error;

use crate::contact::{ContactState, Memory, Phase};
use crate::solver::{SolveReport, Solver, Stop, Workspace};
use crate::system::{System, SystemError};
use assembly::{Assembly, Change};
use mass::MassFactor;

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
    /// The state is no longer finite.
    #[error("the state is no longer finite at t = {time} s, coordinate {coordinate}")]
    NotFinite {
        /// Time in s.
        time: f64,
        /// First coordinate that is not finite.
        coordinate: usize,
    },
    /// A contact that no solver takes.
    #[error("contacts: laws with drilling friction are not supported by the time stepping")]
    Drilling,
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
    q_mid: Vec<f64>,
    /// Forces, then velocities without contact forces, then the new velocities.
    free: Vec<f64>,
    mass: DMatrix<f64>,
    factor: Option<MassFactor>,
    assembly: Assembly,
    memory: Memory,
    workspace: Workspace,
    /// States of all contacts at the last change of the closed ones; since then those of the closed
    /// ones are in `memory`.
    states: Vec<ContactState>,
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
        let n = system.dof();
        if system.contacts().iter().any(|contact| contact.law.dimension() > 2) {
            return Err(StepError::Drilling);
        }
        let mut stepper = Self {
            system,
            solver,
            tolerance,
            dt,
            steps: 0,
            q: q0.to_vec(),
            u: u0.to_vec(),
            q_mid: vec![0.0; n],
            free: vec![0.0; n],
            mass: DMatrix::zeros(n, n),
            factor: None,
            assembly: Assembly::new(system),
            memory: Memory::default(),
            workspace: Workspace::default(),
            states: vec![ContactState::default(); system.contacts().len()],
        };
        for contact in 0..stepper.states.len() {
            let slip = stepper.slip(contact)?;
            if slip.iter().any(|&v| v != 0.0) {
                stepper.states[contact] = ContactState::new(Phase::Slip, slip);
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
        self.assembly.place(contact).map_or(Phase::Open, |place| self.memory.states[place].phase)
    }

    /// Number of components of a contact's friction force.
    pub fn dimension(&self, contact: usize) -> usize {
        self.system.contacts()[contact].law.dimension()
    }

    /// The system's contact behind a contact of the last contact problem.
    pub fn contact_of(&self, place: usize) -> usize {
        self.assembly.active().get(place).copied().unwrap_or(0)
    }

    /// One step.
    pub fn step(&mut self) -> Result<SolveReport, StepError> {
        let (dt, half) = (self.dt, 0.5 * self.dt);
        let t_mid = (self.steps as f64 + 0.5) * dt;
        for (mid, (q, u)) in self.q_mid.iter_mut().zip(self.q.iter().zip(&self.u)) {
            *mid = q + half * u;
        }
        let new_mass = self.update_mass(t_mid)?;
        self.system.forces(t_mid, &self.q_mid, &self.u, &mut self.free)?;
        let Some(factor) = &self.factor else {
            return Err(StepError::SingularMass { time: t_mid });
        };
        factor.solve(&mut self.free);
        for (free, u) in self.free.iter_mut().zip(&self.u) {
            *free = u + dt * *free;
        }
        let system = self.system;
        let at = (t_mid, self.q_mid.as_slice(), dt);
        match self.assembly.update(system, at, (&self.u, &self.free), factor, new_mass)? {
            Change::None => {}
            Change::Operator => self.workspace.prepare(self.assembly.problem()),
            Change::Contacts => {
                self.workspace.prepare(self.assembly.problem());
                self.carry_over();
            }
        }
        self.assembly.load(&self.u, &self.free);
        let stop = Stop::at(self.tolerance);
        let problem = self.assembly.problem();
        let report = self.solver.solve(problem, stop, &mut self.memory, &mut self.workspace);
        self.assembly.apply(&self.memory.percussion, &mut self.free);
        std::mem::swap(&mut self.u, &mut self.free);
        for (q, (mid, u)) in self.q.iter_mut().zip(self.q_mid.iter().zip(&self.u)) {
            *q = mid + half * u;
        }
        self.steps += 1;
        self.check_finite()?;
        Ok(report)
    }

    /// Slip velocity `γ = Wᵀu + χ` of a contact in the present state.
    fn slip(&mut self, contact: usize) -> Result<[f64; 3], StepError> {
        let t = self.time();
        Ok(self.assembly.slip(self.system, t, &self.q, &self.u, contact)?)
    }

    /// What a contact does after the last step.
    pub fn output(&mut self, contact: usize) -> Result<ContactOutput, StepError> {
        let phase = self.phase(contact);
        let Some(place) = self.assembly.place(contact) else {
            let slip = self.slip(contact)?;
            return Ok(ContactOutput { phase, slip, force: [0.0; 3], normal_force: 0.0 });
        };
        let rows = &self.assembly.problem().contacts()[place];
        let (percussion, velocity) = (&self.memory.percussion, &self.workspace.velocity);
        let (mut slip, mut force) = ([0.0; 3], [0.0; 3]);
        for i in 0..rows.law.dimension() {
            slip[i] = velocity[rows.tangent() + i];
            let row = rows.tangent() + i;
            force[i] = self.assembly.percussion(row, percussion[row]) / self.dt;
        }
        let normal_force = match self.system.contacts()[contact].normal_force {
            Some(value) => value,
            None => percussion[rows.offset] / self.dt,
        };
        Ok(ContactOutput { phase, slip, force, normal_force })
    }

    fn update_mass(&mut self, t_mid: f64) -> Result<bool, StepError> {
        if self.system.constancy().mass && self.factor.is_some() {
            return Ok(false);
        }
        self.system.mass(&self.q_mid, &mut self.mass)?;
        self.factor = MassFactor::new(&self.mass);
        match self.factor {
            Some(_) => Ok(true),
            None => Err(StepError::SingularMass { time: t_mid }),
        }
    }

    /// A new memory for a new set of closed contacts: states are kept, percussions start from zero.
    fn carry_over(&mut self) {
        for (state, &contact) in self.memory.states.iter().zip(self.assembly.before()) {
            self.states[contact] = *state;
        }
        let problem = self.assembly.problem();
        self.memory = Memory::new(problem.rows(), problem.contacts().len());
        for contact in 0..self.states.len() {
            match self.assembly.place(contact) {
                Some(place) => self.memory.states[place] = self.states[contact],
                None => self.states[contact].phase = Phase::Open,
            }
        }
    }

    fn check_finite(&self) -> Result<(), StepError> {
        match self.u.iter().position(|v| !v.is_finite()) {
            Some(coordinate) => Err(StepError::NotFinite { time: self.time(), coordinate }),
            None => Ok(()),
        }
    }
}

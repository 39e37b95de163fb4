//! The scheme with its state.

use super::assembly::Assembly;
use super::closed::Closed;
use super::longest_step;
use super::outcome::{ContactOutput, StepError};
use super::outputs::Outputs;
use super::reversals::Reversals;
use super::state::State;
use crate::argument::below;
use crate::contact::{ContactProblem, ContactState, Memory, Phase};
use crate::integrator::options;
use crate::solver::{Shares, Solver, Unsolvable, Workspace};
use crate::system::{self, Configuration, System, rotation};

/// The scheme with its state and all its buffers.
#[derive(Debug)]
pub struct Stepper<'a> {
    pub(super) system: &'a dyn System,
    pub(super) solver: Solver,
    pub(super) tolerance: f64,
    pub(super) dt: f64,
    pub(super) origin: f64,
    pub(super) steps: usize,
    pub(super) q: Vec<f64>,
    pub(super) u: Vec<f64>,
    pub(super) closed: Closed,
    pub(super) assembly: Assembly,
    pub(super) memory: Memory,
    /// The memory before the present step.
    pub(super) before: Memory,
    pub(super) workspace: Workspace,
    pub(super) shares: Shares,
    pub(super) outputs: Outputs,
    pub(super) reversals: Reversals,
}

/// A state of a system, checked, in steps of length `dt` and with rotations of length one.
fn checked(system: &dyn System, dt: f64, state: &State) -> Result<State, StepError> {
    state.check(system)?;
    let mut start = state.in_steps_of(dt);
    rotation::normalise(system.rotations(), &mut start.q)?;
    system::meets(system, &start.q, &start.u, dt)?;
    Ok(start)
}

impl<'a> Stepper<'a> {
    /// The scheme in a state: [`State::new`] of initial coordinates and velocities, or that in which another run has
    /// ended.
    ///
    /// # Errors
    ///
    /// [`StepError::Options`] if `tolerance` or `dt` is not finite and positive, if the state is not one of this system,
    /// with as many finite entries as it has coordinates and velocities, or if a contact of the system touches blocks
    /// that are not there; for `dt` also if motions of a linear system that contacts do not hold grow in such steps
    /// though they do not grow, as its stiffness and damping act explicitly.
    pub fn new(
        system: &'a dyn System,
        solver: Solver,
        tolerance: f64,
        dt: f64,
        state: &State,
    ) -> Result<Self, StepError> {
        options::check_steps(system, tolerance, dt)?;
        system.as_linear().map_or(Ok(()), |linear| longest_step::check(linear, dt))?;
        let start = checked(system, dt, state)?;
        let contacts = system.contacts().len();
        let mut stepper = Self {
            system,
            solver,
            tolerance,
            dt,
            origin: start.origin,
            steps: start.steps,
            closed: Closed::new(system, &start.contacts),
            assembly: Assembly::new(system, &start.q, &start.u, start.momenta),
            q: start.q,
            u: start.u,
            memory: Memory::default(),
            before: Memory::default(),
            workspace: Workspace::default(),
            shares: Shares::default(),
            outputs: Outputs::new(contacts),
            reversals: Reversals::default(),
        };
        if start.contacts.is_empty() {
            stepper.find_first_slips()?;
        }
        Ok(stepper)
    }

    /// The same scheme in another state: what follows is the same to the bit as after [`new`](Self::new), for less where
    /// the contact problem of the next step has the operator of the last one.
    ///
    /// # Errors
    ///
    /// [`StepError::Options`] if the state is not one of this system; the stepper is then what it was. As
    /// [`new`](Self::new) if the system fails.
    pub fn restart(&mut self, state: &State) -> Result<(), StepError> {
        if !(self.closed.ready && self.assembly.is_reusable()) {
            let Self { system, solver, tolerance, dt, .. } = *self;
            *self = Self::new(system, solver, tolerance, dt, state)?;
            return Ok(());
        }
        let start = checked(self.system, self.dt, state)?;
        (self.origin, self.steps) = (start.origin, start.steps);
        self.closed.restart(&start.contacts);
        self.assembly.restart(self.system, &start.q, &start.u, start.momenta);
        (self.q, self.u) = (start.q, start.u);
        if start.contacts.is_empty() {
            self.find_first_slips()?;
        }
        self.closed.recall(&mut self.memory);
        self.before.clear();
        self.workspace.restart(&self.closed.problem);
        self.shares = Shares::default();
        self.outputs.restart();
        self.reversals = Reversals::default();
        Ok(())
    }

    /// The contacts that slip in a state of which nothing else is known.
    fn find_first_slips(&mut self) -> Result<(), StepError> {
        for contact in 0..self.system.contacts().len() {
            let slip = self.slip(contact)?;
            if slip.iter().any(|&v| v != 0.0) {
                self.closed.known[contact].state = ContactState::new(Phase::Slip, slip);
            }
        }
        Ok(())
    }

    /// The present state with all that a run needs that goes on from here.
    pub fn state(&self) -> State {
        State {
            origin: self.origin,
            steps: self.steps,
            dt: Some(self.dt),
            q: self.q.clone(),
            u: self.u.clone(),
            contacts: self.closed.memory(&self.memory),
            momenta: self.assembly.momenta().to_vec(),
        }
    }

    /// Number of steps since the time from which they are counted, that of the first start.
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// Time in s, counted in steps so that it does not drift.
    pub fn time(&self) -> f64 {
        self.time_after(0)
    }

    /// Time in s after so many further steps.
    pub(crate) fn time_after(&self, steps: usize) -> f64 {
        self.origin + (self.steps + steps) as f64 * self.dt
    }

    /// Coordinates.
    pub fn q(&self) -> &[f64] {
        &self.q
    }

    /// Velocities.
    pub fn u(&self) -> &[f64] {
        &self.u
    }

    /// Number of components of a contact's friction force.
    pub(crate) fn dimension(&self, contact: usize) -> usize {
        self.system.contacts()[contact].law().dimension()
    }

    /// The contact problem of the last step.
    pub fn problem(&self) -> &ContactProblem {
        &self.closed.problem
    }

    /// The contact problem of the last step and the proof that it has no solution, if there is one.
    pub fn unsolvable(&self) -> Option<Unsolvable> {
        let infeasibility = self.workspace.infeasibility.clone()?;
        let (problem, contacts) = (self.closed.problem.clone(), self.closed.active.clone());
        Some(Unsolvable { problem, contacts, infeasibility })
    }

    /// The system's contact behind a contact of the last contact problem, if it has one at this place.
    pub fn contact_of(&self, place: usize) -> Option<usize> {
        self.closed.active.get(place).copied()
    }

    /// What the only contact of a system that never opens remembers.
    pub(crate) fn remembered(&self) -> ContactState {
        self.memory.states.first().copied().unwrap_or_default()
    }

    /// Whether the last step has reversed a motion that grows.
    pub(crate) fn may_diverge(&self) -> bool {
        self.reversals.last_at(self.steps)
    }

    /// Goes on from another state of a system with one contact that never opens, after so many steps.
    pub(crate) fn go_on_from(&mut self, steps: usize, q: &[f64], u: &[f64], known: ContactState) {
        self.steps = steps;
        self.q.copy_from_slice(q);
        self.u.copy_from_slice(u);
        self.memory.states.fill(known);
    }

    /// Slip velocity `γ = Wᵀu + χ` of a contact in the present state.
    fn slip(&mut self, contact: usize) -> Result<[f64; 3], StepError> {
        let at = Configuration::new(self.time(), &self.q);
        Ok(self.assembly.slip(self.system, &at, &self.u, contact)?)
    }

    /// Phase of a contact in the last step; nothing is known of a contact that the system does not have.
    pub fn phase(&self, contact: usize) -> Phase {
        self.phases().get(contact).copied().unwrap_or(Phase::Unknown)
    }

    /// Phases of all contacts in the last step, in the order of the system's contacts.
    #[inline]
    pub(crate) fn phases(&self) -> &[Phase] {
        &self.outputs.phases
    }

    /// What a contact does after the last step.
    ///
    /// # Errors
    ///
    /// [`StepError::Options`] if the system has no such contact, [`StepError::System`] if the system fails.
    pub fn output(&mut self, contact: usize) -> Result<ContactOutput, StepError> {
        let laws = self.system.contacts();
        below("contact", contact, laws.len(), "contacts")?;
        if let Some(output) = self.outputs.of(contact, &laws[contact], self.dt) {
            return Ok(output);
        }
        let slip = self.slip(contact)?;
        Ok(ContactOutput { phase: Phase::Open, slip, force: [0.0; 3], normal_force: 0.0 })
    }
}

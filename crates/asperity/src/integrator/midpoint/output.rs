//! What contacts do in a step.

use super::{StepError, Stepper};
use crate::contact::Phase;

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

impl Stepper<'_> {
    /// Phase of a contact in the last step.
    pub fn phase(&self, contact: usize) -> Phase {
        self.outputs[contact].map_or(Phase::Open, |output| output.phase)
    }

    /// What a contact does after the last step.
    pub fn output(&mut self, contact: usize) -> Result<ContactOutput, StepError> {
        if let Some(output) = self.outputs[contact] {
            return Ok(output);
        }
        let slip = self.slip(contact)?;
        Ok(ContactOutput { phase: Phase::Open, slip, force: [0.0; 3], normal_force: 0.0 })
    }

    /// Keeps what the closed contacts do, before the next step changes the contact problem.
    pub(super) fn keep_outputs(&mut self) {
        let Self { closed, memory, workspace, assembly, outputs, system, dt, .. } = self;
        let factors = assembly.factors();
        if outputs.len() > closed.active.len() {
            outputs.fill(None);
        }
        let rows = closed.active.iter().zip(closed.problem.contacts());
        for ((&contact, rows), state) in rows.zip(&memory.states) {
            let (mut slip, mut force) = ([0.0; 3], [0.0; 3]);
            for i in 0..rows.law.dimension() {
                let row = rows.tangent() + i;
                slip[i] = workspace.velocity[row];
                force[i] = memory.percussion[row] * factors.of(row) / *dt;
            }
            let normal_force = match system.contacts()[contact].normal_force {
                Some(value) => value,
                None => memory.percussion[rows.offset] / *dt,
            };
            outputs[contact] =
                Some(ContactOutput { phase: state.phase, slip, force, normal_force });
        }
    }
}

//! What a simulation returns.

use crate::contact::Phase;
use crate::integrator::midpoint::{StepError, Stepper};
use crate::integrator::samples::{ContactSample, Samples};

/// Samples of a run. Sample 0 is the initial state, which no step has led to: forces NaN, phases unknown.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct Trajectory {
    /// States, slips and forces.
    pub samples: Samples,
    /// Iterations `(n_t)`.
    pub iterations: Vec<i64>,
    /// Residuals `(n_t)`.
    pub residual: Vec<f64>,
    /// Steps made.
    pub steps: usize,
    /// Steps in which some contact had more than one solution.
    pub ambiguous_steps: usize,
    /// Steps whose contact problem was not solved to the tolerance.
    pub failed_steps: usize,
    /// Number of steps every contact was open, sticking, slipping `(n_c, 3)`.
    pub phase_counts: Vec<i64>,
}

impl Trajectory {
    pub(crate) fn new(stepper: &mut Stepper<'_>, contacts: usize) -> Result<Self, StepError> {
        let dimensions: Vec<usize> = (0..contacts).map(|i| stepper.dimension(i)).collect();
        let samples = Samples::new(stepper.q().len(), stepper.u().len(), &dimensions);
        let phase_counts = vec![0; 3 * contacts];
        let mut trajectory = Self { samples, phase_counts, ..Self::default() };
        trajectory.record(stepper, 0, f64::NAN)?;
        let samples = &mut trajectory.samples;
        samples.force.fill(f64::NAN);
        samples.normal_force.fill(f64::NAN);
        samples.phase.fill(Phase::Unknown as i8);
        Ok(trajectory)
    }

    /// Counts a step that was made.
    pub(crate) fn count(&mut self, stepper: &Stepper<'_>, ambiguous: bool) {
        self.steps += 1;
        self.ambiguous_steps += usize::from(ambiguous);
        for (contact, counts) in self.phase_counts.chunks_exact_mut(3).enumerate() {
            counts[(stepper.phase(contact) as i8).max(0) as usize] += 1;
        }
    }

    /// Appends the present state, as a whole or not at all.
    pub(crate) fn record(
        &mut self,
        stepper: &mut Stepper<'_>,
        iterations: usize,
        residual: f64,
    ) -> Result<(), StepError> {
        for contact in 0..self.samples.contacts {
            match stepper.output(contact) {
                Ok(output) => self.samples.push_contact(&ContactSample {
                    dimension: stepper.dimension(contact),
                    slip: output.slip,
                    force: output.force,
                    normal_force: output.normal_force,
                    phase: output.phase,
                }),
                Err(error) => {
                    self.samples.truncate(self.samples.len());
                    return Err(error);
                }
            }
        }
        self.samples.push_state(stepper.time(), stepper.q(), stepper.u());
        self.iterations.push(iterations as i64);
        self.residual.push(residual);
        Ok(())
    }
}

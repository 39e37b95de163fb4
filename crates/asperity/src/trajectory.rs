//! What a simulation returns.

use crate::contact::Phase;
#[cfg(feature = "serde")]
use crate::integrator::data::{Checked, checked};
use crate::integrator::midpoint::{StepError, Stepper};
use crate::integrator::samples::{ContactSample, Samples};
use crate::system::System;

/// Samples of a run. Sample 0 is the initial state, which no step has led to: forces NaN, phases unknown.
///
/// ```
/// use asperity::law::FrictionLaw;
/// use asperity::simulate::{Options, simulate};
/// use asperity::system::sliding_point;
///
/// let point = sliding_point(1.0, FrictionLaw::isotropic(0.5)?, 10.0)?;
/// let options = Options::new(1e-2, 0.1)?.with_start(&[0.0, 0.0], &[1.0, 0.0]);
/// let run = simulate(&point, &options)?;
/// let samples = &run.trajectory.samples;
/// assert_eq!((samples.len(), samples.dof, run.trajectory.failed_steps), (11, 2, 0));
/// assert!((samples.state(10).u[0] - 0.5).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(remote = "Self", deny_unknown_fields))]
#[non_exhaustive]
pub struct Trajectory {
    /// States, slips and forces.
    pub samples: Samples,
    /// Iterations `(n_t)`.
    pub iterations: Vec<i64>,
    /// Residuals `(n_t)`.
    #[cfg_attr(feature = "serde", serde(with = "crate::integrator::numbers"))]
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
    /// A trajectory of a system, without samples.
    pub(crate) fn empty(system: &dyn System) -> Self {
        let contacts = system.contacts();
        let dimensions: Vec<usize> = contacts.iter().map(|c| c.law().dimension()).collect();
        let samples = Samples::new(system.coordinates(), system.dof(), &dimensions);
        Self { samples, phase_counts: vec![0; 3 * contacts.len()], ..Self::default() }
    }

    /// Appends the initial state as the first sample.
    pub(crate) fn begin(&mut self, stepper: &mut Stepper<'_>) -> Result<(), StepError> {
        self.record(stepper, 0, f64::NAN)?;
        self.samples.force.fill(f64::NAN);
        self.samples.normal_force.fill(f64::NAN);
        self.samples.phase.fill(Phase::Unknown as i8);
        Ok(())
    }

    /// Counts a step that was made.
    pub(crate) fn count(&mut self, stepper: &Stepper<'_>, ambiguous: bool) {
        self.steps += 1;
        self.ambiguous_steps += usize::from(ambiguous);
        for (contact, &phase) in stepper.phases().iter().enumerate() {
            self.phase_counts[3 * contact + (phase as i8).max(0) as usize] += 1;
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
            let dimension = stepper.dimension(contact);
            match stepper.output(contact) {
                Ok(output) => self.samples.push_contact(&ContactSample {
                    slip: &output.slip[..dimension],
                    force: &output.force[..dimension],
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

#[cfg(feature = "serde")]
impl Checked for Trajectory {
    fn fault(&self) -> Option<&'static str> {
        let n = self.samples.len();
        let counts = self.samples.contacts.checked_mul(3);
        let fits = self.iterations.len() == n
            && self.residual.len() == n
            && Some(self.phase_counts.len()) == counts;
        (!fits)
            .then_some("trajectory: must have one entry per sample, and three counts per contact")
    }
}

#[cfg(feature = "serde")]
checked!(Trajectory);

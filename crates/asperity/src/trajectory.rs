//! What a simulation returns.

use crate::contact::Phase;
use crate::integrator::midpoint::{StepError, Stepper};

/// Samples of a run, time first; `p` is the largest dimension of the laws, shorter forces are padded
/// with NaN. Sample 0 is the initial state, which no step has led to: forces NaN, phases unknown.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Trajectory {
    /// Number of coordinates.
    pub coordinates: usize,
    /// Number of degrees of freedom.
    pub dof: usize,
    /// Number of contacts.
    pub contacts: usize,
    /// Largest dimension of the laws.
    pub p: usize,
    /// Times in s.
    pub t: Vec<f64>,
    /// Coordinates `(n_t, coordinates)`.
    pub q: Vec<f64>,
    /// Velocities `(n_t, dof)`.
    pub u: Vec<f64>,
    /// Slip velocities γ `(n_t, n_c, p)`.
    pub slip: Vec<f64>,
    /// Friction forces λ `(n_t, n_c, p)`.
    pub force: Vec<f64>,
    /// Normal forces λ_N `(n_t, n_c)`.
    pub normal_force: Vec<f64>,
    /// Phases `(n_t, n_c)`.
    pub phase: Vec<i8>,
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
    pub(crate) fn new(
        stepper: &mut Stepper<'_>,
        p: usize,
        contacts: usize,
    ) -> Result<Self, StepError> {
        let (coordinates, dof) = (stepper.q().len(), stepper.u().len());
        let phase_counts = vec![0; 3 * contacts];
        let mut trajectory =
            Self { coordinates, dof, contacts, p, phase_counts, ..Self::default() };
        trajectory.record(stepper, 0, 0.0)?;
        let first = contacts * p;
        trajectory.residual[0] = f64::NAN;
        trajectory.force[..first].fill(f64::NAN);
        trajectory.normal_force[..contacts].fill(f64::NAN);
        trajectory.phase[..contacts].fill(Phase::Unknown as i8);
        Ok(trajectory)
    }

    /// Counts a step that was made.
    pub(crate) fn count(&mut self, stepper: &Stepper<'_>, ambiguous: bool) {
        self.steps += 1;
        self.ambiguous_steps += usize::from(ambiguous);
        for contact in 0..self.contacts {
            let column = (stepper.phase(contact) as i8).max(0) as usize;
            self.phase_counts[3 * contact + column] += 1;
        }
    }

    /// Appends the present state.
    pub(crate) fn record(
        &mut self,
        stepper: &mut Stepper<'_>,
        iterations: usize,
        residual: f64,
    ) -> Result<(), StepError> {
        // First what may fail: a sample is appended as a whole or not at all.
        if let Err(error) = self.record_contacts(stepper) {
            let contacts = self.t.len() * self.contacts;
            self.slip.truncate(contacts * self.p);
            self.force.truncate(contacts * self.p);
            self.normal_force.truncate(contacts);
            self.phase.truncate(contacts);
            return Err(error);
        }
        self.t.push(stepper.time());
        self.q.extend_from_slice(stepper.q());
        self.u.extend_from_slice(stepper.u());
        self.iterations.push(iterations as i64);
        self.residual.push(residual);
        Ok(())
    }

    fn record_contacts(&mut self, stepper: &mut Stepper<'_>) -> Result<(), StepError> {
        for contact in 0..self.contacts {
            let output = stepper.output(contact)?;
            let dimension = stepper.dimension(contact);
            let padded =
                |v: [f64; 3]| (0..self.p).map(move |i| if i < dimension { v[i] } else { f64::NAN });
            self.slip.extend(padded(output.slip));
            self.force.extend(padded(output.force));
            self.normal_force.push(output.normal_force);
            self.phase.push(output.phase as i8);
        }
        Ok(())
    }
}

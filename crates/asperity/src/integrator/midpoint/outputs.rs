//! What is kept of the contacts from a step that was made.

use std::ops::Range;

use super::closed::Closed;
use super::outcome::ContactOutput;
use super::rated::Factors;
use crate::contact::{Memory, Phase};
use crate::system::ContactLaw;
use crate::vectors::copy;

/// Results of the contacts in the last step, as its contact problem had them. Forces follow on demand: most steps are not
/// sampled.
#[derive(Debug, Default)]
pub(super) struct Outputs {
    /// Phases of all contacts, and the rows of those that were closed.
    pub(super) phases: Vec<Phase>,
    rows: Vec<Option<Range<usize>>>,
    /// Row by row `γ_E`, percussions, and the factors of the speed that these are without.
    velocity: Vec<f64>,
    percussion: Vec<f64>,
    factors: Vec<f64>,
    /// The factors of friction by place, by which percussions are too small and velocities too large.
    by_place: Vec<f64>,
}

impl Outputs {
    /// Of so many contacts, before the first step.
    pub(super) fn new(contacts: usize) -> Self {
        let (phases, rows) = (vec![Phase::Open; contacts], vec![None; contacts]);
        Self { phases, rows, ..Self::default() }
    }

    /// Before the first step of another run.
    pub(super) fn restart(&mut self) {
        self.phases.fill(Phase::Open);
        self.rows.fill(None);
    }

    /// Keeps what the closed contacts do, before the next step changes the contact problem.
    #[inline]
    pub(super) fn keep(
        &mut self,
        closed: &mut Closed,
        memory: &Memory,
        velocity: &[f64],
        (factors, by_place): (&Factors, Option<&[f64]>),
    ) {
        if closed.settle() {
            self.renew(closed);
        }
        copy(velocity, &mut self.velocity);
        copy(&memory.percussion, &mut self.percussion);
        if let Some(by_place) = by_place {
            copy(by_place, &mut self.by_place);
        }
        if factors.any() {
            copy(factors.rows(), &mut self.factors);
        }
        for (&contact, state) in closed.active.iter().zip(&memory.states) {
            self.phases[contact] = state.phase;
        }
    }

    /// Makes room for other closed contacts.
    #[inline(never)]
    fn renew(&mut self, closed: &Closed) {
        self.phases.fill(Phase::Open);
        self.rows.fill(None);
        for (&contact, rows) in closed.active.iter().zip(closed.problem.contacts()) {
            self.rows[contact] = Some(rows.rows());
        }
        for list in [&mut self.velocity, &mut self.percussion] {
            list.resize(closed.problem.rows(), 0.0);
        }
        for list in [&mut self.factors, &mut self.by_place] {
            list.clear();
            list.resize(closed.problem.rows(), 1.0);
        }
    }

    /// What a contact with this law did in a step of length `dt`, if it was closed.
    pub(super) fn of(&self, contact: usize, law: &ContactLaw, dt: f64) -> Option<ContactOutput> {
        let rows = self.rows[contact].clone()?;
        let (mut slip, mut force) = ([0.0; 3], [0.0; 3]);
        for (k, row) in (rows.start + law.normal_rows()..rows.end).enumerate() {
            slip[k] = self.velocity[row] / self.by_place[row];
            force[k] = self.percussion[row] * self.factors[row] * self.by_place[row] / dt;
        }
        let normal_force = law.normal_force().prescribed();
        let normal_force = normal_force.unwrap_or(self.percussion[rows.start] / dt);
        Some(ContactOutput { phase: self.phases[contact], slip, force, normal_force })
    }
}

//! What a run hands over to one that continues it.

use crate::argument::{ArgumentError, entries, refuse};
use crate::contact::ContactState;
use crate::system::{System, Turning};

/// What a contact hands over to the next step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ContactMemory {
    /// Whether it was closed in the last step, or nothing is known of it.
    pub closed: bool,
    /// Phase and slip velocities, which decide between several solutions and start Newton's method.
    pub state: ContactState,
    /// Percussions of its rows: the normal one first, if it is unknown, then those of friction per factor of
    /// the speed.
    pub percussion: [f64; 4],
}

/// The state at the end of a run, with all that the next step asks for: a run that is continued from it equals
/// one that was never interrupted, to the bit.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Time in s from which the steps are counted.
    pub origin: f64,
    /// Number of steps since then.
    pub steps: usize,
    /// Their length in s; none while there has been no step.
    pub dt: Option<f64>,
    /// Coordinates.
    pub q: Vec<f64>,
    /// Velocities.
    pub u: Vec<f64>,
    /// One per contact; none if nothing is known of them.
    pub contacts: Vec<ContactMemory>,
    /// What the system carries besides coordinates and velocities ([`Turning::momenta`]): of rigid bodies the angular
    /// momenta of those of unequal moments in the world's axes, one after another. Nothing if they follow from the
    /// velocities.
    pub momenta: Vec<f64>,
}

impl State {
    /// A state of which only coordinates and velocities are known.
    pub fn new(time: f64, q: &[f64], u: &[f64]) -> Self {
        Self {
            origin: time,
            steps: 0,
            dt: None,
            q: q.to_vec(),
            u: u.to_vec(),
            contacts: Vec::new(),
            momenta: Vec::new(),
        }
    }

    /// Time in s.
    pub fn time(&self) -> f64 {
        self.dt.map_or(self.origin, |dt| self.origin + self.steps as f64 * dt)
    }

    /// The same state as the beginning of steps of another length.
    ///
    /// Percussions are forces times the step; what the contacts remember of their slip stays.
    pub(super) fn in_steps_of(&self, dt: f64) -> Self {
        if self.dt == Some(dt) {
            return self.clone();
        }
        let scale = self.dt.map_or(1.0, |before| dt / before);
        let scaled = |contact: &ContactMemory| ContactMemory {
            percussion: contact.percussion.map(|p| p * scale),
            ..*contact
        };
        Self {
            origin: self.time(),
            steps: 0,
            dt: Some(dt),
            contacts: self.contacts.iter().map(scaled).collect(),
            ..self.clone()
        }
    }

    /// Whether a system can start from it.
    pub(super) fn check(&self, system: &dyn System) -> Result<(), ArgumentError> {
        entries("q0", &self.q, system.coordinates())?;
        entries("u0", &self.u, system.dof())?;
        let refuse = |message: String| refuse("start", message);
        let counted = self.dt.map_or(self.steps == 0, |dt| dt.is_finite() && dt > 0.0);
        if !counted {
            return refuse("must have the finite and positive length of its steps".into());
        }
        let (contacts, known) = (system.contacts().len(), self.contacts.len());
        if known != 0 && known != contacts {
            return refuse(format!("must be a state of {contacts} contacts, is one of {known}"));
        }
        if !self.is_finite() {
            return refuse("must be finite".into());
        }
        // Velocities that were replaced would otherwise lose against the momenta that were not.
        let has = |turning: &dyn Turning| turning.has_momenta(&self.q, &self.u, &self.momenta);
        if self.momenta.is_empty() || system.turning().is_some_and(has) {
            return Ok(());
        }
        refuse("has momenta of other velocities: leave them out where velocities are given".into())
    }

    /// Whether all that is handed over is a number.
    pub(crate) fn is_finite(&self) -> bool {
        let mut remembered = self.contacts.iter().flat_map(|contact| {
            let (slips, _) = contact.state.history();
            slips.into_iter().flatten().chain(contact.percussion)
        });
        let mut numbers = self.q.iter().chain(&self.u).chain(&self.momenta).copied();
        self.time().is_finite() && numbers.all(f64::is_finite) && remembered.all(f64::is_finite)
    }
}

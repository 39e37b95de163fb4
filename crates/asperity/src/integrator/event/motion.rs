//! What an event-driven integration returns.

use crate::contact::Phase;
use crate::integrator::event::dynamics::Dynamics;
use crate::integrator::event::state::State;

/// What happens at an event.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EventKind {
    /// A contact begins to stick.
    Stick,
    /// A contact begins to slip, or its slip passes through zero.
    Slip,
    /// A contact opens.
    Open,
    /// A contact closes, with or without a jump of the velocities.
    Impact,
    /// Friction stops the slip by an impact without approach (Painlevé).
    ImpactWithoutCollision,
    /// The motion crosses the section.
    Section,
}

impl EventKind {
    /// Name of the kind.
    pub fn name(self) -> &'static str {
        match self {
            Self::Stick => "stick",
            Self::Slip => "slip",
            Self::Open => "open",
            Self::Impact => "impact",
            Self::ImpactWithoutCollision => "impact_without_collision",
            Self::Section => "section",
        }
    }
}

/// Something that happened.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event {
    /// Time in s.
    pub time: f64,
    /// The contact; none of a section.
    pub contact: Option<usize>,
    /// What happened.
    pub kind: EventKind,
    /// What the contact does afterwards.
    pub phase: Option<Phase>,
    /// Whether the contacts might have done something else.
    pub ambiguous: bool,
}

/// Samples of a motion, time first; `p` is the largest dimension of the laws, shorter forces are padded with
/// NaN. An event gives two samples where all steps are kept, before and after it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Motion {
    /// Number of coordinates and of velocities.
    pub dof: usize,
    /// Number of contacts.
    pub contacts: usize,
    /// Largest dimension of the laws.
    pub p: usize,
    /// Times in s.
    pub t: Vec<f64>,
    /// Coordinates `(n_t, n)`.
    pub q: Vec<f64>,
    /// Velocities `(n_t, n)`.
    pub u: Vec<f64>,
    /// Slip velocities γ `(n_t, n_c, p)`.
    pub slip: Vec<f64>,
    /// Friction forces λ `(n_t, n_c, p)`.
    pub force: Vec<f64>,
    /// Normal forces λ_N `(n_t, n_c)`.
    pub normal_force: Vec<f64>,
    /// Phases `(n_t, n_c)`.
    pub phase: Vec<i8>,
    /// The events in their order.
    pub events: Vec<Event>,
    /// Steps made.
    pub steps: usize,
    /// Steps that were tried and found too long.
    pub rejected_steps: usize,
}

impl Motion {
    pub(crate) fn new(dynamics: &Dynamics<'_>) -> Self {
        let p = dynamics.contacts.iter().map(|contact| contact.p).max().unwrap_or(0);
        Self { dof: dynamics.n, contacts: dynamics.contacts.len(), p, ..Self::default() }
    }

    /// Appends a state, at which the dynamics has been evaluated.
    pub(crate) fn record(&mut self, dynamics: &Dynamics<'_>, state: &State) {
        self.t.push(state.t);
        self.q.extend_from_slice(&state.q);
        self.u.extend_from_slice(&state.u);
        for contact in &dynamics.contacts {
            let padded =
                |v: [f64; 3]| (0..self.p).map(move |i| if i < contact.p { v[i] } else { f64::NAN });
            self.slip.extend(padded(contact.slip));
            self.force.extend(padded(contact.force));
            self.normal_force.push(contact.normal_force);
            self.phase.push(contact.mode as i8);
        }
    }

    /// Number of events at which the contacts might have done something else.
    pub fn ambiguous_events(&self) -> usize {
        self.events.iter().filter(|event| event.ambiguous).count()
    }

    /// Keeps the first samples.
    pub(crate) fn truncate(&mut self, samples: usize) {
        let (n, m) = (self.dof, self.contacts);
        self.t.truncate(samples);
        self.q.truncate(samples * n);
        self.u.truncate(samples * n);
        self.slip.truncate(samples * m * self.p);
        self.force.truncate(samples * m * self.p);
        self.normal_force.truncate(samples * m);
        self.phase.truncate(samples * m);
    }
}

//! What an event-driven integration returns.

use crate::contact::Phase;
use crate::integrator::event::dynamics::{ContactVariables, Dynamics};
use crate::integrator::event::state::State;
use crate::integrator::samples::{ContactSample, Samples};

/// What happens at an event.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum EventKind {
    /// A contact begins to stick.
    Stick,
    /// A contact begins to slip, or its slip passes through zero, or it carries load again while it slips.
    Slip,
    /// A contact opens, or stays closed and carries no load any more.
    Open,
    /// A contact closes, with or without a jump of the velocities.
    Impact,
    /// Friction stops the slip by an impact without approach (Painlevé).
    ImpactWithoutCollision,
    /// The motion crosses the section.
    Section,
    /// A load or the motion of a surface jumps, or its rate does.
    Kink,
    /// A contact crosses a border at which friction jumps, see [`FrictionMap`](crate::system::FrictionMap).
    Border,
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
            Self::Kink => "kink",
            Self::Border => "border",
        }
    }
}

/// Something that happened.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
#[non_exhaustive]
pub struct Event {
    /// Time in s.
    pub time: f64,
    /// The contact; none of a section and of a kink.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub contact: Option<usize>,
    /// What happened.
    pub kind: EventKind,
    /// What the contact does afterwards.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub phase: Option<Phase>,
    /// Whether the contacts might have done something else.
    pub ambiguous: bool,
}

/// Samples of a motion, and its events. An event gives two samples where all steps are kept, before and after it.
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(remote = "Self", deny_unknown_fields))]
#[non_exhaustive]
pub struct Motion {
    /// States, slips and forces.
    pub samples: Samples,
    /// The events in their order.
    pub events: Vec<Event>,
    /// Steps made.
    pub steps: usize,
    /// Steps that were tried and found too long.
    pub rejected_steps: usize,
}

impl Motion {
    pub(crate) fn new(dynamics: &Dynamics<'_>) -> Self {
        let dimensions: Vec<usize> = dynamics.contacts.iter().map(|contact| contact.p).collect();
        let samples = Samples::new(dynamics.system.coordinates(), dynamics.n, &dimensions);
        Self { samples, ..Self::default() }
    }

    /// Appends a state, at which the dynamics have been evaluated.
    pub(crate) fn record(&mut self, dynamics: &mut Dynamics<'_>, state: &State) {
        for contact in &dynamics.contacts {
            let slip = contact.slip.map(|slip| slip / contact.by_place);
            let force = contact.force.map(|force| force * contact.by_place);
            self.samples.push_contact(&ContactSample {
                slip: &slip[..contact.p],
                force: &force[..contact.p],
                normal_force: contact.normal_force,
                phase: contact.mode,
            });
        }
        let (q, u) = dynamics.chart.system_state(state);
        self.samples.push_state(state.t, q, u);
    }

    /// Gives contacts the forces of the last sample.
    pub(crate) fn take_last_forces(&self, contacts: &mut [ContactVariables]) {
        let Samples { p, force, normal_force, .. } = &self.samples;
        let first = normal_force.len().saturating_sub(contacts.len());
        let last = normal_force[first..].iter().zip(force[first * p..].chunks_exact((*p).max(1)));
        for (contact, (normal, force)) in contacts.iter_mut().zip(last) {
            (contact.normal_force, contact.redistributed) = (*normal, false);
            let of_law = force[..contact.p].iter().map(|force| force / contact.by_place);
            contact.force.iter_mut().zip(of_law).for_each(|(to, force)| *to = force);
        }
    }

    /// Number of events at which the contacts might have done something else.
    pub fn ambiguous_events(&self) -> usize {
        self.events.iter().filter(|event| event.ambiguous).count()
    }
}

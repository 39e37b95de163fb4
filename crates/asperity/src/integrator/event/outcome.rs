//! Why an integration has ended.

use crate::integrator::event::state::EvaluationError;
use crate::solver::Unsolvable;

/// Why the integration ended.
#[derive(Debug)]
#[must_use = "an integration may end before its time"]
#[non_exhaustive]
pub enum Outcome {
    /// The end time is reached.
    Finished,
    /// The section is crossed.
    Section,
    /// The observer asked to stop.
    Interrupted,
    /// There were as many events as are allowed.
    TooManyEvents,
    /// Contacts are squeezed, or friction and normal force enforce each other: no force or percussion satisfies the
    /// laws.
    NoSolution {
        /// The contact.
        contact: usize,
        /// The problem of accelerations or of percussions and the proof.
        unsolvable: Option<Box<Unsolvable>>,
    },
    /// The motion does not get on: the forces grow without bound or jump where the method does not know it.
    Stagnated {
        /// How that shows.
        cause: Stagnation,
        /// The contact that is most likely to be the reason.
        contact: Option<usize>,
    },
    /// The accelerations cannot be evaluated.
    Error(EvaluationError),
}

impl Outcome {
    /// The forces or percussions of the contacts are not found.
    pub(crate) fn unsolved(contact: usize) -> Self {
        Self::Stagnated { cause: Stagnation::Unsolved, contact: Some(contact) }
    }
}

/// How it shows that a motion does not get on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Stagnation {
    /// Steps have become shorter than time resolves.
    Step,
    /// Most steps fail, and time hardly passes.
    Rejections,
    /// Events follow each other without time passing.
    Events,
    /// Friction and normal force enforce each other (Painlevé), and an impact without collision that stops every
    /// slip without a normal motion would break the laws; there may be another one.
    NoImpact,
    /// The forces or percussions of the contacts at an event have not been found to the accuracy that is needed.
    Unsolved,
    /// They grow without bound: there is probably no solution, but that is not proven.
    Unbounded,
}

impl Stagnation {
    /// Name of the cause.
    pub fn name(self) -> &'static str {
        match self {
            Self::Step => "step",
            Self::Rejections => "rejections",
            Self::Events => "events",
            Self::NoImpact => "no_impact",
            Self::Unsolved => "unsolved",
            Self::Unbounded => "unbounded",
        }
    }
}

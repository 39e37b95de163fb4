//! What comes of a step: of its contacts, and why it could not be made.

use thiserror::Error;

use crate::argument::ArgumentError;
use crate::contact::Phase;
use crate::system::SystemError;

/// A step could not be made.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum StepError {
    /// An option, the state or what the system says of itself is out of range.
    #[error(transparent)]
    Options(#[from] ArgumentError),
    /// The system failed.
    #[error(transparent)]
    System(#[from] SystemError),
    /// The contact problem is not finite; a solver must not see it.
    #[error("gap, directions or velocities of contact {contact} are not finite at t = {time} s")]
    NotFiniteContact {
        /// Time in s.
        time: f64,
        /// The system's contact.
        contact: usize,
    },
    /// The step was given up, as asked for; the state is the one before it.
    #[error("the step was given up at t = {time} s")]
    Cancelled {
        /// Time before the step in s.
        time: f64,
    },
    /// The state is no longer finite.
    #[error("the state is no longer finite at t = {time} s, coordinate {coordinate}")]
    NotFinite {
        /// Time in s.
        time: f64,
        /// First coordinate that is not finite.
        coordinate: usize,
    },
    /// The velocities have reversed and grown in every one of the last steps, to more than a thousand times.
    #[error(
        "velocities reverse and grow in every step up to t = {time} s, most of all that of coordinate {coordinate}: \
         forces act explicitly, so that springs need Δt² k < 4 m and dampers Δt d < 2 m"
    )]
    Reverses {
        /// Time in s.
        time: f64,
        /// The coordinate with the largest velocity.
        coordinate: usize,
    },
}

/// What one contact does after a step.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
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

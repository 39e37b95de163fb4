//! What can be wrong with a law or a question to it.

use asperity_set::SetError;
use thiserror::Error;

/// A law could not be made, or has no answer.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum LawError {
    /// A set is unusable.
    #[error(transparent)]
    Set(#[from] SetError),
    /// The force at rest is not unique.
    #[error("slip: must not be zero, at rest every force in the reservoir is admissible")]
    AtRest,
    /// The force of a law with a factor of the speed is that of stick or of slip at an unknown speed.
    #[error("force: does not tell stick from slip in a law whose friction depends on the speed")]
    SpeedUnknown,
    /// A force that the contact cannot transmit.
    #[error("force: lies outside the reservoir, its gauge is {gauge:?}")]
    OutsideReservoir {
        /// Gauge of the force per unit normal force.
        gauge: f64,
    },
}

impl LawError {
    /// Name of the argument that is wrong.
    pub fn argument(&self) -> &'static str {
        match self {
            Self::Set(error) => error.argument(),
            Self::AtRest => "slip",
            Self::SpeedUnknown | Self::OutsideReservoir { .. } => "force",
        }
    }
}

//! Problems that cannot be made.

use thiserror::Error;

/// A contact problem could not be made.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ProblemError {
    /// An array has the wrong length.
    #[error("{argument}: must have {expected} entries, has {got}")]
    Length {
        /// Name of the argument.
        argument: &'static str,
        /// Length that fits the laws.
        expected: usize,
        /// Length that was given.
        got: usize,
    },
    /// A matrix does not have the structure it must have.
    #[error("{argument}: {message}")]
    Structure {
        /// Name of the argument.
        argument: &'static str,
        /// What it must have.
        message: &'static str,
    },
    /// A law depends on the speed, which one step takes as given.
    #[error("laws: must not have a factor of the speed; scale the tangential columns of G by it")]
    Rated,
    /// A number is out of range.
    #[error("{argument}: must be {allowed}, got {value}")]
    Value {
        /// Name of the argument.
        argument: &'static str,
        /// The values that are allowed.
        allowed: &'static str,
        /// The value that was given.
        value: f64,
    },
}

impl ProblemError {
    /// Name of the argument that is wrong.
    pub fn argument(&self) -> &'static str {
        match self {
            Self::Length { argument, .. }
            | Self::Value { argument, .. }
            | Self::Structure { argument, .. } => argument,
            Self::Rated => "laws",
        }
    }
}

pub(super) fn check_length(
    argument: &'static str,
    expected: usize,
    got: usize,
) -> Result<(), ProblemError> {
    if expected == got {
        return Ok(());
    }
    Err(ProblemError::Length { argument, expected, got })
}

pub(super) fn check_finite(argument: &'static str, values: &[f64]) -> Result<(), ProblemError> {
    match values.iter().find(|v| !v.is_finite()) {
        Some(&value) => Err(ProblemError::Value { argument, allowed: "finite", value }),
        None => Ok(()),
    }
}

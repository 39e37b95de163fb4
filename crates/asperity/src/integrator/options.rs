//! What options of integrators are checked for.

use thiserror::Error;

use crate::system::SystemError;

/// Bad options.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{argument}: {message}")]
pub struct OptionsError {
    /// Name of the argument.
    pub argument: &'static str,
    /// What is allowed, and what was given.
    pub message: String,
}

impl From<SystemError> for OptionsError {
    fn from(error: SystemError) -> Self {
        match error {
            SystemError::Argument { argument, message } => Self { argument, message },
            other => Self { argument: "system", message: other.to_string() },
        }
    }
}

/// Refuses an argument.
pub(crate) fn refuse(
    argument: &'static str,
    message: impl Into<String>,
) -> Result<(), OptionsError> {
    Err(OptionsError { argument, message: message.into() })
}

/// Refuses what is not finite and positive.
pub(crate) fn check_positive(argument: &'static str, value: f64) -> Result<(), OptionsError> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    refuse(argument, format!("must be finite and positive, got {value}"))
}

/// Refuses what is not as many finite numbers as expected.
pub(crate) fn check_entries(
    argument: &'static str,
    values: &[f64],
    expected: usize,
) -> Result<(), OptionsError> {
    if values.len() != expected {
        return refuse(argument, format!("must have {expected} entries, has {}", values.len()));
    }
    match values.iter().find(|value| !value.is_finite()) {
        Some(value) => refuse(argument, format!("must be finite, got {value}")),
        None => Ok(()),
    }
}

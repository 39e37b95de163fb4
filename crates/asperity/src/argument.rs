//! Arguments that are not allowed, and the checks that all constructors share.

use thiserror::Error;

/// What is wrong with an argument.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// The number of its entries, or its shape.
    Size,
    /// What stands in it.
    Value,
}

/// An argument is not allowed.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{argument}: {message}")]
#[non_exhaustive]
pub struct ArgumentError {
    /// Name of the argument.
    pub argument: &'static str,
    /// What is allowed, and what was given.
    pub message: String,
    /// What is wrong.
    pub fault: Fault,
}

impl ArgumentError {
    pub(crate) fn new(argument: &'static str, message: impl Into<String>) -> Self {
        Self { argument, message: message.into(), fault: Fault::Value }
    }

    /// What must be otherwise than the given number is.
    pub(crate) fn number(argument: &'static str, allowed: &str, value: f64) -> Self {
        Self::new(argument, format!("must be {allowed}, got {value:?}"))
    }

    /// The same error of an argument that its caller calls otherwise.
    #[must_use]
    pub fn named(self, argument: &'static str) -> Self {
        Self { argument, ..self }
    }

    /// The same, which says of which of several it is.
    pub(crate) fn within(self, what: &str, index: usize) -> Self {
        Self { message: format!("of {what} {index} {}", self.message), ..self }
    }
}

type Checked<T> = Result<T, ArgumentError>;

/// Refuses an argument.
pub(crate) fn refuse<T>(argument: &'static str, message: impl Into<String>) -> Checked<T> {
    Err(ArgumentError::new(argument, message))
}

/// Refuses a number that is not as it must be.
pub(crate) fn check(argument: &'static str, value: f64, fits: bool, allowed: &str) -> Checked<f64> {
    if fits { Ok(value) } else { Err(ArgumentError::number(argument, allowed, value)) }
}

/// Refuses what is not finite and positive.
pub(crate) fn positive(argument: &'static str, value: f64) -> Checked<f64> {
    check(argument, value, value.is_finite() && value > 0.0, "finite and positive")
}

/// Refuses what is not finite or is negative.
pub(crate) fn not_negative(argument: &'static str, value: f64) -> Checked<f64> {
    check(argument, value, value.is_finite() && value >= 0.0, "finite and not negative")
}

/// Refuses what is not a part of one.
pub(crate) fn part(argument: &'static str, value: f64) -> Checked<f64> {
    if (0.0..=1.0).contains(&value) {
        return Ok(value);
    }
    refuse(argument, format!("must lie in [0, 1], got {value:?}"))
}

/// Refuses what is not finite.
pub(crate) fn finite(argument: &'static str, values: &[f64]) -> Checked<()> {
    let other = values.iter().find(|value| !value.is_finite());
    other.map_or(Ok(()), |&value| Err(ArgumentError::number(argument, "finite", value)))
}

/// Refuses what has not as many entries as expected.
pub(crate) fn length(argument: &'static str, expected: usize, got: usize) -> Checked<()> {
    if expected == got {
        return Ok(());
    }
    let message = format!("must have {expected} entries, has {got}");
    Err(ArgumentError { argument, message, fault: Fault::Size })
}

/// Refuses what is not as many finite numbers as expected.
pub(crate) fn entries(argument: &'static str, values: &[f64], expected: usize) -> Checked<()> {
    length(argument, expected, values.len())?;
    finite(argument, values)
}

/// Refuses the number of one of `count` bodies or contacts that there is not.
pub(crate) fn below(argument: &'static str, index: usize, count: usize, of: &str) -> Checked<()> {
    if index < count {
        return Ok(());
    }
    refuse(argument, format!("must be below {count}, the number of {of}, got {index}"))
}

//! Arguments that are not allowed, and the checks that all constructors share.

use thiserror::Error;

/// An argument is not allowed.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{argument}: {message}")]
#[non_exhaustive]
pub struct ArgumentError {
    /// Name of the argument.
    pub argument: &'static str,
    /// What is allowed, and what was given.
    pub message: String,
}

type Checked<T> = Result<T, ArgumentError>;

/// Refuses an argument.
pub(crate) fn refuse<T>(argument: &'static str, message: impl Into<String>) -> Checked<T> {
    Err(ArgumentError { argument, message: message.into() })
}

/// Refuses a number unless it is as it must be.
fn number(argument: &'static str, value: f64, fits: bool, must: &str) -> Checked<f64> {
    if fits { Ok(value) } else { refuse(argument, format!("must {must}, got {value}")) }
}

/// Refuses what is not finite and positive.
pub(crate) fn positive(argument: &'static str, value: f64) -> Checked<f64> {
    number(argument, value, value.is_finite() && value > 0.0, "be finite and positive")
}

/// Refuses what is not finite or is negative.
pub(crate) fn not_negative(argument: &'static str, value: f64) -> Checked<f64> {
    number(argument, value, value.is_finite() && value >= 0.0, "be finite and not negative")
}

/// Refuses what is not a part of one.
pub(crate) fn part(argument: &'static str, value: f64) -> Checked<f64> {
    number(argument, value, (0.0..=1.0).contains(&value), "lie in [0, 1]")
}

/// Refuses what is not finite.
pub(crate) fn finite(argument: &'static str, values: &[f64]) -> Checked<()> {
    let other = values.iter().find(|value| !value.is_finite());
    other.map_or(Ok(()), |&value| number(argument, value, false, "be finite").map(drop))
}

/// Refuses what is not as many finite numbers as expected.
pub(crate) fn entries(argument: &'static str, values: &[f64], expected: usize) -> Checked<()> {
    if values.len() != expected {
        return refuse(argument, format!("must have {expected} entries, has {}", values.len()));
    }
    finite(argument, values)
}

/// Refuses the number of one of `count` bodies or contacts that there is not.
pub(crate) fn below(argument: &'static str, index: usize, count: usize, of: &str) -> Checked<()> {
    if index < count {
        return Ok(());
    }
    refuse(argument, format!("must be below {count}, the number of {of}, got {index}"))
}

//! What can be wrong with a set.

use std::ops::RangeInclusive;

use thiserror::Error;

/// A set could not be made, or a question has no answer.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum SetError {
    /// A parameter lies outside its range.
    #[error("{argument}: must be {allowed}, got {value:?}")]
    Parameter {
        /// Name of the parameter.
        argument: &'static str,
        /// The values that are allowed.
        allowed: &'static str,
        /// The value that was given.
        value: f64,
    },
    /// Data that are not the outline of a set; the message holds a witness point.
    #[error("{argument}: {message}")]
    Shape {
        /// Name of the argument.
        argument: &'static str,
        /// What is wrong, and where.
        message: String,
    },
    /// A linear map that does not preserve the dimension of a set.
    #[error("matrix: must be finite and regular")]
    SingularMap,
    /// A convex set is needed and this one is star-shaped only.
    #[error("{argument}: must be convex, {reason}")]
    NotConvex {
        /// Name of the argument.
        argument: &'static str,
        /// Why the set is not convex.
        reason: String,
    },
    /// The gauge is not differentiable at the origin.
    #[error("x: must not be the origin, where the gauge has no gradient")]
    Origin,
    /// The support function is not differentiable at the origin.
    #[error("y: must not be zero")]
    NoDirection,
    /// A finite argument at which the answer is beyond the range of numbers.
    #[error("{argument}: must not be so {excess} that the answer is beyond the range of numbers")]
    Range {
        /// Name of the argument.
        argument: &'static str,
        /// What the argument is too much of.
        excess: &'static str,
    },
    /// A set whose radius vanishes, is infinite or is no number in some direction.
    #[error(
        "{argument}: must hold the origin in its interior and be bounded, its gauge is {gauge}"
    )]
    Degenerate {
        /// Name of the argument.
        argument: &'static str,
        /// The gauge that was found in some direction of unit length.
        gauge: f64,
    },
}

impl SetError {
    /// Name of the argument that is wrong.
    pub fn argument(&self) -> &'static str {
        match self {
            Self::Parameter { argument, .. }
            | Self::NotConvex { argument, .. }
            | Self::Shape { argument, .. }
            | Self::Range { argument, .. }
            | Self::Degenerate { argument, .. } => argument,
            Self::SingularMap => "matrix",
            Self::Origin => "x",
            Self::NoDirection => "y",
        }
    }
}

/// The sizes that sets may have: products of four sizes or of their ratios are then numbers still.
pub(crate) const SIZES: RangeInclusive<f64> = 1e-60..=1e60;
const ALLOWED_SIZES: &str = "between 1e-60 and 1e60";

/// `value` if a set may be as large.
pub(crate) fn size(argument: &'static str, value: f64) -> Result<f64, SetError> {
    positive(argument, value)?;
    if SIZES.contains(&value) {
        Ok(value)
    } else {
        Err(SetError::Parameter { argument, allowed: ALLOWED_SIZES, value })
    }
}

/// The error of an outline that holds a size no set may have.
pub(crate) fn size_error(argument: &'static str, found: f64) -> SetError {
    let message = format!("must give a set of a size {ALLOWED_SIZES}, holds {found:?}");
    SetError::Shape { argument, message }
}

/// `value` if it is finite and positive.
pub(crate) fn positive(argument: &'static str, value: f64) -> Result<f64, SetError> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(SetError::Parameter { argument, allowed: "finite and positive", value })
    }
}

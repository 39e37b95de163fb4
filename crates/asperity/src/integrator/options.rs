//! What options of integrators are checked for.

use thiserror::Error;

use crate::system::{Rotation, System, SystemError};

/// Bad options.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{argument}: {message}")]
#[non_exhaustive]
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

/// Steps of this length to this accuracy, of a system that is put together as it should be.
pub(crate) fn check_steps(
    system: &dyn System,
    tolerance: f64,
    dt: f64,
) -> Result<(), OptionsError> {
    check_positive("dt", dt)?;
    check_positive("tolerance", tolerance)?;
    check_structure(system)
}

/// Refuses what a system of a user says of its blocks and rotations, if places follow from it that there are not.
pub(crate) fn check_structure(system: &dyn System) -> Result<(), OptionsError> {
    let (blocks, n, coordinates) = (system.blocks().count(), system.dof(), system.coordinates());
    if n != system.blocks().velocities() {
        let velocities = system.blocks().velocities();
        return refuse(
            "system",
            format!("must have {velocities} velocities in its blocks, has {n}"),
        );
    }
    if (0..blocks).any(|block| system.blocks().range(block).is_empty()) {
        return refuse("system", "must have a velocity at least in every block");
    }
    for contact in 0..system.contacts().len() {
        let touched = system.touched(contact);
        let ascends = touched.windows(2).all(|pair| pair[0] < pair[1]);
        if touched.is_empty() || !ascends || touched.iter().any(|&block| block >= blocks) {
            let message = format!(
                "must touch some of its {blocks} blocks, in ascending order, with contact {contact}, touches {touched:?}"
            );
            return refuse("system", message);
        }
    }
    let outside = |r: &Rotation| r.coordinate + 4 > coordinates || r.velocity + 3 > n;
    match system.rotations().into_iter().find(outside) {
        Some(rotation) => refuse("system", format!("must have the coordinates of {rotation:?}")),
        None => Ok(()),
    }
}

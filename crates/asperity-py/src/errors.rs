//! Errors of the core as the exceptions of `asperity.errors`.

use asperity::event::EvaluationError;
use asperity::law::LawError;
use asperity::set::SetError;
use asperity::stepper::StepError;
use asperity::system::SystemError;
use asperity::{ArgumentError, Fault};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// `asperity.errors.<kind>(*arguments)`.
fn make<A>(kind: &str, arguments: A) -> PyErr
where
    A: for<'py> pyo3::call::PyCallArgs<'py>,
{
    Python::attach(|py| {
        let made = py
            .import("asperity.errors")
            .and_then(|module| module.getattr(kind))
            .and_then(|class| class.call1(arguments));
        made.map_or_else(|error| error, PyErr::from_value)
    })
}

/// The value of an argument is not allowed.
pub fn parameter(argument: &str, message: &str) -> PyErr {
    make("ParameterError", (argument, message))
}

/// The shape of an argument is wrong.
pub fn dimension(argument: &str, message: &str) -> PyErr {
    make("DimensionError", (argument, message))
}

/// The core has answered what this binding does not know: the two have not been built together.
pub fn unknown(answer: &str) -> PyErr {
    PyRuntimeError::new_err(format!("the core answers what the binding does not know: {answer}"))
}

/// The core writes `argument: message`; Python keeps the two apart.
fn split(argument: &str, text: &str) -> PyErr {
    let message = text.strip_prefix(argument).and_then(|t| t.strip_prefix(": ")).unwrap_or(text);
    parameter(argument, message)
}

/// Errors of the core on their way to Python.
pub struct Failure(pub PyErr);

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> Self {
        failure.0
    }
}

impl From<PyErr> for Failure {
    fn from(error: PyErr) -> Self {
        Self(error)
    }
}

impl From<SetError> for Failure {
    fn from(error: SetError) -> Self {
        Self(split(error.argument(), &error.to_string()))
    }
}

impl From<LawError> for Failure {
    fn from(error: LawError) -> Self {
        Self(split(error.argument(), &error.to_string()))
    }
}

impl From<ArgumentError> for Failure {
    fn from(error: ArgumentError) -> Self {
        Self(match error.fault {
            Fault::Size => dimension(error.argument, &error.message),
            Fault::Value => parameter(error.argument, &error.message),
        })
    }
}

impl From<EvaluationError> for Failure {
    fn from(error: EvaluationError) -> Self {
        let text = error.to_string();
        match error {
            EvaluationError::System(error) => error.into(),
            _ => Self(unknown(&text)),
        }
    }
}

impl From<SystemError> for Failure {
    fn from(error: SystemError) -> Self {
        Self(match error {
            SystemError::Argument(error) => return error.into(),
            // A system of Python that announces its blocks is asked for one after the other.
            SystemError::SingularMass { blocks, .. } => {
                let (text, name) =
                    (error.to_string(), if blocks > 1 { "block_mass" } else { "mass" });
                parameter(name, text.strip_prefix("mass: ").unwrap_or(&text))
            }
            SystemError::Rotation { .. } => parameter("dt", &format!("is too long: {error}")),
            SystemError::Constraints { .. } => {
                parameter("dt", &format!("is too long, or constraints do not fit: {error}"))
            }
            SystemError::Joints { .. } => {
                parameter("dt", &format!("is too long, or joints do not fit: {error}"))
            }
            // An exception of the user's code comes back as itself.
            SystemError::Foreign(source) => match source.downcast::<PyErr>() {
                Ok(error) => *error,
                Err(other) => parameter("system", &other.to_string()),
            },
            other => unknown(&other.to_string()),
        })
    }
}

impl From<StepError> for Failure {
    fn from(error: StepError) -> Self {
        let text = error.to_string();
        match error {
            StepError::Options(error) => error.into(),
            StepError::System(error) => error.into(),
            StepError::NotFinite { .. }
            | StepError::NotFiniteContact { .. }
            | StepError::Reverses { .. } => Self(make("DivergenceError", (text,))),
            StepError::Cancelled { .. } => Self(make("ConvergenceError", (text,))),
            _ => Self(unknown(&text)),
        }
    }
}

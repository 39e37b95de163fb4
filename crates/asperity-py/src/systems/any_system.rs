//! The core's system behind any of the classes.

use asperity::system::System;
use pyo3::prelude::*;

use super::callback::CallbackSystem;
use super::linear::LinearSystem;
use super::rigid::RigidBodies;
use crate::errors::dimension;

/// What `ask` gets to know from the core's system behind any of the classes.
pub fn with_system<T>(
    system: &Bound<'_, PyAny>,
    ask: impl FnOnce(&dyn System) -> T,
) -> PyResult<T> {
    if let Ok(linear) = system.cast::<LinearSystem>() {
        Ok(ask(&linear.get().0))
    } else if let Ok(callback) = system.cast::<CallbackSystem>() {
        Ok(ask(callback.get()))
    } else if let Ok(rigid) = system.cast::<RigidBodies>() {
        Ok(ask(&rigid.get().system))
    } else {
        Err(dimension("system", "must be a system"))
    }
}

/// What callbacks that cannot fail have raised since the last question: the cause of whatever ended the run.
pub fn raised(system: &Bound<'_, PyAny>) -> Option<PyErr> {
    if let Ok(callback) = system.cast::<CallbackSystem>() {
        return callback.get().raised();
    }
    system.cast::<RigidBodies>().ok().and_then(|rigid| rigid.get().raised())
}

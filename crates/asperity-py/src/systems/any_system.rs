//! The core's system behind any of the classes.

use asperity::system::System;
use pyo3::prelude::*;

use super::callback::CallbackSystem;
use super::linear::LinearSystem;
use super::rigid::RigidBodies;
use crate::errors::dimension;

/// The core's system behind any of the classes.
pub fn system_of<'a>(system: &'a Bound<'_, PyAny>) -> PyResult<&'a dyn System> {
    if let Ok(linear) = system.cast::<LinearSystem>() {
        Ok(&linear.get().0)
    } else if let Ok(callback) = system.cast::<CallbackSystem>() {
        Ok(callback.get())
    } else if let Ok(rigid) = system.cast::<RigidBodies>() {
        Ok(&rigid.get().system)
    } else {
        Err(dimension("system", "must be a system"))
    }
}

/// What `ask` gets to know from the core's system behind any of the classes.
pub fn with_system<T>(
    system: &Bound<'_, PyAny>,
    ask: impl FnOnce(&dyn System) -> T,
) -> PyResult<T> {
    system_of(system).map(ask)
}

/// Whether a system calls functions of Python, which only one thread at a time can.
#[pyfunction]
pub fn calls_python(system: &Bound<'_, PyAny>) -> bool {
    let rigid = system.cast::<RigidBodies>().ok();
    system.cast::<CallbackSystem>().is_ok() || rigid.is_some_and(|rigid| rigid.get().calls_python())
}

/// What callbacks that cannot fail have raised since the last question: the cause of whatever ended the run.
pub fn raised(system: &Bound<'_, PyAny>) -> Option<PyErr> {
    if let Ok(callback) = system.cast::<CallbackSystem>() {
        return callback.get().raised();
    }
    system.cast::<RigidBodies>().ok().and_then(|rigid| rigid.get().raised())
}

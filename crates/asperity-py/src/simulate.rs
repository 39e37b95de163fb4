//! The time loop without the interpreter.

use std::ops::ControlFlow;

use asperity::simulate::{Options, Outcome, Run, simulate as run_core};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyBaseException;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::convert::{Numbers, numbers};
use crate::errors::Failure;
use crate::problem::Solver;
use crate::rigid::RigidBodies;
use crate::system::with_system;

/// The run so far as a dictionary, and the exception that ended it, if one did.
#[pyfunction]
#[allow(clippy::too_many_arguments)] // The Python side calls it in one place, by position.
pub fn simulate<'py>(
    py: Python<'py>,
    system: &Bound<'py, PyAny>,
    dt: f64,
    steps: usize,
    q0: Numbers<'py>,
    u0: Numbers<'py>,
    solver: &Solver,
    tolerance: f64,
    save_every: usize,
    until_rest: bool,
    raise_on_failure: bool,
    progress: Option<Py<PyAny>>,
) -> Result<(Bound<'py, PyDict>, Option<Py<PyBaseException>>), Failure> {
    let options = Options {
        dt,
        steps,
        q0: numbers(&q0, "q0")?.to_vec(),
        u0: numbers(&u0, "u0")?.to_vec(),
        solver: solver.0,
        tolerance,
        save_every,
        until_rest,
        stop_on_failure: raise_on_failure,
    };
    let rigid = system.cast::<RigidBodies>();
    let mut raised = None;
    let mut observer = |step: usize, steps: usize| {
        let answer = Python::attach(|py| {
            py.check_signals()?;
            progress.as_ref().map_or(Ok(()), |f| f.call1(py, (step, steps)).map(drop))
        });
        answer.map_or_else(
            |error| {
                raised = Some(error);
                ControlFlow::Break(())
            },
            ControlFlow::Continue,
        )
    };
    let Run { trajectory, outcome } =
        with_system(system, |system| py.detach(|| run_core(system, &options, &mut observer)))??;
    let (status, failure, error) = match outcome {
        Outcome::Finished => ("finished", None, None),
        Outcome::AtRest => ("at_rest", None, None),
        Outcome::Interrupted => ("interrupted", None, raised),
        Outcome::Failed(failure) => ("failed", Some(failure), None),
        Outcome::Error(error) => ("failed", None, Some(Failure::from(error).0)),
    };
    // A frame of Python that raised is the cause of whatever ended the run.
    let error = rigid.ok().and_then(|rigid| rigid.get().raised()).or(error);
    if let Some(f) = progress.as_ref().filter(|_| error.is_none()) {
        f.call1(py, (trajectory.steps, steps))?;
    }
    let (n, n_c, p) = (trajectory.dof, trajectory.contacts, trajectory.p);
    let n_t = trajectory.t.len();
    let out = PyDict::new(py);
    out.set_item("t", PyArray1::from_vec(py, trajectory.t))?;
    out.set_item(
        "q",
        PyArray1::from_vec(py, trajectory.q).reshape([n_t, trajectory.coordinates])?,
    )?;
    out.set_item("u", PyArray1::from_vec(py, trajectory.u).reshape([n_t, n])?)?;
    out.set_item("slip", PyArray1::from_vec(py, trajectory.slip).reshape([n_t, n_c, p])?)?;
    out.set_item("force", PyArray1::from_vec(py, trajectory.force).reshape([n_t, n_c, p])?)?;
    out.set_item(
        "normal_force",
        PyArray1::from_vec(py, trajectory.normal_force).reshape([n_t, n_c])?,
    )?;
    out.set_item("phase", PyArray1::from_vec(py, trajectory.phase).reshape([n_t, n_c])?)?;
    out.set_item("iterations", PyArray1::from_vec(py, trajectory.iterations))?;
    out.set_item("residual", PyArray1::from_vec(py, trajectory.residual))?;
    out.set_item("status", status)?;
    out.set_item("ambiguous_steps", trajectory.ambiguous_steps)?;
    out.set_item("failed_steps", trajectory.failed_steps)?;
    out.set_item("steps", trajectory.steps)?;
    let counts = PyArray1::from_vec(py, trajectory.phase_counts).reshape([n_c, 3])?;
    out.set_item("phase_counts", counts)?;
    let failure = failure.map(|failure| -> PyResult<_> {
        let out = PyDict::new(py);
        out.set_item("step", failure.step)?;
        out.set_item("time", failure.time)?;
        out.set_item("contact", failure.contact)?;
        out.set_item("residual", failure.residual)?;
        out.set_item("status", failure.status.name())?;
        Ok(out)
    });
    out.set_item("failure", failure.transpose()?)?;
    Ok((out, error.map(|error| error.into_value(py))))
}

//! The time loop without the interpreter.

use std::ops::ControlFlow;

use asperity::contact::{ContactState, Phase};
use asperity::simulate::{Failure as Unsolved, Options, Outcome, Run, simulate_with as run_core};
use asperity::stepper::{ContactMemory, State};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyBaseException;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::samples::sample_arrays;
use crate::contact::outcome::without_solution;
use crate::contact::solver::Solver;
use crate::convert::{Numbers, Points, numbers};
use crate::errors::{Failure, dimension, parameter, unknown};
use crate::systems::any_system::{raised as raised_meanwhile, with_system};

/// Columns of what a contact hands over: closed, phase, number of earlier slips, three slip velocities, four
/// percussions.
const COLUMNS: usize = 16;

/// How the steps of a run are counted: from which time, how many, and how long they are.
struct Clock {
    origin: f64,
    steps: usize,
    dt: Option<f64>,
}

/// The state behind the arrays of one.
fn state(
    &Clock { origin, steps, dt }: &Clock,
    q: &Numbers<'_>,
    u: &Numbers<'_>,
    contacts: &Points<'_>,
    momenta: &Points<'_>,
) -> PyResult<State> {
    let rows = |points: &Points<'_>, argument, columns: usize| -> PyResult<Vec<f64>> {
        let array = points.as_array();
        if array.ncols() != columns {
            return Err(dimension(argument, &format!("must have {columns} columns")));
        }
        Ok(array.iter().copied().collect())
    };
    let memory = |row: &[f64]| -> PyResult<ContactMemory> {
        let number = row[1] as i8;
        let phase = Phase::from_number(number).filter(|_| f64::from(number) == row[1]);
        let phase = phase.ok_or_else(|| parameter("contacts", "holds an unknown phase"))?;
        let slips = [3, 6, 9].map(|i| [row[i], row[i + 1], row[i + 2]]);
        Ok(ContactMemory {
            closed: row[0] != 0.0,
            state: ContactState::with_history(phase, slips, row[2] as u8),
            percussion: [row[12], row[13], row[14], row[15]],
        })
    };
    Ok(State {
        origin,
        steps,
        dt,
        q: numbers(q, "q")?.to_vec(),
        u: numbers(u, "u")?.to_vec(),
        contacts: rows(contacts, "contacts", COLUMNS)?
            .chunks_exact(COLUMNS)
            .map(memory)
            .collect::<PyResult<_>>()?,
        momenta: rows(momenta, "momenta", 3)?,
    })
}

/// A state as a dictionary of arrays.
fn state_dict<'py>(py: Python<'py>, state: State) -> PyResult<Bound<'py, PyDict>> {
    let mut table = Vec::with_capacity(COLUMNS * state.contacts.len());
    for memory in &state.contacts {
        let (slips, known) = memory.state.history();
        let phase = f64::from(memory.state.phase as i8);
        table.extend([f64::from(u8::from(memory.closed)), phase, f64::from(known)]);
        table.extend(slips.into_iter().flatten());
        table.extend(memory.percussion);
    }
    let (contacts, bodies) = (state.contacts.len(), state.momenta.len() / 3);
    let out = PyDict::new(py);
    out.set_item("t0", state.origin)?;
    out.set_item("steps", state.steps)?;
    out.set_item("dt", state.dt)?;
    out.set_item("q", PyArray1::from_vec(py, state.q))?;
    out.set_item("u", PyArray1::from_vec(py, state.u))?;
    out.set_item("contacts", PyArray1::from_vec(py, table).reshape([contacts, COLUMNS])?)?;
    out.set_item("momenta", PyArray1::from_vec(py, state.momenta).reshape([bodies, 3])?)?;
    Ok(out)
}

/// The run so far as a dictionary, and the exception that ended it, if one did.
#[pyfunction]
#[allow(clippy::too_many_arguments)] // The Python side calls it in one place, by position.
pub fn simulate<'py>(
    py: Python<'py>,
    system: &Bound<'py, PyAny>,
    dt: f64,
    steps: usize,
    clock: (f64, usize, Option<f64>),
    q0: Numbers<'py>,
    u0: Numbers<'py>,
    contacts: Points<'py>,
    momenta: Points<'py>,
    solver: &Solver,
    tolerance: f64,
    save_every: usize,
    until_rest: bool,
    raise_on_failure: bool,
    progress: Option<Py<PyAny>>,
) -> Result<(Bound<'py, PyDict>, Option<Py<PyBaseException>>), Failure> {
    let clock = Clock { origin: clock.0, steps: clock.1, dt: clock.2 };
    let start = state(&clock, &q0, &u0, &contacts, &momenta)?;
    let mut options = Options::new(dt, dt)?.with_steps(steps).with_save_every(save_every);
    options = options.with_state(start).with_solver(solver.0).with_tolerance(tolerance);
    (options.until_rest, options.stop_on_failure) = (until_rest, raise_on_failure);
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
    let Run { trajectory, end, outcome, .. } =
        with_system(system, |system| py.detach(|| run_core(system, &options, &mut observer)))??;
    let (status, failure, error) = match outcome {
        Outcome::Finished => ("finished", None, None),
        Outcome::AtRest => ("at_rest", None, None),
        Outcome::Interrupted => ("interrupted", None, raised),
        Outcome::Failed(failure) => ("failed", Some(failure), None),
        Outcome::Error(error) => ("failed", None, Some(Failure::from(error).0)),
        other => ("failed", None, Some(unknown(&format!("{other:?}")))),
    };
    let error = raised_meanwhile(system).or(error);
    if let Some(f) = progress.as_ref().filter(|_| error.is_none()) {
        f.call1(py, (trajectory.steps, steps))?;
    }
    let n_c = trajectory.samples.contacts;
    let out = sample_arrays(py, trajectory.samples)?;
    out.set_item("iterations", PyArray1::from_vec(py, trajectory.iterations))?;
    out.set_item("residual", PyArray1::from_vec(py, trajectory.residual))?;
    out.set_item("status", status)?;
    out.set_item("ambiguous_steps", trajectory.ambiguous_steps)?;
    out.set_item("failed_steps", trajectory.failed_steps)?;
    out.set_item("steps", trajectory.steps)?;
    let counts = PyArray1::from_vec(py, trajectory.phase_counts).reshape([n_c, 3])?;
    out.set_item("phase_counts", counts)?;
    out.set_item("end", end.map(|end| state_dict(py, end)).transpose()?)?;
    out.set_item("failure", failure.map(|failure| unsolved(py, &failure)).transpose()?)?;
    Ok((out, error.map(|error| error.into_value(py))))
}

/// A contact problem that was not solved, as a dictionary.
pub fn unsolved<'py>(py: Python<'py>, failure: &Unsolved) -> PyResult<Bound<'py, PyDict>> {
    let out = PyDict::new(py);
    out.set_item("step", failure.step)?;
    out.set_item("time", failure.time)?;
    out.set_item("contact", failure.contact)?;
    out.set_item("residual", failure.residual)?;
    out.set_item("status", failure.status.name())?;
    let unsolvable = failure.unsolvable.as_deref();
    let unsolvable = unsolvable.map(|proof| without_solution(py, proof)).transpose()?;
    out.set_item("unsolvable", unsolvable)?;
    Ok(out)
}

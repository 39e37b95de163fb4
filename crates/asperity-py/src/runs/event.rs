//! Event-driven integration without the interpreter.

use std::ops::ControlFlow;

use asperity::event::{Motion, Options, Outcome, Run, Section, integrate_with as run_core};
use pyo3::exceptions::PyBaseException;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::samples::sample_arrays;
use crate::contact::outcome::without_solution;
use crate::convert::{Numbers, numbers};
use crate::errors::{Failure, unknown};
use crate::systems::any_system::{raised as raised_meanwhile, with_system};

/// The motion so far as a dictionary, and the exception that ended it, if one did.
#[pyfunction]
#[allow(clippy::too_many_arguments)] // The Python side calls it in one place, by position.
pub fn integrate<'py>(
    py: Python<'py>,
    system: &Bound<'py, PyAny>,
    times: (f64, f64),
    q0: Numbers<'py>,
    u0: Numbers<'py>,
    tolerance: f64,
    sample: Option<f64>,
    max_step: Option<f64>,
    section: Option<(Numbers<'py>, f64, f64)>,
    max_events: usize,
    progress: Option<Py<PyAny>>,
) -> Result<(Bound<'py, PyDict>, Option<Py<PyBaseException>>), Failure> {
    let section = section.map(|(normal, level, after)| -> PyResult<Section> {
        Ok(Section { normal: numbers(&normal, "section")?.to_vec(), level, after })
    });
    let (q0, u0) = (numbers(&q0, "q0")?.to_vec(), numbers(&u0, "u0")?.to_vec());
    let section = section.transpose()?;
    let (t_start, t_end) = times;
    let mut options = Options::new(t_end)?
        .with_start_time(t_start)
        .with_start(&q0, &u0)
        .with_tolerance(tolerance);
    (options.sample, options.max_step, options.section) = (sample, max_step, section);
    options.max_events = max_events;
    let mut raised = None;
    let mut observer = |t: f64| {
        let answer = Python::attach(|py| {
            py.check_signals()?;
            progress.as_ref().map_or(Ok(()), |f| f.call1(py, (t, t_end)).map(drop))
        });
        answer.map_or_else(
            |error| {
                raised = Some(error);
                ControlFlow::Break(())
            },
            ControlFlow::Continue,
        )
    };
    let Run { motion, outcome, .. } =
        with_system(system, |system| py.detach(|| run_core(system, &options, &mut observer)))??;
    let out = dictionary(py, motion)?;
    let interrupted = matches!(outcome, Outcome::Interrupted);
    let error = say_how_it_ended(&out, outcome)?;
    let error = raised_meanwhile(system).or(error).or(raised.filter(|_| interrupted));
    Ok((out, error.map(|error| error.into_value(py))))
}

/// Puts into a dictionary how an integration has ended; the exception that ended it, if one did.
pub fn say_how_it_ended(out: &Bound<'_, PyDict>, outcome: Outcome) -> PyResult<Option<PyErr>> {
    let (name, contact, error) = match outcome {
        Outcome::Finished => ("finished", None, None),
        Outcome::Section => ("section", None, None),
        Outcome::Interrupted => ("interrupted", None, None),
        Outcome::TooManyEvents => ("too_many_events", None, None),
        Outcome::NoSolution { contact, unsolvable } => {
            let proven = unsolvable.map(|proof| without_solution(out.py(), &proof)).transpose()?;
            out.set_item("unsolvable", proven)?;
            ("no_solution", Some(contact), None)
        }
        Outcome::Stagnated { cause, contact } => (cause.name(), contact, None),
        Outcome::Error(error) => ("failed", None, Some(Failure::from(error).0)),
        other => ("failed", None, Some(unknown(&format!("{other:?}")))),
    };
    out.set_item("ended", name)?;
    out.set_item("contact", contact)?;
    Ok(error)
}

fn dictionary(py: Python<'_>, motion: Motion) -> PyResult<Bound<'_, PyDict>> {
    let out = sample_arrays(py, motion.samples)?;
    let events = motion.events.iter().map(|event| {
        let phase = event.phase.map(|phase| phase as i8);
        (event.time, event.contact, event.kind.name(), phase, event.ambiguous)
    });
    out.set_item("events", events.collect::<Vec<_>>())?;
    out.set_item("steps", motion.steps)?;
    out.set_item("rejected_steps", motion.rejected_steps)?;
    Ok(out)
}

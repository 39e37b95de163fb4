//! Many runs without the interpreter.

use std::ops::ControlFlow;

use asperity::ensemble::{
    self, Ending, Ensemble, Keep, Lanes, Member, MemberFailure, Members, Reason, Reduced, Workers,
};
use asperity::event::{self, Section};
use asperity::simulate::Options;
use asperity::system::{InitialState, System, SystemError};
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1};
use pyo3::exceptions::PyBaseException;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::event::say_how_it_ended;
use super::samples::sample_arrays;
use super::simulate::unsolved;
use crate::contact::solver::Solver;
use crate::convert::{Numbers, Points, numbers};
use crate::errors::{Failure, dimension};
use crate::systems::any_system::{raised, system_of};
use crate::systems::variants::LinearVariants;

/// The systems of an ensemble.
enum Systems<'a> {
    Held(Vec<&'a dyn System>),
    Made(&'a LinearVariants),
}

/// Start states and systems as arrays.
struct Given<'a> {
    systems: Systems<'a>,
    first: &'a dyn System,
    /// Which of the systems a run is of; the only one, if nothing is said.
    variants: Option<&'a [i64]>,
    /// One row for all, or a row per run.
    q0: &'a [f64],
    u0: &'a [f64],
    count: usize,
}

/// A row of a table that has one row for all runs, or a row per run.
fn row(table: &[f64], width: usize, member: usize) -> Vec<f64> {
    let first = if table.len() > width { member * width } else { 0 };
    table[first..first + width].to_vec()
}

impl Members for Given<'_> {
    fn count(&self) -> usize {
        self.count
    }

    fn first(&self) -> &dyn System {
        self.first
    }

    fn variant(&self, member: usize) -> usize {
        self.variants.map_or(0, |variants| variants[member] as usize)
    }

    fn system(&self, variant: usize) -> Result<Member<'_>, SystemError> {
        Ok(match &self.systems {
            Systems::Held(systems) => Member::Held(systems[variant]),
            Systems::Made(variants) => Member::Made(Box::new(variants.make(variant)?)),
        })
    }

    fn start(&self, member: usize, system: &dyn System) -> InitialState {
        InitialState {
            q: row(self.q0, system.coordinates(), member),
            u: row(self.u0, system.dof(), member),
        }
    }
}

/// The runs: systems, or the first one and what makes the others; which of them each run is of; start states, one row for
/// all or a row per run; how many runs there are.
type Runs<'py> = (
    Vec<Bound<'py, PyAny>>,
    Option<Bound<'py, LinearVariants>>,
    Option<PyReadonlyArray1<'py, i64>>,
    Points<'py>,
    Points<'py>,
    usize,
);

/// What is kept: every so many steps, the time before which nothing is looked at, whether extents, shares of stick and
/// times of rest are wanted, and a section by normal, level and time.
type Kept<'py> = (Option<usize>, f64, [bool; 3], Option<(Numbers<'py>, f64, f64)>);

fn section(given: Option<(Numbers<'_>, f64, f64)>) -> PyResult<Option<Section>> {
    let section = |(normal, level, after): (Numbers<'_>, f64, f64)| -> PyResult<Section> {
        Ok(Section { normal: numbers(&normal, "section")?.to_vec(), level, after })
    };
    given.map(section).transpose()
}

fn keep((every, after, [extent, stick_share, rest_time], given): Kept<'_>) -> PyResult<Keep> {
    Ok(Keep { every, after, extent, stick_share, rest_time, section: section(given)? })
}

/// Looks for Ctrl-C and reports progress.
struct Watch {
    progress: Option<Py<PyAny>>,
    raised: Option<PyErr>,
}

impl Watch {
    fn ask(&mut self, done: usize, count: usize) -> ControlFlow<()> {
        let answer = Python::attach(|py| {
            py.check_signals()?;
            self.progress.as_ref().map_or(Ok(()), |f| f.call1(py, (done, count)).map(drop))
        });
        if let Err(error) = answer {
            self.raised = Some(error);
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    }
}

type Answer<'py> = (Bound<'py, PyDict>, Option<Py<PyBaseException>>);

/// Runs an ensemble without the interpreter.
fn run<'py>(
    py: Python<'py>,
    runs: &Runs<'py>,
    progress: Option<Py<PyAny>>,
    compute: impl FnOnce(
        &Given<'_>,
        &mut dyn FnMut(usize, usize) -> ControlFlow<()>,
    ) -> Result<Ensemble, asperity::ArgumentError>
    + Send,
) -> Result<Answer<'py>, Failure> {
    let (objects, variants, numbers_of_systems, q0, u0, count) = runs;
    let held: Vec<&dyn System> = objects.iter().map(system_of).collect::<PyResult<_>>()?;
    let first = *held.first().ok_or_else(|| dimension("systems", "must not be empty"))?;
    let contiguous = |array: &'_ Points<'py>, argument: &str, width: usize| {
        let (rows, columns) = array.as_array().dim();
        let fits = columns == width && (rows == 1 || rows == *count) && array.as_slice().is_ok();
        let message = "must have a row per run, or one for all";
        if fits { Ok(()) } else { Err(dimension(argument, message)) }
    };
    contiguous(q0, "q0", first.coordinates())?;
    contiguous(u0, "u0", first.dof())?;
    let systems = match variants {
        Some(variants) => Systems::Made(variants.get()),
        None => Systems::Held(held),
    };
    let of = numbers_of_systems.as_ref().map(|numbers| numbers.as_slice()).transpose();
    let of = of.map_err(|_| dimension("replace", "must be contiguous"))?;
    let there = match &systems {
        Systems::Held(held) => held.len(),
        Systems::Made(variants) => variants.count(),
    };
    let fits =
        |of: &[i64]| of.len() == *count && of.iter().all(|&k| (0..there as i64).contains(&k));
    if !of.is_none_or(fits) {
        return Err(dimension("replace", "must say for every run of which system it is").into());
    }
    let given = Given {
        systems,
        first,
        variants: of,
        q0: q0.as_slice().unwrap_or_default(),
        u0: u0.as_slice().unwrap_or_default(),
        count: *count,
    };
    let mut watch = Watch { progress, raised: None };
    let found = py.detach(|| compute(&given, &mut |done, count| watch.ask(done, count)))?;
    if watch.raised.is_none() {
        // The bar comes to its end; what that raises is kept.
        let _ = watch.ask(*count, *count);
    }
    // A run that failed as a function of Python has raised something fails with that.
    let meanwhile = objects.iter().find_map(raised);
    let out = dictionary(py, found, meanwhile)?;
    Ok((out, watch.raised.map(|error| error.into_value(py))))
}

/// Simulates many systems, or one from many states.
#[pyfunction]
#[allow(clippy::too_many_arguments)] // The Python side calls it in one place, by position.
pub fn simulate_many<'py>(
    py: Python<'py>,
    runs: Runs<'py>,
    dt: f64,
    steps: usize,
    solver: &Solver,
    tolerance: f64,
    until_rest: bool,
    kept: Kept<'py>,
    threads: Option<usize>,
    lanes: bool,
    progress: Option<Py<PyAny>>,
) -> Result<Answer<'py>, Failure> {
    let lanes = if lanes { Lanes::Widest } else { Lanes::None };
    let workers = Workers { threads, lanes };
    let mut options =
        Options::new(dt, dt)?.with_steps(steps).with_solver(solver.0).with_tolerance(tolerance);
    options.until_rest = until_rest;
    let keep = keep(kept)?;
    run(py, &runs, progress, move |given, observer| {
        ensemble::simulate_many(given, &options, &keep, workers, observer)
    })
}

/// Integrates many systems, or one from many states.
#[pyfunction]
#[allow(clippy::too_many_arguments)] // The Python side calls it in one place, by position.
pub fn integrate_many<'py>(
    py: Python<'py>,
    runs: Runs<'py>,
    t_end: f64,
    tolerance: f64,
    sample: Option<f64>,
    max_step: Option<f64>,
    stop: Option<(Numbers<'py>, f64, f64)>,
    max_events: usize,
    kept: Kept<'py>,
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> Result<Answer<'py>, Failure> {
    let mut options =
        event::Options::new(t_end)?.with_tolerance(tolerance).with_max_events(max_events);
    (options.sample, options.max_step, options.section) = (sample, max_step, section(stop)?);
    let keep = keep(kept)?;
    run(py, &runs, progress, move |given, observer| {
        ensemble::integrate_many(given, &options, &keep, threads, observer)
    })
}

fn dictionary(
    py: Python<'_>,
    found: Ensemble,
    meanwhile: Option<PyErr>,
) -> PyResult<Bound<'_, PyDict>> {
    let Ensemble {
        ends,
        endings,
        steps,
        ambiguous,
        samples_per_member,
        samples,
        reduced,
        failures,
        ..
    } = found;
    let [coordinates, dof, contacts] = [ends.coordinates, ends.dof, ends.contacts];
    let out = sample_arrays(py, ends)?;
    if samples_per_member > 0 {
        out.set_item("samples", sample_arrays(py, samples)?)?;
    }
    let endings: Vec<i8> = endings.into_iter().map(|ending: Ending| ending as i8).collect();
    out.set_item("ending", PyArray1::from_vec(py, endings))?;
    out.set_item("steps", PyArray1::from_vec(py, steps))?;
    out.set_item("ambiguous", PyArray1::from_vec(py, ambiguous))?;
    let Reduced {
        extent,
        stick_share,
        rest_time,
        crossings,
        crossing_time,
        crossing_q,
        crossing_u,
        period,
        ..
    } = reduced;
    let tables = [
        ("extent", extent, coordinates),
        ("stick_share", stick_share, contacts),
        ("crossing_q", crossing_q, coordinates),
        ("crossing_u", crossing_u, dof),
    ];
    for (name, values, width) in tables.into_iter().filter(|(_, values, _)| !values.is_empty()) {
        let rows = values.len() / width;
        out.set_item(name, PyArray1::from_vec(py, values).reshape([rows, width])?)?;
    }
    for (name, values) in
        [("rest_time", rest_time), ("crossing_time", crossing_time), ("period", period)]
    {
        if !values.is_empty() {
            out.set_item(name, PyArray1::from_vec(py, values))?;
        }
    }
    if !crossings.is_empty() {
        out.set_item("crossings", PyArray1::from_vec(py, crossings))?;
    }
    let mut meanwhile = meanwhile;
    let failures = failures.into_iter().map(|failure| failed(py, failure, &mut meanwhile));
    out.set_item("failures", failures.collect::<PyResult<Vec<_>>>()?)?;
    Ok(out)
}

/// How a run failed, as a dictionary: with the exception, or with what Python makes one of.
fn failed<'py>(
    py: Python<'py>,
    failure: MemberFailure,
    meanwhile: &mut Option<PyErr>,
) -> PyResult<Bound<'py, PyDict>> {
    let MemberFailure { member, time, reason, .. } = failure;
    let out = PyDict::new(py);
    out.set_item("member", member)?;
    out.set_item("time", time)?;
    let error = match reason {
        Reason::System(error) => Some(Failure::from(error).0),
        Reason::Argument(error) => Some(Failure::from(error).0),
        Reason::Step(error) => Some(Failure::from(error).0),
        Reason::Unsolved(failure) => {
            out.set_item("unsolved", unsolved(py, &failure)?)?;
            None
        }
        Reason::Event(outcome) => say_how_it_ended(&out, outcome)?,
        other => Some(crate::errors::unknown(&format!("{other:?}"))),
    };
    let error = meanwhile.take().or(error);
    out.set_item("error", error.map(|error| error.into_value(py)))?;
    Ok(out)
}

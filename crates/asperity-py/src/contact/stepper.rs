//! Steps of a mechanism with contacts.

use std::sync::Mutex;
use std::time::{Duration, Instant};

use asperity::contact::Phase;
use asperity::law;
use asperity::mechanism::{ContactStepper, Mobility, Rows, StepRows};
use asperity::set::StarSet;
use asperity::solver::{SolveReport, Stop};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::sync::MutexExt;
use pyo3::types::PyDict;

use super::delassus::{Triple, sparse};
use super::outcome::{array, certified, numbers as numbers_of};
use super::solver::Solver;
use crate::convert::{Numbers, Points, numbers};
use crate::errors::{Failure, dimension, parameter};
use crate::interrupt::asked;
use crate::law::Law;

/// What stands for rows that are those of no contact with friction.
pub const FRICTIONLESS: i64 = -1;
pub const BILATERAL: i64 = -2;
pub const DRY_FRICTION: i64 = -3;

/// `G` as Python hands it over.
#[derive(FromPyObject)]
enum Entries<'py> {
    Dense(Points<'py>),
    Sparse(Triple<'py>),
}

/// A stepper, and buffers for what Python hands over. Threads wait for it without the interpreter, which a step needs to end.
#[pyclass(frozen, module = "asperity._core")]
pub struct Stepper(Mutex<(ContactStepper, Vec<Rows>, Vec<u64>)>);

/// A step that was solved.
#[pyclass(frozen, module = "asperity._core")]
pub struct Step {
    report: SolveReport,
    percussion: Vec<f64>,
    velocity: Vec<f64>,
    phases: Vec<Phase>,
    ambiguous: Vec<bool>,
    #[pyo3(get)]
    mismatch: f64,
}

#[pymethods]
impl Stepper {
    #[new]
    fn new(laws: Vec<Bound<'_, Law>>, solver: &Solver) -> Result<Self, Failure> {
        let laws = laws.iter().map(|law| law.get().0.clone()).collect();
        let stepper = ContactStepper::new(laws, solver.0)?;
        Ok(Self(Mutex::new((stepper, Vec::new(), Vec::new()))))
    }

    #[allow(clippy::too_many_arguments)] // The Python side calls it in one place, by position.
    fn step(
        &self,
        py: Python<'_>,
        delassus: Entries<'_>,
        free_velocity: Numbers<'_>,
        kinds: PyReadonlyArray1<'_, i64>,
        bounds: Option<Numbers<'_>>,
        keys: Option<PyReadonlyArray1<'_, i64>>,
        tolerance: f64,
        time_limit: Option<f64>,
    ) -> Result<Step, Failure> {
        let free_velocity = numbers(&free_velocity, "free_velocity")?;
        let csr;
        let delassus = match &delassus {
            Entries::Dense(entries) => {
                let (height, width) = entries.as_array().dim();
                if height != width {
                    return Err(dimension("delassus", "must have as many columns as rows").into());
                }
                let all = entries.as_slice();
                Mobility::Dense(all.map_err(|_| dimension("delassus", "must be contiguous"))?)
            }
            Entries::Sparse(triple) => {
                csr = sparse("delassus", (free_velocity.len(), free_velocity.len()), triple)?;
                Mobility::Sparse(&csr)
            }
        };
        let bounds = bounds.as_ref().map(|bounds| numbers(bounds, "bounds")).transpose()?;
        let kinds = kinds.as_array();
        if bounds.is_some_and(|bounds| bounds.len() != kinds.len()) {
            return Err(dimension("bounds", "must have one entry per item").into());
        }
        let mut guard =
            self.0.lock_py_attached(py).map_err(|_| parameter("stepper", "has failed before"))?;
        let (stepper, items, numbers_of) = &mut *guard;
        items.clear();
        for (item, &kind) in kinds.iter().enumerate() {
            items.push(match kind {
                FRICTIONLESS => Rows::Frictionless,
                BILATERAL => Rows::Bilateral,
                DRY_FRICTION => {
                    let message = format!("must be given, item {item} is DRY_FRICTION");
                    let given = bounds.ok_or_else(|| parameter("bounds", &message))?;
                    Rows::DryFriction(given[item])
                }
                law => Rows::Contact(usize::try_from(law).unwrap_or(usize::MAX)),
            });
        }
        numbers_of.clear();
        if let Some(keys) = &keys {
            // Any numbers will do as long as equal ones stay equal and their order is theirs.
            numbers_of.extend(keys.as_array().iter().map(|&key| (key as u64) ^ (1 << 63)));
        }
        let rows = StepRows {
            delassus,
            free_velocity,
            items,
            keys: keys.is_some().then_some(&numbers_of[..]),
            factors: None,
        };
        let report = asked(py, |cancelled| {
            let limit = time_limit.and_then(|s| Duration::try_from_secs_f64(s).ok());
            let mut stop = Stop::at(tolerance).unless(cancelled);
            stop.deadline = limit.and_then(|limit| Instant::now().checked_add(limit));
            stepper.step(&rows, stop)
        })??;
        Ok(Step::of(report, stepper))
    }

    fn forget(&self, py: Python<'_>) -> Result<(), Failure> {
        let mut guard =
            self.0.lock_py_attached(py).map_err(|_| parameter("stepper", "has failed before"))?;
        guard.0.forget();
        Ok(())
    }

    fn certificate<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyDict>, Failure> {
        let guard =
            self.0.lock_py_attached(py).map_err(|_| parameter("stepper", "has failed before"))?;
        Ok(certified(py, &guard.0.certificate()?)?)
    }

    /// The contacts of the last step with joints eliminated: numbers, items, and laws by their number or, on a line, by the
    /// largest friction to both sides, or neither without friction.
    fn contact_problem<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyDict>, Failure> {
        let guard =
            self.0.lock_py_attached(py).map_err(|_| parameter("stepper", "has failed before"))?;
        let problem = guard.0.contact_problem();
        let out = numbers_of(py, problem, true)?;
        let (mut items, mut laws, mut ends) = (Vec::new(), Vec::new(), Vec::new());
        for ((item, kind), rows) in guard.0.contact_items().zip(problem.contacts()) {
            items.push(item);
            laws.push(match (&rows.law, kind) {
                (law::Law::Zero(_), _) => None,
                (_, Rows::Contact(law)) => Some(law),
                _ => None,
            });
            ends.push(match &rows.law {
                law::Law::One(law) => {
                    Some([-1.0, 1.0].map(|x| x / law.reservoir().gauge(&[x].into())))
                }
                _ => None,
            });
        }
        out.set_item("items", array(py, items))?;
        out.set_item("laws", laws)?;
        out.set_item("ends", ends)?;
        Ok(out)
    }
}

impl Step {
    /// The step that a stepper has solved last.
    pub fn of(report: SolveReport, stepper: &ContactStepper) -> Self {
        Self {
            report,
            percussion: stepper.percussion().to_vec(),
            velocity: stepper.velocity().to_vec(),
            phases: stepper.phases().to_vec(),
            ambiguous: stepper.ambiguous().to_vec(),
            mismatch: stepper.mismatch(),
        }
    }
}

#[pymethods]
impl Step {
    #[getter]
    fn percussion<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, self.percussion.clone())
    }

    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, self.velocity.clone())
    }

    #[getter]
    fn phase<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        array(py, self.phases.iter().map(|phase| *phase as i64).collect())
    }

    #[getter]
    fn ambiguous_items<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        array(py, self.ambiguous.clone())
    }

    #[getter]
    fn status(&self) -> &'static str {
        self.report.status.name()
    }

    #[getter]
    fn residual(&self) -> f64 {
        self.report.residual
    }

    #[getter]
    fn iterations(&self) -> usize {
        self.report.iterations
    }

    #[getter]
    fn worst_item(&self) -> usize {
        self.report.worst_contact
    }
}

//! Contact problems and their solvers.

use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use asperity::contact::{ContactProblem, Memory, NormalForce, Phase};
use asperity::law::Law as CoreLaw;
use asperity::solver::{self, Certificate, Measure, Solution, Stop, Workspace};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::delassus::Operator;
use super::outcome::{Outcome, certified};
use super::solver::Solver;
use crate::convert::{Numbers, numbers};
use crate::errors::{Failure, dimension, parameter};
use crate::interrupt::asked;
use crate::law::Law;

/// A contact problem, and what the last solve of it has prepared.
#[pyclass(frozen, module = "asperity._core")]
pub struct Problem {
    pub problem: Arc<ContactProblem>,
    workspace: Mutex<Workspace>,
}

#[pymethods]
impl Problem {
    #[new]
    fn new(
        delassus: Operator<'_>,
        free_velocity: Numbers<'_>,
        laws: Vec<Option<Bound<'_, Law>>>,
        normal_force: Vec<Option<f64>>,
        normal_restitution: Numbers<'_>,
        tangential_restitution: Numbers<'_>,
        initial_velocity: Numbers<'_>,
    ) -> Result<Self, Failure> {
        if normal_force.len() != laws.len() {
            return Err(dimension("normal_force", "must have one entry per law").into());
        }
        let frictionless = CoreLaw::frictionless();
        let contacts: Vec<_> = laws
            .iter()
            .zip(&normal_force)
            .map(|(law, &force)| {
                let law = law.as_ref().map_or(&frictionless, |law| &law.get().0);
                (law.clone(), NormalForce::from(force))
            })
            .collect();
        let rows = |(law, normal): &(CoreLaw, NormalForce)| {
            law.dimension() + usize::from(normal.is_unilateral())
        };
        let sizes: Vec<usize> = contacts.iter().map(rows).collect();
        let free = numbers(&free_velocity, "free_velocity")?.to_vec();
        let problem = ContactProblem::new(delassus.into_delassus(&sizes)?, free, contacts)?;
        let problem = problem.with_restitution(
            numbers(&normal_restitution, "normal_restitution")?,
            numbers(&tangential_restitution, "tangential_restitution")?,
            numbers(&initial_velocity, "initial_velocity")?,
        )?;
        Ok(Self { problem: Arc::new(problem), workspace: Mutex::default() })
    }

    fn solve<'py>(
        &self,
        py: Python<'py>,
        solver: &Solver,
        tolerance: f64,
        time_limit: Option<f64>,
        start: Option<(Numbers<'py>, Vec<i8>, Numbers<'py>)>,
        measure: &str,
    ) -> Result<Outcome, Failure> {
        let problem = &self.problem;
        let measure = match measure {
            "contact" => Measure::Contact,
            "global" => Measure::Global,
            _ => return Err(parameter("measure", "must be contact or global").into()),
        };
        let mut memory = match start {
            None => Memory::new(problem.rows(), problem.contacts().len()),
            Some((percussion, phases, velocity)) => {
                let phases = phases.into_iter().map(|k| Phase::from_number(k).unwrap_or_default());
                let percussion = numbers(&percussion, "start")?;
                let velocity = numbers(&velocity, "start")?;
                Memory::from_solution(problem, percussion, velocity, phases)?
            }
        };
        let solution = asked(py, |cancelled| {
            // A limit beyond the range of the clock is none.
            let limit = time_limit.and_then(|s| Duration::try_from_secs_f64(s).ok());
            let mut stop = Stop::at(tolerance).with_measure(measure).unless(cancelled);
            stop.deadline = limit.and_then(|limit| Instant::now().checked_add(limit));
            // Where the workspace is taken, another thread solves the same problem.
            let (mut shared, mut own) = (self.workspace.try_lock(), Workspace::default());
            let workspace = shared.as_deref_mut().unwrap_or(&mut own);
            let report = solver.0.solve(problem, stop, &mut memory, workspace);
            Solution::new(problem, stop, memory, report, workspace)
        })??;
        Ok(Outcome { solution, problem: Arc::clone(problem) })
    }

    fn natural_map(&self, py: Python<'_>, percussion: Numbers<'_>) -> Result<f64, Failure> {
        let percussion = numbers(&percussion, "percussion")?.to_vec();
        Ok(py.detach(|| {
            let velocity = self.problem.velocities(&percussion)?;
            solver::natural_map(&self.problem, &percussion, &velocity)
        })?)
    }

    fn certificate<'py>(
        &self,
        py: Python<'py>,
        percussion: Numbers<'_>,
    ) -> Result<Bound<'py, PyDict>, Failure> {
        let percussion = numbers(&percussion, "percussion")?.to_vec();
        let found = py.detach(|| Certificate::new(&self.problem, &percussion))?;
        Ok(certified(py, &found)?)
    }

    fn spectrum(&self, py: Python<'_>) -> Result<(f64, f64), Failure> {
        Ok(py.detach(|| self.problem.delassus().spectrum())?)
    }

    fn residual(&self, py: Python<'_>, percussion: Numbers<'_>) -> Result<(f64, usize), Failure> {
        let percussion = numbers(&percussion, "percussion")?.to_vec();
        let residual = py.detach(|| {
            let velocity = self.problem.velocities(&percussion)?;
            solver::natural_residual(&self.problem, &percussion, &velocity)
        })?;
        Ok((residual.value, residual.worst_contact))
    }

    fn solutions<'py>(
        &self,
        py: Python<'py>,
        contact: usize,
        percussion: Numbers<'_>,
    ) -> Result<Vec<Bound<'py, PyDict>>, Failure> {
        let found = solver::solutions(&self.problem, contact, numbers(&percussion, "percussion")?)?;
        found
            .into_iter()
            .map(|solution| {
                let out = PyDict::new(py);
                out.set_item("phase", solution.phase as i64)?;
                out.set_item("percussion", PyArray1::from_vec(py, solution.percussion))?;
                out.set_item("velocity", PyArray1::from_vec(py, solution.velocity))?;
                out.set_item("degenerate", solution.degenerate)?;
                Ok(out)
            })
            .collect()
    }
}

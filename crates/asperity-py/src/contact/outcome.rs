//! What a solve found; arrays are made when Python asks for them.

use std::sync::Arc;

use asperity::contact::{ContactProblem, NormalForce};
use asperity::solver::{Case, Certificate, Infeasibility, Solution, Status, Unsolvable};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::errors::Failure;

/// The solution of a problem, and the problem, for the certificate.
#[pyclass(frozen, module = "asperity._core")]
pub struct Outcome {
    pub solution: Solution,
    pub problem: Arc<ContactProblem>,
}

/// An array that refuses writing.
pub fn array<T: numpy::Element>(py: Python<'_>, values: Vec<T>) -> Bound<'_, PyArray1<T>> {
    let array = PyArray1::from_vec(py, values);
    let _ = array.readwrite().make_nonwriteable();
    array
}

/// A proof that there is no solution as a dictionary.
fn proven<'py>(py: Python<'py>, proof: &Infeasibility) -> PyResult<Bound<'py, PyDict>> {
    let out = PyDict::new(py);
    out.set_item("kind", proof.kind.name())?;
    out.set_item("contact", proof.contact)?;
    out.set_item("direction", array(py, proof.direction.clone()))?;
    out.set_item("closing_velocity", proof.closing_velocity)?;
    out.set_item("residual", proof.residual)?;
    let cases = PyList::empty(py);
    for case in &proof.cases {
        match case {
            Case::Divided(contact) => cases.append(contact)?,
            Case::Empty(direction) => cases.append(array(py, direction.clone()))?,
        }
    }
    out.set_item("cases", cases)?;
    Ok(out)
}

/// Most rows of a problem without solution that is handed over with its operator, every entry of it.
const LARGEST: usize = 1000;

/// A contact problem of a motion without solution: its numbers, the system's contacts in it, and the proof.
pub fn without_solution<'py>(
    py: Python<'py>,
    unsolvable: &Unsolvable,
) -> PyResult<Bound<'py, PyDict>> {
    let Unsolvable { problem, contacts, infeasibility } = unsolvable;
    let out = numbers(py, problem, problem.rows() <= LARGEST)?;
    out.set_item("free_velocity", array(py, unsolvable.load()))?;
    out.set_item("contacts", contacts.clone())?;
    out.set_item("infeasibility", proven(py, infeasibility)?)?;
    Ok(out)
}

/// The numbers of a contact problem, with its operator or without.
pub fn numbers<'py>(
    py: Python<'py>,
    problem: &ContactProblem,
    with_operator: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let normal_force = problem.contacts().iter().map(|rows| match rows.normal {
        NormalForce::Prescribed(value) => Some(value),
        NormalForce::Unilateral => None,
    });
    let out = PyDict::new(py);
    if with_operator {
        // Rows follow each other in Python.
        let operator = problem.delassus().to_dense();
        let entries = PyArray1::from_slice(py, operator.transpose().as_slice());
        out.set_item("delassus", entries.reshape(operator.shape())?)?;
    }
    out.set_item("free_velocity", array(py, problem.free_velocity().to_vec()))?;
    out.set_item("normal_force", normal_force.collect::<Vec<_>>())?;
    Ok(out)
}

#[pymethods]
impl Outcome {
    #[getter]
    fn percussion<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, self.solution.percussion.clone())
    }

    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, self.solution.velocity.clone())
    }

    #[getter]
    fn phase<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        array(py, self.solution.states.iter().map(|state| state.phase as i64).collect())
    }

    #[getter]
    fn ambiguous_contacts<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        array(py, self.solution.ambiguous.clone())
    }

    #[getter]
    fn converged(&self) -> bool {
        self.solution.report.status == Status::Converged
    }

    #[getter]
    fn status(&self) -> &'static str {
        self.solution.report.status.name()
    }

    #[getter]
    fn residual(&self) -> f64 {
        self.solution.report.residual
    }

    #[getter]
    fn iterations(&self) -> usize {
        self.solution.report.iterations
    }

    #[getter]
    fn worst_contact(&self) -> usize {
        self.solution.report.worst_contact
    }

    #[getter]
    fn stages(&self) -> Vec<(&'static str, usize, usize, f64)> {
        let stages = self.solution.stages.iter();
        stages.map(|s| (s.method.name(), s.iterations, s.factorizations, s.residual)).collect()
    }

    /// Contacts, status, residual and iterations of every island.
    #[getter]
    fn islands(&self) -> Vec<(Vec<usize>, &'static str, f64, usize)> {
        let islands = self.solution.islands.iter().map(|island| {
            let report = island.report;
            (island.contacts.to_vec(), report.status.name(), report.residual, report.iterations)
        });
        islands.collect()
    }

    #[getter]
    fn infeasibility<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        self.solution.infeasibility.as_ref().map(|proof| proven(py, proof)).transpose()
    }

    /// Computed when it is asked for.
    #[getter]
    fn certificate<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyDict>, Failure> {
        let found = py.detach(|| Certificate::new(&self.problem, &self.solution.percussion))?;
        Ok(certified(py, &found)?)
    }
}

/// A certificate as a dictionary.
pub fn certified<'py>(py: Python<'py>, found: &Certificate) -> PyResult<Bound<'py, PyDict>> {
    let out = PyDict::new(py);
    out.set_item("worst_contact", found.worst_contact)?;
    out.set_item("natural_map", found.natural_map)?;
    out.set_item("penetration_velocity", found.penetration_velocity)?;
    out.set_item("complementarity", found.complementarity)?;
    out.set_item("tension", found.tension)?;
    out.set_item("cone_violation", found.cone_violation)?;
    out.set_item("direction_violation", found.direction_violation)?;
    for (name, count) in ["open", "stick", "slip"].into_iter().zip(found.phases) {
        out.set_item(name, count)?;
    }
    Ok(out)
}

//! Systems of Python.

use asperity::system::{
    self, Blocks, Configuration, Constancy, ContactLaw, Rotation, System, SystemError,
};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::contact_arguments::{item, law, restitution};
use super::time_function::{Raised, keep, taken};
use crate::convert::returned;
use crate::errors::Failure;

/// A system of Python: every question is a call of its methods.
#[pyclass(frozen, module = "asperity._core")]
#[derive(Debug)]
pub struct CallbackSystem {
    object: Py<PyAny>,
    blocks: Blocks,
    rotations: Vec<Rotation>,
    constraints: usize,
    /// Number of coordinates, where the system advances them itself.
    coordinates: Option<usize>,
    /// Whether it announces the blocks that contacts touch; else each touches all velocities, which are one block.
    in_blocks: bool,
    touched: Vec<Vec<usize>>,
    constancy: Constancy,
    laws: Vec<ContactLaw>,
    /// What a method that cannot fail has raised.
    raised: Raised,
}

#[pymethods]
impl CallbackSystem {
    #[new]
    #[allow(clippy::too_many_arguments)] // The Python side calls it in two places, by position.
    fn new(
        system: Py<PyAny>,
        blocks: Vec<usize>,
        touched: Option<Vec<Vec<usize>>>,
        rotations: Vec<usize>,
        coordinates: Option<usize>,
        constraints: usize,
        constant: (bool, bool),
        contacts: Vec<Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let law_of = |contact: &Bound<'_, PyDict>| {
            let (normal, tangential) = restitution(contact)?;
            let force = item(contact, "normal_force")?.extract::<Option<f64>>()?;
            let made = ContactLaw::new(law(contact)?, force.into());
            let made = made.and_then(|made| made.with_restitution(normal, tangential));
            made.map_err(|error| Failure::from(error).0)
        };
        let laws: Vec<_> = contacts.iter().map(law_of).collect::<PyResult<_>>()?;
        let in_blocks = touched.is_some();
        let touched = touched.unwrap_or_else(|| vec![vec![0]; laws.len()]);
        let (mass, contacts) = constant;
        let constancy = Constancy { mass, contacts, autonomous: false };
        let blocks = Blocks::new(blocks);
        // Every rotation before has one coordinate more than velocities.
        let rotation = |(k, velocity)| Rotation { coordinate: velocity + k, velocity };
        let rotations = rotations.into_iter().enumerate().map(rotation).collect();
        let raised = Raised::default();
        Ok(Self {
            object: system,
            blocks,
            rotations,
            constraints,
            coordinates,
            in_blocks,
            touched,
            constancy,
            laws,
            raised,
        })
    }
}

fn foreign(error: PyErr) -> SystemError {
    SystemError::Foreign(Box::new(error))
}

impl CallbackSystem {
    /// What a method that cannot fail has raised since the last question.
    pub fn raised(&self) -> Option<PyErr> {
        taken(&self.raised)
    }

    /// Calls `method` with arguments made by `arguments` and hands its result to `receive`.
    fn call<T>(
        &self,
        method: &str,
        shape: &[usize],
        arguments: impl FnOnce(Python<'_>) -> PyResult<Vec<Py<PyAny>>>,
        receive: impl FnOnce(&[f64]) -> T,
    ) -> Result<T, SystemError> {
        Python::attach(|py| {
            let arguments = pyo3::types::PyTuple::new(py, arguments(py)?)?;
            let value = self.object.bind(py).call_method1(method, arguments)?;
            let array = returned(&value, method, shape)?;
            Ok(receive(array.readonly().as_slice()?))
        })
        .map_err(foreign)
    }
}

fn array(py: Python<'_>, values: &[f64]) -> Py<PyAny> {
    PyArray1::from_slice(py, values).into_any().unbind()
}

/// Arguments `(t, q, contact)`.
fn arguments(
    at: &Configuration<'_>,
    contact: usize,
) -> impl FnOnce(Python<'_>) -> PyResult<Vec<Py<PyAny>>> {
    move |py| {
        let t = at.t.into_pyobject(py)?.into_any().unbind();
        Ok(vec![t, array(py, at.q), contact.into_pyobject(py)?.into_any().unbind()])
    }
}

impl System for CallbackSystem {
    fn blocks(&self) -> &Blocks {
        &self.blocks
    }

    fn coordinates(&self) -> usize {
        self.coordinates.unwrap_or(self.dof() + self.rotations.len())
    }

    fn rotations(&self) -> &[Rotation] {
        &self.rotations
    }

    /// Not a number where the method has raised, which ends the run.
    fn advance(&self, q: &[f64], u: &[f64], dt: f64, out: &mut [f64]) {
        if self.coordinates.is_none() {
            return system::advance(&self.rotations, q, u, dt, out);
        }
        let arguments = |py: Python<'_>| {
            Ok(vec![array(py, q), array(py, u), dt.into_pyobject(py)?.into_any().unbind()])
        };
        let moved =
            self.call("advance", &[q.len()], arguments, |values| out.copy_from_slice(values));
        if let Err(error) = moved {
            out.fill(f64::NAN);
            if let SystemError::Foreign(error) = error
                && let Ok(error) = error.downcast::<PyErr>()
            {
                keep(&self.raised, *error);
            }
        }
    }

    fn contacts(&self) -> &[ContactLaw] {
        &self.laws
    }

    fn touched(&self, contact: usize) -> &[usize] {
        &self.touched[contact]
    }

    fn constancy(&self) -> Constancy {
        self.constancy
    }

    fn constraints(&self) -> usize {
        self.constraints
    }

    fn constraint(&self, q: &[f64], off: &mut [f64]) -> Result<(), SystemError> {
        let arguments = |py: Python<'_>| Ok(vec![array(py, q)]);
        self.call("constraint", &[off.len()], arguments, |values| off.copy_from_slice(values))
    }

    fn constraint_rows(&self, q: &[f64], rows: &mut [f64]) -> Result<(), SystemError> {
        let (shape, arguments) =
            ([self.constraints, self.dof()], |py: Python<'_>| Ok(vec![array(py, q)]));
        self.call("constraint_rows", &shape, arguments, |values| rows.copy_from_slice(values))
    }

    fn mass(&self, q: &[f64], block: usize, mass: &mut [f64]) -> Result<(), SystemError> {
        let n = self.blocks.range(block).len();
        // The matrix is symmetric: its rows are its columns.
        let receive = |values: &[f64]| mass.copy_from_slice(values);
        if self.in_blocks {
            let arguments = |py: Python<'_>| {
                Ok(vec![array(py, q), block.into_pyobject(py)?.into_any().unbind()])
            };
            return self.call("block_mass", &[n, n], arguments, receive);
        }
        self.call("mass", &[n, n], |py| Ok(vec![array(py, q)]), receive)
    }

    fn forces(
        &self,
        at: &Configuration<'_>,
        u: &[f64],
        forces: &mut [f64],
    ) -> Result<(), SystemError> {
        let arguments = |py: Python<'_>| {
            let t = at.t.into_pyobject(py)?.into_any().unbind();
            Ok(vec![t, array(py, at.q), array(py, u)])
        };
        self.call("forces", &[self.dof()], arguments, |values| forces.copy_from_slice(values))
    }

    fn gap(&self, at: &Configuration<'_>, contact: usize) -> Result<f64, SystemError> {
        self.call("gap", &[], arguments(at, contact), |values| values[0])
    }

    fn rows(
        &self,
        at: &Configuration<'_>,
        contact: usize,
        rows: &mut [f64],
        velocity: &mut [f64],
    ) -> Result<f64, SystemError> {
        let p = self.laws[contact].law().dimension();
        let n = self.touched[contact].iter().map(|&block| self.blocks.range(block).len()).sum();
        let normal_rows = self.laws[contact].normal_rows();
        let (normal, tangent) = rows.split_at_mut(normal_rows * n);
        if normal_rows == 1 {
            self.call("normal", &[n], arguments(at, contact), |values| {
                normal.copy_from_slice(values)
            })?;
            velocity[0] = 0.0;
        }
        self.call("direction", &[n, p], arguments(at, contact), |values| {
            for (k, row) in tangent.chunks_exact_mut(n.max(1)).enumerate() {
                for (i, value) in row.iter_mut().enumerate() {
                    *value = values[i * p + k];
                }
            }
        })?;
        let chi = &mut velocity[normal_rows..];
        self.call("velocity", &[p], arguments(at, contact), |values| chi.copy_from_slice(values))?;
        if normal_rows == 1 { self.gap(at, contact) } else { Ok(0.0) }
    }
}

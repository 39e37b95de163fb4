//! Systems: linear ones as data, those of Python by callbacks.

use std::sync::{Mutex, PoisonError};

use asperity::law::Law as CoreLaw;
use asperity::system::{
    self, Blocks, Configuration, Constancy, Contact, ContactLaw, Normal, System, SystemError,
};
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::convert::{Numbers, Points, matrix, numbers};
use crate::errors::{Failure, dimension};
use crate::law::Law;
use crate::rigid::RigidBodies;

/// A linear system.
#[pyclass(frozen, module = "asperity._core")]
pub struct LinearSystem(pub system::LinearSystem);

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

pub fn item<'py>(contact: &Bound<'py, PyDict>, key: &str) -> PyResult<Bound<'py, PyAny>> {
    contact.get_item(key)?.ok_or_else(|| dimension("contacts", &format!("lacks {key}")))
}

pub fn law(contact: &Bound<'_, PyDict>) -> PyResult<CoreLaw> {
    Ok(item(contact, "law")?.cast::<Law>()?.get().0.clone())
}

pub fn restitution(contact: &Bound<'_, PyDict>) -> PyResult<(f64, f64)> {
    let normal = item(contact, "normal_restitution")?.extract()?;
    Ok((normal, item(contact, "tangential_restitution")?.extract()?))
}

fn linear_contact(contact: &Bound<'_, PyDict>) -> PyResult<Contact> {
    let array = |key: &str| -> PyResult<Vec<f64>> {
        Ok(numbers(&item(contact, key)?.extract::<Numbers<'_>>()?, key)?.to_vec())
    };
    let normal = match item(contact, "normal_force")?.extract()? {
        Some(force) => Normal::Force(force),
        None => Normal::Gap { direction: array("normal")?, gap: item(contact, "gap")?.extract()? },
    };
    let direction = item(contact, "direction")?.extract::<Points<'_>>()?;
    Ok(Contact {
        law: law(contact)?,
        direction: matrix(&direction, "direction")?,
        velocity: array("velocity")?,
        normal,
        restitution: restitution(contact)?,
    })
}

#[pymethods]
impl LinearSystem {
    #[new]
    fn new(
        mass: Points<'_>,
        stiffness: Points<'_>,
        damping: Points<'_>,
        force: Numbers<'_>,
        contacts: Vec<Bound<'_, PyDict>>,
    ) -> Result<Self, Failure> {
        let contacts = contacts.iter().map(linear_contact).collect::<PyResult<_>>()?;
        Ok(Self(system::LinearSystem::new(
            matrix(&mass, "mass")?,
            matrix(&stiffness, "stiffness")?,
            matrix(&damping, "damping")?,
            numbers(&force, "force")?.to_vec(),
            contacts,
        )?))
    }
}

/// A system of Python: every question is a call of its methods.
#[pyclass(frozen, module = "asperity._core")]
#[derive(Debug)]
pub struct CallbackSystem {
    object: Py<PyAny>,
    blocks: Blocks,
    /// Number of coordinates, where the system advances them itself.
    coordinates: Option<usize>,
    /// Whether it announces the blocks that contacts touch; else each touches all velocities, which are one block.
    in_blocks: bool,
    touched: Vec<Vec<usize>>,
    constancy: Constancy,
    laws: Vec<ContactLaw>,
    /// What a method that cannot fail has raised.
    raised: Mutex<Option<PyErr>>,
}

#[pymethods]
impl CallbackSystem {
    #[new]
    fn new(
        system: Py<PyAny>,
        blocks: Vec<usize>,
        touched: Option<Vec<Vec<usize>>>,
        coordinates: Option<usize>,
        constant: (bool, bool),
        contacts: Vec<Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let law_of = |contact: &Bound<'_, PyDict>| {
            let (normal, tangential) = restitution(contact)?;
            let made = ContactLaw::new(law(contact)?, item(contact, "normal_force")?.extract()?);
            let made = made.and_then(|made| made.with_restitution(normal, tangential));
            made.map_err(|error| Failure::from(error).0)
        };
        let laws: Vec<_> = contacts.iter().map(law_of).collect::<PyResult<_>>()?;
        let in_blocks = touched.is_some();
        let touched = touched.unwrap_or_else(|| vec![vec![0]; laws.len()]);
        let (mass, contacts) = constant;
        let constancy = Constancy { mass, contacts };
        let blocks = Blocks::new(blocks);
        let raised = Mutex::default();
        Ok(Self {
            object: system,
            blocks,
            coordinates,
            in_blocks,
            touched,
            constancy,
            laws,
            raised,
        })
    }
}

/// What callbacks that cannot fail have raised since the last question: the cause of whatever ended the run.
pub fn raised(system: &Bound<'_, PyAny>) -> Option<PyErr> {
    let of = |raised: &Mutex<Option<PyErr>>| {
        raised.lock().unwrap_or_else(PoisonError::into_inner).take()
    };
    if let Ok(callback) = system.cast::<CallbackSystem>() {
        return of(&callback.get().raised);
    }
    system.cast::<RigidBodies>().ok().and_then(|rigid| rigid.get().raised())
}

/// What a callback returned, as a float64 array in C order of the given shape, all finite.
pub fn returned<'py>(
    value: &Bound<'py, PyAny>,
    method: &str,
    shape: &[usize],
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let numpy = value.py().import("numpy")?;
    // The conversion would leave the imaginary parts out.
    if numpy.call_method1("iscomplexobj", (value,))?.is_truthy()? {
        return Err(crate::errors::parameter(
            method,
            "must return real numbers, returned complex ones",
        ));
    }
    let array = numpy.call_method1("ascontiguousarray", (value, "float64"))?;
    let array = array.cast_into::<PyArrayDyn<f64>>()?;
    // ascontiguousarray makes a number an array of one entry.
    let fits = array.shape() == shape || (shape.is_empty() && array.len() == 1);
    if !fits {
        let message = format!("must return shape {shape:?}, returned {:?}", array.shape());
        return Err(dimension(method, &message));
    }
    if !array.readonly().as_slice()?.iter().all(|v| v.is_finite()) {
        return Err(crate::errors::parameter(method, "must return finite numbers"));
    }
    Ok(array)
}

fn foreign(error: PyErr) -> SystemError {
    SystemError::Foreign(Box::new(error))
}

impl CallbackSystem {
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
        self.coordinates.unwrap_or(self.dof())
    }

    /// Not a number where the method has raised, which ends the run.
    fn advance(&self, q: &[f64], u: &[f64], dt: f64, out: &mut [f64]) {
        if self.coordinates.is_none() {
            for (out, (q, u)) in out.iter_mut().zip(q.iter().zip(u)) {
                *out = q + dt * u;
            }
            return;
        }
        let arguments = |py: Python<'_>| {
            Ok(vec![array(py, q), array(py, u), dt.into_pyobject(py)?.into_any().unbind()])
        };
        let moved =
            self.call("advance", &[q.len()], arguments, |values| out.copy_from_slice(values));
        if let Err(error) = moved {
            out.fill(f64::NAN);
            let error = match error {
                SystemError::Foreign(error) => error.downcast::<PyErr>().ok().map(|error| *error),
                _ => None,
            };
            let mut raised = self.raised.lock().unwrap_or_else(PoisonError::into_inner);
            *raised = raised.take().or(error);
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

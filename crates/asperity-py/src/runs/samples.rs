//! Samples of motions as arrays.

use asperity::integrator::Samples;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Samples as a dictionary of arrays, time first.
pub fn sample_arrays(py: Python<'_>, samples: Samples) -> PyResult<Bound<'_, PyDict>> {
    let n_t = samples.len();
    let Samples { coordinates, dof, contacts, p, .. } = samples;
    let out = PyDict::new(py);
    out.set_item("t", PyArray1::from_vec(py, samples.t))?;
    for (name, values, columns) in [("q", samples.q, coordinates), ("u", samples.u, dof)] {
        out.set_item(name, PyArray1::from_vec(py, values).reshape([n_t, columns])?)?;
    }
    for (name, values) in [("slip", samples.slip), ("force", samples.force)] {
        out.set_item(name, PyArray1::from_vec(py, values).reshape([n_t, contacts, p])?)?;
    }
    let normal_force = PyArray1::from_vec(py, samples.normal_force).reshape([n_t, contacts])?;
    out.set_item("normal_force", normal_force)?;
    out.set_item("phase", PyArray1::from_vec(py, samples.phase).reshape([n_t, contacts])?)?;
    Ok(out)
}

//! What a system says about one state.

use asperity::system::{self, Configuration, System, full_rows};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use super::any_system::{raised, with_system};
use crate::convert::{Numbers, numbers, rows};
use crate::errors::{Failure, dimension};

fn check_length(argument: &str, values: &[f64], expected: usize) -> PyResult<()> {
    if values.len() == expected {
        return Ok(());
    }
    Err(dimension(argument, &format!("must have {expected} entries, has {}", values.len())))
}

/// The unilateral contact that overlaps most at a time, and its gap, which is negative; none if none overlaps.
#[pyfunction]
pub fn deepest_overlap(
    system: &Bound<'_, PyAny>,
    t: f64,
    q: Numbers<'_>,
) -> Result<Option<(usize, f64)>, Failure> {
    let q = numbers(&q, "q")?;
    let deepest = with_system(system, |system| -> Result<_, Failure> {
        check_length("q", q, system.coordinates())?;
        let at = Configuration::new(t, q);
        let mut deepest: Option<(usize, f64)> = None;
        for (contact, law) in system.contacts().iter().enumerate() {
            if law.normal_rows() == 0 {
                continue;
            }
            let gap = system.gap(&at, contact)?;
            if gap < deepest.map_or(0.0, |(_, least)| least) {
                deepest = Some((contact, gap));
            }
        }
        Ok(deepest)
    })??;
    raised(system).map_or(Ok(deepest), |error| Err(error.into()))
}

/// `M`, `h` and of every contact `W`, χ, and `w_N` and gap if it is unilateral.
#[pyfunction]
pub fn evaluate<'py>(
    py: Python<'py>,
    system: &Bound<'py, PyAny>,
    t: f64,
    q: Numbers<'py>,
    u: Numbers<'py>,
) -> Result<Bound<'py, PyDict>, Failure> {
    let (q, u) = (numbers(&q, "q")?, numbers(&u, "u")?);
    let out = with_system(system, |system| state(py, system, t, q, u))??;
    // Some callbacks cannot return what they raise.
    raised(system).map_or(Ok(out), |error| Err(error.into()))
}

fn state<'py>(
    py: Python<'py>,
    system: &dyn System,
    t: f64,
    q: &[f64],
    u: &[f64],
) -> Result<Bound<'py, PyDict>, Failure> {
    let n = system.dof();
    check_length("q", q, system.coordinates())?;
    check_length("u", u, n)?;
    let (blocks, mut mass, mut own) = (system.blocks(), vec![0.0; n * n], Vec::new());
    for block in 0..blocks.count() {
        let range = blocks.range(block);
        let len = range.len();
        own.resize(len * len, 0.0);
        system.mass(q, block, &mut own)?;
        for (j, column) in own.chunks_exact(len.max(1)).enumerate() {
            for (i, entry) in column.iter().enumerate() {
                mass[(range.start + i) * n + range.start + j] = *entry;
            }
        }
    }
    let mut forces = vec![0.0; n];
    system.forces(&Configuration::new(t, q), u, &mut forces)?;
    let contacts = PyList::empty(py);
    for contact in 0..system.contacts().len() {
        contacts.append(kinematics(py, system, t, q, contact)?)?;
    }
    let out = PyDict::new(py);
    out.set_item("mass", rows(py, mass, n)?)?;
    out.set_item("forces", PyArray1::from_vec(py, forces))?;
    out.set_item("contacts", contacts)?;
    Ok(out)
}

fn kinematics<'py>(
    py: Python<'py>,
    system: &dyn System,
    t: f64,
    q: &[f64],
    contact: usize,
) -> Result<Bound<'py, PyDict>, Failure> {
    let (n, law) = (system.dof(), &system.contacts()[contact]);
    let (len, normal_rows) = (law.rows(), law.normal_rows());
    let (mut tangent, mut velocity) = (vec![0.0; n * len], vec![0.0; len]);
    let at = Configuration::new(t, q);
    let gap = full_rows(system, &at, contact, &mut tangent, &mut velocity)?;
    let normal: Vec<f64> = tangent.drain(..n * normal_rows).collect();
    let out = PyDict::new(py);
    out.set_item("tangent", rows(py, tangent, n)?)?;
    out.set_item("velocity", PyArray1::from_slice(py, &velocity[normal_rows..]))?;
    if normal_rows == 1 {
        out.set_item("gap", gap)?;
        out.set_item("normal", PyArray1::from_vec(py, normal))?;
    }
    Ok(out)
}

/// Forces of a system's own constraints in the middle of a step that ends in a state.
#[pyfunction]
pub fn constraint_forces<'py>(
    py: Python<'py>,
    system: &Bound<'py, PyAny>,
    times: (f64, f64),
    q: Numbers<'py>,
    u: Numbers<'py>,
    contacts: Numbers<'py>,
) -> Result<Bound<'py, PyArray1<f64>>, Failure> {
    let (state, contacts) =
        ((numbers(&q, "q")?, numbers(&u, "u")?), numbers(&contacts, "contacts")?);
    let forces =
        with_system(system, |system| system::constraint_forces(system, times, state, contacts))?;
    // Some callbacks cannot return what they raise.
    raised(system).map_or(Ok(PyArray1::from_vec(py, forces?)), |error| Err(error.into()))
}

/// `q ⊕ dt u`.
#[pyfunction]
pub fn advance<'py>(
    py: Python<'py>,
    system: &Bound<'py, PyAny>,
    q: Numbers<'py>,
    u: Numbers<'py>,
    dt: f64,
) -> Result<Bound<'py, PyArray1<f64>>, Failure> {
    let (q, u) = (numbers(&q, "q")?, numbers(&u, "u")?);
    let moved = with_system(system, |system| {
        check_length("q", q, system.coordinates())?;
        check_length("u", u, system.dof())?;
        let mut out = vec![0.0; q.len()];
        system.advance(q, u, dt, &mut out);
        Ok::<_, Failure>(out)
    })??;
    // It cannot return what it raises.
    raised(system).map_or(Ok(PyArray1::from_vec(py, moved)), |error| Err(error.into()))
}

//! Linear systems as data.

use asperity::system::{self, Contact, Normal};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::contact_arguments::{item, law, restitution};
use crate::convert::{Numbers, Points, matrix, numbers};
use crate::errors::Failure;

/// A linear system.
#[pyclass(frozen, module = "asperity._core")]
pub struct LinearSystem(pub system::LinearSystem);

pub fn linear_contact(contact: &Bound<'_, PyDict>) -> PyResult<Contact> {
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

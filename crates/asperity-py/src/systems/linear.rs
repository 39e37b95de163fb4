//! Linear systems as data.

use asperity::system::{self, Contact};
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
    let direction = item(contact, "direction")?.extract::<Points<'_>>()?;
    let (law, direction) = (law(contact)?, matrix(&direction, "direction")?);
    let made = match item(contact, "normal_force")?.extract()? {
        Some(force) => Contact::with_force(law, direction, force),
        None => {
            let gap = item(contact, "gap")?.extract()?;
            Contact::unilateral(law, direction, array("normal")?, gap)
        }
    };
    Ok(Contact { velocity: array("velocity")?, restitution: restitution(contact)?, ..made })
}

#[pymethods]
impl LinearSystem {
    #[new]
    #[pyo3(signature = (mass, stiffness, damping, force, contacts, constraints=None))]
    fn new(
        mass: Points<'_>,
        stiffness: Points<'_>,
        damping: Points<'_>,
        force: Numbers<'_>,
        contacts: Vec<Bound<'_, PyDict>>,
        constraints: Option<(Points<'_>, Numbers<'_>)>,
    ) -> Result<Self, Failure> {
        let contacts = contacts.iter().map(linear_contact).collect::<PyResult<_>>()?;
        let system = system::LinearSystem::new(
            matrix(&mass, "mass")?,
            matrix(&stiffness, "stiffness")?,
            matrix(&damping, "damping")?,
            numbers(&force, "force")?.to_vec(),
            contacts,
        )?;
        let Some((rows, constraint)) = constraints else { return Ok(Self(system)) };
        let constraint = numbers(&constraint, "constraint")?.to_vec();
        Ok(Self(system.with_constraints(&matrix(&rows, "constraint_rows")?, constraint)?))
    }
}

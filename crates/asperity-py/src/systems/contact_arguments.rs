//! What the dictionaries of contacts hold.

use asperity::law::Law as CoreLaw;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::dimension;
use crate::law::Law;

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

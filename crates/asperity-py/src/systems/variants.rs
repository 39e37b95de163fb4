//! Linear systems that differ in some numbers.

use asperity::contact::NormalForce;
use asperity::law::Law;
use asperity::system::{Contact, LinearSystem, SystemError};
use nalgebra::DMatrix;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Deserialize;
use serde_json::Value;

use super::linear::linear_contact;
use crate::convert::{Numbers, Points, matrix, numbers};
use crate::errors::{Failure, dimension, parameter};
use crate::law::Law as PythonLaw;

/// A number of a linear system.
enum Place {
    Mass(usize, usize),
    Stiffness(usize, usize),
    Damping(usize, usize),
    Force(usize),
    NormalForce(usize),
    Gap(usize),
    /// χ of a contact, and its component.
    Velocity(usize, usize),
    /// An argument of the law of a contact, by the keys of its table one within the other.
    Law(usize, Vec<String>),
}

/// A linear system with places that have another number in every variant.
#[pyclass(frozen, module = "asperity._core")]
pub struct LinearVariants {
    mass: DMatrix<f64>,
    stiffness: DMatrix<f64>,
    damping: DMatrix<f64>,
    force: Vec<f64>,
    contacts: Vec<Contact>,
    /// The laws of contacts as tables, of those that change.
    laws: Vec<Option<Value>>,
    places: Vec<Place>,
    /// A row of numbers per variant.
    values: Vec<f64>,
    /// Contacts with another law in every variant.
    replaced: Vec<(usize, Vec<Law>)>,
    count: usize,
}

/// A kind of place, the numbers of contact, row and column, and the keys of an argument.
type GivenPlace = (String, usize, usize, Vec<String>);

#[pymethods]
impl LinearVariants {
    /// `laws` holds a table in JSON for every contact of whose law a number changes, `replaced` the laws of those that get
    /// another one.
    #[new]
    #[allow(clippy::too_many_arguments)] // The Python side calls it in one place, by position.
    fn new(
        mass: Points<'_>,
        stiffness: Points<'_>,
        damping: Points<'_>,
        force: Numbers<'_>,
        contacts: Vec<Bound<'_, PyDict>>,
        laws: Vec<Option<String>>,
        places: Vec<GivenPlace>,
        values: Points<'_>,
        replaced: Vec<(usize, Vec<Bound<'_, PythonLaw>>)>,
    ) -> Result<Self, Failure> {
        let (mass, force) = (matrix(&mass, "mass")?, numbers(&force, "force")?.to_vec());
        let contacts: Vec<Contact> =
            contacts.iter().map(linear_contact).collect::<PyResult<_>>()?;
        let (n, count) = (force.len(), contacts.len());
        let table = |text: &String| {
            serde_json::from_str(text).map_err(|error| parameter("law", &error.to_string()))
        };
        let laws: Vec<Option<Value>> = laws
            .iter()
            .map(|text| text.as_ref().map(table).transpose())
            .collect::<PyResult<_>>()?;
        let place = |(kind, i, j, keys): GivenPlace| {
            let place = match kind.as_str() {
                "mass" if i < n && j < n => Place::Mass(i, j),
                "stiffness" if i < n && j < n => Place::Stiffness(i, j),
                "damping" if i < n && j < n => Place::Damping(i, j),
                "force" if i < n => Place::Force(i),
                "normal_force" if i < count => Place::NormalForce(i),
                "gap" if i < count => Place::Gap(i),
                "velocity" if contacts.get(i).is_some_and(|c| j < c.velocity.len()) => {
                    Place::Velocity(i, j)
                }
                "law" if laws.get(i).is_some_and(Option::is_some) && i < count => {
                    Place::Law(i, keys)
                }
                _ => return Err(dimension("replace", &format!("knows no place {kind} {i} {j}"))),
            };
            Ok(place)
        };
        let places: Vec<Place> = places.into_iter().map(place).collect::<PyResult<_>>()?;
        let variants = values.as_array().nrows();
        let fits = |(i, laws): &(usize, Vec<_>)| *i < count && laws.len() == variants;
        if values.as_array().ncols() != places.len() || !replaced.iter().all(fits) {
            return Err(dimension("replace", "must have a column per place").into());
        }
        let replaced = replaced
            .into_iter()
            .map(|(i, laws)| (i, laws.iter().map(|law| law.get().0.clone()).collect()))
            .collect();
        Ok(Self {
            mass,
            stiffness: matrix(&stiffness, "stiffness")?,
            damping: matrix(&damping, "damping")?,
            force,
            contacts,
            laws,
            places,
            values: values.as_array().iter().copied().collect(),
            replaced,
            count: variants,
        })
    }
}

impl LinearVariants {
    /// Number of variants.
    pub fn count(&self) -> usize {
        self.count
    }

    /// One of them.
    pub fn make(&self, variant: usize) -> Result<LinearSystem, SystemError> {
        let width = self.places.len();
        let row = self.values.get(variant * width..(variant + 1) * width).unwrap_or_default();
        let (mut mass, mut stiffness) = (self.mass.clone(), self.stiffness.clone());
        let (mut damping, mut force) = (self.damping.clone(), self.force.clone());
        let (mut contacts, mut laws) = (self.contacts.clone(), self.laws.clone());
        for (place, &value) in self.places.iter().zip(row) {
            match place {
                Place::Mass(i, j) => mass[(*i, *j)] = value,
                Place::Stiffness(i, j) => stiffness[(*i, *j)] = value,
                Place::Damping(i, j) => damping[(*i, *j)] = value,
                Place::Force(i) => force[*i] = value,
                Place::NormalForce(i) => contacts[*i].normal_force = NormalForce::Prescribed(value),
                Place::Gap(i) => contacts[*i].gap = value,
                Place::Velocity(i, j) => contacts[*i].velocity[*j] = value,
                Place::Law(i, keys) => {
                    if let Some(table) = &mut laws[*i] {
                        put(table, keys, value)?;
                    }
                }
            }
        }
        for (contact, table) in contacts.iter_mut().zip(&laws) {
            if let Some(table) = table {
                contact.law = Law::deserialize(table).map_err(|error| refused("law", &error))?;
            }
        }
        for (i, laws) in &self.replaced {
            contacts[*i].law = laws[variant].clone();
        }
        Ok(LinearSystem::new(mass, stiffness, damping, force, contacts)?)
    }
}

/// Puts a number into a table of tables and lists. The argument itself may be one that had its default.
fn put(table: &mut Value, keys: &[String], value: f64) -> Result<(), SystemError> {
    let Some((last, within)) = keys.split_last() else { return Ok(()) };
    let number = serde_json::Number::from_f64(value);
    let number = number.ok_or_else(|| refused(last, &format!("must be finite, got {value}")))?;
    let place = within.iter().try_fold(table, |table, key| match table {
        Value::Array(list) => key.parse().ok().and_then(|i: usize| list.get_mut(i)),
        Value::Object(map) => map.get_mut(key),
        _ => None,
    });
    let found = match place {
        Some(Value::Array(list)) => last.parse().ok().and_then(|i: usize| list.get_mut(i)),
        Some(Value::Object(map)) => Some(map.entry(last).or_insert(Value::Null)),
        _ => None,
    };
    *found.ok_or_else(|| refused("law", &format!("has no argument {}", keys.join("."))))? =
        number.into();
    Ok(())
}

/// What Python would say where it makes the same system.
fn refused(argument: &str, what: &impl ToString) -> SystemError {
    let text = what.to_string();
    let (argument, message) = text.split_once(": ").unwrap_or((argument, &text));
    SystemError::Foreign(Box::new(parameter(argument, message)))
}

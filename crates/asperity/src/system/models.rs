//! The paper's two systems.

use nalgebra::{DMatrix, Matrix2, Vector2};

use super::{Contact, LinearSystem};
use crate::argument::{ArgumentError, positive};
use crate::law::FrictionLaw;

/// A point mass sliding on a plane under its weight (\[WL19\] §5.3).
///
/// # Errors
///
/// [`ArgumentError`] if mass or gravity is not finite and positive.
pub fn sliding_point(
    mass: f64,
    law: FrictionLaw<2>,
    gravity: f64,
) -> Result<LinearSystem, ArgumentError> {
    positive("mass", mass)?;
    positive("gravity", gravity)?;
    let contact = Contact::with_force(law, DMatrix::identity(2, 2), mass * gravity);
    let (mass, zero) = (DMatrix::identity(2, 2) * mass, DMatrix::zeros(2, 2));
    LinearSystem::new(mass, zero.clone(), zero, vec![0.0; 2], vec![contact])
}

/// A mass on springs that rubs on a belt moving with `belt_velocity` v: χ = −v (\[WL19\] §4.3).
///
/// # Errors
///
/// As [`LinearSystem::new`].
pub fn mass_on_belt(
    mass: f64,
    stiffness: Matrix2<f64>,
    law: FrictionLaw<2>,
    normal_force: f64,
    belt_velocity: Vector2<f64>,
) -> Result<LinearSystem, ArgumentError> {
    let velocity = vec![-belt_velocity.x, -belt_velocity.y];
    let at_rest = Contact::with_force(law, DMatrix::identity(2, 2), normal_force);
    let contact = Contact { velocity, ..at_rest };
    let stiffness = DMatrix::from_column_slice(2, 2, stiffness.as_slice());
    let (mass, damping) = (DMatrix::identity(2, 2) * mass, DMatrix::zeros(2, 2));
    LinearSystem::new(mass, stiffness, damping, vec![0.0; 2], vec![contact])
}

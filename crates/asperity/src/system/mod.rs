//! Mechanical systems: what a time step asks of them.

mod linear;
mod models;
pub mod rigid;

use std::error::Error;
use std::fmt::Debug;

use nalgebra::DMatrix;
use thiserror::Error as ThisError;

pub use linear::{Contact, LinearSystem, Normal};
pub use models::{mass_on_belt, sliding_point};
pub use rigid::RigidBodies;

use crate::law::Law;

/// What of a system never changes, so that it is computed once.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Constancy {
    /// The mass matrix.
    pub mass: bool,
    /// Directions and velocities χ of all contacts.
    pub contacts: bool,
}

/// A rotation of space among the coordinates of a system.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rotation {
    /// The first of its four coordinates: a unit quaternion `(w, x, y, z)` that turns the body's axes to the world's.
    pub coordinate: usize,
    /// The first of its three velocities: the angular velocity in the body's axes.
    pub velocity: usize,
}

/// A contact as the law sees it.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactLaw {
    /// Friction law.
    pub law: Law,
    /// Prescribed normal force in N; `None` for a unilateral contact.
    pub normal_force: Option<f64>,
    /// Newton's coefficient of restitution `e_N`.
    pub normal_restitution: f64,
    /// Tangential restitution `e_T`.
    pub tangential_restitution: f64,
}

/// A system could not be made or evaluated.
#[derive(Debug, ThisError)]
pub enum SystemError {
    /// An argument is out of range.
    #[error("{argument}: {message}")]
    Argument {
        /// Name of the argument.
        argument: &'static str,
        /// What is allowed, and what was given.
        message: String,
    },
    /// A callback of the user failed.
    #[error("{0}")]
    Foreign(Box<dyn Error + Send + Sync>),
}

impl SystemError {
    pub(crate) fn argument(argument: &'static str, message: impl Into<String>) -> Self {
        Self::Argument { argument, message: message.into() }
    }

    /// A direction that moves nothing would make the friction force of this contact meaningless.
    pub(crate) fn direction(contact: usize) -> Self {
        let message = format!("must be finite and not zero, is not at contact {contact}");
        Self::argument("direction", message)
    }
}

/// `M(q) u̇ − h(t, q, u) = W_N λ_N + W λ`, `q̇ = u` or what [`System::advance`] makes of it, with `γ_N = W_Nᵀu` and `γ = Wᵀu + χ`
/// (\[WL19\] §2.2, (23)).
///
/// Immutable: everything that changes lives in the buffers that the methods fill.
pub trait System: Debug + Sync {
    /// Number of degrees of freedom.
    fn dof(&self) -> usize;

    /// Number of coordinates, more than velocities where rotations of space are among them.
    fn coordinates(&self) -> usize {
        self.dof()
    }

    /// `out ← q ⊕ dt u`, the coordinates after moving with the velocities `u` for `dt`.
    #[inline]
    fn advance(&self, q: &[f64], u: &[f64], dt: f64, out: &mut [f64]) {
        for (out, (q, u)) in out.iter_mut().zip(q.iter().zip(u)) {
            *out = q + dt * u;
        }
    }

    /// The rotations of space among the coordinates, in ascending order. The other coordinates have the other
    /// velocities as rates, in the same order, and [`advance`](Self::advance) turns the rotations by `R exp(dt Ω)`.
    /// Event-driven integration needs to know them.
    fn rotations(&self) -> Vec<Rotation> {
        Vec::new()
    }

    /// Brings initial coordinates to their normal form: quaternions to the length one.
    fn normalise(&self, _q0: &mut [f64]) -> Result<(), SystemError> {
        Ok(())
    }

    /// The system as rigid bodies, which are stepped body by body, without matrices of the size of the
    /// system.
    fn rigid_bodies(&self) -> Option<&RigidBodies> {
        None
    }

    /// The contacts, in a fixed order.
    fn contacts(&self) -> &[ContactLaw];

    /// What never changes.
    fn constancy(&self) -> Constancy {
        Constancy::default()
    }

    /// Mass matrix `M(q)`, symmetric positive definite.
    fn mass(&self, q: &[f64], mass: &mut DMatrix<f64>) -> Result<(), SystemError>;

    /// Forces `h(t, q, u)` without those of the contacts.
    fn forces(&self, t: f64, q: &[f64], u: &[f64], forces: &mut [f64]) -> Result<(), SystemError>;

    /// Directions of one contact: `row(k)` of `Wᵀ` into `tangent[k·dof..]`, and χ into `velocity`.
    fn tangent(
        &self,
        t: f64,
        q: &[f64],
        contact: usize,
        tangent: &mut [f64],
        velocity: &mut [f64],
    ) -> Result<(), SystemError>;

    /// Gap of a unilateral contact, and the row `W_Nᵀ` into `normal`.
    fn gap(
        &self,
        _t: f64,
        _q: &[f64],
        _contact: usize,
        _normal: &mut [f64],
    ) -> Result<f64, SystemError> {
        Err(SystemError::argument("contacts", "a unilateral contact needs a gap function"))
    }
}

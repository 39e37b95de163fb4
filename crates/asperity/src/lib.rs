//! Set-valued anisotropic dry friction: laws, contact problems, solvers, time stepping.
//!
//! One law holds them all (\[WL19\] Def. 16): a star-shaped force reservoir *C* bounds the friction
//! force, a convex direction set *D* gives the sliding direction by normality,
//! `γ ∈ N_D(−αλ)`. A [`ContactProblem`](contact::ContactProblem) is plain data (Delassus operator, free
//! velocities, laws); a [`Solver`](solver::Solver) returns percussions with a residual that no solver
//! computes for itself; [`simulate`](simulate::simulate) drives a [`System`](system::System) through
//! Moreau's midpoint scheme, [`event::integrate`] from event to event.
//!
//! ```
//! use asperity::law::FrictionLaw;
//! use asperity::set::{Convex, Ellipse, Vector};
//!
//! let ellipse: Convex<2> = Ellipse::new(Vector::<2>::new(0.54, 0.48))?.into();
//! let law = FrictionLaw::associated(ellipse);
//! let force = law.force(&Vector::<2>::new(1.0, 0.0), 9.3).unwrap();
//! assert!((force.x + 9.3 * 0.54).abs() < 1e-12 && force.y.abs() < 1e-12);
//! # Ok::<(), asperity::set::SetError>(())
//! ```
#![deny(missing_docs, clippy::missing_errors_doc)]

pub use asperity_set as set;
pub use integrator::{event, midpoint as stepper};
pub use nalgebra;

pub mod contact;
pub mod integrator;
pub mod law;
mod linear;
#[cfg(test)]
#[path = "../tests/common/random.rs"]
mod random;
pub mod simulate;
pub mod solver;
pub mod system;
pub mod trajectory;

/// The examples of the README are compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

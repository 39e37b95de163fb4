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
//!
//! # Features
//!
//! | feature | what it adds |
//! |---|---|
//! | `parallel`, by default | threads for contacts and islands, where a [`Solver`](solver::Solver) is given some |
//! | `serde` | sets ([`set::Star`], [`set::Convex`]), laws, contact problems, trajectories and motions as data |
//!
//! No result depends on `parallel`. What `serde` reads goes through the constructors, so that nothing comes out that these would
//! refuse. The words are those of the Python package; a law is written as
//!
//! ```toml
//! [reservoir]
//! type = "Superellipse"
//! a = 0.5366
//! b = 0.457
//! exponent = 2.94
//!
//! [direction]
//! type = "Ellipse"
//! a = 0.46
//! b = 0.3
//! angle = 0.1
//!
//! [rate]
//! speed = 0.02
//! ratio = 0.7
//! shape = "exponential"
//! ```
#![deny(missing_docs, clippy::missing_errors_doc)]

pub use argument::{ArgumentError, Fault};
pub use asperity_set as set;
pub use integrator::{event, midpoint as stepper};
pub use nalgebra;

mod argument;
pub mod contact;
pub mod ensemble;
pub mod integrator;
pub mod law;
mod linear;
pub mod mechanism;
#[cfg(test)]
#[path = "../tests/common/random.rs"]
mod random;
pub mod simulate;
pub mod solver;
pub mod system;
mod threads;
pub mod trajectory;
mod vectors;

/// The examples of the README are compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

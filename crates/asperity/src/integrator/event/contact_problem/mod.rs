//! What contacts do next: contact problems on the level of accelerations, and of impacts.
//!
//! `γ̇ = Gλ + b` has the structure of `γ_E = G P + b`: forces take the place of percussions and accelerations that of
//! velocities, so that the solvers of time stepping decide, with their rule of selection.

pub(crate) mod accelerations;
pub(crate) mod impacts;
pub(crate) mod load_bearing;
pub(crate) mod problem;
pub(crate) mod redundancy;

pub(crate) use impacts::ImpactLaw;
pub(crate) use problem::{Decision, Question, Solving};

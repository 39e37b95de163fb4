//! Integrators: Moreau's time stepping.

pub mod midpoint;

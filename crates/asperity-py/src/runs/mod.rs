//! Both integrators.

pub mod event;
mod samples;
pub mod simulate;

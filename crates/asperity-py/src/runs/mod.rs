//! Both integrators.

pub mod event;
pub mod many;
mod samples;
pub mod simulate;

//! Accelerations and contact forces while every contact keeps its mode: open, sticking or slipping.
//!
//! `M a = h + Σ (w_N λ_N + W λ)`, with `λ = λ_N f(γ)` in slip, `γ̇ = 0` in stick and `γ̇_N = 0` at closed unilateral
//! contacts. Forces that are not given follow from one small linear system ([`forces::constraints`]).

mod buffers;
mod chart;
mod contact_variables;
mod drift;
mod equations;
mod evaluation;
mod forces;
mod independent_parts;
mod jacobian;
mod projection;
mod rounding;
mod time_dependence;

pub(crate) use chart::Chart;
pub(crate) use contact_variables::{ContactVariables, ROWS};
pub(crate) use equations::Dynamics;
pub(crate) use evaluation::SlidingForces;
pub(crate) use forces::constraint_matrix::ConstraintMatrix;
pub(crate) use forces::sharing::{mean_mobility, null_projection};

//! The methods for problems of many contacts, each with its own buffers.

mod admm;
mod anderson;
mod cones;
mod interior;
mod least_norm;
mod newton;
mod prox;
mod proximal;

pub(crate) use admm::{ALONE, Admm, BESIDE};
pub(crate) use anderson::Anderson;
pub(crate) use cones::Cones;
pub(crate) use interior::{Course, Interior};
pub(crate) use least_norm::LeastNorm;
pub use prox::ProxStep;
pub(crate) use prox::{Order, ProxIteration};
pub(crate) use proximal::{PATIENCE, ProximalPoint};

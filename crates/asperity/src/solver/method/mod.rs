//! The methods for problems of many contacts, each with its own buffers.

mod accelerated;
mod admm;
mod cones;
mod cost;
mod interior;
mod island_sweeps;
mod newton;
mod progress;
mod prox;
mod proximal;
mod rate;
mod standing;
mod sweep;
mod swept;
mod task;
mod threads;

pub(crate) use accelerated::Accelerated;
pub(crate) use admm::{ALONE, Admm, BESIDE};
pub(crate) use cones::Cones;
pub(crate) use cost::Cost;
pub(crate) use interior::{Course, Interior};
pub(crate) use island_sweeps::Plan;
pub(crate) use progress::{Buffers, Progress};
pub use prox::ProxStep;
pub(crate) use prox::{Order, ProxIteration};
pub(crate) use proximal::ProximalPoint;
pub(crate) use rate::{Rate, TRIAL_SWEEPS};
pub(crate) use standing::Standing;
pub(crate) use sweep::{Own, Sweeper, mark_ambiguous};
pub(crate) use swept::Swept;
pub(crate) use task::{Iterate, Task};
pub(crate) use threads::Threads;

//! The methods for problems of many contacts, each with its own buffers.

mod accelerated;
mod admm;
mod cones;
mod interior;
mod newton;
mod over_relaxed;
mod progress;
mod prox;
mod proximal;
mod standing;
mod sweeps;
mod task;

pub(crate) use accelerated::Accelerated;
pub(crate) use admm::{ALONE, Admm, BESIDE};
pub(crate) use cones::Cones;
pub(crate) use interior::{Course, Interior};
pub(crate) use over_relaxed::OverRelaxed;
pub(crate) use progress::{Buffers, Progress};
pub use prox::ProxStep;
pub(crate) use prox::{Order, ProxIteration};
pub(crate) use proximal::{Limits, ProximalPoint};
pub(crate) use standing::Standing;
pub(crate) use sweeps::{
    BodySweeps, Cost, OVER_BODIES, Own, Plan, Rate, Sweeper, Swept, TRIAL_SWEEPS, UNTIMED,
    mark_ambiguous, untimed_visits,
};
pub(crate) use task::{Iterate, Past, Reached, Task};

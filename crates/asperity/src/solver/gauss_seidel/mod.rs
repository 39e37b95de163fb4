//! Block Gauss–Seidel: a sweep, island by island, and how long sweeps are worth going on with.

mod cost;
mod islands;
mod rate;
mod sweep;
mod swept;
mod task;
mod visitor;

pub(crate) use cost::Cost;
pub(crate) use islands::Plan;
pub(crate) use rate::{Rate, TRIAL_SWEEPS};
pub(crate) use sweep::{Own, Sweeper, mark_ambiguous};
pub(crate) use swept::Swept;
pub(crate) use task::{Iterate, Past, Reached, Task};
pub(crate) use visitor::untimed_visits;

//! Block Gauss–Seidel: a sweep, in the order of colours, island by island, over the velocities of bodies, and how long they
//! are worth going on with.

mod body_sweeps;
mod colours;
mod cost;
mod island_sweeps;
mod rate;
mod sweep;
mod swept;
mod visitor;
mod worker;

pub(crate) use body_sweeps::{BodySweeps, OVER_BODIES};
pub(crate) use cost::Cost;
pub(crate) use island_sweeps::Plan;
pub(crate) use rate::{Rate, TRIAL_SWEEPS};
pub(crate) use sweep::{Own, Sweeper, mark_ambiguous};
pub(crate) use swept::Swept;
pub(crate) use visitor::{UNTIMED, untimed_visits};

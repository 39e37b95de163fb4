//! Contact problems at events.

pub(crate) mod accelerations;
pub(crate) mod participants;
pub(crate) mod redundancy;

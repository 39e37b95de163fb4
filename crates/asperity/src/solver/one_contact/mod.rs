//! One contact, the percussions of the others held: all its solutions, and which of them it takes.

pub(crate) mod block;
mod line;
mod local;
mod plane;
mod single;
mod singular;
mod solution;
pub(crate) mod solutions;
pub(crate) mod solve;
mod uniqueness;

pub(crate) use plane::ImplicitRate;
pub(crate) use uniqueness::Uniqueness;

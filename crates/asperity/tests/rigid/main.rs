//! Rigid bodies against closed forms, invariants and other ways to compute the same.

mod arguments;
mod collisions;
#[path = "../common/mod.rs"]
mod common;
mod drilling;
mod frames;
mod free_flight;
mod friction;
mod gaps;
mod impacts;
mod moving;
mod stepping;
mod sticking;
mod support;

//! Rigid bodies against closed forms, invariants and other ways to compute the same.

mod free_flight;
mod friction;
mod impacts;
mod stepping;
mod support;

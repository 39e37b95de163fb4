//! Event-driven integration against closed forms, published motions and time stepping.

#[path = "../common/mod.rs"]
mod common;

mod arguments;
mod belt;
mod impacts;
mod parts;
mod sliding;
mod spatial;
mod stepping;
mod support;

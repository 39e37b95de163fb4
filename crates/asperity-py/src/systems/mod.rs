//! Systems: linear ones, those of Python, rigid bodies.

pub mod any_system;
pub mod callback;
mod contact_arguments;
pub mod evaluate;
pub mod linear;
pub mod rigid;
pub mod time_function;
pub mod variants;

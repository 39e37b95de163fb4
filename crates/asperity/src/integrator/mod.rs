//! How motions are computed from equations of motion and contact laws.

pub mod event;

//! Contact forces that are not given: the linear system for them, and how contacts share what it leaves open.

pub(crate) mod constraint_matrix;
pub(crate) mod constraints;
pub(crate) mod sharing;
pub(crate) mod unloaded;

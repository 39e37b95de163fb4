//! Measures of percussions, which no solver owns and which grade them all: how far they are from a solution, what
//! contacts do under them, and whether they run away.

pub(crate) mod approach;
pub(crate) mod certificate;
pub(crate) mod natural_map;
pub(crate) mod natural_residual;
pub(crate) mod own;
pub(crate) mod phase;
pub(crate) mod stop;

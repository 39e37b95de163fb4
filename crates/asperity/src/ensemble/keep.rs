//! What is kept of every run.

use crate::integrator::event::Section;

/// What is kept of every run besides its end. Nothing else by default.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Keep {
    /// Samples on the way: every so many steps under time stepping.
    pub every: Option<usize>,
    /// Time in s up to which the quantities below do not look.
    pub after: f64,
    /// Largest less smallest value of every coordinate.
    pub extent: bool,
    /// Part of the time in which every contact sticks.
    pub stick_share: bool,
    /// Time from which on everything rests to the end of the run.
    pub rest_time: bool,
    /// Crossings of a hyperplane of states in the direction of its normal: how many there are, when and where the last
    /// one is, and the time since the one before.
    pub section: Option<Section>,
}

impl Keep {
    /// Whether something is asked for that every step has to be looked at for.
    pub(super) fn reduces(&self) -> bool {
        self.extent || self.stick_share || self.rest_time || self.section.is_some()
    }
}

//! The state of a motion.

use thiserror::Error;

use crate::system::SystemError;
use crate::vectors::add;

/// The accelerations cannot be evaluated.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum EvaluationError {
    /// The system failed.
    #[error(transparent)]
    System(#[from] SystemError),
}

/// Time, coordinates and velocities.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct State {
    pub(crate) t: f64,
    pub(crate) q: Vec<f64>,
    pub(crate) u: Vec<f64>,
}

/// What errors in coordinates and velocities are compared with.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scale {
    pub(crate) q: f64,
    pub(crate) u: f64,
}

impl State {
    /// Becomes the state after `time` with constant accelerations from `start`.
    pub(crate) fn extrapolate(&mut self, start: &Self, accelerations: &[f64], time: f64) {
        self.clone_from(start);
        self.t += time;
        add(&mut self.q, time, &start.u);
        add(&mut self.q, 0.5 * time * time, accelerations);
        add(&mut self.u, time, accelerations);
    }
}

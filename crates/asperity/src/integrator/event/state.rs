//! The state of a motion, and what counts as zero in it.

use thiserror::Error;

use crate::system::SystemError;
use crate::vectors::add;

/// Slip over the speed of a contact, and approach over the largest velocity, that count as none. A thousand times the
/// rounding of one operation: larger values take motions for rest, smaller ones let rounding decide on directions.
pub(crate) const ZERO_VELOCITY: f64 = 1e-12;
/// Gap over the reach of a contact that counts as closed at an impact and at the beginning.
pub(crate) const CLOSED_GAP: f64 = 1e-12;
/// Gap in m, and velocity in m/s, that count as none at the beginning at most, where no length may be known but that of
/// rounding, such as of a body at rest at the origin: states of a size of one are no finer.
pub(crate) const LEAST: f64 = f64::EPSILON;
/// Overlap over the reach of a contact that rounding explains.
pub(crate) const ROUNDED_OVERLAP: f64 = 1e-14;
/// Rounding errors of accelerations over the accelerations that balance in them.
pub(crate) const ROUNDING: f64 = 64.0 * f64::EPSILON;
/// Number of spacings between floating-point times below which a step is too short.
const SPACINGS: f64 = 4.0;

/// A time too short for a step at `t`.
pub(crate) fn shortest_step(t: f64) -> f64 {
    SPACINGS * f64::EPSILON * t
}

/// Gap and velocity that count as none at the beginning, whatever is known of lengths: what rounding leaves of the way and
/// of the velocity that the loads give until the end, where nothing stops them.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Negligible {
    pub(crate) gap: f64,
    pub(crate) velocity: f64,
}

impl Negligible {
    /// In a motion that begins with the velocity `speed` and lasts for `duration`, with accelerations up to `acceleration`.
    pub(crate) fn of(speed: f64, acceleration: f64, duration: f64) -> Self {
        let velocity = f64::EPSILON * acceleration * duration;
        let gap = (f64::EPSILON * speed + velocity) * duration;
        Self { gap: gap.min(LEAST), velocity: velocity.min(LEAST) }
    }
}

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

//! What is known of a state and of a contact in it.

use thiserror::Error;

use crate::contact::Phase;
use crate::system::SystemError;

/// Rows of a contact: the normal one, then up to three tangential ones.
pub(super) const ROWS: usize = 4;

/// Slip over the speed of a contact, and approach over the largest velocity, that count as none.
pub(super) const STILL: f64 = 1e-12;
/// Gap over the reach of a contact that counts as closed at an impact and at the beginning.
pub(super) const TOUCHING: f64 = 1e-12;
/// Overlap over the reach of a contact that rounding explains.
pub(super) const SLACK: f64 = 1e-14;
/// Rounding errors of accelerations over the accelerations that balance in them.
pub(super) const ROUNDING: f64 = 64.0 * f64::EPSILON;
/// Spacings of the time that are too short for a step.
const SHORTEST: f64 = 4.0;

/// A time too short for a step at `t`.
pub(super) fn instant(t: f64) -> f64 {
    SHORTEST * f64::EPSILON * t
}

/// The accelerations cannot be evaluated.
#[derive(Debug, Error)]
pub enum FieldError {
    /// The system failed.
    #[error(transparent)]
    System(#[from] SystemError),
    /// The mass matrix is not positive definite.
    #[error("mass: must be symmetric positive definite, is not at t = {time:.9} s")]
    SingularMass {
        /// Time in s.
        time: f64,
    },
}

/// Time, coordinates and velocities.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct State {
    pub(super) t: f64,
    pub(super) q: Vec<f64>,
    pub(super) u: Vec<f64>,
}

/// What the field says of a contact, at the state where it was evaluated last.
#[derive(Debug, Clone, Copy)]
pub(super) struct Touch {
    /// What it does; nothing but [`Phase::Open`], [`Phase::Stick`] and [`Phase::Slip`].
    pub(super) mode: Phase,
    /// Closed without slip, to be decided on; meanwhile its mode is open.
    pub(super) resting: bool,
    /// Whether its force is the part that the contact problem gave it.
    pub(super) shared: bool,
    /// Excess of the friction force over the boundary of the reservoir, as a normal force, that has turned out to
    /// be rounding: the contact rests at the limit of its force.
    pub(super) tolerated: f64,
    pub(super) p: usize,
    /// Normal force that is given.
    pub(super) prescribed: Option<f64>,
    pub(super) gap: f64,
    pub(super) slip: [f64; 3],
    /// λ for unit normal force while it slips.
    pub(super) sliding: [f64; 3],
    pub(super) normal_force: f64,
    pub(super) force: [f64; 3],
    /// `w_NᵀM⁻¹(w_N + W f)` over `w_NᵀM⁻¹w_N`.
    pub(super) resistance: f64,
    /// `‖|Wᵀ||u| + |χ|‖`.
    pub(super) size: f64,
    /// The largest of these along the motion; attempts do not count.
    pub(super) speed: f64,
    /// The velocity of which the share [`STILL`] is what rounding may have made of forces that balance, since the
    /// contact has stuck last.
    pub(super) creep: f64,
    /// The larger of `|w_N|ᵀ|q|` and `|g_N − w_Nᵀq|`, the largest along the motion: what gaps are compared with,
    /// whatever the other coordinates are.
    pub(super) reach: f64,
}

impl Touch {
    /// What slips are compared with to tell whether they vanish.
    pub(super) fn reference(&self) -> f64 {
        self.speed.max(self.creep)
    }

    /// Unilateral and not closed.
    pub(super) fn is_free(&self) -> bool {
        self.mode == Phase::Open && !self.resting && self.prescribed.is_none()
    }
}

//! What is known of a state and of a contact in it.

use thiserror::Error;

use crate::contact::Phase;
use crate::system::SystemError;

/// Rows of a contact: the normal one, then up to three tangential ones.
pub(crate) const ROWS: usize = 4;

/// Slip over the speed of a contact, and approach over the largest velocity, that count as none.
pub(crate) const STILL: f64 = 1e-12;
/// Gap over the reach of a contact that counts as closed at an impact and at the beginning.
pub(crate) const TOUCHING: f64 = 1e-12;
/// Overlap over the reach of a contact that rounding explains.
pub(crate) const SLACK: f64 = 1e-14;
/// Rounding errors of accelerations over the accelerations that balance in them.
pub(crate) const ROUNDING: f64 = 64.0 * f64::EPSILON;
/// Spacings of the time that are too short for a step.
const SHORTEST: f64 = 4.0;

/// A time too short for a step at `t`.
pub(crate) fn instant(t: f64) -> f64 {
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
pub(crate) struct State {
    pub(crate) t: f64,
    pub(crate) q: Vec<f64>,
    pub(crate) u: Vec<f64>,
}

/// What the field says of a contact, at the state where it was evaluated last.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Touch {
    /// What it does; nothing but [`Phase::Open`], [`Phase::Stick`] and [`Phase::Slip`].
    pub(crate) mode: Phase,
    /// Closed without slip, to be decided on; meanwhile its mode is open.
    pub(crate) resting: bool,
    /// Whether its force is the part that the contact problem gave it.
    pub(crate) shared: bool,
    /// Excess of the friction force over the boundary of the reservoir, as a normal force, that has turned out to
    /// be rounding: the contact rests at the limit of its force.
    pub(crate) tolerated: f64,
    pub(crate) p: usize,
    /// Normal force that is given.
    pub(crate) prescribed: Option<f64>,
    pub(crate) gap: f64,
    pub(crate) slip: [f64; 3],
    /// λ for unit normal force while it slips.
    pub(crate) sliding: [f64; 3],
    pub(crate) normal_force: f64,
    pub(crate) force: [f64; 3],
    /// `w_NᵀM⁻¹(w_N + W f)` over `w_NᵀM⁻¹w_N`.
    pub(crate) resistance: f64,
    /// `‖|Wᵀ||u| + |χ|‖`.
    pub(crate) size: f64,
    /// The largest of these along the motion; attempts do not count.
    pub(crate) speed: f64,
    /// The velocity of which the share [`STILL`] is what rounding may have made of forces that balance, since the
    /// contact has stuck last.
    pub(crate) creep: f64,
    /// The larger of `|w_N|ᵀ|q|` and `|g_N − w_Nᵀq|`, the largest along the motion: what gaps are compared with,
    /// whatever the other coordinates are.
    pub(crate) reach: f64,
}

impl Touch {
    /// What slips are compared with to tell whether they vanish.
    pub(crate) fn reference(&self) -> f64 {
        self.speed.max(self.creep)
    }

    /// Unilateral and not closed.
    pub(crate) fn is_free(&self) -> bool {
        self.mode == Phase::Open && !self.resting && self.prescribed.is_none()
    }
}

//! What a contact does in the present mode, with its gap, its slip and its forces.

use crate::contact::Phase;
use crate::integrator::event::resolution::NOTHING;
use crate::system::ContactLaw;
use crate::vectors::norm;

/// Rows of a contact: the normal one, then up to three tangential ones.
pub(crate) const ROWS: usize = 4;

/// A contact at the state where the dynamics were evaluated last.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct ContactVariables {
    /// What the contact does; nothing but [`Phase::Open`], [`Phase::Stick`] and [`Phase::Slip`].
    pub(crate) mode: Phase,
    /// Whether the contact is closed without slip and awaits the decision on its mode, which is open until then.
    pub(crate) undecided: bool,
    /// Whether the contact is closed but carries nothing: its mode is open, and its normal row depends on those of contacts
    /// that carry load.
    pub(crate) unloaded: bool,
    /// Normal force of an unloaded contact by its share, less rounding; `None` where loaded contacts do not close it.
    pub(crate) share: Option<f64>,
    /// Whether its force was found by the contact problem of all closed contacts, which share their forces in many ways.
    pub(crate) redistributed: bool,
    /// Excess of the friction force over the boundary of the reservoir, as a normal force, that proved to be rounding.
    pub(crate) tolerated_excess: f64,
    /// Dimension of the law.
    pub(crate) p: usize,
    /// Normal force that is given; none of a unilateral contact.
    pub(crate) prescribed: Option<f64>,
    pub(crate) gap: f64,
    pub(crate) slip: [f64; 3],
    /// λ for unit normal force while the contact slips.
    pub(crate) sliding: [f64; 3],
    pub(crate) normal_force: f64,
    pub(crate) force: [f64; 3],
    /// The region of the map of friction in which the contact is, while it is followed there, and its place.
    pub(crate) region: Option<usize>,
    pub(crate) place: [f64; 2],
    /// The factor of friction by place, without which `force` is, and with which `slip` is.
    pub(crate) by_place: f64,
    /// A function of the place that is positive outside of the region.
    pub(crate) outside: f64,
    /// `w_NᵀM⁻¹(w_N + W f)` over `w_NᵀM⁻¹w_N`. Where it vanishes the contact no longer resists normal motions.
    pub(crate) resistance: f64,
    /// `‖|Wᵀ||u| + |χ|‖`: what rounding in the slip is proportional to.
    pub(crate) size: f64,
    /// The largest `size` along the motion; attempts of steps do not count.
    pub(crate) speed: f64,
    /// A velocity of which the share [`NOTHING`](crate::integrator::event::resolution::NOTHING) is what
    /// rounding may have made of forces and percussions that balance, since the contact has stuck last.
    pub(crate) creep: f64,
    /// The larger of `|w_N|ᵀ|q|` and `|g_N − w_Nᵀq|`, the largest along the motion: the scale of gaps.
    pub(crate) reach: f64,
}

impl ContactVariables {
    /// An open contact of which nothing has been evaluated.
    pub(crate) fn new(contact: &ContactLaw) -> Self {
        let (p, prescribed) = (contact.law().dimension(), contact.normal_force().prescribed());
        Self {
            mode: Phase::Open,
            p,
            prescribed,
            resistance: 1.0,
            by_place: 1.0,
            outside: -1.0,
            ..Self::default()
        }
    }

    /// What slips are compared with to tell whether they vanish.
    pub(crate) fn reference_speed(&self) -> f64 {
        self.speed.max(self.creep)
    }

    /// Whether the slip vanishes but for rounding.
    pub(crate) fn is_still(&self) -> bool {
        norm(&self.slip) <= NOTHING * self.reference_speed()
    }

    /// Whether the contact is unilateral and not closed.
    pub(crate) fn is_free(&self) -> bool {
        self.mode == Phase::Open && !self.undecided && !self.unloaded && self.prescribed.is_none()
    }

    /// Whether the contact is unilateral and sticks or slips.
    pub(crate) fn is_closed_unilateral(&self) -> bool {
        self.mode != Phase::Open && self.prescribed.is_none()
    }
}

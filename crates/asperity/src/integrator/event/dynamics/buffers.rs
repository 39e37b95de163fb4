//! What the dynamics work in, kept from one evaluation to the next.

use crate::integrator::event::dynamics::forces::constraint_matrix::ConstraintMatrix;

/// The states of differences along the motion.
#[derive(Debug)]
pub(crate) struct Stencil {
    /// Time between neighbouring states.
    pub(crate) width: f64,
    pub(crate) widest: f64,
    /// Whether the states lie on one side of the present one.
    pub(crate) one_sided: bool,
    /// What the rows there make of the present velocities.
    pub(crate) velocities: Vec<[f64; 4]>,
}

impl Stencil {
    pub(crate) fn new(rows: usize) -> Self {
        Self { width: 0.0, widest: 0.0, one_sided: false, velocities: vec![[0.0; 4]; rows] }
    }
}

/// The linear system for the forces.
#[derive(Debug, Default)]
pub(crate) struct Constraints {
    /// The contacts' rows of which the rate vanishes; each has a force.
    pub(crate) rows: Vec<usize>,
    /// The accelerations that one unit of each force gives, friction included.
    pub(crate) columns: Vec<f64>,
    pub(crate) matrix: ConstraintMatrix,
    /// The forces, or their change by the last call of `Dynamics::constrain`.
    pub(crate) forces: Vec<f64>,
    pub(crate) defects: Vec<f64>,
}

/// The Jacobian at fixed sliding directions, which changes little along a step, and its buffers.
#[derive(Debug, Default)]
pub(crate) struct SmoothJacobian {
    /// Derivatives of the accelerations by velocities and by coordinates, row by row.
    pub(crate) by_u: Vec<f64>,
    pub(crate) by_q: Vec<f64>,
    /// `∂γ/∂q`, row by row.
    pub(crate) slip_by_q: Vec<f64>,
    /// Accelerations and slips at the state of the differences.
    pub(crate) acceleration: Vec<f64>,
    pub(crate) slips: Vec<[f64; 3]>,
    /// The coordinates and velocities of the differences.
    pub(crate) shifted: (Vec<f64>, Vec<f64>),
    /// The parts of the system that do not act on each other, if they are known.
    pub(crate) together: Option<IndependentParts>,
}

impl SmoothJacobian {
    pub(crate) fn new(n: usize, rows: usize) -> Self {
        Self {
            by_u: vec![0.0; n * n],
            by_q: vec![0.0; n * n],
            slip_by_q: vec![0.0; rows * n],
            acceleration: vec![0.0; n],
            ..Self::default()
        }
    }
}

/// What projections work in.
#[derive(Debug, Default)]
pub(crate) struct Projection {
    pub(crate) rows: Vec<usize>,
    pub(crate) matrix: ConstraintMatrix,
    pub(crate) percussions: Vec<f64>,
    pub(crate) shifts: Vec<f64>,
}

/// Parts of a system that do not act on each other.
#[derive(Debug)]
pub(crate) struct IndependentParts {
    /// The part of every velocity.
    pub(crate) of: Vec<usize>,
    /// Velocities of different parts, which are shifted together where derivatives are differences.
    pub(crate) columns: Vec<Vec<usize>>,
}

/// What the parts of functions of time give, see `time_dependence.rs`.
#[derive(Debug, Clone, Default)]
pub(crate) struct TimeParts {
    /// The largest acceleration that the parts of the forces give.
    pub(crate) load: f64,
    /// The largest velocity that the forces give by the time at which they have reached half of their largest value.
    pub(crate) reach: f64,
    /// The largest of the velocities of contacts.
    pub(crate) velocity: f64,
    /// Those of every contact; empty if nothing depends on time.
    pub(crate) velocities: Vec<f64>,
    /// Whether anything depends on time.
    pub(crate) depends_on_time: bool,
}

impl TimeParts {
    /// The velocities of a contact.
    pub(crate) fn velocity_of(&self, contact: usize) -> f64 {
        self.velocities.get(contact).copied().unwrap_or(0.0)
    }
}

/// What the shares of closed contacts without load are found in.
#[derive(Debug, Default)]
pub(crate) struct Unloaded {
    /// `N` of the contacts that carry load.
    pub(crate) mobility: ConstraintMatrix,
    pub(crate) loaded: Vec<usize>,
    /// `N⁻¹λ_N`, and `β`.
    pub(crate) multipliers: Vec<f64>,
    pub(crate) dependence: Vec<f64>,
}

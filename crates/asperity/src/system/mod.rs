//! Mechanical systems: what a time step asks of them.

pub(crate) mod constrained;
pub(crate) mod friction_map;
mod halves;
pub(crate) mod held;
pub(crate) mod linear;
pub(crate) mod mass;
mod models;
pub mod rigid;
pub(crate) mod rotation;
mod signal;
pub(crate) mod time_function;
mod turning;

use std::error::Error;
use std::fmt::Debug;
use std::ops::Range;

use thiserror::Error as ThisError;

pub use constrained::constraint_forces;
pub use friction_map::{Field, FrictionMap};
pub use linear::{Contact, LinearSystem};
pub use models::{mass_on_belt, sliding_point};
pub use rigid::RigidBodies;
pub use rotation::{Rotation, advance};
pub use signal::{Break, Derivative, Moment, Signal, Smoothness};
pub use time_function::{Function, FunctionWithRate, TimeFunction};
pub use turning::{Midpoint, Step, Turning};

use crate::argument::{ArgumentError, not_negative, part, refuse};
use crate::contact::NormalForce;
use crate::law::Law;
pub(crate) use halves::{begin, derive, finish, hold, meets, momenta};

/// What of a system never changes, so that it is computed once.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Constancy {
    /// The mass matrix.
    pub mass: bool,
    /// Directions and velocities χ of all contacts.
    pub contacts: bool,
    /// Forces, gaps and contacts as functions of the state: nothing depends on time.
    pub autonomous: bool,
}

/// A contact as the law sees it.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactLaw {
    law: Law,
    normal_force: NormalForce,
    normal_restitution: f64,
    tangential_restitution: f64,
}

impl ContactLaw {
    /// A contact without restitution.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] if a prescribed normal force is not finite or negative, or if the law is of no friction.
    pub fn new(law: impl Into<Law>, normal_force: NormalForce) -> Result<Self, ArgumentError> {
        not_negative("normal_force", normal_force.prescribed().unwrap_or(0.0))?;
        let law = law.into();
        if law.dimension() == 0 {
            return refuse("law", "must have friction: contacts of systems have tangential rows");
        }
        let (normal_restitution, tangential_restitution) = (0.0, 0.0);
        Ok(Self { law, normal_force, normal_restitution, tangential_restitution })
    }

    /// The same contact with Newton's coefficients of restitution `e_N` and `e_T`.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] unless both lie in [0, 1].
    pub fn with_restitution(self, normal: f64, tangential: f64) -> Result<Self, ArgumentError> {
        let normal_restitution = part("normal_restitution", normal)?;
        let tangential_restitution = part("tangential_restitution", tangential)?;
        Ok(Self { normal_restitution, tangential_restitution, ..self })
    }

    /// Friction law.
    #[inline]
    pub fn law(&self) -> &Law {
        &self.law
    }

    /// Normal force, in N if it is prescribed.
    #[inline]
    pub fn normal_force(&self) -> NormalForce {
        self.normal_force
    }

    /// Newton's coefficient of restitution `e_N`.
    #[inline]
    pub fn normal_restitution(&self) -> f64 {
        self.normal_restitution
    }

    /// Tangential restitution `e_T`.
    #[inline]
    pub fn tangential_restitution(&self) -> f64 {
        self.tangential_restitution
    }

    /// Number of normal rows: one if the contact is unilateral.
    #[inline]
    pub fn normal_rows(&self) -> usize {
        usize::from(self.normal_force.is_unilateral())
    }

    /// Number of rows: the normal one, if there is one, and those of friction.
    #[inline]
    pub fn rows(&self) -> usize {
        self.normal_rows() + self.law.dimension()
    }
}

/// A system could not be made or evaluated.
#[derive(Debug, ThisError)]
#[non_exhaustive]
pub enum SystemError {
    /// An argument is out of range.
    #[error(transparent)]
    Argument(#[from] ArgumentError),
    /// A body of unequal moments turns too far in a step for the midpoint rule.
    #[error(
        "body {body} turns by {angle:.3} rad in a step, so that its angular velocity at the end is not found: dt times \
         the angular velocity should be below about 1"
    )]
    Rotation {
        /// The body.
        body: usize,
        /// Step times angular velocity in rad.
        angle: f64,
    },
    /// Bodies turn too far in a step for joints to be held, or joints contradict each other.
    #[error(
        "joints are not held at t = {time} s: dt times the angular velocities should be below about 1, and joints must not nearly repeat each other"
    )]
    Joints {
        /// Time in s.
        time: f64,
    },
    /// Constraints of a system are not held.
    #[error(
        "constraints are not held at t = {time} s: they must not bend much within dt, their rows must be the rates of what \
         they are off, and must not nearly repeat each other"
    )]
    Constraints {
        /// Time in s.
        time: f64,
    },
    /// The mass matrix of a block has no Cholesky factor.
    #[error("mass: must be symmetric positive definite, is not{} at t = {time} s", of_block(*block, *blocks))]
    SingularMass {
        /// The block.
        block: usize,
        /// The number of blocks.
        blocks: usize,
        /// Time in s.
        time: f64,
    },
    /// A callback of the user failed.
    #[error("{0}")]
    Foreign(Box<dyn Error + Send + Sync>),
}

/// Of which of several blocks is spoken.
fn of_block(block: usize, blocks: usize) -> String {
    if blocks > 1 { format!(" of block {block}") } else { String::new() }
}

impl SystemError {
    /// A direction that moves nothing would make the friction force of this contact meaningless.
    pub(crate) fn direction(contact: usize) -> Self {
        let message = format!("must be finite and not zero, is not at contact {contact}");
        ArgumentError::new("direction", message).into()
    }

    /// The force of this contact would be any, as joints or constraints let nothing move along its normal.
    pub(crate) fn held(contact: usize, by_joints: bool) -> Self {
        let (by, what) = if by_joints { ("joints", "the bodies of ") } else { ("constraints", "") };
        let message =
            format!("must let {what}contact {contact} move along its normal, where it is closed");
        ArgumentError::new(by, message).into()
    }
}

/// How the velocities of a system fall into blocks, which the mass matrix does not couple: the bodies of a system of
/// bodies, or all velocities at once.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Blocks {
    /// First velocity of every block, and the number of velocities.
    starts: Vec<usize>,
}

impl Blocks {
    /// Blocks of these sizes, one after another; a system's are of one velocity at least.
    pub fn new(sizes: impl IntoIterator<Item = usize>) -> Self {
        let mut starts = vec![0];
        let mut end = 0;
        starts.extend(sizes.into_iter().map(|size| {
            end += size;
            end
        }));
        Self { starts }
    }

    /// One block of so many velocities.
    pub fn one(size: usize) -> Self {
        Self { starts: vec![0, size] }
    }

    /// Number of blocks.
    #[inline]
    pub fn count(&self) -> usize {
        self.starts.len() - 1
    }

    /// Number of velocities of all blocks.
    #[inline]
    pub fn velocities(&self) -> usize {
        self.starts[self.starts.len() - 1]
    }

    /// The velocities of a block.
    ///
    /// # Panics
    ///
    /// If there is no such block.
    #[inline]
    pub fn range(&self, block: usize) -> Range<usize> {
        self.starts[block]..self.starts[block + 1]
    }
}

/// Where a system is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Configuration<'a> {
    /// Time in s.
    pub t: f64,
    /// A time in s of the smooth piece by which functions of time are continued to `t`, see [`Moment`].
    pub piece: f64,
    /// Coordinates.
    pub q: &'a [f64],
    /// What [`Turning::derive`] makes of them, or nothing.
    pub derived: &'a [f64],
}

impl<'a> Configuration<'a> {
    /// A configuration from which nothing is derived yet.
    pub fn new(t: f64, q: &'a [f64]) -> Self {
        Self { t, piece: t, q, derived: &[] }
    }

    /// The time, for functions of time.
    #[inline]
    pub fn moment(&self) -> Moment {
        Moment { t: self.t, piece: self.piece }
    }
}

/// Coordinates and velocities to start from.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct InitialState {
    /// Coordinates.
    pub q: Vec<f64>,
    /// Velocities.
    pub u: Vec<f64>,
}

/// A part of a system that nothing connects with the rest, with the places of what it has in the whole, ascending.
#[derive(Debug)]
pub struct SystemPart {
    /// The part as a system.
    pub system: Box<dyn System>,
    /// Its coordinates.
    pub coordinates: Vec<usize>,
    /// Its velocities.
    pub velocities: Vec<usize>,
    /// Its contacts.
    pub contacts: Vec<usize>,
}

/// Sizes of the terms of which functions of time are made, from zero to the end of a run.
///
/// A function of time may be the small difference of large parts, such as 1 − cos t near zero. Rounding leaves a share of
/// these parts in it, below which nothing can be known of it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TimeDependence {
    /// Parts of the forces, per velocity.
    pub forces: Vec<f64>,
    /// Impulses that the forces give, per velocity, by the time at which they have reached half of their largest value.
    pub impulses: Vec<f64>,
    /// Parts of the gap in m, per contact.
    pub gaps: Vec<f64>,
    /// Parts of χ_N and χ in m/s, per contact.
    pub velocities: Vec<f64>,
}

impl TimeDependence {
    /// Of a system with so many velocities and contacts, nothing of which depends on time.
    pub fn none(velocities: usize, contacts: usize) -> Self {
        Self {
            forces: vec![0.0; velocities],
            impulses: vec![0.0; velocities],
            gaps: vec![0.0; contacts],
            velocities: vec![0.0; contacts],
        }
    }
}

/// Bounds on a motion over a time: no velocity and no acceleration exceeds its own in magnitude.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MotionBounds {
    /// The time in s.
    pub duration: f64,
    /// Of every velocity.
    pub velocities: Vec<f64>,
    /// Of every acceleration.
    pub accelerations: Vec<f64>,
}

/// `M(q) u̇ − h(t, q, u) = W_N λ_N + W λ`, `q̇ = u` or what [`System::advance`] makes of it, with `γ_N = W_Nᵀu + χ_N`
/// and `γ = Wᵀu + χ` (\[WL19\] §2.2, (23)).
///
/// The velocities fall into [`Blocks`] that the mass matrix does not couple, and a contact touches few of them, so that
/// a step of many bodies costs in proportion to their number. A system without such structure has one block, which
/// every contact touches.
///
/// Immutable: everything that changes lives in the buffers that the methods fill. Who calls them gives states and buffers
/// of the system's sizes; the integrators do, and the methods need not look.
pub trait System: Debug + Sync {
    /// The blocks of the velocities.
    fn blocks(&self) -> &Blocks;

    /// Number of degrees of freedom.
    fn dof(&self) -> usize {
        self.blocks().velocities()
    }

    /// Number of coordinates, more than velocities where rotations of space are among them.
    fn coordinates(&self) -> usize {
        self.dof()
    }

    /// `out ← q ⊕ dt u`, the coordinates after moving with the velocities `u` for `dt`: by default rotations turn by
    /// `R exp(dt Ω)`.
    #[inline]
    fn advance(&self, q: &[f64], u: &[f64], dt: f64, out: &mut [f64]) {
        advance(self.rotations(), q, u, dt, out);
    }

    /// The rotations of space among the coordinates, in ascending order. The other coordinates have the other
    /// velocities as rates, in the same order. Quaternions of initial coordinates are brought to the length one.
    fn rotations(&self) -> &[Rotation] {
        &[]
    }

    /// The state to start from where none is given: all coordinates and velocities zero, and no rotation.
    fn initial_state(&self) -> InitialState {
        let mut q = vec![0.0; self.coordinates()];
        for rotation in self.rotations() {
            if let Some(w) = q.get_mut(rotation.coordinate) {
                *w = 1.0;
            }
        }
        InitialState { q, u: vec![0.0; self.dof()] }
    }

    /// The contacts, in a fixed order.
    fn contacts(&self) -> &[ContactLaw];

    /// The blocks that a contact touches, ascending. A system of several blocks has to say it.
    fn touched(&self, _contact: usize) -> &[usize] {
        if self.blocks().count() == 1 { &[0] } else { &[] }
    }

    /// What never changes.
    fn constancy(&self) -> Constancy {
        Constancy::default()
    }

    /// The parts that nothing ever connects, neither forces nor contacts that may close, as systems of their own; none, as
    /// by default, if all is one part. Event-driven integration gives each its own steps.
    fn parts(&self) -> Vec<SystemPart> {
        Vec::new()
    }

    /// Whether joints hold bodies, which only [`Turning`] of a time step knows: event-driven integration refuses them.
    fn has_joints(&self) -> bool {
        false
    }

    /// Number of bilateral constraints `g(q) = 0`, which time steps hold and event-driven integration refuses. A system with
    /// constraints has one block of velocities.
    fn constraints(&self) -> usize {
        0
    }

    /// What constraints are off: `g(q)` in m or rad.
    ///
    /// # Errors
    ///
    /// [`SystemError::Foreign`] if what the user has written fails.
    fn constraint(&self, _q: &[f64], _off: &mut [f64]) -> Result<(), SystemError> {
        Ok(refuse("constraints", "a constraint needs what it is off")?)
    }

    /// The rows of `J(q)` in `ġ = J u`, one after another.
    ///
    /// # Errors
    ///
    /// [`SystemError::Foreign`] if what the user has written fails.
    fn constraint_rows(&self, _q: &[f64], _rows: &mut [f64]) -> Result<(), SystemError> {
        Ok(refuse("constraints", "a constraint needs its row")?)
    }

    /// The system by its matrices, if it is linear and made of them, so that steps need not ask for these.
    fn as_linear(&self) -> Option<&LinearSystem> {
        None
    }

    /// What bodies that turn need besides; nothing by default.
    fn turning(&self) -> Option<&dyn Turning> {
        None
    }

    /// The mass matrix `M(q)` of a block, symmetric positive definite, column by column.
    ///
    /// # Errors
    ///
    /// [`SystemError::Foreign`] if what the user has written fails.
    fn mass(&self, q: &[f64], block: usize, mass: &mut [f64]) -> Result<(), SystemError>;

    /// Forces `h(t, q, u)` without those of the contacts.
    ///
    /// # Errors
    ///
    /// [`SystemError::Foreign`] if what the user has written fails.
    fn forces(
        &self,
        at: &Configuration<'_>,
        u: &[f64],
        forces: &mut [f64],
    ) -> Result<(), SystemError>;

    /// The first time after `t` at which forces, gaps, rows or χ are not smooth functions of time; none by default.
    /// Event-driven integration ends its steps there, and evaluates the system within steps as it is continued smoothly
    /// from [`Configuration::piece`].
    fn next_break(&self, _t: f64) -> Option<Break> {
        None
    }

    /// The terms of functions of time up to `t_end`, seen from the coordinates `q`, where the system knows them; by default
    /// integrators take the largest values at about a hundred times for them.
    fn time_dependence(&self, _q: &[f64], _t_end: f64) -> Option<TimeDependence> {
        None
    }

    /// Gap `g_N` of a unilateral contact.
    ///
    /// # Errors
    ///
    /// [`SystemError::Foreign`] if what the user has written fails.
    fn gap(&self, _at: &Configuration<'_>, _contact: usize) -> Result<f64, SystemError> {
        Ok(refuse("contacts", "a unilateral contact needs a gap function")?)
    }

    /// A bound on `|g̈_N|` of a unilateral contact in all motions within `bounds` that begin at a configuration and do not
    /// let it overlap. With it no impact is missed, however long steps are; what is measured at a few places of every step
    /// takes the place of a bound where there is none, as by default.
    fn gap_acceleration(
        &self,
        _at: &Configuration<'_>,
        _contact: usize,
        _bounds: &MotionBounds,
    ) -> Option<f64> {
        None
    }

    /// The map by which the friction of a contact depends on its place, and this place; none by default.
    ///
    /// Integrators multiply the friction with the factor there; [`rows`](Self::rows) know nothing of it.
    fn friction_place(
        &self,
        _at: &Configuration<'_>,
        _contact: usize,
    ) -> Option<(&FrictionMap, [f64; 2])> {
        None
    }

    /// Directions of one contact: the rows of `W_Nᵀ`, if it is unilateral, and of `Wᵀ`, one after another, each with
    /// the velocities of the blocks that it touches; and χ_N and χ into `velocity`. Returns the gap, zero where the
    /// normal force is given.
    ///
    /// # Errors
    ///
    /// [`SystemError::Foreign`] if what the user has written fails.
    fn rows(
        &self,
        at: &Configuration<'_>,
        contact: usize,
        rows: &mut [f64],
        velocity: &mut [f64],
    ) -> Result<f64, SystemError>;
}

/// The rows of a contact with all velocities of the system, as methods with matrices of its size need them; its gap.
///
/// # Errors
///
/// As [`System::rows`].
pub fn full_rows<S: System + ?Sized>(
    system: &S,
    at: &Configuration<'_>,
    contact: usize,
    rows: &mut [f64],
    velocity: &mut [f64],
) -> Result<f64, SystemError> {
    let (blocks, touched, n) = (system.blocks(), system.touched(contact), system.dof());
    let len = velocity.len();
    let width: usize = touched.iter().map(|&block| blocks.range(block).len()).sum();
    let (narrow, wide) = (len * width, len * n);
    let gap = system.rows(at, contact, &mut rows[..narrow], velocity)?;
    if width == n {
        return Ok(gap);
    }
    // From the last entry to the first, as every entry moves to the right.
    rows[narrow..wide].fill(0.0);
    for row in (0..len).rev() {
        let (mut source, mut end) = ((row + 1) * width, (row + 1) * n);
        for &block in touched.iter().rev() {
            let range = blocks.range(block);
            let target = row * n + range.start;
            source -= range.len();
            rows.copy_within(source..source + range.len(), target);
            rows[target + range.len()..end].fill(0.0);
            end = target;
        }
        rows[row * n..end].fill(0.0);
    }
    Ok(gap)
}

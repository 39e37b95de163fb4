//! Rigid bodies with contacts, springs and weight, in space or in a plane.
//!
//! The body `k` of space has the coordinates `q[7k..]` (centre of mass, unit quaternion `(w, x, y, z)`) and
//! the velocities `u[6k..]` (velocity of the centre of mass in the world's axes, angular velocity Ω in the
//! body's), so that the mass matrix is constant. A planar body has `(x, y, φ)` and their rates.

mod body;
mod chord;
mod contact;
mod measures;
mod motion;
mod pair;
mod plane_motion;
mod rotation;
mod spring;
mod structure;
mod surface;

use nalgebra::{Matrix3, Vector3, Vector6};

pub use body::{Bodies, Body, PlanarBody};
pub use contact::ContactGeometry;
pub use pair::{Pair, Shape};
pub use plane_motion::PlaneMotion;
pub use spring::Spring;
pub use surface::{Field, Frame, Plane};

use super::{Blocks, ContactLaw, Moment};
use crate::argument::{ArgumentError, finite, refuse};
use body::{Inertial, Parts, TimedLoad};
use contact::Contact;
use surface::Timed;

/// A system of rigid bodies.
///
/// ```
/// use asperity::law::FrictionLaw;
/// use asperity::system::RigidBodies;
/// use asperity::system::rigid::{Body, Pair, Plane, Shape};
///
/// let half = [0.1, 0.1, 0.05];
/// let block = Body { position: [0.0, 0.0, 0.05], ..Body::cuboid(1.0, half) };
/// let shape = Shape::BoxPlane { body: 0, half_sizes: half, plane: Plane::floor() };
/// let pair = Pair::new(shape, FrictionLaw::<2>::isotropic(0.5)?);
/// let system = RigidBodies::new(vec![block], &[pair], vec![], [0.0, 0.0, -9.81])?;
/// assert_eq!(system.q0()[..3], [0.0, 0.0, 0.05]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Contacts are numbered pair after pair, the corners of a box one after another.
#[derive(Debug, Clone, PartialEq)]
pub struct RigidBodies {
    planar: bool,
    blocks: Blocks,
    inertial: Vec<Inertial>,
    /// Bodies of unequal moments, whose angular momenta are what is stepped.
    unequal: Vec<usize>,
    timed_loads: Vec<TimedLoad>,
    timed_planes: Vec<Timed>,
    gravity: Vector3<f64>,
    springs: Vec<Spring>,
    contacts: Vec<Contact>,
    laws: Vec<ContactLaw>,
    /// Pair and number within it of every contact.
    labels: Vec<(usize, usize)>,
    /// Contacts whose normal force is given, which loads the bodies like a spring.
    prescribed: Vec<usize>,
    q0: Vec<f64>,
    u0: Vec<f64>,
}

/// Place and attitude of a body: what carries its axes to those of the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Centre of mass in m.
    pub position: Vector3<f64>,
    /// Rotation matrix.
    pub rotation: Matrix3<f64>,
}

/// Velocity `(v, Ω)` of a body, or what is dual to it: v in the world's axes, Ω in the body's.
type Twist = Vector6<f64>;

impl Pose {
    /// World coordinates of a point of the body.
    #[inline]
    pub fn point(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.position + self.rotation * point
    }

    /// A force and a torque about the centre of mass, both in the world's axes, as dual to the twist.
    #[inline]
    fn wrench(&self, force: &Vector3<f64>, torque: &Vector3<f64>) -> Twist {
        twist(force, &self.rotation.tr_mul(torque))
    }
}

#[inline]
fn twist(linear: &Vector3<f64>, angular: &Vector3<f64>) -> Twist {
    Twist::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z)
}

#[inline]
fn linear(twist: &Twist) -> Vector3<f64> {
    Vector3::new(twist[0], twist[1], twist[2])
}

#[inline]
fn angular(twist: &Twist) -> Vector3<f64> {
    Vector3::new(twist[3], twist[4], twist[5])
}

impl RigidBodies {
    /// A system of bodies, all in space or all in the plane `z = 0`, with gravity in m/s².
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] that says of which body, pair or spring a number or index is out of its range.
    pub fn new(
        bodies: impl Into<Bodies>,
        pairs: &[Pair],
        springs: Vec<Spring>,
        gravity: [f64; 3],
    ) -> Result<Self, ArgumentError> {
        let bodies = bodies.into();
        let planar = matches!(bodies, Bodies::Planar(_));
        let Parts { inertial, timed_loads, q0, u0 } = bodies.parts()?;
        finite("gravity", &gravity)?;
        if planar && gravity[2] != 0.0 {
            return refuse("gravity", "must have z = 0 in planar systems");
        }
        for (i, spring) in springs.iter().enumerate() {
            spring.check(inertial.len(), planar).map_err(|error| within("spring", i, error))?;
        }
        let (mut contacts, mut laws, mut labels) = (Vec::new(), Vec::new(), Vec::new());
        for (i, pair) in pairs.iter().enumerate() {
            let name = |error| within("pair", i, error);
            let law = pair.contact_law(planar).map_err(name)?;
            for (k, contact) in
                pair.contacts(inertial.len(), planar).map_err(name)?.into_iter().enumerate()
            {
                contacts.push(contact);
                laws.push(law.clone());
                labels.push((i, k));
            }
        }
        let timed_planes = pairs.iter().filter_map(|pair| pair.shape.timed()).collect();
        let given = |&contact: &usize| laws[contact].normal_force().is_some();
        let prescribed = (0..laws.len()).filter(given).collect();
        let unequal = (0..inertial.len()).filter(|&body| !inertial[body].isotropic).collect();
        let (gravity, size) = (gravity.into(), if planar { 3 } else { 6 });
        let blocks = Blocks::new(std::iter::repeat_n(size, inertial.len()));
        #[rustfmt::skip]
        let bodies =
            Self { planar, blocks, inertial, unequal, timed_loads, timed_planes, gravity, springs, contacts, laws, labels, prescribed, q0, u0 };
        Ok(bodies)
    }

    /// Whether the bodies move in the plane `z = 0`.
    pub fn is_planar(&self) -> bool {
        self.planar
    }

    /// Number of bodies.
    pub fn bodies(&self) -> usize {
        self.inertial.len()
    }

    /// Initial coordinates.
    pub fn q0(&self) -> &[f64] {
        &self.q0
    }

    /// Initial velocities.
    pub fn u0(&self) -> &[f64] {
        &self.u0
    }

    /// Pair that a contact belongs to, and its number within the pair.
    pub fn label(&self, contact: usize) -> (usize, usize) {
        self.labels[contact]
    }

    /// The body of a contact on which its forces act, and the other one if it is not the world.
    pub fn partners(&self, contact: usize) -> (usize, Option<usize>) {
        (self.contacts[contact].body, self.contacts[contact].other)
    }

    /// Gap, place and directions of a contact in the world at the time `t`.
    pub fn contact_geometry(&self, t: f64, q: &[f64], contact: usize) -> ContactGeometry {
        let contact = &self.contacts[contact];
        let second = contact.other.map(|body| self.pose(q, body));
        contact.geometry(Moment::new(t), &self.pose(q, contact.body), second.as_ref())
    }

    /// Whether loads, springs or planes depend on time.
    pub fn depends_on_time(&self) -> bool {
        let springs = self.springs.iter().any(|spring| spring.length.constant().is_none());
        springs || !self.timed_loads.is_empty() || !self.timed_planes.is_empty()
    }

    /// Number of coordinates and of velocities per body.
    #[inline]
    fn sizes(&self) -> (usize, usize) {
        if self.planar { (3, 3) } else { (7, 6) }
    }
}

/// Says which of several the error is about.
fn within(what: &str, index: usize, error: ArgumentError) -> ArgumentError {
    ArgumentError { message: format!("of {what} {index} {}", error.message), ..error }
}

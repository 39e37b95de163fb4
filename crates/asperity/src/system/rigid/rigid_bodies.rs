//! A system of rigid bodies, as it is put together.

use std::sync::Arc;

use nalgebra::Vector3;

use super::body::{Bodies, Inertial, Parts, TimedLoad};
use super::contact::{Contact, ContactGeometry};
use super::joint::{Joint, Placed};
use super::pair::Pair;
use super::pose::Pose;
use super::spring::Spring;
use super::surface::Timed;
use crate::argument::{ArgumentError, below, entries, finite, refuse};
use crate::system::{Blocks, ContactLaw, Moment, Rotation, System};

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
    pub(super) planar: bool,
    /// Number of velocities per body.
    pub(super) size: usize,
    pub(super) rotations: Vec<Rotation>,
    pub(super) blocks: Blocks,
    pub(super) inertial: Vec<Inertial>,
    /// Bodies of unequal moments or with joints, whose angular momenta are what is stepped.
    pub(super) unequal: Vec<usize>,
    pub(super) joints: Vec<Placed>,
    /// Blocks with joints, and the numbers of these.
    pub(super) jointed: Vec<(usize, Vec<usize>)>,
    pub(super) timed_loads: Vec<TimedLoad>,
    pub(super) timed_planes: Vec<Arc<Timed>>,
    pub(super) gravity: Vector3<f64>,
    pub(super) springs: Vec<Spring>,
    pub(super) contacts: Vec<Contact>,
    pub(super) laws: Vec<ContactLaw>,
    labels: Vec<ContactLabel>,
    /// Contacts whose normal force is given, which loads the bodies like a spring.
    pub(super) prescribed: Vec<usize>,
    pub(super) q0: Vec<f64>,
    pub(super) u0: Vec<f64>,
}

/// Where a contact comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ContactLabel {
    /// The pair that it belongs to.
    pub pair: usize,
    /// Its number within the pair.
    pub number: usize,
}

/// The two sides of a contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Partners {
    /// The body on which the contact forces act.
    pub body: usize,
    /// The other body; none is the world.
    pub other: Option<usize>,
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
            spring.check(inertial.len(), planar).map_err(|error| error.within("spring", i))?;
        }
        let (mut contacts, mut laws, mut labels) = (Vec::new(), Vec::new(), Vec::new());
        for (i, pair) in pairs.iter().enumerate() {
            let name = |error: ArgumentError| error.within("pair", i);
            let law = pair.contact_law(planar).map_err(name)?;
            for (k, contact) in
                pair.contacts(inertial.len(), planar).map_err(name)?.into_iter().enumerate()
            {
                contacts.push(contact);
                laws.push(law.clone());
                labels.push(ContactLabel { pair: i, number: k });
            }
        }
        let timed_planes = timed_planes(&contacts);
        let given = |&contact: &usize| !laws[contact].normal_force().is_unilateral();
        let prescribed = (0..laws.len()).filter(given).collect();
        let unequal = (0..inertial.len()).filter(|&body| !inertial[body].isotropic).collect();
        let (gravity, size) = (gravity.into(), if planar { 3 } else { 6 });
        let blocks = Blocks::new(std::iter::repeat_n(size, inertial.len()));
        let turning = if planar { 0 } else { inertial.len() };
        let rotation = |k| Rotation { coordinate: 7 * k + 3, velocity: 6 * k + 3 };
        let rotations = (0..turning).map(rotation).collect();
        #[rustfmt::skip]
        let bodies =
            Self { planar, size, rotations, blocks, inertial, unequal, joints: vec![], jointed: vec![], timed_loads, timed_planes, gravity, springs, contacts, laws, labels, prescribed, q0, u0 };
        Ok(bodies)
    }

    /// The same system with joints, placed as the bodies are at the coordinates `q`. Bodies that joints connect, and those
    /// numbered between them, become one block of velocities.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] that says of which joint a number, index or axis is not allowed, or if `q` has not the coordinates
    /// of the system.
    pub fn with_joints(mut self, joints: &[Joint], q: &[f64]) -> Result<Self, ArgumentError> {
        entries("q", q, self.coordinates())?;
        let count = self.bodies();
        let mut joined = vec![false; count];
        for (i, joint) in joints.iter().enumerate() {
            joint.check(count, self.planar).map_err(|error| error.within("joint", i))?;
            let other = joint.other.unwrap_or(joint.body);
            joined[joint.body.min(other)..joint.body.max(other)].fill(true);
        }
        let mut blocks: Vec<usize> = Vec::new();
        let block: Vec<usize> = (0..count)
            .map(|body| {
                if body == 0 || !joined[body - 1] {
                    blocks.push(0);
                }
                let last = blocks.len() - 1;
                blocks[last] += self.size;
                last
            })
            .collect();
        self.blocks = Blocks::new(blocks);
        let range = |number: usize| {
            let range = self.blocks.range(number);
            range.start / self.size..range.end / self.size
        };
        let contacts = self.contacts.drain(..);
        self.contacts = contacts.map(|contact| contact.in_blocks(&block, range)).collect();
        let place = |joint: &Joint| {
            let bodies = [joint.body, joint.other.unwrap_or(joint.body)];
            let square =
                |body: usize| self.inertial[body].inertia.trace() / self.inertial[body].mass;
            let length = bodies.map(|body| square(body).sqrt()).iter().sum();
            Placed::new(joint, length, |body| self.pose_of(q, body))
        };
        self.joints = joints.iter().map(place).collect();
        let of = |number: usize| -> Vec<usize> {
            (0..joints.len()).filter(|&joint| block[joints[joint].body] == number).collect()
        };
        let numbers = (0..self.blocks.count()).map(|number| (number, of(number)));
        self.jointed = numbers.filter(|(_, joints)| !joints.is_empty()).collect();
        let holds = |body: usize| joints.iter().any(|j| j.body == body || j.other == Some(body));
        let steps_momentum =
            |body: &usize| !self.inertial[*body].isotropic || !self.planar && holds(*body);
        self.unequal = (0..count).filter(steps_momentum).collect();
        Ok(self)
    }

    /// The system of some of the bodies alone, ascending, with these contacts and springs, which touch no others.
    pub(super) fn of_bodies(&self, bodies: &[usize], contacts: &[usize]) -> Self {
        let place = |body: &usize| bodies.binary_search(body).ok();
        let count = bodies.len();
        let size = if self.planar { 3 } else { 7 };
        let part = |of: &[f64], size: usize| -> Vec<f64> {
            bodies.iter().flat_map(|body| &of[size * body..size * (body + 1)]).copied().collect()
        };
        let loads = self.timed_loads.iter();
        let loads = loads.filter_map(|l| Some(TimedLoad { body: place(&l.body)?, ..l.clone() }));
        let springs = self.springs.iter().filter_map(|spring| {
            let other = spring.other.as_ref().and_then(place);
            Some(Spring { body: place(&spring.body)?, other, ..spring.clone() })
        });
        let moved = |&contact: &usize| self.contacts[contact].renumbered(|body| place(&body));
        let own: Vec<Contact> = contacts.iter().filter_map(moved).collect();
        let given = |i: &usize| !self.laws[contacts[*i]].normal_force().is_unilateral();
        let inertial: Vec<_> = bodies.iter().map(|&body| self.inertial[body]).collect();
        Self {
            planar: self.planar,
            size: self.size,
            rotations: self.rotations[..count.min(self.rotations.len())].to_vec(),
            blocks: Blocks::new(std::iter::repeat_n(self.size, count)),
            unequal: (0..count).filter(|&body| !inertial[body].isotropic).collect(),
            inertial,
            joints: Vec::new(),
            jointed: Vec::new(),
            timed_loads: loads.collect(),
            timed_planes: timed_planes(&own),
            gravity: self.gravity,
            springs: springs.collect(),
            contacts: own,
            laws: contacts.iter().map(|&contact| self.laws[contact].clone()).collect(),
            labels: contacts.iter().map(|&contact| self.labels[contact]).collect(),
            prescribed: (0..contacts.len()).filter(given).collect(),
            q0: part(&self.q0, size),
            u0: part(&self.u0, self.size),
        }
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

    /// The pair that a contact belongs to; nothing if there is no such contact.
    pub fn label(&self, contact: usize) -> Option<ContactLabel> {
        self.labels.get(contact).copied()
    }

    /// The bodies of a contact; nothing if there is no such contact.
    pub fn partners(&self, contact: usize) -> Option<Partners> {
        let contact = self.contacts.get(contact)?;
        Some(Partners { body: contact.body, other: contact.other })
    }

    /// Place and attitude of a body.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] if there is no such body, or if `q` has not the coordinates of the system.
    pub fn pose(&self, q: &[f64], body: usize) -> Result<Pose, ArgumentError> {
        entries("q", q, self.coordinates())?;
        below("body", body, self.bodies(), "bodies")?;
        Ok(self.pose_of(q, body))
    }

    /// Gap, place and directions of a contact in the world at the time `t`.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] if there is no such contact, or if `q` has not the coordinates of the system.
    pub fn contact_geometry(
        &self,
        t: f64,
        q: &[f64],
        contact: usize,
    ) -> Result<ContactGeometry, ArgumentError> {
        finite("t", &[t])?;
        entries("q", q, self.coordinates())?;
        below("contact", contact, self.contacts.len(), "contacts")?;
        let contact = &self.contacts[contact];
        let poses = contact.poses(|body| self.pose_of(q, body));
        Ok(contact.geometry(Moment::new(t), &poses))
    }

    /// Whether loads, springs or planes depend on time.
    pub fn depends_on_time(&self) -> bool {
        let springs = self.springs.iter().any(|spring| spring.length.constant().is_none());
        springs || !self.timed_loads.is_empty() || !self.timed_planes.is_empty()
    }
}

/// What depends on time of the planes of contacts; those of one pair share it.
fn timed_planes(contacts: &[Contact]) -> Vec<Arc<Timed>> {
    let mut planes: Vec<Arc<Timed>> = contacts.iter().filter_map(Contact::timed).cloned().collect();
    planes.dedup_by(|a, b| Arc::ptr_eq(a, b));
    planes
}

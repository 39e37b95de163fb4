//! Rigid bodies with contacts, joints, springs and weight, in space or in a plane.
//!
//! The body `k` of space has the coordinates `q[7k..]` (centre of mass, unit quaternion `(w, x, y, z)`) and
//! the velocities `u[6k..]` (velocity of the centre of mass in the world's axes, angular velocity Ω in the
//! body's), so that the mass matrix is constant. A planar body has `(x, y, φ)` and their rates.

mod body;
mod chord;
mod contact;
mod joined;
mod joint;
mod measures;
mod motion;
mod pair;
mod plane_motion;
mod pose;
mod reactions;
mod rigid_bodies;
mod spring;
mod structure;
mod surface;

pub use body::{Bodies, Body, PlanarBody};
pub use contact::ContactGeometry;
pub use joint::{Joint, JointKind};
pub use pair::{Pair, Shape};
pub use plane_motion::PlaneMotion;
pub use pose::Pose;
pub use rigid_bodies::{ContactLabel, Partners, RigidBodies};
pub use spring::Spring;
pub use surface::{Frame, Plane};

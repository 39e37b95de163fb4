//! Springs with dampers between points of two bodies, or of a body and the world.

use nalgebra::Vector3;

use super::pose::{Pose, Twist};
use crate::argument::{ArgumentError, below, finite, not_negative, refuse};
use crate::system::{Moment, TimeFunction};

/// A spring with a damper along the line between two points.
///
/// Of natural length zero it pulls with `k d`, like a spring in every direction; of any other it exerts no
/// force while its ends coincide. It acts explicitly: `Δt d < 2m` and `Δt² k < 4m` with the effective mass.
#[derive(Debug, Clone, PartialEq)]
pub struct Spring {
    /// The first body.
    pub body: usize,
    /// Its point in m in the body's axes.
    pub point: [f64; 3],
    /// The second body, `None` for the world.
    pub other: Option<usize>,
    /// Its point in m.
    pub other_point: [f64; 3],
    /// Stiffness in N/m.
    pub stiffness: f64,
    /// Damping in N s/m.
    pub damping: f64,
    /// Natural length in m.
    pub length: TimeFunction<1>,
}

impl Spring {
    pub(super) fn check(&self, bodies: usize, planar: bool) -> Result<(), ArgumentError> {
        below("body", self.body, bodies, "bodies")?;
        below("other", self.other.unwrap_or(self.body), bodies, "bodies")?;
        finite("point", &self.point)?;
        finite("other_point", &self.other_point)?;
        if planar && (self.point[2] != 0.0 || self.other_point[2] != 0.0) {
            return refuse("point", "must have z = 0 in planar systems");
        }
        let length = match &self.length {
            TimeFunction::Constant([length]) => *length,
            TimeFunction::Signal(signal) if signal.components() == 1 => signal.least(0),
            length => length.check("length").map(|()| 0.0)?,
        };
        not_negative("stiffness", self.stiffness)?;
        not_negative("damping", self.damping)?;
        not_negative("length", length).map(drop)
    }

    /// Vector from the second point to the first.
    fn distance(&self, pose: impl Fn(usize) -> Pose) -> Vector3<f64> {
        let first = pose(self.body).point(&self.point.into());
        let other = Vector3::from(self.other_point);
        first - self.other.map_or(other, |body| pose(body).point(&other))
    }

    /// Energy in J.
    pub(super) fn energy(&self, at: Moment, pose: impl Fn(usize) -> Pose) -> f64 {
        let extension = self.distance(pose).norm() - self.length.value(at)[0];
        0.5 * self.stiffness * extension * extension
    }

    /// Adds its forces to those of the bodies.
    pub(super) fn load(
        &self,
        at: Moment,
        pose: impl Fn(usize) -> Pose,
        twist: impl Fn(usize) -> Twist,
        add: &mut impl FnMut(usize, Twist),
    ) {
        let distance = self.distance(&pose);
        let length = distance.norm();
        let along = if length > 0.0 { distance / length } else { Vector3::zeros() };
        let row = |body: usize, point: [f64; 3]| {
            let pose = pose(body);
            let lever = pose.rotation * Vector3::from(point);
            pose.wrench(&along, &lever.cross(&along))
        };
        let own = row(self.body, self.point);
        let other = self.other.map(|body| (body, row(body, self.other_point)));
        let mut rate = own.dot(&twist(self.body));
        if let Some((body, row)) = &other {
            rate -= row.dot(&twist(*body));
        }
        let force = -self.stiffness * (length - self.length.value(at)[0]) - self.damping * rate;
        add(self.body, own * force);
        if let Some((body, row)) = other {
            add(body, row * -force);
        }
    }
}

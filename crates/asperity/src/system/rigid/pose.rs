//! Where bodies are, how they move, and what acts on them.

use nalgebra::{Matrix3, Vector3, Vector6};

/// Place and attitude of a body: what carries its axes to those of the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Centre of mass in m.
    pub position: Vector3<f64>,
    /// Rotation matrix.
    pub rotation: Matrix3<f64>,
}

/// Velocity `(v, Ω)` of a body, or what is dual to it: v in the world's axes, Ω in the body's.
pub(super) type Twist = Vector6<f64>;

/// The poses of the two bodies of a contact; the second one may be the world.
#[derive(Debug, Clone, Copy)]
pub(super) struct Poses {
    pub(super) first: Pose,
    pub(super) second: Option<Pose>,
}

impl Pose {
    /// World coordinates of a point of the body.
    #[inline]
    pub fn point(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.position + self.rotation * point
    }

    /// A force on a point, all in the world's axes, as dual to the twist.
    #[inline]
    pub(super) fn pushed(&self, point: &Vector3<f64>, force: &Vector3<f64>) -> Twist {
        self.wrench(force, &(point - self.position).cross(force))
    }

    /// A force and a torque about the centre of mass, both in the world's axes, as dual to the twist.
    #[inline]
    pub(super) fn wrench(&self, force: &Vector3<f64>, torque: &Vector3<f64>) -> Twist {
        twist(force, &self.rotation.tr_mul(torque))
    }
}

#[inline]
pub(super) fn twist(linear: &Vector3<f64>, angular: &Vector3<f64>) -> Twist {
    Twist::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z)
}

#[inline]
pub(super) fn linear(twist: &Twist) -> Vector3<f64> {
    Vector3::new(twist[0], twist[1], twist[2])
}

#[inline]
pub(super) fn angular(twist: &Twist) -> Vector3<f64> {
    Vector3::new(twist[3], twist[4], twist[5])
}

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

/// Bounds on the components of a body's velocity and acceleration.
#[derive(Debug, Clone, Copy)]
pub(super) struct Speeds {
    pub(super) velocity: Twist,
    pub(super) acceleration: Twist,
}

impl Speeds {
    /// Bounds on velocity and acceleration of a point of the body at this distance from its centre:
    /// `v + rω` and `a + r(ω² + α)`.
    pub(super) fn of_point(&self, arm: f64) -> [f64; 2] {
        let [turning, turning_rate] = self.turning();
        let velocity = linear(&self.velocity).norm() + arm * turning;
        let turned = turning * turning + turning_rate;
        [velocity, linear(&self.acceleration).norm() + arm * turned]
    }

    /// Bounds on its angular velocity ω and angular acceleration α.
    pub(super) fn turning(&self) -> [f64; 2] {
        [angular(&self.velocity).norm(), angular(&self.acceleration).norm()]
    }
}

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

//! Energy and momentum.

use nalgebra::Vector3;

use super::{RigidBodies, angular, linear};
use crate::system::Moment;

impl RigidBodies {
    /// Kinetic energy in J.
    pub fn kinetic_energy(&self, u: &[f64]) -> f64 {
        let energy = |body: usize| {
            let (inertial, twist) = (&self.inertial[body], self.twist(u, body));
            let (v, omega) = (linear(&twist), angular(&twist));
            0.5 * (inertial.mass * v.norm_squared() + omega.dot(&(inertial.inertia * omega)))
        };
        (0..self.bodies()).map(energy).sum()
    }

    /// Potential energy in J of the weight, the constant forces and the springs at the time `t`; zero with all
    /// centres of mass at the origin and all springs at their natural length. Torques and forces that depend on time
    /// have none.
    pub fn potential_energy(&self, t: f64, q: &[f64]) -> f64 {
        let weight = |body: usize| {
            let inertial = &self.inertial[body];
            -(self.gravity * inertial.mass + inertial.force).dot(&self.pose(q, body).position)
        };
        let pose = |body| self.pose(q, body);
        let springs = self.springs.iter().map(|spring| spring.energy(Moment::new(t), pose));
        (0..self.bodies()).map(weight).sum::<f64>() + springs.sum::<f64>()
    }

    /// Linear momentum in kg m/s.
    pub fn momentum(&self, u: &[f64]) -> Vector3<f64> {
        let momentum = |body: usize| linear(&self.twist(u, body)) * self.inertial[body].mass;
        (0..self.bodies()).map(momentum).sum()
    }

    /// Angular momentum in kg m²/s about a point of the world.
    pub fn angular_momentum(&self, q: &[f64], u: &[f64], about: &Vector3<f64>) -> Vector3<f64> {
        let momentum = |body: usize| {
            let (inertial, twist) = (&self.inertial[body], self.twist(u, body));
            let pose = self.pose(q, body);
            let orbital = (pose.position - about).cross(&(linear(&twist) * inertial.mass));
            orbital + pose.rotation * (inertial.inertia * angular(&twist))
        };
        (0..self.bodies()).map(momentum).sum()
    }
}

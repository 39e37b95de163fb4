//! Energy and momentum.

use nalgebra::Vector3;

use super::pose::{angular, linear};
use super::rigid_bodies::RigidBodies;
use crate::argument::{ArgumentError, entries, finite};
use crate::system::{Moment, System};

impl RigidBodies {
    /// Kinetic energy in J.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] unless `u` has the velocities of the system.
    pub fn kinetic_energy(&self, u: &[f64]) -> Result<f64, ArgumentError> {
        entries("u", u, self.dof())?;
        let energy = |body: usize| {
            let (inertial, twist) = (&self.inertial[body], self.twist(u, body));
            let (v, omega) = (linear(&twist), angular(&twist));
            0.5 * (inertial.mass * v.norm_squared() + omega.dot(&(inertial.inertia * omega)))
        };
        Ok((0..self.bodies()).map(energy).sum())
    }

    /// Potential energy in J of the weight, the constant forces and the springs at the time `t`; zero with all
    /// centres of mass at the origin and all springs at their natural length. Torques and forces that depend on time
    /// have none.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] unless `q` has the coordinates of the system.
    pub fn potential_energy(&self, t: f64, q: &[f64]) -> Result<f64, ArgumentError> {
        finite("t", &[t])?;
        entries("q", q, self.coordinates())?;
        let weight = |body: usize| {
            let inertial = &self.inertial[body];
            -(self.gravity * inertial.mass + inertial.force).dot(&self.pose_of(q, body).position)
        };
        let pose = |body| self.pose_of(q, body);
        let springs = self.springs.iter().map(|spring| spring.energy(Moment::new(t), pose));
        Ok((0..self.bodies()).map(weight).sum::<f64>() + springs.sum::<f64>())
    }

    /// Linear momentum in kg m/s.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] unless `u` has the velocities of the system.
    pub fn momentum(&self, u: &[f64]) -> Result<Vector3<f64>, ArgumentError> {
        entries("u", u, self.dof())?;
        let momentum = |body: usize| linear(&self.twist(u, body)) * self.inertial[body].mass;
        Ok((0..self.bodies()).map(momentum).sum())
    }

    /// Angular momentum in kg m²/s about a point of the world.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] unless `q` and `u` have the coordinates and velocities of the system.
    pub fn angular_momentum(
        &self,
        q: &[f64],
        u: &[f64],
        about: &Vector3<f64>,
    ) -> Result<Vector3<f64>, ArgumentError> {
        entries("q", q, self.coordinates())?;
        entries("u", u, self.dof())?;
        let momentum = |body: usize| {
            let (inertial, twist) = (&self.inertial[body], self.twist(u, body));
            let pose = self.pose_of(q, body);
            let orbital = (pose.position - about).cross(&(linear(&twist) * inertial.mass));
            orbital + pose.rotation * (inertial.inertia * angular(&twist))
        };
        Ok((0..self.bodies()).map(momentum).sum())
    }
}

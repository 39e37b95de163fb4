//! What joints transmit.

use nalgebra::Vector3;

use super::rigid_bodies::RigidBodies;
use crate::system::SystemError;
use crate::system::constrained;

impl RigidBodies {
    /// Force in N and torque in N m of every joint on its first body, at its anchor, of a weld at the body's centre, in the
    /// world's axes and in the middle of a step of length `dt` that ends in a state at `t`. `contacts` are the forces of all
    /// rows of contacts. Rows that repeat others transmit nothing.
    ///
    /// # Errors
    ///
    /// [`SystemError::Argument`] unless the state has the coordinates and velocities of the system.
    pub fn joint_reactions(
        &self,
        times: (f64, f64),
        state: (&[f64], &[f64]),
        contacts: &[f64],
    ) -> Result<Vec<[Vector3<f64>; 2]>, SystemError> {
        let (forces, middle) = constrained::reactions(self, times, state, contacts)?;
        let mut reactions = vec![[Vector3::zeros(); 2]; self.joints.len()];
        let mut rest = &forces[..];
        for joint in self.in_order() {
            let (own, others) = rest.split_at(self.joints[joint].rows());
            reactions[joint] = self.joints[joint].reaction(|body| self.pose_of(&middle, body), own);
            rest = others;
        }
        Ok(reactions)
    }
}

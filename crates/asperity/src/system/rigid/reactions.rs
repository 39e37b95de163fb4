//! What joints transmit.

use nalgebra::Vector3;

use super::rigid_bodies::RigidBodies;
use crate::argument::entries;
use crate::system::constrained::Constraints;
use crate::system::mass::MassFactors;
use crate::system::{Configuration, System, SystemError, full_rows};

/// Rounds in which velocities and accelerations in the middle of a step follow from each other.
const ROUNDS: usize = 3;

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
        (t, dt): (f64, f64),
        (q, u): (&[f64], &[f64]),
        contacts: &[f64],
    ) -> Result<Vec<[Vector3<f64>; 2]>, SystemError> {
        let (half, n) = (0.5 * dt, self.dof());
        entries("q", q, self.coordinates())?;
        entries("u", u, n)?;
        let moved = |from: &[f64], u: &[f64], time: f64| {
            let mut out = from.to_vec();
            self.advance(from, u, time, &mut out);
            out
        };
        let middle = moved(q, u, -half);
        let at = Configuration::new(t - half, &middle);
        let (mut pushed, mut rest) = (vec![0.0; n], contacts.iter());
        for (contact, len) in self.laws.iter().map(|law| law.rows()).enumerate() {
            let (mut rows, mut velocity) = (vec![0.0; len * n], vec![0.0; len]);
            full_rows(self, &at, contact, &mut rows, &mut velocity)?;
            for (row, force) in rows.chunks_exact(n).zip(&mut rest) {
                pushed.iter_mut().zip(row).for_each(|(pushed, w)| *pushed += w * force);
            }
        }
        let (mut mass, mut speeds, mut forces) = (MassFactors::default(), u.to_vec(), Vec::new());
        mass.update(self, t, &middle)?;
        let held = self.held(t, &middle)?;
        for _ in 0..ROUNDS {
            let mut accelerations = vec![0.0; n];
            self.forces(&at, &speeds, &mut accelerations)?;
            accelerations.iter_mut().zip(&pushed).for_each(|(h, pushed)| *h += pushed);
            mass.solve(self, &mut accelerations);
            // What J u would change by without joints.
            let ahead = self.rates(&moved(&middle, &speeds, half), &speeds)?;
            let behind = self.rates(&moved(&middle, &speeds, -half), &speeds)?;
            let mut off = self.rates(&middle, &accelerations)?;
            for (off, (ahead, behind)) in off.iter_mut().zip(ahead.iter().zip(&behind)) {
                *off += (ahead - behind) / dt;
            }
            forces.clear();
            for held in &held {
                let own = &off[forces.len()..forces.len() + held.count];
                forces.extend(held.reactions(own));
                held.take(own, &mut accelerations[held.velocities.clone()]);
            }
            let back = speeds.iter_mut().zip(u).zip(&accelerations);
            back.for_each(|((speed, u), a)| *speed = u - half * a);
        }
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

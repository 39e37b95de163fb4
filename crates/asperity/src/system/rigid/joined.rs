//! Joints as constraints of a step ([`crate::system::constrained`]). Angular momenta are stepped for all bodies with joints, as
//! these turn them besides.

use nalgebra::{DMatrix, Vector3};

use super::pose::{Twist, angular, linear, twist};
use super::rigid_bodies::RigidBodies;
use crate::system::constrained::{self, Constraints, End};
use crate::system::held::Held;
use crate::system::{Midpoint, System, SystemError};

impl RigidBodies {
    /// Joints of all blocks, in the order of what is held.
    pub(super) fn in_order(&self) -> impl Iterator<Item = usize> {
        self.jointed.iter().flat_map(|(_, joints)| joints).copied()
    }
}

impl Constraints for RigidBodies {
    fn system(&self) -> &dyn System {
        self
    }

    fn held(&self, _t: f64, q: &[f64]) -> Result<Vec<Held>, SystemError> {
        let of_block = |(block, joints): &(usize, Vec<usize>)| {
            let velocities = self.blocks.range(*block);
            let (n, first) = (velocities.len(), velocities.start / self.size);
            let (mut rows, mut responses, mut sizes) = (Vec::new(), Vec::new(), Vec::new());
            for joint in joints.iter().map(|&joint| &self.joints[joint]) {
                joint.sizes(|body| self.pose_of(q, body), &mut sizes);
                for directions in joint.directions(|body| self.pose_of(q, body)) {
                    let (mut row, mut response) = (vec![0.0; n], vec![0.0; n]);
                    for (body, direction) in joint.bodies().zip(directions) {
                        let inertial = &self.inertial[body];
                        let speed = linear(&direction) * inertial.inverse_mass;
                        let moved = twist(&speed, &inertial.rate(&angular(&direction)));
                        self.set_twist(&mut row, body - first, &direction);
                        self.set_twist(&mut response, body - first, &moved);
                    }
                    rows.extend(row);
                    responses.extend(response);
                }
            }
            let count = rows.len() / n;
            let rows = DMatrix::from_row_slice(count, n, &rows);
            let responses = DMatrix::from_column_slice(n, count, &responses);
            Held::new(*block, velocities, &rows, &responses, sizes)
        };
        Ok(self.jointed.iter().map(of_block).collect())
    }

    fn defects(&self, q: &[f64]) -> Result<Vec<f64>, SystemError> {
        let mut defects = Vec::new();
        for joint in self.in_order() {
            self.joints[joint].defects(|body| self.pose_of(q, body), &mut defects);
        }
        Ok(defects)
    }

    fn rates(&self, q: &[f64], u: &[f64]) -> Result<Vec<f64>, SystemError> {
        let mut rates = Vec::new();
        for joint in self.in_order().map(|joint| &self.joints[joint]) {
            let rate = |directions: [Twist; 2]| {
                let parts = joint.bodies().zip(directions);
                parts.map(|(body, direction)| direction.dot(&self.twist(u, body))).sum::<f64>()
            };
            rates.extend(joint.directions(|body| self.pose_of(q, body)).into_iter().map(rate));
        }
        Ok(rates)
    }

    fn end(&self, midpoint: &Midpoint, after: &[f64], half: f64) -> Result<End, SystemError> {
        let at = midpoint.configuration();
        let (mut q, mut ends, mut spins) = (midpoint.q.clone(), after.to_vec(), Vec::new());
        for (&body, momentum) in self.unequal.iter().zip(midpoint.momenta.chunks_exact(3)) {
            let own = self.twist(after, body);
            let omega = self.end_rate(body, &angular(&own), half)?;
            self.set_twist(&mut ends, body, &twist(&linear(&own), &omega));
            let gained = angular(&own) - angular(&self.twist(&midpoint.before, body));
            let change = self.pose_at(&at, body).rotation * (self.inertial[body].inertia * gained);
            spins.extend_from_slice((Vector3::from_column_slice(momentum) + change).as_slice());
        }
        let Midpoint { t, q: from, held, .. } = midpoint;
        constrained::arrive(self, *t, held, (from, &mut ends, half), &mut q, |q, u| {
            for (&body, spin) in self.unequal.iter().zip(spins.chunks_exact(3)) {
                let spin = self.pose_of(q, body).rotation.tr_mul(&Vector3::from_column_slice(spin));
                let omega = self.inertial[body].rate(&spin);
                self.set_twist(u, body, &twist(&linear(&self.twist(u, body)), &omega));
            }
        })?;
        Ok([q, ends, spins])
    }

    fn name(&self, row: usize) -> String {
        let mut rows = self.in_order().flat_map(|j| std::iter::repeat_n(j, self.joints[j].rows()));
        format!("joint {}", rows.nth(row).unwrap_or_default())
    }

    fn lost(&self, time: f64) -> SystemError {
        SystemError::Joints { time }
    }
}

//! What time steps ask of rigid bodies: body by body, or in matrices as of any system.

use nalgebra::DMatrix;

use super::contact::Contact;
use super::rotation::unit;
use super::{RigidBodies, Twist, angular, linear, twist};
use crate::contact::Csr;
use crate::system::{Constancy, ContactLaw, Rotation, System, SystemError};

impl RigidBodies {
    /// Number of velocities of a body.
    #[inline]
    pub(crate) fn velocities_per_body(&self) -> usize {
        self.sizes().1
    }

    /// The mass matrix, body by body.
    pub(crate) fn sparse_mass(&self) -> Option<Csr> {
        let (n, bodies) = (self.sizes().1, self.bodies());
        let (mut starts, mut indices, mut values) = (vec![0], Vec::new(), Vec::new());
        for (body, inertial) in self.inertial.iter().enumerate() {
            for row in 0..n {
                let unit = Twist::ith(if self.planar && row == 2 { 5 } else { row }, 1.0);
                let moving = linear(&unit) * inertial.mass;
                let column = twist(&moving, &(inertial.inertia * angular(&unit)));
                let mut entries = [0.0; 6];
                self.set_twist(&mut entries, 0, &column);
                for (k, &entry) in entries[..n].iter().enumerate().filter(|(_, e)| **e != 0.0) {
                    indices.push(n * body + k);
                    values.push(entry);
                }
                starts.push(indices.len());
            }
        }
        Csr::new("mass", (n * bodies, n * bodies), starts, indices, values).ok()
    }

    /// Laws of the contacts.
    #[inline]
    pub(crate) fn contact_laws(&self) -> &[ContactLaw] {
        &self.laws
    }

    /// `γ = Wᵀu + χ` of a contact.
    pub(crate) fn slip(&self, q: &[f64], u: &[f64], index: usize) -> [f64; 3] {
        let contact = &self.contacts[index];
        let first = self.pose(q, contact.body);
        let second = contact.other.map(|body| self.pose(q, body));
        let (mut own, mut others) = ([Twist::zeros(); 3], [Twist::zeros(); 3]);
        let (at, mut slip) = ((&first, second.as_ref()), [0.0; 3]);
        let geometry = contact.geometry(at.0, at.1);
        let rows = (own.as_mut_slice(), others.as_mut_slice());
        contact.rows_of(&geometry, at, (false, contact.tangential), rows, &mut slip);
        for (k, slip) in slip.iter_mut().enumerate() {
            *slip += own[k].dot(&self.twist(u, contact.body));
            if let Some(body) = contact.other {
                *slip += others[k].dot(&self.twist(u, body));
            }
        }
        slip
    }

    /// The possible contacts.
    #[inline]
    pub(crate) fn possible_contacts(&self) -> &[Contact] {
        &self.contacts
    }

    /// Rows of one contact for the whole system, from coordinates.
    fn wide_rows(
        &self,
        q: &[f64],
        index: usize,
        (normal, p): (bool, usize),
        wide: &mut [f64],
        chi: &mut [f64],
    ) -> f64 {
        let contact = &self.contacts[index];
        let first = self.pose(q, contact.body);
        let second = contact.other.map(|body| self.pose(q, body));
        let (mut own, mut others) = ([Twist::zeros(); 3], [Twist::zeros(); 3]);
        let geometry = contact.geometry(&first, second.as_ref());
        let rows = (own.as_mut_slice(), others.as_mut_slice());
        contact.rows_of(&geometry, (&first, second.as_ref()), (normal, p), rows, chi);
        wide.fill(0.0);
        for (k, row) in wide.chunks_exact_mut(self.dof()).enumerate() {
            self.set_twist(row, contact.body, &own[k]);
            if let Some(body) = contact.other {
                self.set_twist(row, body, &others[k]);
            }
        }
        geometry.gap
    }
}

impl System for RigidBodies {
    fn dof(&self) -> usize {
        self.sizes().1 * self.bodies()
    }

    fn coordinates(&self) -> usize {
        self.sizes().0 * self.bodies()
    }

    fn advance(&self, q: &[f64], u: &[f64], dt: f64, out: &mut [f64]) {
        for body in 0..self.bodies() {
            self.advance_body(q, u, body, dt, out);
        }
    }

    fn rotations(&self) -> Vec<Rotation> {
        let bodies = if self.planar { 0 } else { self.bodies() };
        (0..bodies).map(|k| Rotation { coordinate: 7 * k + 3, velocity: 6 * k + 3 }).collect()
    }

    fn normalise(&self, q0: &mut [f64]) -> Result<(), SystemError> {
        if self.planar {
            return Ok(());
        }
        for (body, q) in q0.chunks_exact_mut(7).enumerate() {
            let Some(orientation) = unit([q[3], q[4], q[5], q[6]]) else {
                let message = format!(
                    "the orientation of body {body}, (w, x, y, z), must not be of length zero"
                );
                return Err(SystemError::argument("q0", message));
            };
            q[3..].copy_from_slice(&orientation);
        }
        Ok(())
    }

    fn rigid_bodies(&self) -> Option<&RigidBodies> {
        Some(self)
    }

    fn contacts(&self) -> &[ContactLaw] {
        &self.laws
    }

    fn constancy(&self) -> Constancy {
        Constancy { mass: true, contacts: false }
    }

    fn mass(&self, _q: &[f64], mass: &mut DMatrix<f64>) -> Result<(), SystemError> {
        mass.fill(0.0);
        let n = self.sizes().1;
        for (body, inertial) in self.inertial.iter().enumerate() {
            let first = n * body;
            for i in 0..3 {
                mass[(first + i, first + i)] = inertial.mass;
            }
            if self.planar {
                mass[(first + 2, first + 2)] = inertial.inertia.m33;
            } else {
                mass.fixed_view_mut::<3, 3>(first + 3, first + 3).copy_from(&inertial.inertia);
            }
        }
        Ok(())
    }

    fn forces(&self, _t: f64, q: &[f64], u: &[f64], forces: &mut [f64]) -> Result<(), SystemError> {
        for body in 0..self.bodies() {
            self.set_twist(forces, body, &self.weight(body, &self.pose(q, body)));
        }
        let mut add = |body: usize, load: Twist| {
            let sum = self.twist(forces, body) + load;
            self.set_twist(forces, body, &sum);
        };
        self.couplings(|body| self.pose(q, body), u, &mut add);
        for (body, inertial) in self.inertial.iter().enumerate().filter(|(_, i)| !i.isotropic) {
            let omega = angular(&self.twist(u, body));
            let gyroscopic = (inertial.inertia * omega).cross(&omega);
            let load = self.twist(forces, body);
            self.set_twist(forces, body, &twist(&linear(&load), &(angular(&load) + gyroscopic)));
        }
        Ok(())
    }

    fn tangent(
        &self,
        _t: f64,
        q: &[f64],
        contact: usize,
        tangent: &mut [f64],
        velocity: &mut [f64],
    ) -> Result<(), SystemError> {
        self.wide_rows(q, contact, (false, velocity.len()), tangent, velocity);
        Ok(())
    }

    fn gap(
        &self,
        _t: f64,
        q: &[f64],
        contact: usize,
        normal: &mut [f64],
    ) -> Result<f64, SystemError> {
        Ok(self.wide_rows(q, contact, (true, 0), normal, &mut [0.0]))
    }
}

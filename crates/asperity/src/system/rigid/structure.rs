//! Rigid bodies as a system: every body is a block of velocities.

use nalgebra::Vector3;

use super::pose::{Speeds, Twist, angular, linear, twist};
use super::rigid_bodies::RigidBodies;
use crate::contact::Components;
use crate::system::constrained::{self, Constraints};
use crate::system::{
    Blocks, Break, Configuration, Constancy, ContactLaw, FrictionMap, InitialState, Midpoint,
    MotionBounds, Rotation, Step, System, SystemError, SystemPart, TimeDependence, Turning,
};

/// How far a momentum may be off that of its state, relative to `‖J‖‖Ω‖ + ‖L‖`: the terms of `J Ω` cancel where a slender
/// body turns about its axis, so that `R J J⁻¹ Rᵀ L` is L to a few roundings of these.
const SAME_MOMENTUM: f64 = 1e-12;

impl System for RigidBodies {
    #[inline]
    fn blocks(&self) -> &Blocks {
        &self.blocks
    }

    fn coordinates(&self) -> usize {
        self.dof() + self.rotations.len()
    }

    #[inline]
    fn rotations(&self) -> &[Rotation] {
        &self.rotations
    }

    /// The state in which the bodies were given.
    fn initial_state(&self) -> InitialState {
        InitialState { q: self.q0.clone(), u: self.u0.clone() }
    }

    #[inline]
    fn contacts(&self) -> &[ContactLaw] {
        &self.laws
    }

    #[inline]
    fn touched(&self, contact: usize) -> &[usize] {
        self.contacts[contact].touched()
    }

    fn constancy(&self) -> Constancy {
        Constancy { mass: true, contacts: false, autonomous: !self.depends_on_time() }
    }

    fn has_joints(&self) -> bool {
        !self.joints.is_empty()
    }

    fn turning(&self) -> Option<&dyn Turning> {
        Some(self)
    }

    /// Bodies between which there are contacts or springs are of one part, however far they are from each other.
    fn parts(&self) -> Vec<SystemPart> {
        if self.has_joints() {
            return Vec::new();
        }
        let mut connected = Components::default();
        connected.separate(self.bodies());
        for contact in &self.contacts {
            connected.join(contact.bodies[0], contact.bodies[1]);
        }
        for spring in &self.springs {
            connected.join(spring.body, spring.other.unwrap_or(spring.body));
        }
        let places = |bodies: &[usize], size: usize| -> Vec<usize> {
            bodies.iter().flat_map(|body| size * body..size * (body + 1)).collect()
        };
        let coordinates = self.coordinates() / self.bodies();
        let part = |(bodies, contacts): (Vec<usize>, Vec<usize>)| SystemPart {
            system: Box::new(self.of_bodies(&bodies, &contacts)),
            coordinates: places(&bodies, coordinates),
            velocities: places(&bodies, self.size),
            contacts,
        };
        let touched = self.contacts.iter().map(|contact| contact.body);
        connected.split(touched).into_iter().map(part).collect()
    }

    fn mass(&self, _q: &[f64], block: usize, mass: &mut [f64]) -> Result<(), SystemError> {
        mass.fill(0.0);
        let range = self.blocks.range(block);
        let n = range.len();
        for first in (0..n).step_by(self.size) {
            let inertial = &self.inertial[(range.start + first) / self.size];
            let mut set = |i: usize, j: usize, entry| mass[n * (first + j) + first + i] = entry;
            if self.planar {
                set(0, 0, inertial.mass);
                set(1, 1, inertial.mass);
                set(2, 2, inertial.inertia.m33);
                continue;
            }
            for i in 0..3 {
                set(i, i, inertial.mass);
                for j in 0..3 {
                    set(3 + i, 3 + j, inertial.inertia[(i, j)]);
                }
            }
        }
        Ok(())
    }

    fn time_dependence(&self, q: &[f64], t_end: f64) -> Option<TimeDependence> {
        Some(self.extents_in_time(q, t_end))
    }

    fn next_break(&self, t: f64) -> Option<Break> {
        let mut next = None;
        for load in &self.timed_loads {
            next = Break::earlier(next, load.force.next_break(t));
            next = Break::earlier(next, load.torque.next_break(t));
        }
        for spring in &self.springs {
            next = Break::earlier(next, spring.length.next_break(t));
        }
        for plane in &self.timed_planes {
            next = Break::earlier(next, plane.next_break(t));
        }
        next
    }

    fn forces(
        &self,
        at: &Configuration<'_>,
        u: &[f64],
        forces: &mut [f64],
    ) -> Result<(), SystemError> {
        self.loads(at, u, forces);
        for &body in &self.unequal {
            let omega = angular(&self.twist(u, body));
            let gyroscopic = (self.inertial[body].inertia * omega).cross(&omega);
            let load = self.twist(forces, body);
            self.set_twist(forces, body, &twist(&linear(&load), &(angular(&load) + gyroscopic)));
        }
        Ok(())
    }

    #[inline]
    fn gap(&self, at: &Configuration<'_>, contact: usize) -> Result<f64, SystemError> {
        let contact = &self.contacts[contact];
        Ok(contact.gap(at.moment(), &contact.poses(|body| self.pose_at(at, body))).0)
    }

    fn gap_acceleration(
        &self,
        at: &Configuration<'_>,
        contact: usize,
        bounds: &MotionBounds,
    ) -> Option<f64> {
        let contact = &self.contacts[contact];
        let speeds = |body| Speeds {
            velocity: self.twist(&bounds.velocities, body),
            acceleration: self.twist(&bounds.accelerations, body),
        };
        let poses = contact.poses(|body| self.pose_at(at, body));
        contact.gap_acceleration(&poses, speeds, bounds.duration)
    }

    fn friction_place(
        &self,
        at: &Configuration<'_>,
        contact: usize,
    ) -> Option<(&FrictionMap, [f64; 2])> {
        let contact = &self.contacts[contact];
        let map = contact.friction.as_deref()?;
        Some((map, contact.place(at.moment(), &contact.poses(|body| self.pose_at(at, body)))))
    }

    fn rows(
        &self,
        at: &Configuration<'_>,
        contact: usize,
        rows: &mut [f64],
        velocity: &mut [f64],
    ) -> Result<f64, SystemError> {
        let contact = &self.contacts[contact];
        let poses = contact.poses(|body| self.pose_at(at, body));
        let (mut own, mut others) = ([Twist::zeros(); 4], [Twist::zeros(); 4]);
        let geometry = contact.geometry(at.moment(), &poses);
        contact.rows(&geometry, &poses, &mut own, &mut others, velocity);
        let (place, other_place) = contact.places;
        if self.has_joints() {
            rows.fill(0.0);
        }
        for (k, row) in rows.chunks_exact_mut(self.size * contact.width).enumerate() {
            self.set_twist(row, place, &own[k]);
            if contact.other.is_some() {
                self.set_twist(row, other_place, &others[k]);
            }
        }
        Ok(if contact.unilateral { geometry.gap } else { 0.0 })
    }
}

impl Turning for RigidBodies {
    /// The poses, twelve numbers per body.
    fn derive(&self, q: &[f64], derived: &mut Vec<f64>) {
        derived.clear();
        for body in 0..self.bodies() {
            let pose = self.pose_of(q, body);
            derived.extend_from_slice(pose.position.as_slice());
            derived.extend_from_slice(pose.rotation.as_slice());
        }
    }

    fn chord(
        &self,
        midpoint: &Midpoint,
        step: &Step<'_>,
        contact: usize,
        rows: &[f64],
        correction: &mut [f64],
    ) -> bool {
        let (contact, &Step { u, dt, .. }) = (&self.contacts[contact], step);
        let second = contact.other.map(|body| self.twist(u, body)).unwrap_or_default();
        if !contact.bends(&self.twist(u, contact.body), &second, dt) {
            return false;
        }
        let first = self.predicted(midpoint, u, contact.body, dt);
        let second = contact.other.map(|body| self.predicted(midpoint, u, body, dt));
        let bend = contact.bend(midpoint.t, &first, second.as_ref(), dt);
        let (normal_rows, (place, _)) = (usize::from(contact.unilateral), contact.places);
        let width = self.size * contact.width;
        for (k, (row, out)) in rows.chunks_exact(width).zip(correction).enumerate() {
            // The force of a row on the first body is its direction.
            *out = match (k + 1) - normal_rows {
                0 => bend.normal,
                3 => contact.patch * bend.drilling,
                _ => bend.tangential.dot(&linear(&self.twist(row, place))),
            };
        }
        true
    }

    fn momenta(&self, q: &[f64], u: &[f64]) -> Vec<f64> {
        let momentum = |&body: &usize| <[f64; 3]>::from(self.spin(q, u, body));
        self.unequal.iter().flat_map(momentum).collect()
    }

    fn has_momenta(&self, q: &[f64], u: &[f64], momenta: &[f64]) -> bool {
        let has = |(&body, given): (&usize, &[f64])| {
            let given = Vector3::from_column_slice(given);
            let size = self.inertial[body].inertia.norm() * angular(&self.twist(u, body)).norm();
            (self.spin(q, u, body) - given).amax() <= SAME_MOMENTUM * (size + given.norm())
        };
        momenta.len() == 3 * self.unequal.len()
            && self.unequal.iter().zip(momenta.chunks_exact(3)).all(has)
    }

    fn meets(&self, q: &[f64], u: &[f64], dt: f64) -> Result<(), SystemError> {
        constrained::check(self, q, u, 0.5 * dt)
    }

    fn hold(&self, midpoint: &Midpoint, after: &mut [f64], dt: f64) -> Result<(), SystemError> {
        constrained::hold(self, midpoint, after, 0.5 * dt)
    }

    fn begin(&self, step: &Step<'_>, midpoint: &mut Midpoint) -> Result<(), SystemError> {
        let &Step { midpoint: t, dt, q, u } = step;
        midpoint.t = t;
        let Midpoint { q: mid, derived, before, forces, momenta, held, .. } = midpoint;
        self.advance(q, u, 0.5 * dt, mid);
        if self.has_joints() {
            constrained::begin(self, step, mid, held)?;
        }
        self.derive(mid, derived);
        before.copy_from_slice(u);
        let at = Configuration { t, piece: t, q: mid, derived };
        for (&body, momentum) in self.unequal.iter().zip(momenta.chunks_exact(3)) {
            let momentum = Vector3::from_column_slice(momentum);
            let spin = self.pose_at(&at, body).rotation.tr_mul(&momentum);
            let omega = self.inertial[body].rate(&spin);
            self.set_twist(before, body, &twist(&linear(&self.twist(u, body)), &omega));
        }
        self.loads(&at, u, forces);
        Ok(())
    }

    fn finish(
        &self,
        midpoint: &mut Midpoint,
        after: &[f64],
        dt: f64,
        q: &mut [f64],
        u: &mut [f64],
    ) -> Result<(), SystemError> {
        if !midpoint.held.is_empty() {
            let [end, velocities, spins] = Constraints::end(self, midpoint, after, 0.5 * dt)?;
            q.copy_from_slice(&end);
            u.copy_from_slice(&velocities);
            midpoint.momenta = spins;
            return Ok(());
        }
        let Midpoint { t, q: mid, derived, before, forces, momenta, .. } = midpoint;
        let at = Configuration { t: *t, piece: *t, q: mid, derived };
        // Nothing changes unless all are found: until then the place of the forces, which have acted, holds them.
        let ends = forces;
        ends.copy_from_slice(after);
        for &body in &self.unequal {
            let after = self.twist(after, body);
            let omega = self.end_rate(body, &angular(&after), 0.5 * dt)?;
            self.set_twist(ends, body, &twist(&linear(&after), &omega));
        }
        u.copy_from_slice(ends);
        for (&body, momentum) in self.unequal.iter().zip(momenta.chunks_exact_mut(3)) {
            let gained = angular(&self.twist(after, body)) - angular(&self.twist(before, body));
            let change = self.inertial[body].inertia * gained;
            let spin =
                Vector3::from_column_slice(momentum) + self.pose_at(&at, body).rotation * change;
            momentum.copy_from_slice(spin.as_slice());
        }
        self.advance(mid, u, 0.5 * dt, q);
        for (&body, momentum) in self.unequal.iter().zip(momenta.chunks_exact(3)) {
            // Momentum is kept whatever the iteration has left over.
            let spin = Vector3::from_column_slice(momentum);
            let omega = self.inertial[body].rate(&self.pose_of(q, body).rotation.tr_mul(&spin));
            self.set_twist(u, body, &twist(&linear(&self.twist(u, body)), &omega));
        }
        Ok(())
    }
}

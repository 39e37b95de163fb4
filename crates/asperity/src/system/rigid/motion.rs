//! How rigid bodies move within a step.
//!
//! Both halves of Moreau's step are taken literally, `q_M = q_B ⊕ ½Δt u_B`, `q_E = q_M ⊕ ½Δt u_E`, with
//! `R ⊕ Ω = R exp Ω` for rotations. Unless the inertia is isotropic, Ω changes while a body turns freely,
//! whereas its angular momentum `L = R J Ω` stays: so L is what is stepped, and Ω is re-expressed from it
//! wherever the attitude has changed,
//!
//! `Ω⁻ = J⁻¹ R_Mᵀ L_B`, `Ω⁺ = Ω⁻ + J⁻¹ R_Mᵀ (Δt τ + W P)`, `L_E = L_B + Δt τ + W P`, `Ω_E = J⁻¹ R_Eᵀ L_E`
//!
//! where the last is implicit, as `R_E = R_M exp(½Δt Ω_E)`. Free flight then reads the same backwards: it is
//! of second order, keeps linear and angular momentum to rounding, and its energy oscillates without
//! drift, by a part of the order of `(Δt‖Ω‖)²`: 5 % where a body turns by a radian in a step, 10 % at two. Beyond, Ω_E may
//! not be found, and from half a turn on it is none but where Ω hardly changes, which ends the run. (With Ω⁺ in the second half it would be explicit and of first order, and tops would gain
//! energy.) L is kept from step to step: recovered from Ω, its rounding would add up.
//!
//! The velocities act from one midpoint to the next, and it is on this way, its chord, that the laws of contacts that
//! stay closed hold (`chord.rs`): points that stick on turning bodies creep with O(Δt²), those that a turntable carries
//! not at all. Contacts that close, those of the bodies which they strike, and the directions of contacts that slide are
//! of first order. Their laws hold in Ω⁺ at `q_M`: in the world's axes `R_M Ω⁺` and `R_E Ω_E` differ by O(Δt) where
//! gyroscopic terms act, and so do the γ at the end and the γ_E of the laws; for isotropic inertia, for planar bodies
//! and at rest they are the same.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Matrix3, Vector3};

use super::body::TimedLoad;
use super::pose::{Pose, Twist, angular, twist};
use super::rigid_bodies::RigidBodies;
use crate::system::rotation::{differential, matrix, turned_back};
use crate::system::time_function::Extent;
use crate::system::{Configuration, Derivative, SystemError, TimeDependence};

/// Most iterations for the angular velocity at the end of a step; bodies that turn by up to 3 rad take 8 at the most.
const MOST_ITERATIONS: usize = 20;
/// Defect of its equation relative to its terms that counts as rounding.
const CONVERGED: f64 = 4.0 * f64::EPSILON;
/// Change of the angular velocity times half the step, in rad, up to which it may be any: a wheel that spins about its
/// axis. Otherwise more than half a turn in a step has several solutions, of which some gain energy.
const STEADY: f64 = 1e-2;

impl RigidBodies {
    /// Place and attitude of a body that there is.
    #[inline]
    pub(super) fn pose_of(&self, q: &[f64], body: usize) -> Pose {
        if self.planar {
            let q = &q[3 * body..3 * body + 3];
            let (s, c) = if q[2] == 0.0 { (0.0, 1.0) } else { q[2].sin_cos() };
            let rotation = Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0);
            return Pose { position: Vector3::new(q[0], q[1], 0.0), rotation };
        }
        let q = &q[7 * body..7 * body + 7];
        let rotation = matrix(&[q[3], q[4], q[5], q[6]]);
        Pose { position: Vector3::new(q[0], q[1], q[2]), rotation }
    }

    /// The same, as it was derived from the coordinates before if it was.
    #[inline]
    pub(super) fn pose_at(&self, at: &Configuration<'_>, body: usize) -> Pose {
        match at.derived.get(12 * body..12 * body + 12) {
            Some(derived) => Pose {
                position: Vector3::from_column_slice(&derived[..3]),
                rotation: Matrix3::from_column_slice(&derived[3..]),
            },
            None => self.pose_of(at.q, body),
        }
    }

    /// `(v, Ω)` of a body.
    #[inline]
    pub(super) fn twist(&self, u: &[f64], body: usize) -> Twist {
        if self.planar {
            let u = &u[3 * body..3 * body + 3];
            return Twist::new(u[0], u[1], 0.0, 0.0, 0.0, u[2]);
        }
        Twist::from_column_slice(&u[6 * body..6 * body + 6])
    }

    /// Writes a body's velocities, or what is dual to them.
    #[inline]
    pub(super) fn set_twist(&self, u: &mut [f64], body: usize, twist: &Twist) {
        if self.planar {
            u[3 * body..3 * body + 3].copy_from_slice(&[twist[0], twist[1], twist[5]]);
        } else {
            u[6 * body..6 * body + 6].copy_from_slice(twist.as_slice());
        }
    }

    /// Angular momentum `R J Ω` of a body about its centre of mass, in the world's axes.
    pub(super) fn spin(&self, q: &[f64], u: &[f64], body: usize) -> Vector3<f64> {
        self.pose_of(q, body).rotation
            * (self.inertial[body].inertia * angular(&self.twist(u, body)))
    }

    /// `Ω` with `J Ω = exp(−½Δt Ω) Π` by Newton's method.
    ///
    /// # Errors
    ///
    /// [`SystemError::Rotation`] where that does not converge, or to another motion: the body turns too far in a step.
    pub(super) fn end_rate(
        &self,
        body: usize,
        start: &Vector3<f64>,
        half: f64,
    ) -> Result<Vector3<f64>, SystemError> {
        let inertia = &self.inertial[body].inertia;
        let momentum = inertia * start;
        let too_far = SystemError::Rotation { body, angle: 2.0 * half * start.norm() };
        let mut omega = *start;
        for _ in 0..MOST_ITERATIONS {
            let angle = omega * half;
            let turned = turned_back(&angle, &momentum);
            let defect = turned - inertia * omega;
            // Both terms are rounded, and so is the angle.
            let size = momentum.norm() * (1.0 + angle.norm()) + inertia.norm() * omega.norm();
            if defect.amax() <= CONVERGED * size {
                let steady = (omega - start).norm() * half <= STEADY;
                let followed = steady || angle.norm() <= FRAC_PI_2;
                return if followed { Ok(omega) } else { Err(too_far) };
            }
            let slope = inertia - turned.cross_matrix() * differential(&-angle) * half;
            let Some(step) = slope.lu().solve(&defect) else { break };
            omega += step;
        }
        Err(too_far)
    }

    /// How large that becomes which depends on time, seen from these coordinates.
    pub(super) fn extents_in_time(&self, q: &[f64], t_end: f64) -> TimeDependence {
        let mut found = TimeDependence::none(self.blocks.velocities(), self.contacts.len());
        let width = self.size;
        // The places of a body's force and torque among its velocities.
        let places = if self.planar { [[0, 1, 1], [2, 2, 2]] } else { [[0, 1, 2], [3, 4, 5]] };
        let mut add = |body: usize, kind: usize, component: usize, size: f64, impulse: f64| {
            let place = width * body + places[kind][component];
            found.forces[place] += size;
            found.impulses[place] += impulse;
        };
        for TimedLoad { body, force, torque } in &self.timed_loads {
            for (kind, load) in [force, torque].into_iter().enumerate() {
                let extents = load.extents(Derivative::Value, t_end);
                // Torques are given in the world's axes, and may be about any of the body's.
                let turned = kind == 1 && !self.planar;
                for component in 0..3 {
                    let own = if turned { &extents[..] } else { &extents[component..=component] };
                    let size = own.iter().map(|extent| extent.size).sum();
                    let impulse = own.iter().map(Extent::reach).sum();
                    add(*body, kind, component, size, impulse);
                }
            }
        }
        for spring in &self.springs {
            let [length] = spring.length.extents(Derivative::Value, t_end);
            let ends = [(Some(spring.body), spring.point), (spring.other, spring.other_point)];
            for (body, point) in ends {
                let Some(body) = body else { continue };
                for (kind, arm) in [1.0, Vector3::from(point).norm()].into_iter().enumerate() {
                    let share = spring.stiffness * arm;
                    for component in 0..3 {
                        add(body, kind, component, share * length.size, share * length.reach());
                    }
                }
            }
        }
        for (i, contact) in self.contacts.iter().enumerate() {
            let poses = contact.poses(|body| self.pose_of(q, body));
            let extents = contact.extents(&poses, t_end);
            [found.gaps[i], found.velocities[i]] = extents.unwrap_or_default();
        }
        found
    }

    /// Weight, loads, springs and prescribed normal forces, without gyroscopic terms.
    pub(super) fn loads(&self, at: &Configuration<'_>, u: &[f64], forces: &mut [f64]) {
        for (body, inertial) in self.inertial.iter().enumerate() {
            let force = self.gravity * inertial.mass + inertial.force;
            let load = if inertial.torque == Vector3::zeros() {
                twist(&force, &inertial.torque)
            } else {
                self.pose_at(at, body).wrench(&force, &inertial.torque)
            };
            self.set_twist(forces, body, &load);
        }
        let mut add = |body: usize, load: Twist| {
            let sum = self.twist(forces, body) + load;
            self.set_twist(forces, body, &sum);
        };
        let (pose, moment) = (|body| self.pose_at(at, body), at.moment());
        for TimedLoad { body, force, torque } in &self.timed_loads {
            let [force, torque] = [force, torque].map(|load| load.value(moment).into());
            add(*body, pose(*body).wrench(&force, &torque));
        }
        for spring in &self.springs {
            spring.load(moment, pose, |body| self.twist(u, body), &mut add);
        }
        for &i in &self.prescribed {
            let contact = &self.contacts[i];
            let force = self.laws[i].normal_force().prescribed().unwrap_or(0.0);
            let poses = contact.poses(pose);
            let geometry = contact.geometry(moment, &poses);
            let push = geometry.normal * force;
            add(contact.body, poses.first.pushed(&geometry.point, &push));
            if let (Some(body), Some(second)) = (contact.other, &poses.second) {
                add(body, second.pushed(&geometry.point, &-push));
            }
        }
    }
}

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
//! drift. (With Ω⁺ in the second half it would be explicit and of first order, and tops would gain
//! energy.) L is kept from step to step: recovered from Ω, its rounding would add up.
//!
//! Closed contacts are of first order: sticking makes γ vanish with the directions of `q_M`, whereas the
//! velocities act from one midpoint to the next, so that points of turning bodies creep with `½Δt dγ/dt`,
//! the rate without contact forces.
//!
//! The contact laws hold in Ω⁺ at `q_M`. In the world's axes `R_M Ω⁺` and `R_E Ω_E` differ by O(Δt) where
//! gyroscopic terms act, and so do the γ at the end and the γ_E of the laws; for isotropic inertia, for
//! planar bodies and at rest they are the same.

use nalgebra::{Matrix3, Vector3};

use super::rotation::{matrix, turned, turned_back};
use super::{Pose, RigidBodies, Twist, angular, linear, twist};

/// How far a momentum may be off that of its state, as a part: `R J J⁻¹ Rᵀ L` is L to a few roundings.
const SAME_SPIN: f64 = 1e-12;

/// The bodies at the midpoint of a step.
#[derive(Debug)]
pub(crate) struct Middle {
    pub(crate) q: Vec<f64>,
    pub(crate) poses: Vec<Pose>,
    /// Velocities before the step.
    pub(crate) before: Vec<Twist>,
    /// Velocities without contact forces, then with their percussions.
    pub(crate) free: Vec<Twist>,
}

impl RigidBodies {
    /// Place and attitude of a body.
    #[inline]
    pub fn pose(&self, q: &[f64], body: usize) -> Pose {
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

    /// `(v, Ω)` of a body.
    #[inline]
    pub(crate) fn twist(&self, u: &[f64], body: usize) -> Twist {
        if self.planar {
            let u = &u[3 * body..3 * body + 3];
            return Twist::new(u[0], u[1], 0.0, 0.0, 0.0, u[2]);
        }
        Twist::from_column_slice(&u[6 * body..6 * body + 6])
    }

    /// Writes a body's velocities, or what is dual to them.
    #[inline]
    pub(crate) fn set_twist(&self, u: &mut [f64], body: usize, twist: &Twist) {
        if self.planar {
            u[3 * body..3 * body + 3].copy_from_slice(&[twist[0], twist[1], twist[5]]);
        } else {
            u[6 * body..6 * body + 6].copy_from_slice(twist.as_slice());
        }
    }

    /// `q ⊕ dt u` of one body.
    #[inline]
    pub(super) fn advance_body(&self, q: &[f64], u: &[f64], body: usize, dt: f64, out: &mut [f64]) {
        let ((n, _), twist) = (self.sizes(), self.twist(u, body));
        let (q, out) = (&q[n * body..n * (body + 1)], &mut out[n * body..n * (body + 1)]);
        out[0] = q[0] + dt * twist[0];
        out[1] = q[1] + dt * twist[1];
        if self.planar {
            out[2] = q[2] + dt * twist[5];
            return;
        }
        out[2] = q[2] + dt * twist[2];
        let (omega, attitude) = (angular(&twist), [q[3], q[4], q[5], q[6]]);
        // What does not turn keeps its attitude to the bit.
        let turns = omega.amax() > 0.0;
        let end = if turns { turned(&attitude, &(omega * dt)) } else { attitude };
        out[3..].copy_from_slice(&end);
    }

    /// Angular momentum `R J Ω` of a body about its centre of mass, in the world's axes.
    pub(crate) fn spin(&self, q: &[f64], u: &[f64], body: usize) -> Vector3<f64> {
        self.pose(q, body).rotation * (self.inertial[body].inertia * angular(&self.twist(u, body)))
    }

    /// Whether a momentum is that of a body in a state, to rounding. Bodies of equal moments keep none.
    pub(crate) fn has_spin(
        &self,
        (q, u): (&[f64], &[f64]),
        body: usize,
        momentum: [f64; 3],
    ) -> bool {
        let (found, given) = (self.spin(q, u, body), Vector3::from(momentum));
        self.inertial[body].isotropic || (found - given).amax() <= SAME_SPIN * given.amax()
    }

    /// The first half of the step: where the bodies are at the midpoint, and their velocities there
    /// before the step and without contact forces.
    pub(crate) fn start(
        &self,
        (q, u, spins): (&[f64], &[f64], &[Vector3<f64>]),
        dt: f64,
        middle: &mut Middle,
    ) {
        let Middle { q: mid, poses, before, free } = middle;
        for (body, inertial) in self.inertial.iter().enumerate() {
            self.advance_body(q, u, body, 0.5 * dt, mid);
            let pose = self.pose(mid, body);
            let mut start = self.twist(u, body);
            if !inertial.isotropic {
                let momentum = pose.rotation.tr_mul(&spins[body]);
                start = twist(&linear(&start), &inertial.rate(&momentum));
            }
            poses[body] = pose;
            before[body] = start;
            free[body] = start + self.response(body, &self.weight(body, &pose)) * dt;
        }
        let mut add = |body: usize, load: Twist| free[body] += self.response(body, &load) * dt;
        self.couplings(|body| poses[body], u, &mut add);
    }

    /// `M⁻¹` times what is dual to a twist.
    #[inline]
    pub(crate) fn response(&self, body: usize, wrench: &Twist) -> Twist {
        let inertial = &self.inertial[body];
        let torque = angular(wrench);
        let turning = if inertial.isotropic {
            torque * inertial.inverse_inertia.m11
        } else {
            inertial.inverse_inertia * torque
        };
        twist(&(linear(wrench) * inertial.inverse_mass), &turning)
    }

    /// The second half of the step: coordinates and velocities at the end, once the percussions are in the
    /// velocities `free`. Takes `L` along.
    pub(crate) fn finish(
        &self,
        middle: &Middle,
        spins: &mut [Vector3<f64>],
        half: f64,
        (q, u): (&mut [f64], &mut [f64]),
    ) {
        let Middle { q: mid, poses, before, free: after } = middle;
        for (body, (inertial, after)) in self.inertial.iter().zip(after).enumerate() {
            if inertial.isotropic {
                self.set_twist(u, body, after);
                self.advance_body(mid, u, body, half, q);
                continue;
            }
            let change = inertial.inertia * (angular(after) - angular(&before[body]));
            spins[body] += poses[body].rotation * change;
            let omega = self.end_rate(body, &angular(after), half);
            self.set_twist(u, body, &twist(&linear(after), &omega));
            self.advance_body(mid, u, body, half, q);
            // Momentum is kept whatever the iteration has left over.
            let momentum = self.pose(q, body).rotation.tr_mul(&spins[body]);
            self.set_twist(u, body, &twist(&linear(after), &inertial.rate(&momentum)));
        }
    }

    /// `Ω` with `J Ω = exp(−½Δt Ω) Π` by Newton's method without the terms of second order.
    fn end_rate(&self, body: usize, start: &Vector3<f64>, half: f64) -> Vector3<f64> {
        let inertia = &self.inertial[body].inertia;
        let momentum = inertia * start;
        let mut omega = *start;
        for _ in 0..20 {
            let turned = turned_back(&(omega * half), &momentum);
            let defect = turned - inertia * omega;
            if !(defect.amax() > 4.0 * f64::EPSILON * momentum.amax()) {
                break;
            }
            let slope = inertia - turned.cross_matrix() * half;
            omega += slope.lu().solve(&defect).unwrap_or(defect * 0.0);
        }
        omega
    }

    /// Weight and constant loads of a body.
    #[inline]
    pub(super) fn weight(&self, body: usize, pose: &Pose) -> Twist {
        let inertial = &self.inertial[body];
        let force = self.gravity * inertial.mass + inertial.force;
        if inertial.torque == Vector3::zeros() {
            return twist(&force, &inertial.torque);
        }
        pose.wrench(&force, &inertial.torque)
    }

    /// Springs and prescribed normal forces.
    pub(super) fn couplings(
        &self,
        pose: impl Fn(usize) -> Pose,
        u: &[f64],
        add: &mut impl FnMut(usize, Twist),
    ) {
        for spring in &self.springs {
            spring.load(&pose, |body| self.twist(u, body), add);
        }
        for &i in &self.prescribed {
            let contact = &self.contacts[i];
            let force = self.laws[i].normal_force.unwrap_or(0.0);
            let poses = (pose(contact.body), contact.other.map(&pose));
            let geometry = contact.geometry(&poses.0, poses.1.as_ref());
            let (mut own, mut other) = ([Twist::zeros()], [Twist::zeros()]);
            let at = (&poses.0, poses.1.as_ref());
            contact.rows_of(&geometry, at, (true, 0), (&mut own, &mut other), &mut [0.0]);
            add(contact.body, own[0] * force);
            if let Some(body) = contact.other {
                add(body, other[0] * force);
            }
        }
    }
}

//! What a contact's velocities change by on the way from one midpoint to the next.
//!
//! The velocities `u` after a step move the bodies from its midpoint to the next one, so that it is this way, the chord
//! of the contact's motion, on which the laws have to hold. In the velocities that are wanted the chord is linear but
//! for the rotations. About velocities `ũ` that leave Ω as it was before the step
//!
//! `D(u)/Δt ≈ W(q_M)ᵀu + χ + c`, `c = D(ũ)/Δt − W(q_M)ᵀũ − χ`,
//!
//! with D the displacement of what touches along the rows: one step of Newton's method for the constraint of SHAKE,
//! whose forces act along the rows at `q_M` while the constraint is met at the next midpoint. What Ω changes by in a
//! step is O(Δt), the defect of D is O(Δt³), and points that stick creep with O(Δt²): not at all while Ω stays the same
//! in the body's axes, as where a turntable carries the body. Velocities of centres of mass cancel in `c`, but for the
//! gap to a plane that tips or between spheres.
//!
//! **Points.** D is the displacement of the point of the first body less that of the material of the second one, or of
//! the surface, that is in the same place at `q_M`; along the normal it is the difference of the gaps.
//!
//! **Spheres.** The centre moves like a point. The contact point wanders over both bodies: with `r` from it to the
//! centre, slip is the velocity of the centre less `ω₁ × r` and less that of the second surface. On a plane that does
//! not move the mean of this is the chord of the centre less `ω₁ × r`. On one that turns with `ω₂` the point wanders
//! with `v = (ω₁ − ω₂) × r` while it does not slip and `r` turns with the plane, so that half of
//! `ω₂ × v + (ω₁ − ω₂) × (ω₂ × r)` comes off for every second of the step. Between two spheres of radii `R₁`, `R₂` the
//! normal turns, without slip, with `(R₁ω₁ + R₂ω₂)/(R₁ + R₂)`.
//!
//! **Drilling.** `n·(ω₁ − ω₂)` changes as the normal turns.

use nalgebra::Vector3;

use super::contact::{Contact, Touching, direction};
use super::pose::{Pose, Twist, angular, linear};
use super::rigid_bodies::RigidBodies;
use super::surface::{PredictedSurface, Surface};
use crate::system::rotation::Turn;
use crate::system::{Midpoint, Moment};

/// Radians per step up to which a rotation is followed; beyond, the chord has little to do with the velocity.
const LARGEST_TURN: f64 = 1.0;

/// How a body moves on with the velocities before the step, in the world's axes.
pub(super) struct PredictedBody {
    pose: Pose,
    velocity: Vector3<f64>,
    omega: Vector3<f64>,
    /// Difference between `omega` and the velocity at the midpoint that ends up as `omega`, by gyroscopic terms.
    gyroscopic: Vector3<f64>,
    turn: Turn,
}

impl PredictedBody {
    /// What the mean velocity of a point is above the present one, the arm from the centre of mass to it given.
    fn bend(&self, arm: &Vector3<f64>, dt: f64) -> Vector3<f64> {
        self.turn.chord(arm) / dt - self.omega.cross(arm)
    }

    /// The mean velocity of a point.
    fn mean(&self, arm: &Vector3<f64>, dt: f64) -> Vector3<f64> {
        self.velocity + self.turn.chord(arm) / dt
    }
}

/// The corrections `c` of all rows of a contact: along its normal, along tangential directions and about the normal.
#[derive(Default)]
pub(super) struct Bend {
    pub(super) normal: f64,
    pub(super) tangential: Vector3<f64>,
    pub(super) drilling: f64,
}

impl RigidBodies {
    /// The predicted motion of a body that has the velocities `u` before the step.
    pub(super) fn predicted(
        &self,
        midpoint: &Midpoint,
        u: &[f64],
        body: usize,
        dt: f64,
    ) -> PredictedBody {
        let (pose, twist) = (self.pose_at(&midpoint.configuration(), body), self.twist(u, body));
        let (inertial, rate) = (&self.inertial[body], angular(&twist));
        let omega = pose.rotation * rate;
        let gyroscopic = if inertial.isotropic {
            Vector3::zeros()
        } else {
            // J Ω⁺ = exp(½Δt Ω) J Ω, the inverse of what `end_rate` solves.
            let momentum = inertial.inertia * rate;
            let change = Turn::new(&(rate * (0.5 * dt))).chord(&momentum);
            pose.rotation * (inertial.inverse_inertia * change)
        };
        let turn = Turn::new(&(omega * dt));
        PredictedBody { pose, velocity: linear(&twist), omega, gyroscopic, turn }
    }
}

impl Contact {
    /// Whether bodies turn in a step, by more than rounding and not too far to be followed, or a surface changes its velocity;
    /// from the velocities of both bodies before the step.
    pub(super) fn bends(&self, first: &Twist, second: &Twist, dt: f64) -> bool {
        let (own, moves) = match &self.touching {
            Touching::Plane { surface, timed, .. } => (surface.spin.abs(), timed.is_some()),
            Touching::Spheres { radii, .. } => {
                ((linear(first) - linear(second)).norm() / (radii[0] + radii[1]), false)
            }
        };
        let rate = angular(first).norm_squared().max(angular(second).norm_squared()).sqrt();
        let turn = dt * own.max(rate);
        (moves || turn > f64::EPSILON) && turn <= LARGEST_TURN
    }

    /// The corrections of its rows.
    pub(super) fn bend(
        &self,
        t: f64,
        first: &PredictedBody,
        second: Option<&PredictedBody>,
        dt: f64,
    ) -> Bend {
        match &self.touching {
            Touching::Plane { point, radius, surface, timed } => {
                let arm = first.pose.rotation * point;
                let surface = match timed {
                    None => *surface,
                    Some(timed) => timed.at(surface, Moment::new(t)),
                };
                let predicted = match timed {
                    None => surface.predicted(dt),
                    Some(timed) => timed.predicted(&surface, t, dt),
                };
                match second {
                    None => on_plane(&arm, *radius, &surface, &predicted, first, None, dt),
                    Some(second) => {
                        let predicted = predicted.at(&second.pose.rotation);
                        let surface = surface.at(&second.pose);
                        on_plane(&arm, *radius, &surface, &predicted, first, Some(second), dt)
                    }
                }
            }
            Touching::Spheres { centres, radii } => match second {
                Some(second) => between_spheres(centres, radii, first, second, dt),
                None => Bend::default(),
            },
        }
    }
}

fn on_plane(
    arm: &Vector3<f64>,
    radius: f64,
    surface: &Surface,
    predicted: &PredictedSurface,
    first: &PredictedBody,
    second: Option<&PredictedBody>,
    dt: f64,
) -> Bend {
    let centre = first.pose.position + arm;
    let normal = surface.normal;
    let away = normal * radius;
    let point = centre - away;
    // The material of the surface moves within its plane, and is carried along with it.
    let (velocity, _) = surface.material_velocity(&point);
    let way = surface.way(&point, predicted) / dt;
    let carried = second.map_or(Vector3::zeros(), |second| second.turn.chord(&way));
    let mut tangential = first.bend(arm, dt) - first.gyroscopic.cross(&(arm - away));
    let mut bend = Bend {
        normal: normal.dot(&(first.bend(arm, dt) - first.gyroscopic.cross(arm))),
        tangential: Vector3::zeros(),
        drilling: -normal.dot(&first.gyroscopic),
    };
    tangential -= way - velocity + carried;
    let mut spin = normal * surface.spin;
    // The way of the centre, over the time, as it shows in the plane.
    let mut relative = first.mean(arm, dt);
    if let Some(second) = second {
        let other = centre - second.pose.position;
        let own = second.bend(&other, dt);
        tangential -= own - second.gyroscopic.cross(&(other - away));
        // The gap is measured along the normal at the end.
        relative -= second.mean(&other, dt);
        let tipped = second.turn.inverse().chord(&relative);
        relative += tipped;
        bend.normal += normal.dot(&(tipped - own + second.gyroscopic.cross(&other)));
        let rolling = second.omega.cross(&normal).dot(&first.omega);
        bend.drilling += normal.dot(&second.gyroscopic) + 0.5 * dt * rolling;
        spin += second.omega;
    }
    bend.drilling -= predicted.angle / dt - surface.spin;
    if let (Some(plane), Some([shift, turning])) = (&predicted.plane, &surface.motion) {
        let from = centre - surface.point;
        let own = plane.way(&from) / dt;
        relative -= own;
        let tipped = plane.rotation.tr_mul(&relative) - relative;
        bend.normal += normal.dot(&(tipped - own + shift + turning.cross(&from)));
        let rolling = turning.cross(&normal).dot(&first.omega);
        bend.drilling += 0.5 * dt * rolling - normal.dot(&(plane.angle() / dt - turning));
        spin += turning;
    }
    if radius > 0.0 {
        let relative = first.omega - spin;
        let wandering = spin.cross(&relative.cross(&away)) + relative.cross(&spin.cross(&away));
        tangential -= wandering * (0.5 * dt);
    }
    bend.tangential = tangential;
    bend
}

fn between_spheres(
    centres: &[Vector3<f64>; 2],
    radii: &[f64; 2],
    first: &PredictedBody,
    second: &PredictedBody,
    dt: f64,
) -> Bend {
    let arms = [first.pose.rotation * centres[0], second.pose.rotation * centres[1]];
    let apart = first.pose.position + arms[0] - (second.pose.position + arms[1]);
    let (normal, distance) = direction(apart);
    // The contact point halves the gap.
    let half = 0.5 * (distance - radii[0] - radii[1]);
    let [a, b] = radii.map(|radius| radius + half);
    let turning = (first.omega * a + second.omega * b) / distance;
    let between = normal * distance;
    let bent = first.bend(&arms[0], dt) - second.bend(&arms[1], dt);
    let gyroscopic = first.gyroscopic.cross(&arms[0]) - second.gyroscopic.cross(&arms[1]);
    let rolled = Turn::new(&(turning * dt)).chord(&between) / dt - turning.cross(&between);
    let spun = (first.gyroscopic * a + second.gyroscopic * b).cross(&normal);
    // ‖apart + D‖ − ‖apart‖ − n·D, without their difference.
    let way = (first.mean(&arms[0], dt) - second.mean(&arms[1], dt)) * dt;
    let (along, square) = (normal.dot(&way), way.norm_squared());
    let end = (apart + way).norm();
    let longer = (2.0 * distance * along + square) / (end + distance);
    let beside = (square - along * longer) / (end + distance);
    let relative = first.omega - second.omega;
    Bend {
        normal: normal.dot(&(bent - gyroscopic)) + beside / dt,
        tangential: bent - gyroscopic - rolled + spun,
        drilling: 0.5 * dt * turning.cross(&normal).dot(&relative)
            - normal.dot(&(first.gyroscopic - second.gyroscopic)),
    }
}

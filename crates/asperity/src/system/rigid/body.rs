//! Rigid bodies as they are given, and what the equations of motion need of them.

use nalgebra::{Matrix3, Vector3};

use crate::argument::{ArgumentError, finite, positive, refuse};
use crate::system::TimeFunction;
use crate::system::rotation::unit;

/// A rigid body in space, described about its centre of mass, with its initial state.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Mass in kg.
    pub mass: f64,
    /// Inertia tensor in kg m² about the centre of mass, in the body's axes, row by row.
    pub inertia: [[f64; 3]; 3],
    /// Centre of mass in m.
    pub position: [f64; 3],
    /// Quaternion `(w, x, y, z)` from the body's axes to those of the world; of any length but zero.
    pub orientation: [f64; 4],
    /// Velocity of the centre of mass in m/s.
    pub velocity: [f64; 3],
    /// Angular velocity Ω in rad/s in the body's axes.
    pub angular_velocity: [f64; 3],
    /// Force in N at the centre of mass, in the axes of the world.
    pub force: TimeFunction<3>,
    /// Torque in N m in the axes of the world.
    pub torque: TimeFunction<3>,
}

impl Body {
    /// A body at rest at the origin with principal moments of inertia along its axes.
    pub fn new(mass: f64, moments: [f64; 3]) -> Self {
        let [a, b, c] = moments;
        Self {
            mass,
            inertia: [[a, 0.0, 0.0], [0.0, b, 0.0], [0.0, 0.0, c]],
            position: [0.0; 3],
            orientation: [1.0, 0.0, 0.0, 0.0],
            velocity: [0.0; 3],
            angular_velocity: [0.0; 3],
            force: TimeFunction::ZERO,
            torque: TimeFunction::ZERO,
        }
    }

    /// A homogeneous ball.
    pub fn ball(mass: f64, radius: f64) -> Self {
        Self::new(mass, [0.4 * mass * radius * radius; 3])
    }

    /// A homogeneous box.
    pub fn cuboid(mass: f64, half_sizes: [f64; 3]) -> Self {
        let [a, b, c] = half_sizes.map(|h| h * h);
        Self::new(mass, [b + c, a + c, a + b].map(|sum| mass * sum / 3.0))
    }
}

/// A rigid body of the plane `z = 0`, described about its centre of mass, with its initial state.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanarBody {
    /// Mass in kg.
    pub mass: f64,
    /// Moment of inertia in kg m² about the centre of mass.
    pub inertia: f64,
    /// Centre of mass in m.
    pub position: [f64; 2],
    /// Angle in rad.
    pub angle: f64,
    /// Velocity of the centre of mass in m/s.
    pub velocity: [f64; 2],
    /// Angular velocity in rad/s.
    pub angular_velocity: f64,
    /// Force in N at the centre of mass.
    pub force: TimeFunction<2>,
    /// Torque in N m.
    pub torque: TimeFunction<1>,
}

impl PlanarBody {
    /// A body at rest at the origin.
    pub fn new(mass: f64, inertia: f64) -> Self {
        Self {
            mass,
            inertia,
            position: [0.0; 2],
            angle: 0.0,
            velocity: [0.0; 2],
            angular_velocity: 0.0,
            force: TimeFunction::ZERO,
            torque: TimeFunction::ZERO,
        }
    }
}

/// Bodies that all move in space or all in one plane.
#[derive(Debug, Clone, PartialEq)]
pub enum Bodies {
    /// In the plane `z = 0`: coordinates `(x, y, φ)`, velocities `(ẋ, ẏ, φ̇)`.
    Planar(Vec<PlanarBody>),
    /// In space: coordinates `(x, y, z, w, x, y, z)`, velocities `(v, Ω)`, Ω in the body's axes.
    Spatial(Vec<Body>),
}

impl From<Vec<PlanarBody>> for Bodies {
    fn from(bodies: Vec<PlanarBody>) -> Self {
        Self::Planar(bodies)
    }
}

impl From<Vec<Body>> for Bodies {
    fn from(bodies: Vec<Body>) -> Self {
        Self::Spatial(bodies)
    }
}

/// Mass and loads of a body. A planar body is one of space that only turns about z: its inertia is taken as isotropic.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Inertial {
    pub(super) mass: f64,
    pub(super) inverse_mass: f64,
    pub(super) inertia: Matrix3<f64>,
    pub(super) inverse_inertia: Matrix3<f64>,
    /// Whether the inertia is a multiple of the identity: Ω is then constant in free flight.
    pub(super) isotropic: bool,
    /// Constant force without the weight, and constant torque.
    pub(super) force: Vector3<f64>,
    pub(super) torque: Vector3<f64>,
}

/// Force and torque of a body that depend on time.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TimedLoad {
    pub(super) body: usize,
    pub(super) force: TimeFunction<3>,
    pub(super) torque: TimeFunction<3>,
}

impl TimedLoad {
    /// The loads as far as they are not constant, if any is.
    fn new(body: usize, force: TimeFunction<3>, torque: TimeFunction<3>) -> Option<Self> {
        if force.constant().is_some() && torque.constant().is_some() {
            return None;
        }
        let timed = |load: TimeFunction<3>| match load.constant() {
            Some(_) => TimeFunction::ZERO,
            None => load,
        };
        Some(Self { body, force: timed(force), torque: timed(torque) })
    }
}

impl Inertial {
    fn new(
        mass: f64,
        inertia: Matrix3<f64>,
        force: &TimeFunction<3>,
        torque: &TimeFunction<3>,
    ) -> Result<Self, ArgumentError> {
        positive("mass", mass)?;
        let inverse_inertia = inverse(&inertia)?;
        Ok(Self {
            mass,
            inverse_mass: 1.0 / mass,
            inertia,
            inverse_inertia,
            isotropic: inertia == Matrix3::identity() * inertia.m11,
            force: force.constant().unwrap_or_default().into(),
            torque: torque.constant().unwrap_or_default().into(),
        })
    }

    /// `Ω = J⁻¹ Π`, refined so that `J Ω` gives Π back but for rounding.
    #[inline]
    pub(super) fn rate(&self, momentum: &Vector3<f64>) -> Vector3<f64> {
        let rate = self.inverse_inertia * momentum;
        rate + self.inverse_inertia * (momentum - self.inertia * rate)
    }
}

/// Bodies taken apart: mass and loads, initial coordinates, initial velocities.
#[derive(Debug, Default)]
pub(super) struct Parts {
    pub(super) inertial: Vec<Inertial>,
    pub(super) timed_loads: Vec<TimedLoad>,
    pub(super) q0: Vec<f64>,
    pub(super) u0: Vec<f64>,
}

impl Bodies {
    pub(super) fn parts(&self) -> Result<Parts, ArgumentError> {
        let mut parts = Parts::default();
        let count = match self {
            Self::Planar(bodies) => bodies.len(),
            Self::Spatial(bodies) => bodies.len(),
        };
        for i in 0..count {
            let inertial = match self {
                Self::Planar(bodies) => planar(&bodies[i], &mut parts),
                Self::Spatial(bodies) => spatial(&bodies[i], &mut parts),
            };
            parts.inertial.push(inertial.map_err(|error| error.within("body", i))?);
        }
        Ok(parts)
    }
}

fn planar(body: &PlanarBody, parts: &mut Parts) -> Result<Inertial, ArgumentError> {
    finite("position", &body.position)?;
    finite("angle", &[body.angle])?;
    finite("velocity", &body.velocity)?;
    finite("angular_velocity", &[body.angular_velocity])?;
    parts.q0.extend([body.position[0], body.position[1], body.angle]);
    parts.u0.extend([body.velocity[0], body.velocity[1], body.angular_velocity]);
    let inertia = Matrix3::identity() * body.inertia;
    body.force.check("force")?;
    body.torque.check("torque")?;
    let (force, torque) = (body.force.spread([0, 1]), body.torque.spread([2]));
    let inertial = Inertial::new(body.mass, inertia, &force, &torque)?;
    parts.timed_loads.extend(TimedLoad::new(parts.inertial.len(), force, torque));
    Ok(inertial)
}

fn spatial(body: &Body, parts: &mut Parts) -> Result<Inertial, ArgumentError> {
    finite("position", &body.position)?;
    finite("orientation", &body.orientation)?;
    finite("velocity", &body.velocity)?;
    finite("angular_velocity", &body.angular_velocity)?;
    let Some(orientation) = unit(body.orientation) else {
        return refuse("orientation", "must not be a quaternion (w, x, y, z) of length zero");
    };
    parts.q0.extend(body.position);
    parts.q0.extend(orientation);
    parts.u0.extend(body.velocity);
    parts.u0.extend(body.angular_velocity);
    let inertia = symmetric(&Matrix3::from_fn(|i, j| body.inertia[i][j]))?;
    body.force.check("force")?;
    body.torque.check("torque")?;
    let (force, torque) = (body.force.clone(), body.torque.clone());
    let inertial = Inertial::new(body.mass, inertia, &force, &torque)?;
    parts.timed_loads.extend(TimedLoad::new(parts.inertial.len(), force, torque));
    Ok(inertial)
}

/// The symmetric part of what is symmetric but for rounding, as tensors in turned axes are.
fn symmetric(inertia: &Matrix3<f64>) -> Result<Matrix3<f64>, ArgumentError> {
    finite("inertia", inertia.as_slice())?;
    if (inertia - inertia.transpose()).amax() > 1e-12 * inertia.amax() {
        return refuse("inertia", "must be symmetric");
    }
    Ok((inertia + inertia.transpose()) * 0.5)
}

/// Inverse of an inertia tensor that some body can have.
fn inverse(inertia: &Matrix3<f64>) -> Result<Matrix3<f64>, ArgumentError> {
    let refuse = |message: String| refuse("inertia", message);
    finite("inertia", inertia.as_slice())?;
    let mut moments: [f64; 3] = inertia.symmetric_eigenvalues().into();
    moments.sort_by(f64::total_cmp);
    let [a, b, c] = moments;
    if !(a > 0.0) {
        return refuse(format!("must be positive definite, has the principal moment {a}"));
    }
    if a + b < c * (1.0 - 1e-9) {
        return refuse(format!(
            "must be that of a body, but its largest principal moment {c} exceeds the sum of the others"
        ));
    }
    match inertia.try_inverse() {
        Some(inverse) => Ok(inverse),
        None => refuse("must be invertible".into()),
    }
}

//! Planes that bodies touch, and the directions that anisotropic friction refers to.

use std::fmt;
use std::sync::Arc;

use nalgebra::Vector3;

use super::body::check;
use super::rotation::Turn;
use crate::system::SystemError;

/// A plane, fixed to the world or to a body; bodies are on the side that its normal points to.
///
/// Its material may move within it, as a belt with `velocity` or as a turntable with `spin`. The plane
/// and its axes stay where they are: grooves that turn with a table need a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// A point of the plane in m, and the centre of the spin.
    pub point: [f64; 3],
    /// Normal, of any length but zero.
    pub normal: [f64; 3],
    /// Direction of `e₁`, projected onto the plane; `e₂ = n × e₁`.
    pub axis: [f64; 3],
    /// Velocity of the material in m/s along `e₁`, `e₂`.
    pub velocity: [f64; 2],
    /// Angular velocity of the material in rad/s about the normal through `point`.
    pub spin: f64,
    /// The body that the plane is fixed to, in whose axes it is given then.
    pub body: Option<usize>,
}

impl Plane {
    /// The plane through `point` with this normal and axis, at rest in the world.
    pub fn new(point: [f64; 3], normal: [f64; 3], axis: [f64; 3]) -> Self {
        Self { point, normal, axis, velocity: [0.0; 2], spin: 0.0, body: None }
    }

    /// The plane `z = 0` with `e₁` along x.
    pub fn floor() -> Self {
        Self::new([0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0])
    }

    /// A line of planar systems; `e₁` is its normal turned clockwise, along x for a normal along y.
    pub fn line(point: [f64; 2], normal: [f64; 2]) -> Self {
        let [x, y] = normal;
        Self::new([point[0], point[1], 0.0], [x, y, 0.0], [y, -x, 0.0])
    }
}

/// What fixes the direction `e₁` in the contact plane; `e₂ = n × e₁`. Planar systems need none.
#[derive(Clone)]
#[non_exhaustive]
pub enum Frame {
    /// The plane's axis.
    Plane,
    /// An axis fixed to the (first) body, projected onto the contact plane. Where it is parallel to the
    /// normal the plane's axis takes its place, between spheres some direction across the normal.
    Body {
        /// The axis, of any length but zero.
        axis: [f64; 3],
    },
    /// Away from the plane's point: across grooves that circle it.
    Polar,
    /// The angle in rad from the plane's axis, over the position in the plane's axes from its point.
    Field(Field),
}

/// Angle of `e₁` over the position in the plane.
pub type Field = Arc<dyn Fn([f64; 2]) -> f64 + Send + Sync>;

impl fmt::Debug for Frame {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Plane => f.write_str("Plane"),
            Self::Body { axis } => f.debug_struct("Body").field("axis", axis).finish(),
            Self::Polar => f.write_str("Polar"),
            Self::Field(_) => f.write_str("Field(..)"),
        }
    }
}

impl PartialEq for Frame {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Plane, Self::Plane) | (Self::Polar, Self::Polar) => true,
            (Self::Body { axis: a }, Self::Body { axis: b }) => a == b,
            (Self::Field(a), Self::Field(b)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }
}

/// A plane with orthonormal axes, in the coordinates of what it is fixed to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Surface {
    pub(super) point: Vector3<f64>,
    pub(super) e1: Vector3<f64>,
    pub(super) e2: Vector3<f64>,
    pub(super) normal: Vector3<f64>,
    pub(super) velocity: [f64; 2],
    pub(super) spin: f64,
}

impl Surface {
    pub(super) fn new(plane: &Plane) -> Result<Self, SystemError> {
        check("point", &plane.point)?;
        check("velocity", &plane.velocity)?;
        check("spin", &[plane.spin])?;
        let normal = unit("normal", plane.normal)?;
        let axis = unit("axis", plane.axis)?;
        let e1 = tangent(&axis, &normal).ok_or_else(|| {
            SystemError::argument("axis", "must not be parallel to the plane's normal")
        })?;
        let Plane { velocity, spin, .. } = *plane;
        let e2 = normal.cross(&e1);
        Ok(Self { point: plane.point.into(), e1, e2, normal, velocity, spin })
    }

    /// The surface in the world, if what it is fixed to has this pose.
    #[inline]
    pub(super) fn at(&self, pose: &super::Pose) -> Self {
        Self {
            point: pose.point(&self.point),
            e1: pose.rotation * self.e1,
            e2: pose.rotation * self.e2,
            normal: pose.rotation * self.normal,
            ..*self
        }
    }

    /// Velocity of the material at a place `x` of the plane.
    #[inline]
    pub(super) fn material_velocity(&self, x: &Vector3<f64>) -> Vector3<f64> {
        let belt = self.e1 * self.velocity[0] + self.e2 * self.velocity[1];
        belt + self.normal.cross(&(x - self.point)) * self.spin
    }

    /// The way of material with this velocity in a time, within what the surface is fixed to: the velocity of what
    /// stays in the material turns with the spin.
    #[inline]
    pub(super) fn way(&self, velocity: &Vector3<f64>, dt: f64) -> Vector3<f64> {
        if self.spin == 0.0 {
            return velocity * dt;
        }
        Turn::new(&(self.normal * (self.spin * dt))).mean(velocity) * dt
    }
}

/// The unit vector along `vector`.
pub(super) fn unit(argument: &'static str, vector: [f64; 3]) -> Result<Vector3<f64>, SystemError> {
    check(argument, &vector)?;
    let vector = Vector3::from(vector);
    // Twice, so that neither tiny nor huge vectors lose digits.
    let scaled = vector / vector.amax();
    if vector.amax() > 0.0 && scaled.amax() > 0.0 {
        return Ok(scaled.normalize());
    }
    Err(SystemError::argument(argument, "must not be zero"))
}

/// The unit vector along the projection of `axis` onto the plane with this normal, if there is one.
#[inline]
pub(super) fn tangent(axis: &Vector3<f64>, normal: &Vector3<f64>) -> Option<Vector3<f64>> {
    let along = axis - normal * normal.dot(axis);
    let square = along.norm_squared();
    (square > 1e-24 * axis.norm_squared()).then(|| along / square.sqrt())
}

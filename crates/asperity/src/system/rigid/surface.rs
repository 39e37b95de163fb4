//! Planes that bodies touch, and the directions that anisotropic friction refers to.

use std::fmt;
use std::sync::Arc;

use nalgebra::{Matrix3, Rotation3, Vector3};

use super::plane_motion::{PlacedMotion, PlaneMotion};
use crate::argument::{ArgumentError, finite, refuse};
use crate::system::friction_map::{Field, FrictionMap};
use crate::system::rotation::Turn;
use crate::system::time_function::Extent;
use crate::system::{Break, Derivative, Moment, TimeFunction};

/// A plane, fixed to the world or to a body; bodies are on the side that its normal points to.
///
/// Its material may move within it, as a belt with `velocity` or as a turntable with `spin`, while the plane and its
/// axes stay where they are. With a `motion` the plane itself moves, with its axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Plane {
    /// A point of the plane in m, and the centre of the spin.
    pub point: [f64; 3],
    /// Normal, of any length but zero.
    pub normal: [f64; 3],
    /// Direction of `e₁`, projected onto the plane; `e₂ = n × e₁`.
    pub axis: [f64; 3],
    /// Velocity of the material in m/s along `e₁`, `e₂`.
    pub velocity: TimeFunction<2>,
    /// Angular velocity of the material in rad/s about the normal through `point`.
    pub spin: TimeFunction<1>,
    /// How the plane moves in the axes in which it is given, if it does.
    pub motion: Option<PlaneMotion>,
    /// By what factor friction depends on the place, if it does.
    pub friction: Option<Arc<FrictionMap>>,
    /// The body that the plane is fixed to, in whose axes it is given then.
    pub body: Option<usize>,
}

impl Plane {
    /// The plane through `point` with this normal and axis, at rest in the world.
    pub fn new(point: [f64; 3], normal: [f64; 3], axis: [f64; 3]) -> Self {
        let (velocity, spin) = (TimeFunction::ZERO, TimeFunction::ZERO);
        Self { point, normal, axis, velocity, spin, motion: None, friction: None, body: None }
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
    /// The angle of `e₁` in rad from the plane's axis, over the position in the plane's axes from its point.
    Field(Field),
}

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

/// A plane with orthonormal axes at an instant, in the coordinates of what it is fixed to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Surface {
    pub(super) point: Vector3<f64>,
    pub(super) e1: Vector3<f64>,
    pub(super) e2: Vector3<f64>,
    pub(super) normal: Vector3<f64>,
    /// Velocity of the material within the plane along the axes, and its angular velocity about the normal.
    pub(super) velocity: [f64; 2],
    pub(super) spin: f64,
    /// Velocity of the point and angular velocity of the plane itself, if it moves.
    pub(super) motion: Option<[Vector3<f64>; 2]>,
}

impl Surface {
    /// The plane as it is given; with what depends on time still zero.
    pub(super) fn new(plane: &Plane) -> Result<Self, ArgumentError> {
        finite("point", &plane.point)?;
        plane.velocity.check("velocity")?;
        plane.spin.check("spin")?;
        let normal = unit("normal", plane.normal)?;
        let axis = unit("axis", plane.axis)?;
        let Some(e1) = tangent(&axis, &normal) else {
            return refuse("axis", "must not be parallel to the plane's normal");
        };
        let velocity = plane.velocity.constant().unwrap_or_default();
        let [spin] = plane.spin.constant().unwrap_or_default();
        let e2 = normal.cross(&e1);
        Ok(Self { point: plane.point.into(), e1, e2, normal, velocity, spin, motion: None })
    }

    /// The surface in the world, if what it is fixed to has this pose.
    #[inline]
    pub(super) fn at(&self, pose: &super::Pose) -> Self {
        Self {
            point: pose.point(&self.point),
            e1: pose.rotation * self.e1,
            e2: pose.rotation * self.e2,
            normal: pose.rotation * self.normal,
            motion: self.motion.map(|motion| motion.map(|part| pose.rotation * part)),
            ..*self
        }
    }

    /// Velocity of the material at a place `x` of the plane, and its part along the normal, by motion of the plane alone.
    #[inline]
    pub(super) fn material_velocity(&self, x: &Vector3<f64>) -> (Vector3<f64>, f64) {
        let belt = self.e1 * self.velocity[0] + self.e2 * self.velocity[1];
        let within = belt + self.normal.cross(&(x - self.point)) * self.spin;
        let Some([velocity, turning]) = &self.motion else { return (within, 0.0) };
        let own = velocity + turning.cross(&(x - self.point));
        (within + own, self.normal.dot(&own))
    }

    /// Angular velocity of the material about the normal.
    #[inline]
    pub(super) fn material_spin(&self) -> f64 {
        self.spin + self.motion.map_or(0.0, |[_, turning]| self.normal.dot(&turning))
    }

    /// How plane and material move on for `dt` if nothing depends on time.
    #[inline]
    pub(super) fn predicted(&self, dt: f64) -> PredictedSurface {
        let belt = (self.e1 * self.velocity[0] + self.e2 * self.velocity[1]) * dt;
        PredictedSurface { belt, angle: self.spin * dt, plane: None }
    }

    /// The way of the material at a place `x` of the plane along its predicted motion, within what the plane is fixed to. The
    /// velocity of what stays in the material turns with the spin.
    #[inline]
    pub(super) fn way(&self, x: &Vector3<f64>, predicted: &PredictedSurface) -> Vector3<f64> {
        let arm = x - self.point;
        let mut way = predicted.belt;
        if predicted.angle != 0.0 {
            let angle = self.normal * predicted.angle;
            way = Turn::new(&angle).mean(&(way + angle.cross(&arm)));
        }
        match &predicted.plane {
            None => way,
            Some(plane) => plane.way(&arm) + plane.rotation * way,
        }
    }
}

/// What happens to a plane and its material in a time, in the axes that the plane has at its beginning or in those of
/// what it is fixed to.
pub(super) struct PredictedSurface {
    /// Way of the material within the plane, and the angle by which it turns about the normal.
    belt: Vector3<f64>,
    pub(super) angle: f64,
    /// How the plane itself moves, if it does.
    pub(super) plane: Option<PredictedPlane>,
}

/// How a plane moves in a time.
pub(super) struct PredictedPlane {
    /// Way of its point.
    shift: Vector3<f64>,
    pub(super) rotation: Matrix3<f64>,
}

impl PredictedPlane {
    /// The rotation vector of its turn.
    pub(super) fn angle(&self) -> Vector3<f64> {
        Rotation3::from_matrix_unchecked(self.rotation).scaled_axis()
    }

    /// The way of what moves along with the plane, the arm from its point given.
    pub(super) fn way(&self, arm: &Vector3<f64>) -> Vector3<f64> {
        self.shift + (self.rotation * arm - arm)
    }
}

impl PredictedSurface {
    /// The same in the axes of the world, if what the plane is fixed to has this attitude.
    pub(super) fn at(self, rotation: &Matrix3<f64>) -> Self {
        let plane = self.plane.map(|PredictedPlane { shift, rotation: own }| PredictedPlane {
            shift: rotation * shift,
            rotation: rotation * own * rotation.transpose(),
        });
        Self { belt: rotation * self.belt, plane, ..self }
    }
}

/// What of a plane depends on time.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Timed {
    velocity: TimeFunction<2>,
    spin: TimeFunction<1>,
    motion: Option<PlaneMotion>,
}

impl Timed {
    /// What of this plane depends on time, if anything does.
    pub(super) fn new(plane: &Plane) -> Option<Self> {
        let constant = plane.velocity.constant().is_some() && plane.spin.constant().is_some();
        let Plane { velocity, spin, motion, .. } = plane.clone();
        (!constant || motion.is_some()).then_some(Self { velocity, spin, motion })
    }

    /// Whether the plane itself moves, and not just its material.
    pub(super) fn moves(&self) -> bool {
        self.motion.is_some()
    }

    /// The plane at a time.
    pub(super) fn at(&self, surface: &Surface, at: Moment) -> Surface {
        let (velocity, [spin]) = (self.velocity.value(at), self.spin.value(at));
        let surface = Surface { velocity, spin, ..*surface };
        let Some(motion) = &self.motion else { return surface };
        let PlacedMotion { displacement, rotation, velocity, angular_velocity } = motion.at(at);
        Surface {
            point: surface.point + displacement,
            e1: rotation * surface.e1,
            e2: rotation * surface.e2,
            normal: rotation * surface.normal,
            motion: Some([velocity, angular_velocity]),
            ..surface
        }
    }

    /// How plane and material move on from the time `t` for `dt`, where `surface` is the plane at that time.
    pub(super) fn predicted(&self, surface: &Surface, t: f64, dt: f64) -> PredictedSurface {
        let [v1, v2] = self.velocity.integral(t, t + dt);
        let [angle] = self.spin.integral(t, t + dt);
        let plane = self.motion.as_ref().map(|motion| {
            let [start, end] = [t, t + dt].map(|t| motion.at(Moment::new(t)));
            PredictedPlane {
                shift: end.displacement - start.displacement,
                rotation: end.rotation * start.rotation.transpose(),
            }
        });
        PredictedSurface { belt: surface.e1 * v1 + surface.e2 * v2, angle, plane }
    }

    /// Sizes of the parts of the gap and of the velocities of a body that touches the plane at this distance from its point.
    pub(super) fn extents(&self, arm: f64, t_end: f64) -> [f64; 2] {
        let largest = |sum: f64, extent: Extent| sum + extent.size;
        let vector = |extents: &[Extent]| extents.iter().copied().fold(0.0, largest);
        let [value, rate] = [Derivative::Value, Derivative::First];
        let within = vector(&self.velocity.extents(value, t_end))
            + arm * vector(&self.spin.extents(value, t_end));
        let of_plane = |derivative: Derivative| {
            self.motion.as_ref().map_or(0.0, |PlaneMotion { displacement, rotation }| {
                let turned = vector(&rotation.extents(derivative, t_end));
                vector(&displacement.extents(derivative, t_end)) + arm * turned
            })
        };
        [of_plane(value), within + of_plane(rate)]
    }

    /// The next time at which it is not smooth.
    pub(super) fn next_break(&self, t: f64) -> Option<Break> {
        let motion = self.motion.as_ref().and_then(|motion| motion.next_break(t));
        let belt = Break::earlier(self.velocity.next_break(t), self.spin.next_break(t));
        Break::earlier(motion, belt)
    }
}

/// The unit vector along `vector`.
pub(super) fn unit(
    argument: &'static str,
    vector: [f64; 3],
) -> Result<Vector3<f64>, ArgumentError> {
    finite(argument, &vector)?;
    let vector = Vector3::from(vector);
    // Twice, so that neither tiny nor huge vectors lose digits.
    let scaled = vector / vector.amax();
    if vector.amax() > 0.0 && scaled.amax() > 0.0 {
        return Ok(scaled.normalize());
    }
    refuse(argument, "must not be zero")
}

/// The unit vector along the projection of `axis` onto the plane with this normal, if there is one.
#[inline]
pub(super) fn tangent(axis: &Vector3<f64>, normal: &Vector3<f64>) -> Option<Vector3<f64>> {
    let along = axis - normal * normal.dot(axis);
    let square = along.norm_squared();
    (square > 1e-24 * axis.norm_squared()).then(|| along / square.sqrt())
}

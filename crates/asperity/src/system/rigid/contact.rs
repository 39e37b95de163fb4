//! One possible contact: gap, place, directions, and its rows of `W_Nᵀ` and `Wᵀ`.

use std::ops::Range;
use std::sync::Arc;

use nalgebra::Vector3;

use super::pose::{Pose, Poses, Speeds, Twist};
use super::surface::{Frame, Surface, Timed, tangent};
use crate::system::Moment;
use crate::system::friction_map::FrictionMap;

/// A possible contact of a body with another one or with the world.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Contact {
    pub(super) body: usize,
    pub(super) other: Option<usize>,
    /// The bodies in ascending order, the only one twice.
    pub(super) bodies: [usize; 2],
    /// Their blocks of velocities in ascending order, the only one twice; the places of the first and of the second body
    /// in its rows, and how many bodies these have.
    pub(super) blocks: [usize; 2],
    pub(super) places: (usize, usize),
    pub(super) width: usize,
    /// Whether it may open, and has a normal row.
    pub(super) unilateral: bool,
    /// Number of tangential rows.
    pub(super) tangential: usize,
    pub(super) touching: Touching,
    pub(super) frame: Frame,
    /// The map of its plane, if it has one.
    pub(super) friction: Option<Arc<FrictionMap>>,
    /// Radius of the patch for drilling friction.
    pub(super) patch: f64,
}

/// The two surfaces, each in the axes of its own body.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Touching {
    /// A sphere, of radius zero for a point, and a plane, with what of this depends on time.
    Plane { point: Vector3<f64>, radius: f64, surface: Surface, timed: Option<Arc<Timed>> },
    /// Two spheres.
    Spheres { centres: [Vector3<f64>; 2], radii: [f64; 2] },
}

/// Where and along which directions a contact acts, in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ContactGeometry {
    /// Gap in m.
    pub gap: f64,
    /// Contact point in m.
    pub point: Vector3<f64>,
    /// Directions of the friction force, `e₂ = n × e₁`.
    pub e1: Vector3<f64>,
    /// See `e1`.
    pub e2: Vector3<f64>,
    /// Normal, from the plane or the second sphere to the first body.
    pub normal: Vector3<f64>,
    /// Velocity in m/s of a moving surface at the contact point, relative to what it is fixed to.
    pub surface_velocity: Vector3<f64>,
    /// Its part along the normal, of planes that move themselves.
    pub surface_normal_velocity: f64,
    /// Angular velocity in rad/s of a moving surface about the normal.
    pub surface_spin: f64,
}

impl ContactGeometry {
    /// World coordinates of a force given by its components along `e₁`, `e₂`, `n`.
    pub fn world(&self, force: [f64; 3]) -> Vector3<f64> {
        self.e1 * force[0] + self.e2 * force[1] + self.normal * force[2]
    }
}

impl Contact {
    /// The blocks that it touches, ascending.
    #[inline]
    pub(super) fn touched(&self) -> &[usize] {
        &self.blocks[..1 + usize::from(self.blocks[0] != self.blocks[1])]
    }

    /// The same where a block has the bodies from the first one that `range` returns for any of them on to the last one.
    pub(super) fn in_blocks(self, block: &[usize], range: impl Fn(usize) -> Range<usize>) -> Self {
        let blocks = self.bodies.map(|body| block[body]);
        let first = range(blocks[0]);
        let place = |body: usize| match block[body] == blocks[0] {
            true => body - first.start,
            false => first.len() + body - range(blocks[1]).start,
        };
        let second = if blocks[0] == blocks[1] { 0 } else { range(blocks[1]).len() };
        let places = (place(self.body), self.other.map_or(0, place));
        Self { blocks, places, width: first.len() + second, ..self }
    }

    /// The same between bodies with other numbers in the same order; nothing where a body has none.
    pub(super) fn renumbered(&self, number: impl Fn(usize) -> Option<usize>) -> Option<Self> {
        let other = self.other.map(&number);
        let [a, b] = self.bodies.map(&number);
        let (body, bodies) = (number(self.body)?, [a?, b?]);
        Some(Self { body, other: other.flatten(), bodies, blocks: bodies, ..self.clone() })
    }

    /// What of its plane depends on time.
    pub(super) fn timed(&self) -> Option<&Arc<Timed>> {
        match &self.touching {
            Touching::Plane { timed, .. } => timed.as_ref(),
            Touching::Spheres { .. } => None,
        }
    }

    /// The poses of its bodies.
    #[inline]
    pub(super) fn poses(&self, pose: impl Fn(usize) -> Pose) -> Poses {
        Poses { first: pose(self.body), second: self.other.map(pose) }
    }

    /// Gap and contact point.
    #[inline]
    pub(super) fn gap(&self, at: Moment, poses: &Poses) -> (f64, Vector3<f64>) {
        let Poses { first, second } = poses;
        match &self.touching {
            Touching::Plane { point, radius, surface, timed } => {
                let moved;
                let surface = match timed {
                    None => surface,
                    Some(timed) => {
                        moved = timed.at(surface, at);
                        &moved
                    }
                };
                let x = first.point(point);
                let (normal, origin) = match second {
                    Some(pose) => (pose.rotation * surface.normal, pose.point(&surface.point)),
                    None => (surface.normal, surface.point),
                };
                (normal.dot(&(x - origin)) - radius, x - normal * *radius)
            }
            Touching::Spheres { centres, radii } => {
                let (gap, point, _) = spheres(centres, radii, poses);
                (gap, point)
            }
        }
    }

    /// The contact point in the axes of its plane, from the plane's point.
    pub(super) fn place(&self, at: Moment, poses: &Poses) -> [f64; 2] {
        let Touching::Plane { surface, timed, .. } = &self.touching else { return [0.0; 2] };
        let surface = timed.as_ref().map_or(*surface, |timed| timed.at(surface, at));
        let surface = poses.second.as_ref().map_or(surface, |pose| surface.at(pose));
        let away = self.gap(at, poses).1 - surface.point;
        [away.dot(&surface.e1), away.dot(&surface.e2)]
    }

    /// A bound on `|g̈_N|` while it does not overlap, from these poses on for `duration`; none with a plane that moves itself.
    ///
    /// With a plane on a body, and the arm `d` from its point to the contact, it is `|a| + 2ω|v| + (ω² + α)|d|` with
    /// velocity and acceleration of one end of the arm relative to the other. Of spheres whose centres are R apart where
    /// they touch it is `|a| + |v|²/R`. As they would meet within a time Δt that is too long for this to be seen, it is
    /// made `|a| + 8|v|²/R`: from `R/2|v|` on, `⅛|g̈_N|Δt²` is more than `½|v|Δt`, by which a gap can fall below those at both ends.
    pub(super) fn gap_acceleration(
        &self,
        poses: &Poses,
        speeds: impl Fn(usize) -> Speeds,
        duration: f64,
    ) -> Option<f64> {
        let first = speeds(self.body);
        let second = self.other.map(&speeds);
        let of_second = |arm: f64| second.as_ref().map_or([0.0; 2], |speeds| speeds.of_point(arm));
        match &self.touching {
            Touching::Plane { timed: Some(timed), .. } if timed.moves() => None,
            Touching::Plane { point, surface, .. } => {
                let [v1, a1] = first.of_point(point.norm());
                let (Some(speeds), Some(pose)) = (&second, &poses.second) else { return Some(a1) };
                let ([v2, a2], [turning, turning_rate]) =
                    (of_second(surface.point.norm()), speeds.turning());
                let arm = (poses.first.point(point) - pose.point(&surface.point)).norm();
                let (velocity, arm) = (v1 + v2, arm + (v1 + v2) * duration);
                let turned = turning * turning + turning_rate;
                Some(a1 + a2 + 2.0 * turning * velocity + turned * arm)
            }
            Touching::Spheres { centres, radii } => {
                let [v1, a1] = first.of_point(centres[0].norm());
                let [v2, a2] = of_second(centres[1].norm());
                Some(a1 + a2 + 8.0 * (v1 + v2).powi(2) / (radii[0] + radii[1]))
            }
        }
    }

    /// Sizes of the parts of gap and velocities that depend on time, seen from these poses; none if nothing does.
    pub(super) fn extents(&self, poses: &Poses, t_end: f64) -> Option<[f64; 2]> {
        let Poses { first, second } = poses;
        let Touching::Plane { point, surface, timed: Some(timed), .. } = &self.touching else {
            return None;
        };
        let origin = second.map_or(surface.point, |pose| pose.point(&surface.point));
        Some(timed.extents((first.point(point) - origin).norm(), t_end))
    }

    /// Everything of the contact but its rows.
    #[inline]
    pub(super) fn geometry(&self, at: Moment, poses: &Poses) -> ContactGeometry {
        let Poses { first, second } = poses;
        match &self.touching {
            Touching::Plane { point, radius, surface, timed } => {
                let surface = match timed {
                    None => *surface,
                    Some(timed) => timed.at(surface, at),
                };
                let surface = second.as_ref().map_or(surface, |pose| surface.at(pose));
                let (normal, x) = (surface.normal, first.point(point));
                let (gap, point) =
                    (normal.dot(&(x - surface.point)) - radius, x - normal * *radius);
                let (e1, e2) = self.directions(&surface, &point, first);
                let (surface_velocity, surface_normal_velocity) = surface.material_velocity(&point);
                ContactGeometry {
                    gap,
                    point,
                    e1,
                    e2,
                    normal,
                    surface_velocity,
                    surface_normal_velocity,
                    surface_spin: surface.material_spin(),
                }
            }
            Touching::Spheres { centres, radii } => {
                let (gap, point, normal) = spheres(centres, radii, poses);
                let e1 = match &self.frame {
                    Frame::Body { axis } => {
                        tangent(&(first.rotation * Vector3::from(*axis)), &normal)
                            .unwrap_or_else(|| across(&normal))
                    }
                    // Planar systems.
                    _ => normal.cross(&Vector3::z()),
                };
                ContactGeometry {
                    gap,
                    point,
                    e1,
                    e2: normal.cross(&e1),
                    normal,
                    surface_velocity: Vector3::zeros(),
                    surface_normal_velocity: 0.0,
                    surface_spin: 0.0,
                }
            }
        }
    }

    /// `e₁`, `e₂` on a plane; where the frame has no direction, those of the plane.
    #[inline]
    fn directions(
        &self,
        surface: &Surface,
        point: &Vector3<f64>,
        first: &Pose,
    ) -> (Vector3<f64>, Vector3<f64>) {
        let e1 = match &self.frame {
            Frame::Plane => return (surface.e1, surface.e2),
            Frame::Body { axis } => {
                tangent(&(first.rotation * Vector3::from(*axis)), &surface.normal)
            }
            Frame::Polar => {
                let away = point - surface.point;
                let along = away - surface.normal * surface.normal.dot(&away);
                // Relative to the place of the origin, so that rounding gives no direction.
                let size = point.amax().max(surface.point.amax());
                (along.amax() > 1e-12 * size).then(|| along.normalize())
            }
            Frame::Field(angle) => {
                let away = point - surface.point;
                let (sine, cosine) =
                    angle([away.dot(&surface.e1), away.dot(&surface.e2)]).sin_cos();
                Some(surface.e1 * cosine + surface.e2 * sine)
            }
        };
        match e1 {
            Some(e1) => (e1, surface.normal.cross(&e1)),
            None => (surface.e1, surface.e2),
        }
    }

    /// Its rows for the first and for the second body, and χ: the normal one if it may open, and those of friction.
    #[inline]
    pub(super) fn rows(
        &self,
        geometry: &ContactGeometry,
        poses: &Poses,
        own: &mut [Twist],
        others: &mut [Twist],
        chi: &mut [f64],
    ) {
        let (start, p) = (usize::from(self.unilateral), self.tangential);
        let directions = [geometry.normal, geometry.e1, geometry.e2];
        let directions = &directions[1 - start..1 + p.min(2)];
        for (k, direction) in directions.iter().enumerate() {
            own[k] = poses.first.pushed(&geometry.point, direction);
            chi[k] = -direction.dot(&geometry.surface_velocity);
        }
        if self.unilateral {
            chi[0] = -geometry.surface_normal_velocity;
        }
        let drilling = geometry.normal * self.patch;
        if p == 3 {
            own[start + 2] = poses.first.wrench(&Vector3::zeros(), &drilling);
            chi[start + 2] = -self.patch * geometry.surface_spin;
        }
        let Some(second) = &poses.second else { return };
        for (k, direction) in directions.iter().enumerate() {
            others[k] = second.pushed(&geometry.point, &-direction);
        }
        if p == 3 {
            others[start + 2] = second.wrench(&Vector3::zeros(), &-drilling);
        }
    }
}

/// Direction and length; concentric spheres are pushed apart along x.
#[inline]
pub(super) fn direction(v: Vector3<f64>) -> (Vector3<f64>, f64) {
    let length = v.norm();
    if length > 0.0 { (v / length, length) } else { (Vector3::x(), 0.0) }
}

/// Some unit vector perpendicular to `normal`.
fn across(normal: &Vector3<f64>) -> Vector3<f64> {
    let axis = Vector3::ith(normal.iamin(), 1.0);
    normal.cross(&axis).normalize()
}

/// Gap, contact point and normal of two spheres.
#[inline]
fn spheres(
    centres: &[Vector3<f64>; 2],
    radii: &[f64; 2],
    poses: &Poses,
) -> (f64, Vector3<f64>, Vector3<f64>) {
    let Poses { first, second } = poses;
    let b = second.as_ref().map_or(centres[1], |pose| pose.point(&centres[1]));
    let (normal, distance) = direction(first.point(&centres[0]) - b);
    let gap = distance - radii[0] - radii[1];
    (gap, b + normal * (radii[1] + 0.5 * gap), normal)
}

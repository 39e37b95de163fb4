//! What may touch what, as it is given; every pair expands to contacts.

use std::sync::Arc;

use nalgebra::Vector3;

use super::contact::{Contact, Touching};
use super::surface::{Frame, Plane, Surface, Timed, unit};
use crate::argument::{ArgumentError, below, finite, positive, refuse};
use crate::contact::NormalForce;
use crate::law::Law;
use crate::system::{ContactLaw, FrictionMap, TimeFunction};

/// Two surfaces that may touch; bodies are given by their number, places in their axes.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Shape {
    /// A point of a body.
    PointPlane {
        /// The body.
        body: usize,
        /// The point in m.
        point: [f64; 3],
        /// The plane.
        plane: Plane,
    },
    /// A sphere fixed to a body.
    SpherePlane {
        /// The body.
        body: usize,
        /// Its centre in m.
        centre: [f64; 3],
        /// Its radius in m.
        radius: f64,
        /// The plane.
        plane: Plane,
    },
    /// The corners of a box about the body's origin: eight contacts, four of a planar body. The signs of
    /// corner `k` are the bits of `k`, x first, zero for minus.
    BoxPlane {
        /// The body.
        body: usize,
        /// Half the edges in m.
        half_sizes: [f64; 3],
        /// The plane.
        plane: Plane,
    },
    /// Two spheres; the normal points to the first.
    SphereSphere {
        /// The body of the first sphere.
        body: usize,
        /// Its centre in m.
        centre: [f64; 3],
        /// Its radius in m.
        radius: f64,
        /// The body of the second sphere.
        other: usize,
        /// Its centre in m.
        other_centre: [f64; 3],
        /// Its radius in m.
        other_radius: f64,
    },
}

/// Two surfaces with the laws of their contacts.
///
/// Newton's restitution multiplies every relative velocity before the step by its coefficient. Impacts do
/// not bring energy in where all coefficients of all contacts that are closed at the same time agree and
/// lie in \[0, 1\], all of them are contacts of bodies that are struck, and no surface moves: with `ξ = γ_E + eγ_B` and `γ_E − γ_B = GP` the energy grows by
/// `Pᵀξ/(1+e) − ½ (1−e)/(1+e) PᵀGP ≤ 0`, at the midpoint: what gyroscopic terms change until the end of
/// the step is O(Δt²), and none for planar bodies and isotropic inertia. Restitution acts in every step in
/// which a contact is closed. Where they differ (`e_N ≠ e_T` is enough) it may grow, which is
/// known as Kane's paradox: Newton's restitution then has no energy balance that holds in general.
#[derive(Debug, Clone, PartialEq)]
pub struct Pair {
    /// The surfaces.
    pub shape: Shape,
    /// Friction law of every contact: of dimension 1 in the plane, 2 or 3 in space.
    pub law: Law,
    /// The directions that an anisotropic law refers to.
    pub frame: Frame,
    /// Normal force of every contact, acting on both bodies; in N if it is prescribed.
    pub normal_force: NormalForce,
    /// Newton's `e_N`, in [0, 1].
    pub normal_restitution: f64,
    /// `e_T`, in [0, 1].
    pub tangential_restitution: f64,
    /// Radius `R` of the contact patch in m for laws with drilling, whose third slip is `R ω_N`.
    pub patch_radius: Option<f64>,
}

impl Pair {
    /// Unilateral contacts without restitution, directions given by the plane or, between spheres, by
    /// the first body's x-axis.
    pub fn new(shape: Shape, law: impl Into<Law>) -> Self {
        let frame = match shape {
            Shape::SphereSphere { .. } => Frame::Body { axis: [1.0, 0.0, 0.0] },
            _ => Frame::Plane,
        };
        Self {
            shape,
            law: law.into(),
            frame,
            normal_force: NormalForce::Unilateral,
            normal_restitution: 0.0,
            tangential_restitution: 0.0,
            patch_radius: None,
        }
    }

    /// The laws of its contacts, checked.
    pub(super) fn contact_law(&self, planar: bool) -> Result<ContactLaw, ArgumentError> {
        let p = self.law.dimension();
        if planar != (p == 1) {
            let (space, allowed) = if planar { ("a plane", "1") } else { ("space", "2 or 3") };
            return refuse("law", format!("must be of dimension {allowed} in {space}, is of {p}"));
        }
        match self.patch_radius {
            Some(_) if p < 3 => {
                return refuse("patch_radius", "must be given for drilling friction only");
            }
            None if p == 3 => {
                return refuse("patch_radius", "must be given for drilling friction");
            }
            radius => positive("patch_radius", radius.unwrap_or(1.0))?,
        };
        ContactLaw::new(self.law.clone(), self.normal_force)?
            .with_restitution(self.normal_restitution, self.tangential_restitution)
    }

    /// Its contacts, between `bodies` bodies.
    pub(super) fn contacts(
        &self,
        bodies: usize,
        planar: bool,
    ) -> Result<Vec<Contact>, ArgumentError> {
        let (body, other) = self.shape.bodies();
        let second = match self.shape {
            Shape::SphereSphere { .. } => "other",
            _ => "plane.body",
        };
        below("body", body, bodies, "bodies")?;
        below(second, other.unwrap_or(body), bodies, "bodies")?;
        if other == Some(body) {
            return refuse("body", "must not touch itself");
        }
        let (frame, friction) = (self.checked_frame(planar)?, self.shape.friction());
        if friction.is_some() && self.law.rate().is_some() {
            let message = "must not be given for a law whose friction depends on the speed";
            return refuse("friction_factor", message);
        }
        let bodies = other.map_or([body; 2], |other| [body.min(other), body.max(other)]);
        let contact = |touching| Contact {
            body,
            other,
            bodies,
            blocks: bodies,
            places: if bodies[0] == body { (0, 1) } else { (1, 0) },
            width: 1 + usize::from(other.is_some()),
            unilateral: self.normal_force.is_unilateral(),
            tangential: self.law.dimension(),
            touching,
            frame: frame.clone(),
            friction: friction.cloned(),
            patch: self.patch_radius.unwrap_or(0.0),
        };
        Ok(self.shape.expand(planar)?.into_iter().map(contact).collect())
    }

    /// The frame; in the plane there is but one.
    fn checked_frame(&self, planar: bool) -> Result<Frame, ArgumentError> {
        match &self.frame {
            _ if planar => Ok(Frame::Plane),
            Frame::Body { axis } => Ok(Frame::Body { axis: unit("axis", *axis)?.into() }),
            _ if matches!(self.shape, Shape::SphereSphere { .. }) => {
                let message = "must be fixed to a body between two spheres, which have no plane";
                refuse("frame", message)
            }
            frame => Ok(frame.clone()),
        }
    }
}

impl Shape {
    fn bodies(&self) -> (usize, Option<usize>) {
        match self {
            Self::PointPlane { body, plane, .. }
            | Self::SpherePlane { body, plane, .. }
            | Self::BoxPlane { body, plane, .. } => (*body, plane.body),
            Self::SphereSphere { body, other, .. } => (*body, Some(*other)),
        }
    }

    /// What of its plane depends on time, if it has one and anything does.
    pub(super) fn timed(&self) -> Option<Timed> {
        match self {
            Self::PointPlane { plane, .. }
            | Self::SpherePlane { plane, .. }
            | Self::BoxPlane { plane, .. } => Timed::new(plane),
            Self::SphereSphere { .. } => None,
        }
    }

    /// By what factor friction depends on the place on its plane, if it has one and it does.
    fn friction(&self) -> Option<&Arc<FrictionMap>> {
        match self {
            Self::PointPlane { plane, .. }
            | Self::SpherePlane { plane, .. }
            | Self::BoxPlane { plane, .. } => plane.friction.as_ref(),
            Self::SphereSphere { .. } => None,
        }
    }

    fn expand(&self, planar: bool) -> Result<Vec<Touching>, ArgumentError> {
        let surface = |plane: &Plane| {
            if planar && (plane.normal[2] != 0.0 || plane.axis[2] != 0.0) {
                let message = "must have a normal and an axis with z = 0 in planar systems";
                return refuse("plane", message);
            }
            if planar && plane.spin != TimeFunction::ZERO {
                return refuse("spin", "must be zero in planar systems");
            }
            plane.motion.as_ref().map_or(Ok(()), |motion| motion.check(planar))?;
            Surface::new(plane)
        };
        let timed = self.timed().map(Arc::new);
        match self {
            Self::PointPlane { point, plane, .. } => {
                let (surface, point) = (surface(plane)?, place("point", *point, planar)?);
                Ok(vec![Touching::Plane { point, radius: 0.0, surface, timed }])
            }
            Self::SpherePlane { centre, radius, plane, .. } => {
                let (point, radius) =
                    (place("centre", *centre, planar)?, positive("radius", *radius)?);
                Ok(vec![Touching::Plane { point, radius, surface: surface(plane)?, timed }])
            }
            Self::BoxPlane { half_sizes, plane, .. } => {
                let surface = surface(plane)?;
                let count = if planar { 2 } else { 3 };
                let mut half = [0.0; 3];
                for (h, &given) in half.iter_mut().zip(&half_sizes[..count]) {
                    *h = positive("half_sizes", given)?;
                }
                let sign = |k: usize, i: usize| if k >> i & 1 == 1 { 1.0 } else { -1.0 };
                let corner = |k: usize| Vector3::from_fn(|i, _| sign(k, i) * half[i]);
                let touching = |k| Touching::Plane {
                    point: corner(k),
                    radius: 0.0,
                    surface,
                    timed: timed.clone(),
                };
                Ok((0..1 << count).map(touching).collect())
            }
            Self::SphereSphere { centre, radius, other_centre, other_radius, .. } => {
                let (own, other) = (*centre, *other_centre);
                let centres =
                    [place("centre", own, planar)?, place("other_centre", other, planar)?];
                let radii =
                    [positive("radius", *radius)?, positive("other_radius", *other_radius)?];
                Ok(vec![Touching::Spheres { centres, radii }])
            }
        }
    }
}

fn place(
    argument: &'static str,
    point: [f64; 3],
    planar: bool,
) -> Result<Vector3<f64>, ArgumentError> {
    finite(argument, &point)?;
    if planar && point[2] != 0.0 {
        return refuse(argument, "must have z = 0 in planar systems");
    }
    Ok(point.into())
}

//! Hinges, sliders and welds: what they hold, and the rows of their velocities.

use std::ops::Range;

use nalgebra::{Matrix3, Vector3};

use super::pose::{Pose, Twist};
use crate::argument::{ArgumentError, below, finite, refuse};

/// What a joint leaves of the motion of a body relative to another one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointKind {
    /// Turning about an axis.
    Hinge,
    /// Sliding along an axis.
    Slider,
    /// Nothing.
    Weld,
}

/// A joint between a body and another one or the world, placed in the world as the bodies are at the start.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// What it leaves.
    pub kind: JointKind,
    /// The first body.
    pub body: usize,
    /// The second body, `None` for the world.
    pub other: Option<usize>,
    /// A point of its axis in m.
    pub anchor: [f64; 3],
    /// The direction of its axis, of any length.
    pub axis: [f64; 3],
}

impl Joint {
    pub(super) fn check(&self, bodies: usize, planar: bool) -> Result<(), ArgumentError> {
        below("body", self.body, bodies, "bodies")?;
        below("other", self.other.unwrap_or(self.body), bodies, "bodies")?;
        if self.other == Some(self.body) {
            return refuse("other", format!("must be another body than {}", self.body));
        }
        finite("anchor", &self.anchor)?;
        finite("axis", &self.axis)?;
        if self.axis == [0.0; 3] {
            return refuse("axis", "must not be zero");
        }
        let [x, y, z] = self.axis.map(|a| a != 0.0);
        let is_outside = if self.kind == JointKind::Hinge { x || y } else { z };
        if planar && (self.anchor[2] != 0.0 || self.kind != JointKind::Weld && is_outside) {
            return refuse("axis", "must leave the bodies in the plane z = 0 in planar systems");
        }
        Ok(())
    }
}

/// A joint in the axes of its bodies.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Placed {
    kind: JointKind,
    pub(super) body: usize,
    pub(super) other: Option<usize>,
    /// Its point, and its axes `t₁, t₂, n` column by column, on both sides.
    anchors: [Vector3<f64>; 2],
    axes: [Matrix3<f64>; 2],
    /// Radii of gyration of the bodies, together.
    length: f64,
}

/// Of two sides, the world's where there is no second body.
fn sides(body: usize, other: Option<usize>, pose: impl Fn(usize) -> Pose) -> [Pose; 2] {
    let world = Pose { position: Vector3::zeros(), rotation: Matrix3::identity() };
    [pose(body), other.map_or(world, pose)]
}

impl Placed {
    pub(super) fn new(joint: &Joint, length: f64, pose: impl Fn(usize) -> Pose) -> Self {
        let axis = Vector3::from(joint.axis);
        let n = (axis / axis.amax()).normalize();
        let t1 = n.cross(&Vector3::ith(n.iamin(), 1.0)).normalize();
        let world = Matrix3::from_columns(&[t1, n.cross(&t1), n]);
        let Joint { kind, body, other, .. } = *joint;
        let poses = sides(body, other, pose);
        let anchor = |p: &Pose| p.rotation.tr_mul(&(Vector3::from(joint.anchor) - p.position));
        let anchors = [anchor(&poses[0]), anchor(&poses[1])];
        let axes = [poses[0].rotation.tr_mul(&world), poses[1].rotation.tr_mul(&world)];
        Self { kind, body, other, anchors, axes, length }
    }

    /// The axes along which it holds points, and those about which it holds attitudes.
    fn held(&self) -> [Range<usize>; 2] {
        match self.kind {
            JointKind::Hinge => [0..3, 0..2],
            JointKind::Slider => [0..2, 0..3],
            JointKind::Weld => [0..3, 0..3],
        }
    }

    /// Its bodies.
    pub(super) fn bodies(&self) -> impl Iterator<Item = usize> {
        [Some(self.body), self.other].into_iter().flatten()
    }

    /// Number of rows.
    pub(super) fn rows(&self) -> usize {
        self.held().into_iter().map(|held| held.len()).sum()
    }

    /// How far it is off, row by row, in m or rad.
    pub(super) fn defects(&self, pose: impl Fn(usize) -> Pose, out: &mut Vec<f64>) {
        let poses = sides(self.body, self.other, pose);
        let [own, axes] = [0, 1].map(|k| poses[k].rotation * self.axes[k]);
        let [first, second] = [0, 1].map(|k| poses[k].point(&self.anchors[k]));
        let turn = |k: usize| axes.column(k).cross(&own.column(k));
        let tilt = match self.kind {
            JointKind::Hinge => turn(2),
            _ => (turn(0) + turn(1) + turn(2)) * 0.5,
        };
        let [along, about] = self.held();
        out.extend(along.map(|k| axes.column(k).dot(&(first - second))));
        out.extend(about.map(|k| axes.column(k).dot(&tilt)));
    }

    /// The sizes of the terms of these differences.
    pub(super) fn sizes(&self, pose: impl Fn(usize) -> Pose, out: &mut Vec<f64>) {
        let poses = sides(self.body, self.other, pose);
        let sizes = [0, 1].map(|k| poses[k].position.norm() + self.anchors[k].norm());
        let [along, about] = self.held();
        out.extend(along.map(|_| sizes[0] + sizes[1] + self.length));
        out.extend(about.map(|_| 1.0));
    }

    /// Force and torque on the first body at its anchor, of a weld at the body's centre, of forces of the rows.
    pub(super) fn reaction(
        &self,
        pose: impl Fn(usize) -> Pose,
        forces: &[f64],
    ) -> [Vector3<f64>; 2] {
        let poses = sides(self.body, self.other, pose);
        let (axes, mut forces) = (poses[1].rotation * self.axes[1], forces.iter());
        let sum =
            |held: Range<usize>| held.zip(&mut forces).map(|(k, f)| axes.column(k) * *f).sum();
        let [force, torque]: [Vector3<f64>; 2] = self.held().map(sum);
        let is_weld = self.kind == JointKind::Weld;
        let arm = if is_weld { poses[0].rotation * self.anchors[0] } else { Vector3::zeros() };
        [force, torque + arm.cross(&force)]
    }

    /// The rows of both bodies, one after another: the rates of its defects where there are none.
    pub(super) fn directions(&self, pose: impl Fn(usize) -> Pose) -> Vec<[Twist; 2]> {
        let poses = sides(self.body, self.other, pose);
        let (axes, point) = (poses[1].rotation * self.axes[1], poses[0].point(&self.anchors[0]));
        let [along, about] = self.held();
        let pushed = |k: usize| {
            let axis = axes.column(k).into_owned();
            [poses[0].pushed(&point, &axis), poses[1].pushed(&point, &-axis)]
        };
        let turned = |k: usize| {
            let (axis, none) = (axes.column(k).into_owned(), Vector3::zeros());
            [poses[0].wrench(&none, &axis), poses[1].wrench(&none, &-axis)]
        };
        along.map(pushed).chain(about.map(turned)).collect()
    }
}

//! Star-shaped polygons.

use std::f64::consts::TAU;
use std::sync::Arc;

use crate::error::{SIZES, size_error};
use crate::numeric::periodic_curve::diamond;
use crate::numeric::vectors::{cross, quarter_turn};
use crate::{Cone, ConvexSet, Matrix, SetError, StarSet, Vector};

/// The set inside a closed polygon that is star-shaped with respect to the origin.
#[derive(Debug, Clone, PartialEq)]
pub struct Polygon {
    /// Counter-clockwise, from the first polar angle on.
    vertices: Arc<[Vector<2>]>,
    /// Normal of the edge from each vertex to the next, with `nᵀx = 1` on the edge.
    normals: Arc<[Vector<2>]>,
    convex: bool,
}

impl Polygon {
    /// The polygon with these corners, in either sense.
    ///
    /// Refused with a witness point if it crosses itself, does not hold the origin in its interior, or is
    /// not star-shaped.
    ///
    /// # Errors
    ///
    /// [`SetError::Shape`] with the point that is wrong.
    pub fn new(vertices: &[Vector<2>]) -> Result<Self, SetError> {
        let refuse = |message| Err(SetError::Shape { argument: "vertices", message });
        if let Some(bad) = vertices.iter().find(|v| !v.iter().all(|x| x.is_finite())) {
            return refuse(format!("must be finite, holds {}", text(bad)));
        }
        let largest = vertices.iter().map(|v| v.amax()).fold(0.0, f64::max);
        if !SIZES.contains(&largest) {
            return Err(size_error("vertices", largest));
        }
        let outline = distinct(vertices);
        if outline.len() < 3 {
            return refuse(format!("must hold at least 3 different points, has {}", outline.len()));
        }
        if let Some(fault) = fault(&outline) {
            return refuse(fault.to_string());
        }
        let mut vertices = outline;
        if winding(&vertices) < 0.0 {
            vertices.reverse();
        }
        let first = (0..vertices.len())
            .min_by(|&i, &j| diamond(&vertices[i]).total_cmp(&diamond(&vertices[j])));
        vertices.rotate_left(first.unwrap_or(0));
        let n = vertices.len();
        let normals: Arc<[Vector<2>]> = (0..n)
            .map(|i| {
                let (a, b) = (vertices[i], vertices[(i + 1) % n]);
                -quarter_turn(&(b - a)) / cross(&a, &b)
            })
            .collect();
        let nearest = normals.iter().map(|n| 1.0 / n.amax()).fold(f64::INFINITY, f64::min);
        if !SIZES.contains(&nearest) {
            return Err(size_error("vertices", nearest));
        }
        let convex = (0..n).all(|i| {
            let j = (i + n - 1) % n;
            let (before, after) = (normals[j], normals[i]);
            let length = |k: usize| (vertices[(k + 1) % n] - vertices[k]).norm();
            // The rounding of corners turns short edges.
            let rounding = vertices[i].norm() * (1.0 / length(i) + 1.0 / length(j));
            cross(&before, &after) >= -8.0 * f64::EPSILON * rounding * before.norm() * after.norm()
        });
        Ok(Self { vertices: vertices.into(), normals, convex })
    }

    /// Corners, counter-clockwise.
    pub fn vertices(&self) -> &[Vector<2>] {
        &self.vertices
    }

    /// Whether no corner points inwards.
    pub fn is_convex(&self) -> bool {
        self.convex
    }

    /// A corner that points inwards, between its neighbours.
    pub(crate) fn reentrant(&self) -> Option<[Vector<2>; 2]> {
        let n = self.vertices.len();
        let deepest = (0..n).min_by(|&i, &j| {
            let turn = |k: usize| cross(&self.normals[(k + n - 1) % n], &self.normals[k]);
            turn(i).total_cmp(&turn(j))
        })?;
        Some([self.vertices[(deepest + n - 1) % n], self.vertices[(deepest + 1) % n]])
    }

    /// Number of the edge that the ray through `x` meets.
    #[inline]
    fn edge(&self, x: &Vector<2>) -> usize {
        let turn = diamond(x);
        let started = self.vertices.partition_point(|v| diamond(v) <= turn);
        if started == 0 { self.vertices.len() - 1 } else { started - 1 }
    }
}

/// What keeps a closed outline from being that of a star-shaped set, and where.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum OutlineFault {
    /// Two edges meet at a point that is not a corner they share.
    Crossing(Vector<2>),
    /// The origin is not inside; the point is the nearest one of the outline.
    OriginOutside(Vector<2>),
    /// The point lies in the set, but the way to it from the origin does not.
    Hidden(Vector<2>),
    /// The point lies on an edge along a ray: star-shaped, but not strictly, so that the radius jumps.
    Radial(Vector<2>),
}

impl OutlineFault {
    /// The witness point.
    pub fn witness(&self) -> Vector<2> {
        match self {
            Self::Crossing(x) | Self::OriginOutside(x) | Self::Hidden(x) | Self::Radial(x) => *x,
        }
    }
}

impl std::fmt::Display for OutlineFault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let at = text(&self.witness());
        match self {
            Self::Crossing(_) => write!(f, "must not cross or touch itself, does at {at}"),
            Self::OriginOutside(_) => {
                write!(f, "must hold the origin in its interior, its nearest point is {at}")
            }
            Self::Hidden(_) => write!(f, "must be star-shaped, the origin does not see {at}"),
            Self::Radial(_) => {
                write!(f, "must be strictly star-shaped, an edge through {at} points at the origin")
            }
        }
    }
}

fn text(x: &Vector<2>) -> String {
    format!("({}, {})", x.x, x.y)
}

/// The points without repetitions next to each other.
pub(crate) fn distinct(points: &[Vector<2>]) -> Vec<Vector<2>> {
    let mut kept: Vec<Vector<2>> = points.to_vec();
    kept.dedup();
    while kept.len() > 1 && kept.first() == kept.last() {
        kept.pop();
    }
    kept
}

/// Signed angle by which the outline turns around the origin.
fn winding(outline: &[Vector<2>]) -> f64 {
    edges(outline).map(|(a, b)| cross(&a, &b).atan2(a.dot(&b))).sum()
}

fn edges(outline: &[Vector<2>]) -> impl Iterator<Item = (Vector<2>, Vector<2>)> + '_ {
    (0..outline.len()).map(|i| (outline[i], outline[(i + 1) % outline.len()]))
}

/// Why a closed outline does not bound a set that is star-shaped with respect to the origin, if so.
pub fn fault(outline: &[Vector<2>]) -> Option<OutlineFault> {
    // An outline that turns around the origin once and never backwards cannot cross itself.
    let turn = winding(outline);
    let sense = turn.signum();
    let hidden = edges(outline).find(|(a, b)| cross(a, b) * sense <= 0.0);
    if hidden.is_none() && (turn.abs() - TAU).abs() < 1.0 {
        return None;
    }
    if let Some(point) = crossing(outline) {
        return Some(OutlineFault::Crossing(point));
    }
    let nearest = edges(outline)
        .map(|(a, b)| {
            let along = b - a;
            a + along * (-a.dot(&along) / along.norm_squared()).clamp(0.0, 1.0)
        })
        .min_by(|p, q| p.norm().total_cmp(&q.norm()))?;
    let size = outline.iter().map(|v| v.norm()).fold(0.0, f64::max);
    if turn.abs() < 1.0 || nearest.norm() <= 8.0 * f64::EPSILON * size {
        return Some(OutlineFault::OriginOutside(nearest));
    }
    let backwards = edges(outline).find(|(a, b)| cross(a, b) * sense < 0.0);
    match (backwards, hidden) {
        (Some((a, b)), _) => Some(OutlineFault::Hidden((a + b) * 0.5)),
        (None, Some((a, b))) => Some(OutlineFault::Radial((a + b) * 0.5)),
        (None, None) => None,
    }
}

/// A point that two edges share without being neighbours.
fn crossing(outline: &[Vector<2>]) -> Option<Vector<2>> {
    let n = outline.len();
    let all: Vec<_> = edges(outline).collect();
    for i in 0..n {
        for j in i + 2..n {
            if i == 0 && j == n - 1 {
                continue;
            }
            let ((a, b), (c, d)) = (all[i], all[j]);
            let (u, v, w) = (b - a, d - c, c - a);
            let size = cross(&u, &v);
            if size == 0.0 {
                continue;
            }
            let (s, t) = (cross(&w, &v) / size, cross(&w, &u) / size);
            if (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
                return Some(a + u * s);
            }
        }
    }
    None
}

impl StarSet<2> for Polygon {
    #[inline]
    fn gauge(&self, x: &Vector<2>) -> f64 {
        self.normals[self.edge(x)].dot(x)
    }

    #[inline]
    fn gauge_jet(&self, x: &Vector<2>) -> (f64, Vector<2>) {
        let normal = self.normals[self.edge(x)];
        (normal.dot(x), normal)
    }

    fn corners(&self) -> Vec<Vector<2>> {
        self.vertices.to_vec()
    }
}

/// Meaningful where [`Polygon::is_convex`]; [`Convex`](crate::Convex) admits no other.
impl ConvexSet<2> for Polygon {
    #[inline]
    fn support_point(&self, y: &Vector<2>) -> Vector<2> {
        let height = |v: &Vector<2>| y.dot(v);
        let highest = self
            .vertices
            .iter()
            .fold(self.vertices[0], |best, v| if height(v) > height(&best) { *v } else { best });
        // The middle of a side if that is farthest as a whole.
        let across = quarter_turn(y);
        let level = height(&highest);
        let (mut first, mut last) = (highest, highest);
        for v in self.vertices.iter() {
            if level - height(v) <= 2.0 * f64::EPSILON * level.abs() {
                first = if across.dot(v) < across.dot(&first) { *v } else { first };
                last = if across.dot(v) > across.dot(&last) { *v } else { last };
            }
        }
        if first == last { highest } else { (first + last) * 0.5 }
    }

    fn support_jet(&self, y: &Vector<2>) -> (Vector<2>, Matrix<2>) {
        (self.support_point(y), Matrix::zeros())
    }

    fn project(&self, z: &Vector<2>) -> Vector<2> {
        if self.gauge(z) <= 1.0 {
            return *z;
        }
        let nearest = edges(&self.vertices).map(|(a, b)| {
            let along = b - a;
            a + along * ((z - a).dot(&along) / along.norm_squared()).clamp(0.0, 1.0)
        });
        // ‖z − p‖² − ‖z − q‖² for a z far away, where the squares would have no digits left.
        let is_nearer = |p: &Vector<2>, q: &Vector<2>| (q - p).dot(&(z * 2.0 - p - q)) < 0.0;
        nearest.fold(self.vertices[0], |best, p| if is_nearer(&p, &best) { p } else { best })
    }

    /// Along an edge the nearest point follows, at a corner it stays.
    fn project_jet(&self, z: &Vector<2>, _start: &Vector<2>) -> (Vector<2>, Matrix<2>) {
        let x = self.project(z);
        if x == *z {
            return (x, Matrix::identity());
        }
        // The end of an edge is a corner up to rounding.
        let corner = self.vertices.iter().any(|v| (v - x).norm() <= 8.0 * f64::EPSILON * v.norm());
        let t = quarter_turn(&self.normals[self.edge(&x)].normalize());
        (x, if corner { Matrix::zeros() } else { t * t.transpose() })
    }

    fn normal_cone(&self, x: &Vector<2>, tolerance: f64) -> Option<Cone<2>> {
        let gauge = self.gauge(x);
        if gauge > 1.0 + tolerance {
            return None;
        }
        let touched = self.normals.iter().filter(|n| n.dot(x) >= 1.0 - tolerance);
        Some(Cone::new(touched.copied()))
    }

    fn flat_normals(&self) -> Vec<Vector<2>> {
        self.normals.to_vec()
    }
}

//! The slip equation of one contact.

use asperity_set::{BoundaryPoint, Matrix, StarSet, Vector};

use super::super::local::Local;
use super::super::solution::LocalSolution;
use crate::law::{Cell, Node};

pub(super) type V = Vector<2>;

#[inline]
pub(super) fn cross(a: &V, b: &V) -> f64 {
    a.x * b.y - a.y * b.x
}

/// How far normal and position stray from their chords over a piece of the boundary.
#[derive(Clone, Copy)]
pub(super) struct Bounds {
    pub(super) normal: f64,
    pub(super) position: f64,
}

/// The slip equation of one contact.
pub(super) struct Slip<'a, 'b> {
    pub(super) local: &'a Local<'b, 2>,
    pub(super) c0: V,
    pub(super) a: Matrix<2>,
    pub(super) norm_c: f64,
    pub(super) norm_a: f64,
    /// Factor of the table's points of bdry *C*.
    pub(super) scale: f64,
    /// `|F|` below this value is rounding.
    pub(super) rounding: f64,
    /// Denominators below this value cost digits.
    least: f64,
    /// Square of a radius of curvature that is not extreme.
    pub(super) mild_bend: f64,
}

impl<'a, 'b> Slip<'a, 'b> {
    pub(super) fn new(local: &'a Local<'b, 2>) -> Self {
        let largest_radius = local.law.bounds().largest_radius;
        let (c0, a) = local.affine();
        // Sums of magnitudes bound the norms and need no roots.
        let norm_c = c0.x.abs() + c0.y.abs();
        let norm_a = a.m11.abs() + a.m12.abs() + a.m21.abs() + a.m22.abs();
        let rounding = 8.0 * f64::EPSILON * (norm_c + norm_a * largest_radius);
        let mild_bend = (10.0 * largest_radius).powi(2);
        let scale = local.law.isotropic_coefficient().unwrap_or(1.0);
        let least = local.least_denominator();
        Self { local, c0, a, norm_c, norm_a, scale, rounding, least, mild_bend }
    }

    /// `v(x)` at a node of the table.
    #[inline]
    pub(super) fn velocity_at(&self, node: &Node) -> V {
        self.velocity(&(node.x * self.scale))
    }

    #[inline]
    pub(super) fn velocity(&self, x: &V) -> V {
        self.c0 - self.a * x
    }

    pub(super) fn on_reservoir(&self, point: &BoundaryPoint) -> V {
        point.position / self.local.law.reservoir().gauge(&point.position)
    }

    pub(super) fn value(&self, point: &BoundaryPoint) -> f64 {
        cross(&point.normal, &self.velocity(&self.on_reservoir(point)))
    }

    /// The bounds of a cell of the table in the units of bdry *C*.
    #[inline]
    pub(super) fn bounds(&self, cell: &Cell) -> Bounds {
        Bounds { normal: cell.normal, position: self.scale * cell.position }
    }

    /// How far `F` and `n·v` may stray from their chords over a cell.
    #[inline]
    pub(super) fn stray(&self, cell: &Cell) -> f64 {
        self.norm_c * cell.normal + self.norm_a * self.scale * cell.product
    }

    /// The slip solution at a root, if it is one: `v` along `n` and the normal force positive.
    pub(super) fn admit(
        &self,
        point: &BoundaryPoint,
        degenerate: bool,
    ) -> Option<LocalSolution<2>> {
        let x = self.on_reservoir(point);
        let least = self.local.vanishing_denominator(x.norm());
        let found = self.admit_above(least, &point.normal, &x, &self.velocity(&x))?;
        Some(LocalSolution { degenerate, ..found })
    }

    /// The same for a root that Newton's method has found, if it has kept its digits.
    #[inline(always)]
    pub(super) fn admit_root(&self, n: &V, x: &V, v: &V) -> Option<LocalSolution<2>> {
        self.admit_above(self.least, n, x, v)
    }

    #[inline(always)]
    fn admit_above(&self, least: f64, n: &V, x: &V, v: &V) -> Option<LocalSolution<2>> {
        let slips = n.dot(v) > 0.0 && self.local.denominator(x) > least;
        slips.then(|| self.local.slip(x, v))
    }
}

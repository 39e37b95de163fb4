//! The roots of the slip equation in a cell of the walk.

use asperity_set::{Arc, BoundaryPoint, Convex};

use super::super::local::LocalSolution;
use super::equation::{Bounds, Slip, V};

/// Halvings of a fine cell: roots nearer to each other than about `10⁻⁹` rad are one.
const DEEPEST: usize = 24;
/// Pieces of a fine cell that are looked at before it is given up, and pieces of all cells together, which take
/// some milliseconds: longer, no search can keep anybody waiting. An ordinary cell has one piece; next to the
/// cusp of a caustic, three roots within 10⁻⁴ rad take some thousand.
const PATIENCE: usize = 4000;
const MOST: usize = 20_000;
/// Roots beyond which those of an ill-conditioned block are rounding, of which some are enough.
const MANY: usize = 64;
/// Change of `F` against its distance from the chord from which on `F` is monotone: 4 is enough where the
/// second derivative is constant, and it varies little in a cell.
pub(super) const MONOTONE: f64 = 8.0;

/// A point of the boundary with what the slip equation has there.
#[derive(Clone, Copy)]
pub(super) struct End {
    pub(super) point: BoundaryPoint,
    /// `x` on bdry *C*.
    pub(super) x: V,
    /// `v(x)`.
    pub(super) v: V,
    /// `n × v` and `n·v`, which is positive in slip.
    pub(super) value: f64,
    pub(super) along: f64,
}

impl End {
    pub(super) fn new(slip: &Slip<'_, '_>, point: BoundaryPoint) -> Self {
        let x = slip.on_reservoir(&point);
        let v = slip.velocity(&x);
        let value = super::equation::cross(&point.normal, &v);
        Self { point, x, v, value, along: point.normal.dot(&v) }
    }
}

/// How far `F` and `n·v` may stray from their chords between two points, where `n` and `x` stray by `bounds`.
///
/// With the chords `n_c`, `v_c` at the same fraction of the way, `F = (n_c + e_n) × (v_c − A e_x)`: the product of
/// the chords is off its chord by at most a quarter of `‖Δn‖‖Δv‖`. Unlike the bound of the table this one
/// falls with the slip velocity, which is small beside stick.
pub(super) fn stray(slip: &Slip<'_, '_>, a: &End, b: &End, bounds: &Bounds) -> f64 {
    let bend = 0.25 * (b.point.normal - a.point.normal).norm() * (b.v - a.v).norm();
    bounds.normal * a.v.norm().max(b.v.norm()) + slip.norm_a * bounds.position + bend
}

/// The bounds of the halves of a cell whose middle is `middle`.
///
/// The distance to the chord falls with the square of the length where the boundary is smooth, and with a
/// lesser power, but at least to a half, where its curvature is without bound: the distance of the middle
/// tells which.
pub(super) fn halved(bounds: &Bounds, a: &End, middle: &End, b: &End) -> Bounds {
    let off = |first: &V, mid: &V, last: &V| (mid - (first + last) * 0.5).norm();
    let fallen = |bound: f64, off: f64| f64::min(bound, f64::max(0.3 * bound, 0.625 * off));
    Bounds {
        normal: fallen(bounds.normal, off(&a.point.normal, &middle.point.normal, &b.point.normal)),
        position: fallen(bounds.position, off(&a.x, &middle.x, &b.x)),
    }
}

/// The search of cells for roots, which become solutions.
pub(super) struct Search<'a, 'b, 'c> {
    slip: &'a Slip<'b, 'c>,
    direction: &'a Convex<2>,
    out: &'a mut Vec<LocalSolution<2>>,
    /// Pieces looked at in this cell, and pieces that all others may still have.
    pieces: usize,
    left: usize,
    /// Whether no cell was given up.
    pub(super) complete: bool,
}

impl<'a, 'b, 'c> Search<'a, 'b, 'c> {
    pub(super) fn new(
        slip: &'a Slip<'b, 'c>,
        direction: &'a Convex<2>,
        out: &'a mut Vec<LocalSolution<2>>,
    ) -> Self {
        Self { slip, direction, out, pieces: 0, left: MOST, complete: true }
    }

    /// All roots of `F` in a cell.
    pub(super) fn cell(&mut self, first: &End, last: &End, bounds: Bounds) {
        self.pieces = 0;
        self.piece(first, last, bounds, 0);
        self.left = self.left.saturating_sub(self.pieces);
        #[cfg(test)]
        super::tests::count(self.pieces);
    }

    fn piece(&mut self, a: &End, b: &End, bounds: Bounds, depth: usize) {
        self.pieces += 1;
        if self.out.len() >= MANY && !self.slip.local.block.sound {
            self.complete = false;
            return;
        }
        let slip = self.slip;
        if (b.x - a.x).norm() <= 4.0 * f64::EPSILON * a.x.norm() {
            self.corner(a, b);
            return;
        }
        let stray = stray(slip, a, b, &bounds) + slip.rounding;
        let changes = (a.value >= 0.0) != (b.value >= 0.0);
        let no_root = !changes && a.value.abs().min(b.value.abs()) > stray;
        if no_root || a.along.max(b.along) < -stray {
            return;
        }
        let arc = Arc { start: a.point, end: b.point };
        let single = (b.value - a.value).abs() > MONOTONE * stray;
        let mut root = || {
            let root = arc.root(self.direction, slip.rounding, |point| slip.value(point));
            self.out.extend(slip.admit(&root, false));
        };
        if single {
            if changes {
                root();
            }
            return;
        }
        let middle = End::new(slip, arc.middle(self.direction));
        let largest = middle.value.abs().max(a.value.abs()).max(b.value.abs());
        if largest <= slip.rounding {
            // A continuum of solutions is represented by its ends.
            self.out.extend([a, b].iter().filter_map(|end| slip.admit(&end.point, true)));
            return;
        }
        let deepest = depth == DEEPEST;
        if deepest || self.pieces >= PATIENCE.min(self.left) {
            self.complete &= deepest;
            if changes {
                root();
            } else if deepest {
                // A double root.
                self.out.extend(slip.admit(&a.point, true));
            }
            return;
        }
        let half = halved(&bounds, a, &middle, b);
        self.piece(a, &middle, half, depth + 1);
        self.piece(&middle, b, half, depth + 1);
    }

    /// At a corner of *D* the slip velocity is the same for all normals, and the root is the normal along it.
    fn corner(&mut self, a: &End, b: &End) {
        let slip = self.slip;
        let still = a.v.norm() <= slip.rounding;
        let within =
            a.value >= -slip.rounding && b.value <= slip.rounding && a.along + b.along > 0.0;
        if within || still {
            let normal = a.v.try_normalize(0.0).unwrap_or(a.point.normal);
            let point = BoundaryPoint { position: a.point.position, normal };
            self.out.extend(slip.admit(&point, still));
        }
    }
}

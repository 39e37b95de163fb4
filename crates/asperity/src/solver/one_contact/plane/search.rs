//! The roots of the slip equation in a cell of the walk.

use asperity_set::{Arc, BoundaryPoint, Convex};

use super::super::block::MARGIN;
use super::super::local::Local;
use super::super::solution::LocalSolution;
use super::equation::{Bounds, Slip, V};
use crate::law::{Cell, Node, Walk};

/// Halvings of a fine cell: roots nearer to each other than about `10⁻⁹` rad are one.
const DEEPEST: usize = 24;
/// Pieces that are looked at in one search, which take some milliseconds. An ordinary cell has one piece; next to the
/// cusp of a caustic, three roots within 10⁻⁴ rad take some thousand.
const PATIENCE: usize = 20_000;
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
        Self::at(slip, point, slip.on_reservoir(&point))
    }

    pub(super) fn of_node(slip: &Slip<'_, '_>, node: &Node) -> Self {
        Self::at(slip, node.point, node.x * slip.scale)
    }

    fn at(slip: &Slip<'_, '_>, point: BoundaryPoint, x: V) -> Self {
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

/// Whether neither open nor stick nor slip is possible, with a margin: see `proves_no_solution` in `one_contact/solve.rs`.
pub(crate) fn proves_no_solution(local: &Local<'_, 2>) -> bool {
    if !local.excludes_open_and_stick() {
        return false;
    }
    let Walk { table, direction } = local.law.walk();
    let slip = Slip::new(local);
    let radius = local.law.bounds().largest_radius;
    let mut roots = Vec::new();
    let mut search = Search {
        velocity: MARGIN * (slip.norm_c + slip.norm_a * radius),
        resistance: MARGIN * (local.block.g_nn + local.block.g_nt.norm() * radius),
        proves: true,
        ..Search::new(&slip, direction, &mut roots)
    };
    table.nodes.windows(2).zip(&table.fine).all(|(pair, cell)| {
        search.cell(&pair[0], &pair[1], cell);
        search.complete
    })
}

/// The search of cells for roots, which become solutions.
pub(super) struct Search<'a, 'b, 'c> {
    slip: &'a Slip<'b, 'c>,
    direction: &'a Convex<2>,
    out: &'a mut Vec<LocalSolution<2>>,
    /// Velocities and denominators that count as zero.
    velocity: f64,
    resistance: f64,
    /// Whether the search ends, incomplete, where there may be a root.
    proves: bool,
    /// Pieces looked at.
    pub(super) pieces: usize,
    /// Whether no cell was given up.
    pub(super) complete: bool,
}

impl<'a, 'b, 'c> Search<'a, 'b, 'c> {
    pub(super) fn new(
        slip: &'a Slip<'b, 'c>,
        direction: &'a Convex<2>,
        out: &'a mut Vec<LocalSolution<2>>,
    ) -> Self {
        let (velocity, resistance, proves) = (slip.rounding, 0.0, false);
        let (pieces, complete) = (0, true);
        Self { slip, direction, out, velocity, resistance, proves, pieces, complete }
    }

    /// All roots of `F` between two nodes of the table.
    pub(super) fn cell(&mut self, first: &Node, last: &Node, cell: &Cell) {
        let slip = self.slip;
        let [first, last] = [first, last].map(|node| End::of_node(slip, node));
        let bounds = slip.bounds(cell);
        if !self.holds_none(&first, &last, slip.stray(cell) + self.velocity, bounds.position) {
            self.piece(&first, &last, bounds, 0);
        }
    }

    fn piece(&mut self, a: &End, b: &End, bounds: Bounds, depth: usize) {
        self.pieces += 1;
        let slip = self.slip;
        if self.proves && !self.complete {
            return;
        }
        // Of an ill-conditioned block so many roots are rounding.
        if self.out.len() >= 64 && !slip.local.block.sound {
            self.complete = false;
            return;
        }
        if !self.proves && (b.x - a.x).norm() <= 4.0 * f64::EPSILON * a.x.norm() {
            self.corner(a, b);
            return;
        }
        let stray = stray(slip, a, b, &bounds) + self.velocity;
        let changes = (a.value >= 0.0) != (b.value >= 0.0);
        if self.holds_none(a, b, stray, bounds.position) {
            return;
        }
        let arc = Arc { start: a.point, end: b.point };
        let single = (b.value - a.value).abs() > MONOTONE * stray;
        if single && !self.proves {
            if changes {
                self.root(&arc);
            }
            return;
        }
        let middle = End::new(slip, arc.middle(self.direction));
        let largest = middle.value.abs().max(a.value.abs()).max(b.value.abs());
        if largest <= slip.rounding && !self.proves {
            // A continuum of solutions is represented by its ends.
            self.out.extend([a, b].iter().filter_map(|end| slip.admit(&end.point, true)));
            return;
        }
        let deepest = depth == DEEPEST;
        if deepest || self.pieces >= PATIENCE {
            self.complete &= deepest && !self.proves;
            if changes {
                self.root(&arc);
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

    /// Whether no slip lies between two points: `F` keeps its sign, or `n·v` or the denominator is negative.
    fn holds_none(&self, a: &End, b: &End, stray: f64, position: f64) -> bool {
        let local = self.slip.local;
        let same = (a.value >= 0.0) == (b.value >= 0.0);
        let resists = || {
            let largest = local.denominator(&a.x).max(local.denominator(&b.x));
            largest >= -(local.block.g_nt.norm() * position + self.resistance)
        };
        same && a.value.abs().min(b.value.abs()) > stray
            || a.along.max(b.along) < -stray
            || !resists()
    }

    fn root(&mut self, arc: &Arc) {
        let slip = self.slip;
        let root = arc.root(self.direction, slip.rounding, |point| slip.value(point));
        self.out.extend(slip.admit(&root, false));
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

//! The proof that a contact in the plane has no solution.

use asperity_set::{Arc, Convex};

use super::super::local::Local;
use super::equation::{Bounds, Slip};
use super::search::{End, halved, stray};
use crate::law::Walk;

/// Relative margin of every inequality of a proof: what rounding, or data that are known to nine digits, could
/// turn round proves nothing.
const MARGIN: f64 = 1e-9;
/// Halvings of a cell and pieces of it before the proof is given up.
const DEEPEST: usize = 40;
const PATIENCE: usize = 4000;

/// Whether neither open nor stick nor slip is possible, with a margin: see `proves_no_solution` in `one_contact/solve.rs`.
pub(crate) fn proves_no_solution(local: &Local<'_, 2>) -> bool {
    if !local.excludes_open_and_stick(MARGIN) {
        return false;
    }
    let Walk { table, direction } = local.law.walk();
    let slip = Slip::new(local, local.law.bounds().largest_radius);
    let radius = local.law.bounds().largest_radius;
    let margins = Margins {
        velocity: MARGIN * (slip.norm_c + slip.norm_a * radius),
        resistance: MARGIN * (local.block.g_nn + local.block.g_nt.norm() * radius),
    };
    let mut proof = Proof { slip: &slip, direction, margins, pieces: 0 };
    table.nodes.windows(2).zip(&table.fine).all(|(pair, cell)| {
        let [first, last] = [&pair[0], &pair[1]].map(|node| End::new(&slip, node.point));
        proof.pieces = 0;
        proof.excludes(&first, &last, slip.bounds(cell), 0)
    })
}

/// What counts as zero.
struct Margins {
    velocity: f64,
    resistance: f64,
}

struct Proof<'a, 'b, 'c> {
    slip: &'a Slip<'b, 'c>,
    direction: &'a Convex<2>,
    margins: Margins,
    pieces: usize,
}

impl Proof<'_, '_, '_> {
    /// Whether there is no slip solution between two points: `F` keeps its sign, or `n·v` or the denominator is
    /// negative, all over the piece or over each half of it.
    fn excludes(&mut self, a: &End, b: &End, bounds: Bounds, depth: usize) -> bool {
        self.pieces += 1;
        let (slip, local) = (self.slip, self.slip.local);
        let stray = stray(slip, a, b, &bounds) + self.margins.velocity;
        let same = (a.value >= 0.0) == (b.value >= 0.0);
        let no_root = same && a.value.abs().min(b.value.abs()) > stray;
        let resistance = |end: &End| local.denominator(&end.x);
        let lifted = local.block.g_nt.norm() * bounds.position + self.margins.resistance;
        if no_root || a.along.max(b.along) < -stray || resistance(a).max(resistance(b)) < -lifted {
            return true;
        }
        if depth == DEEPEST || self.pieces >= PATIENCE {
            return false;
        }
        let arc = Arc { start: a.point, end: b.point };
        let middle = End::new(slip, arc.middle(self.direction));
        let half = halved(&bounds, a, &middle, b);
        self.excludes(a, &middle, half, depth + 1) && self.excludes(&middle, b, half, depth + 1)
    }
}

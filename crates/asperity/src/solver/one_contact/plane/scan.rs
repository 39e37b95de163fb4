//! The coarse scan of the walk, which rules out most of the boundary at once.

use super::equation::{Slip, cross};
use super::search::MONOTONE;
use crate::law::{COARSE, Columns, WalkTable};

/// Which coarse cells may hold a solution.
pub(super) struct Scan {
    /// How far a cell is from holding a solution; not positive where it may hold one.
    margin: [f64; COARSE],
}

/// A call of [`Scan::new`] that the compiler copies into every set of instructions. The loops have no branches, so that they
/// are compiled to vector instructions; multiplications and additions stay apart, with the same bits in all of them.
struct Evaluation<'a, 'b, 'c> {
    slip: &'a Slip<'b, 'c>,
    table: &'a WalkTable,
}

impl pulp::NullaryFnOnce for Evaluation<'_, '_, '_> {
    type Output = Scan;

    #[inline(always)]
    fn call(self) -> Scan {
        let Self { slip, table } = self;
        let (c0, a) = (&slip.c0, slip.a * slip.scale);
        let Columns { n: [n0, n1], nx: [[n0x0, n0x1], [n1x0, n1x1]], normal, product } =
            &*table.columns;
        let (mut value, mut against) = ([0.0; COARSE + 1], [0.0; COARSE + 1]);
        for i in 0..COARSE {
            let v0 = a.m11 * n0x0[i] + a.m12 * n0x1[i];
            let v1 = a.m21 * n1x0[i] + a.m22 * n1x1[i];
            against[i] = v0 + v1 - (c0.x * n0[i] + c0.y * n1[i]);
            let w0 = a.m21 * n0x0[i] + a.m22 * n0x1[i];
            let w1 = a.m11 * n1x0[i] + a.m12 * n1x1[i];
            value[i] = c0.y * n0[i] - c0.x * n1[i] - w0 + w1;
        }
        (value[COARSE], against[COARSE]) = (value[0], against[0]);
        let (by_normal, by_product) = (slip.norm_c, slip.norm_a * slip.scale);
        let mut margin = [0.0; COARSE];
        for i in 0..COARSE {
            let stray = by_normal * normal[i] + by_product * product[i];
            let (f, g) = (value[i], value[i + 1]);
            // The lesser magnitude of values of one sign, not positive where the sign changes.
            let apart = larger(smaller(f, g), smaller(-f, -g));
            margin[i] = larger(apart, smaller(against[i], against[i + 1])) - stray;
        }
        Scan { margin }
    }
}

impl Scan {
    /// Evaluates `F` and `n·v` at all coarse nodes: a cell is excluded where `F` keeps away from zero, or `n·v` stays
    /// below it, by more than they may stray from their chords.
    pub(super) fn new(slip: &Slip<'_, '_>, table: &WalkTable) -> Self {
        pulp::Arch::new().dispatch(Evaluation { slip, table })
    }

    /// The cells that may hold a solution; what is not a number excludes nothing.
    pub(super) fn open(&self) -> impl Iterator<Item = usize> + '_ {
        self.margin.iter().enumerate().filter_map(|(i, &margin)| (!(margin > 0.0)).then_some(i))
    }

    /// Whether there is one slip only: all coarse cells but one hold none, and all fine cells in there but one, in which
    /// `F` changes its sign and is monotone within its bound.
    #[inline(never)]
    pub(super) fn has_one_root(slip: &Slip<'_, '_>, table: &WalkTable) -> bool {
        let scan = Self::new(slip, table);
        let mut open = scan.open();
        let (Some(cell), None) = (open.next(), open.next()) else { return false };
        let value = |j: usize| {
            let node = &table.nodes[j];
            cross(&node.point.normal, &slip.velocity_at(node))
        };
        let mut changes = 0;
        for j in cell * table.fine_per_coarse..(cell + 1) * table.fine_per_coarse {
            let (f, g) = (value(j), value(j + 1));
            let stray = slip.stray(&table.fine[j]);
            let change = (f >= 0.0) != (g >= 0.0);
            let certain = if change {
                (f - g).abs() > MONOTONE * stray
            } else {
                f.abs().min(g.abs()) > stray
            };
            if !certain {
                return false;
            }
            changes += usize::from(change);
        }
        changes == 1
    }
}

/// The smaller and the larger of two numbers without the questions about what is none.
#[inline(always)]
fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

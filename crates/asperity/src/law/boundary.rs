//! The boundary of *C* in pieces, with the normals of *D* that belong to them.

use asperity_set::{StarSet, Vector};

use super::FrictionLaw;

/// A piece of the boundary, on a line one of two points.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BoundaryPiece {
    /// Normals of *D* at its ends.
    pub(crate) normals: [Vector<2>; 2],
    /// Points of *C* at its ends.
    pub(crate) ends: [Vector<2>; 2],
    /// How far points of *C* stray from the chord.
    pub(crate) stray: f64,
}

impl FrictionLaw<1> {
    /// Both ends of *C*, times `unit`.
    pub(crate) fn boundary(&self, unit: f64) -> Vec<BoundaryPiece> {
        let end = |sign: f64| {
            let x = unit * sign / self.reservoir().gauge(&Vector::<1>::new(sign));
            let (n, x) = (Vector::<2>::new(sign, 0.0), Vector::<2>::new(x, 0.0));
            BoundaryPiece { normals: [n, n], ends: [x, x], stray: 0.0 }
        };
        [1.0, -1.0].map(end).into()
    }
}

impl FrictionLaw<2> {
    /// The cells of the law's table, times `unit`.
    pub(crate) fn boundary(&self, unit: f64) -> Vec<BoundaryPiece> {
        let table = self.walk().table;
        // Isotropic laws share the table of the unit disk.
        let unit = unit * self.isotropic_coefficient().unwrap_or(1.0);
        let cells = table.nodes.windows(2).zip(&table.fine);
        let piece = cells.map(|(pair, cell)| BoundaryPiece {
            normals: [pair[0].point.normal, pair[1].point.normal],
            ends: [pair[0].x * unit, pair[1].x * unit],
            stray: cell.position * unit,
        });
        piece.collect()
    }
}

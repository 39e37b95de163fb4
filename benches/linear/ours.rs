//! The factorisations of the library.

use crate::contact::BlockMatrix;
use crate::linear::{DenseLu, Kind, Numeric, Symbolic};
use crate::measure::Factorisation;

/// Analysed once, factored without allocation.
pub struct Ours<'a> {
    matrix: &'a BlockMatrix,
    kind: Kind,
    symbolic: Symbolic,
    numeric: Numeric,
}

impl<'a> Ours<'a> {
    /// The analysis of the pattern, with room for the factors.
    pub fn new(matrix: &'a BlockMatrix, kind: Kind) -> Self {
        let (symbolic, mut numeric) = (Symbolic::new(matrix), Numeric::default());
        numeric.reserve(&symbolic);
        Self { matrix, kind, symbolic, numeric }
    }
}

impl Factorisation for Ours<'_> {
    fn factor(&mut self) -> bool {
        self.numeric.factor(&self.symbolic, (self.matrix, self.kind), &|| false)
    }

    fn solve(&mut self, x: &mut [f64]) {
        self.numeric.solve(&self.symbolic, x);
    }
}

/// The factorisation of small dense matrices.
pub struct OursDense<'a> {
    entries: &'a [f64],
    size: usize,
    lu: DenseLu,
}

impl<'a> OursDense<'a> {
    /// Of a matrix whose entries are given row by row.
    pub fn new(entries: &'a [f64], size: usize) -> Self {
        Self { entries, size, lu: DenseLu::default() }
    }
}

impl Factorisation for OursDense<'_> {
    fn factor(&mut self) -> bool {
        self.lu.begin(self.size).copy_from_slice(self.entries);
        self.lu.factor(0.0)
    }

    fn solve(&mut self, x: &mut [f64]) {
        self.lu.solve(x);
    }
}

//! Velocities that bilateral constraints hold: projections along their forces.
//!
//! With rows `J` of what is held, forces of constraints change velocities by `M⁻¹JᵀΛ`. What they take out of velocities `u` is
//! `M⁻¹Jᵀ(J M⁻¹Jᵀ)⁻¹J u` with as many rows as do not repeat others, as some do in planar loops in space.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

/// Share of the diagonal below which pivots are rounding; that of a light body between heavy ones is their ratio of masses.
const REPEATED: f64 = 1e-13;

/// The constraints of a block of velocities at a configuration.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Held {
    pub(crate) block: usize,
    pub(crate) velocities: Range<usize>,
    /// Number of rows, and those that repeat no others.
    pub(crate) count: usize,
    /// Sizes of the terms of `g`, of all rows.
    pub(crate) sizes: Vec<f64>,
    kept: Vec<usize>,
    /// `J` and `M⁻¹Jᵀ` of these, and the Cholesky factor of `J M⁻¹Jᵀ`.
    rows: DMatrix<f64>,
    responses: DMatrix<f64>,
    factor: DMatrix<f64>,
}

impl Held {
    /// From `J`, `M⁻¹Jᵀ` and sizes of all rows.
    pub(crate) fn new(
        block: usize,
        velocities: Range<usize>,
        rows: &DMatrix<f64>,
        responses: &DMatrix<f64>,
        sizes: Vec<f64>,
    ) -> Self {
        let (count, mut left) = (rows.nrows(), rows * responses);
        let diagonal = left.diagonal();
        let (mut kept, mut columns) = (Vec::new(), Vec::new());
        while let Some(next) = (0..count)
            .filter(|&k| left[(k, k)] > REPEATED * diagonal[k])
            .max_by(|&a, &b| (left[(a, a)] / diagonal[a]).total_cmp(&(left[(b, b)] / diagonal[b])))
        {
            let column = left.column(next) / left[(next, next)].sqrt();
            left -= &column * column.transpose();
            left.row_mut(next).fill(0.0);
            left.column_mut(next).fill(0.0);
            kept.push(next);
            columns.push(column);
        }
        let entry = |i: usize, k: usize| if i < k { 0.0 } else { columns[k][kept[i]] };
        let factor = DMatrix::from_fn(kept.len(), kept.len(), entry);
        let (rows, responses) = (rows.select_rows(&kept), responses.select_columns(&kept));
        Self { block, velocities, count, sizes, kept, rows, responses, factor }
    }

    /// Whether a row is none that repeats others.
    pub(crate) fn keeps(&self, row: usize) -> bool {
        self.kept.contains(&row)
    }

    /// Takes rates of what is held, of all rows, out of velocities of the block.
    pub(crate) fn take(&self, rates: &[f64], velocities: &mut [f64]) {
        self.remove(
            DVector::from_iterator(self.kept.len(), self.kept.iter().map(|&k| rates[k])),
            velocities,
        );
    }

    /// Leaves of velocities of the block what the constraints let pass.
    pub(crate) fn project(&self, velocities: &mut [f64]) {
        // Twice, as the first is off by rounding of what it takes.
        for _ in 0..2 {
            self.remove(&self.rows * DVector::from_column_slice(velocities), velocities);
        }
    }

    /// Forces of all rows against rates of what is held; of rows that repeat others none.
    pub(crate) fn reactions(&self, rates: &[f64]) -> Vec<f64> {
        let kept = DVector::from_iterator(self.kept.len(), self.kept.iter().map(|&k| -rates[k]));
        let mut forces = vec![0.0; self.count];
        self.kept.iter().zip(&self.solved(kept)).for_each(|(&k, &force)| forces[k] = force);
        forces
    }

    fn solved(&self, mut rates: DVector<f64>) -> DVector<f64> {
        self.factor.solve_lower_triangular_mut(&mut rates);
        self.factor.tr_solve_lower_triangular_mut(&mut rates);
        rates
    }

    fn remove(&self, rates: DVector<f64>, velocities: &mut [f64]) {
        let taken = &self.responses * self.solved(rates);
        velocities.iter_mut().zip(&taken).for_each(|(u, taken)| *u -= taken);
    }
}

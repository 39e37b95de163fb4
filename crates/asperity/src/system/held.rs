//! Velocities that joints hold: projections along their forces.
//!
//! With rows `J` of what is held, forces of joints change velocities by `M⁻¹JᵀΛ`. What they take out of velocities `u` is
//! `M⁻¹Jᵀ(J M⁻¹Jᵀ)⁺J u`, of least norm in Λ scaled by the diagonal, so that joints may repeat each other, as in planar
//! loops in space.

use std::ops::Range;

use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Scaled eigenvalue up to which rows repeat others; that of a light body between heavy ones is their ratio of masses.
const REPEATED: f64 = 1e-13;

/// The joints of a block of velocities at a configuration.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Held {
    pub(crate) block: usize,
    pub(crate) velocities: Range<usize>,
    /// `J`, and `M⁻¹Jᵀ`.
    rows: DMatrix<f64>,
    responses: DMatrix<f64>,
    /// Roots of the diagonal of `J M⁻¹Jᵀ`, inverse; zero for rows that move nothing.
    scale: DVector<f64>,
    /// `Λ^{-1/2} Vᵀ` of the scaled `J M⁻¹Jᵀ = V Λ Vᵀ`.
    basis: DMatrix<f64>,
}

impl Held {
    pub(crate) fn new(
        block: usize,
        velocities: Range<usize>,
        rows: DMatrix<f64>,
        responses: DMatrix<f64>,
    ) -> Self {
        let mobility = &rows * &responses;
        let scale = mobility.diagonal().map(|g| if g > 0.0 { g.sqrt().recip() } else { 0.0 });
        let scaled = DMatrix::from_fn(scale.len(), scale.len(), |i, j| {
            scale[i] * mobility[(i, j)] * scale[j]
        });
        let SymmetricEigen { eigenvectors, eigenvalues } = SymmetricEigen::new(scaled);
        let least = REPEATED * scale.len() as f64;
        let kept: Vec<usize> = (0..scale.len()).filter(|&k| eigenvalues[k] > least).collect();
        let basis = DMatrix::from_fn(kept.len(), scale.len(), |k, i| {
            eigenvectors[(i, kept[k])] / eigenvalues[kept[k]].sqrt()
        });
        Self { block, velocities, rows, responses, scale, basis }
    }

    /// Number of rows.
    pub(crate) fn len(&self) -> usize {
        self.rows.nrows()
    }

    /// The forces of the joints that change what they hold by `rates`.
    pub(crate) fn forces(&self, rates: &DVector<f64>) -> DVector<f64> {
        let scaled = &self.basis * rates.component_mul(&self.scale);
        self.basis.tr_mul(&scaled).component_mul(&self.scale)
    }

    /// Takes `rates` out of velocities of the block.
    pub(crate) fn take(&self, rates: &DVector<f64>, velocities: &mut [f64]) {
        let taken = &self.responses * self.forces(rates);
        velocities.iter_mut().zip(&taken).for_each(|(u, taken)| *u -= taken);
    }

    /// Leaves of velocities of the block what the joints let pass.
    pub(crate) fn project(&self, velocities: &mut [f64]) {
        // Twice, as the first is off by rounding of what it takes.
        for _ in 0..2 {
            let rates = &self.rows * DVector::from_column_slice(velocities);
            self.take(&rates, velocities);
        }
    }
}

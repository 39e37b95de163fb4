//! Factors of the mass matrix, block by block.

use nalgebra::{Cholesky, DMatrix, DVectorViewMut, Dyn};

use super::{System, SystemError};
use crate::vectors::unrolled;

/// The mass matrix ready to be solved with.
#[derive(Debug, Clone, Default)]
pub(crate) struct MassFactors {
    /// Reciprocals of the diagonals of blocks that have nothing beside them.
    reciprocals: Vec<f64>,
    /// Cholesky factors of the other blocks; none at all if there are no others.
    cholesky: Vec<Option<Cholesky<f64, Dyn>>>,
    /// The matrix of a block.
    block: Vec<f64>,
}

impl MassFactors {
    /// Factors the mass matrix of these coordinates at the time `t`.
    ///
    /// # Errors
    ///
    /// [`SystemError::SingularMass`] unless it is symmetric positive definite.
    #[inline(never)]
    pub(crate) fn update(
        &mut self,
        system: &dyn System,
        t: f64,
        q: &[f64],
    ) -> Result<(), SystemError> {
        let blocks = system.blocks();
        let singular =
            |block| Err(SystemError::SingularMass { block, blocks: blocks.count(), time: t });
        self.reciprocals.resize(blocks.velocities(), 0.0);
        self.cholesky.clear();
        for number in 0..blocks.count() {
            let range = blocks.range(number);
            let n = range.len();
            self.block.resize(n * n, 0.0);
            system.mass(q, number, &mut self.block)?;
            let entry = |i: usize, j: usize| self.block[n * j + i];
            if (0..n).all(|j| (0..n).all(|i| i == j || entry(i, j) == 0.0)) {
                if !(0..n).all(|i| entry(i, i) > 0.0 && entry(i, i).is_finite()) {
                    return singular(number);
                }
                let reciprocals = self.reciprocals[range].iter_mut();
                reciprocals.enumerate().for_each(|(i, value)| *value = 1.0 / entry(i, i));
                continue;
            }
            let mass = DMatrix::from_column_slice(n, n, &self.block);
            let symmetric = (&mass - mass.transpose()).amax() <= 1e-12 * mass.amax();
            let Some(factor) = mass.cholesky().filter(|_| symmetric) else {
                return singular(number);
            };
            self.cholesky.resize(blocks.count(), None);
            self.cholesky[number] = Some(factor);
        }
        Ok(())
    }

    /// `values ← M⁻¹ values` for one block.
    #[inline]
    pub(crate) fn solve_block(&self, system: &dyn System, block: usize, values: &mut [f64]) {
        if let Some(Some(factor)) = self.cholesky.get(block) {
            let len = values.len();
            return factor.solve_mut(&mut DVectorViewMut::from_slice(values, len));
        }
        let first = system.blocks().range(block).start;
        for (value, reciprocal) in values.iter_mut().zip(&self.reciprocals[first..]) {
            *value *= reciprocal;
        }
    }

    /// `values ← M⁻¹ values` for all velocities.
    #[inline(never)]
    pub(crate) fn solve(&self, system: &dyn System, values: &mut [f64]) {
        if self.cholesky.is_empty() {
            for (value, reciprocal) in values.iter_mut().zip(&self.reciprocals) {
                *value *= reciprocal;
            }
            return;
        }
        let blocks = system.blocks();
        for block in 0..blocks.count() {
            self.solve_block(system, block, &mut values[blocks.range(block)]);
        }
    }

    /// `u ← u_B + Δt M⁻¹ h` for all velocities.
    #[inline]
    pub(crate) fn accelerate(
        &self,
        system: &dyn System,
        before: &[f64],
        (dt, forces): (f64, &[f64]),
        u: &mut [f64],
    ) {
        if self.cholesky.is_empty() {
            return unrolled!(n = u.len() => {
                let (before, forces, u) = (&before[..n], &forces[..n], &mut u[..n]);
                let reciprocals = &self.reciprocals[..n];
                for i in 0..n {
                    u[i] = before[i] + dt * (forces[i] * reciprocals[i]);
                }
            });
        }
        u.copy_from_slice(forces);
        self.solve(system, u);
        for (u, before) in u.iter_mut().zip(before) {
            *u = before + dt * *u;
        }
    }
}

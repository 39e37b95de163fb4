//! Bilateral rows, `ξ_E = 0` with percussions of any sign, eliminated from `ξ = G P + b`.
//!
//! With `S = diag(G_EE)^{-1/2}` and `S G_EE S = V Λ Vᵀ`, `B = Λ^{-1/2} Vᵀ S` over the eigenvalues that are not zero:
//! `P_E = −Bᵀ(B b_E + B G_EC P_C)` has the least sum of squares, weighted with `G_ii`, among all that leave the least velocities. The
//! other rows see `G_CC − (B G_EC)ᵀ(B G_EC)` and `b_C − (B G_EC)ᵀ B b_E`.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::ROUNDED;

/// Part of the velocities that joints have to take out which may be left: loops repeat rows, and drift makes them differ.
pub(super) const DRIFT: f64 = 1e-6;

/// The bilateral rows of a step.
#[derive(Debug, Clone, Default)]
pub(super) struct Joints {
    rows: Vec<usize>,
    /// `B`.
    basis: DMatrix<f64>,
    /// `B G`, over all rows.
    coupling: DMatrix<f64>,
    /// `B b_E`.
    load: DVector<f64>,
}

impl Joints {
    /// Eliminates these rows; `delassus` is symmetric.
    pub(super) fn eliminate(
        &mut self,
        rows: impl Iterator<Item = usize>,
        delassus: &[f64],
        free_velocity: &[f64],
    ) {
        self.rows.clear();
        self.rows.extend(rows);
        let (rows, all) = (&self.rows, free_velocity.len());
        let count = rows.len();
        if count == 0 {
            return;
        }
        let g = |i: usize, j: usize| delassus[i * all + j];
        let scale = |i: usize| if g(i, i) > 0.0 { g(i, i).sqrt().recip() } else { 0.0 };
        let scaled = DMatrix::from_fn(count, count, |a, b| {
            scale(rows[a]) * g(rows[a], rows[b]) * scale(rows[b])
        });
        let SymmetricEigen { eigenvectors, eigenvalues } = SymmetricEigen::new(scaled);
        let least = ROUNDED * count as f64;
        let kept: Vec<usize> = (0..count).filter(|&k| eigenvalues[k] > least).collect();
        self.basis = DMatrix::from_fn(kept.len(), count, |k, a| {
            eigenvectors[(a, kept[k])] * scale(rows[a]) / eigenvalues[kept[k]].sqrt()
        });
        // Sums whose order is that of the joints, wherever a row is listed.
        let times = |k: usize, value: &dyn Fn(usize) -> f64| -> f64 {
            rows.iter().enumerate().map(|(a, &row)| self.basis[(k, a)] * value(row)).sum()
        };
        self.coupling = DMatrix::from_fn(kept.len(), all, |k, j| times(k, &|row| g(row, j)));
        self.load = DVector::from_fn(kept.len(), |k, _| times(k, &|row| free_velocity[row]));
    }

    /// What the joints take from an entry of `G`.
    #[inline]
    pub(super) fn entry(&self, i: usize, j: usize) -> f64 {
        if self.rows.is_empty() {
            return 0.0;
        }
        self.coupling.column(i).dot(&self.coupling.column(j))
    }

    /// What the joints take from the free velocity of a row.
    #[inline]
    pub(super) fn velocity(&self, i: usize) -> f64 {
        if self.rows.is_empty() { 0.0 } else { self.coupling.column(i).dot(&self.load) }
    }

    /// Fills in the percussions of the joints from those of the `other` rows.
    pub(super) fn react(&self, percussion: &mut [f64], others: impl Iterator<Item = usize>) {
        if self.rows.is_empty() {
            return;
        }
        let mut taken = self.load.clone();
        for j in others.filter(|&j| percussion[j] != 0.0) {
            taken.axpy(percussion[j], &self.coupling.column(j), 1.0);
        }
        for (a, &row) in self.rows.iter().enumerate() {
            percussion[row] = -self.basis.column(a).dot(&taken);
        }
    }

    /// The row that moves most where others contradict it, by more than drift of the velocities that rows which influence it have to
    /// take out; else the one that moves most.
    pub(super) fn mismatch(
        &self,
        delassus: &[f64],
        free_velocity: &[f64],
        percussion: &[f64],
        velocity: &[f64],
    ) -> Mismatch {
        let all = free_velocity.len();
        let entry = |i: usize, j: usize| delassus[i * all + j];
        let load = |row: usize| {
            let others = (0..all).filter(|j| !self.rows.contains(j));
            free_velocity[row].abs()
                + others.map(|j| (entry(row, j) * percussion[j]).abs()).sum::<f64>()
        };
        let loads: Vec<f64> = self.rows.iter().map(|&row| load(row)).collect();
        let rounding = ROUNDED * loads.iter().copied().fold(0.0, f64::max);
        let mut worst = Mismatch { is_drift: true, ..Mismatch::default() };
        for &row in &self.rows {
            let meet = |other: usize| {
                entry(row, other).abs() > ROUNDED * (entry(row, row) * entry(other, other)).sqrt()
            };
            let own =
                self.rows.iter().zip(&loads).filter(|(other, _)| **other == row || meet(**other));
            let reach = own.map(|(_, load)| *load).fold(0.0, f64::max);
            let left = velocity[row].abs();
            // Also where it is not a number.
            let is_drift = left <= f64::max(DRIFT * reach, rounding);
            if left.is_nan() || (!is_drift, left) > (!worst.is_drift, worst.velocity) {
                worst = Mismatch { row, velocity: left, is_drift };
            }
            if left.is_nan() {
                break;
            }
        }
        worst
    }
}

/// What is left of a velocity that no percussion can change.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Mismatch {
    pub(super) row: usize,
    pub(super) velocity: f64,
    pub(super) is_drift: bool,
}

//! Bilateral rows, `ξ_E = 0` with percussions of any sign, eliminated from `ξ = G P + b`.
//!
//! With `S = diag(G_EE)^{-1/2}` and `S G_EE S = V Λ Vᵀ`, `B = Λ^{-1/2} Vᵀ S` over the eigenvalues that are not zero:
//! `P_E = −Bᵀ(B b_E + B G_EC P_C)` has the least sum of squares, weighted with `G_ii`, among all that leave the least velocities. The
//! other rows see `G_CC − (B G_EC)ᵀ(B G_EC)` and `b_C − (B G_EC)ᵀ B b_E`.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::arranged::{Arranged, Rows};
use super::{DRIFT, ROUNDED};

/// What a percussion brings to its own row over the largest velocity without percussions, from which on it may run away.
const GROWN: f64 = 100.0;

/// The bilateral rows of a step.
#[derive(Debug, Clone, Default)]
pub(super) struct Joints {
    joints: Vec<usize>,
    rows: Vec<usize>,
    /// Whether each row, of all, is influenced by one of them.
    meets: Vec<bool>,
    /// `B`.
    basis: DMatrix<f64>,
    /// `B G`, over all rows.
    coupling: DMatrix<f64>,
    /// `B b_E`.
    load: DVector<f64>,
}

impl Joints {
    /// Eliminates the bilateral rows of a step.
    pub(super) fn eliminate(&mut self, step: &Arranged) {
        let Self { joints, rows, meets, .. } = self;
        meets.clear();
        meets.resize(step.len(), false);
        joints.clear();
        joints.extend((0..step.items.len()).filter(|&k| step.items[k] == Rows::Bilateral));
        rows.clear();
        rows.extend(joints.iter().map(|&joint| step.rows(joint).start));
        let count = joints.len();
        if count == 0 {
            return;
        }
        let g =
            |a: usize, b: usize| step.mobility.between(joints[a], joints[b]).map_or(0.0, |g| g[0]);
        let scale = |a: usize| if g(a, a) > 0.0 { g(a, a).sqrt().recip() } else { 0.0 };
        let scaled = DMatrix::from_fn(count, count, |a, b| scale(a) * g(a, b) * scale(b));
        let SymmetricEigen { eigenvectors, eigenvalues } = SymmetricEigen::new(scaled);
        // What rows that almost repeat each other leave of velocities is their root.
        let least = (0.1 * DRIFT).powi(2) * count as f64;
        let kept: Vec<usize> = (0..count).filter(|&k| eigenvalues[k] > least).collect();
        self.basis = DMatrix::from_fn(kept.len(), count, |k, a| {
            eigenvectors[(a, kept[k])] * scale(a) / eigenvalues[kept[k]].sqrt()
        });
        self.coupling = DMatrix::zeros(kept.len(), step.len());
        self.load = DVector::zeros(kept.len());
        for (a, &joint) in joints.iter().enumerate() {
            let own = self.basis.column(a);
            self.load.axpy(step.free_velocity[rows[a]], &own, 1.0);
            for (other, block) in step.mobility.row(joint) {
                for (row, &entry) in step.rows(other).zip(block) {
                    meets[row] |= entry != 0.0;
                    self.coupling.column_mut(row).axpy(entry, &own, 1.0);
                }
            }
        }
    }

    /// Whether joints influence a row.
    pub(super) fn influence(&self, row: usize) -> bool {
        self.meets[row]
    }

    /// What the joints take from an entry of `G`.
    #[inline]
    pub(super) fn entry(&self, i: usize, j: usize) -> f64 {
        if !(self.meets[i] && self.meets[j]) {
            return 0.0;
        }
        self.coupling.column(i).dot(&self.coupling.column(j))
    }

    /// What the joints take from the free velocity of a row.
    #[inline]
    pub(super) fn velocity(&self, i: usize) -> f64 {
        if self.meets[i] { self.coupling.column(i).dot(&self.load) } else { 0.0 }
    }

    /// Fills in the percussions of the joints from those of the `other` rows.
    pub(super) fn react(&self, percussion: &mut [f64], others: impl Iterator<Item = usize>) {
        if self.rows.is_empty() {
            return;
        }
        let mut taken = self.load.clone();
        for j in others.filter(|&j| percussion[j] != 0.0 && self.meets[j]) {
            taken.axpy(percussion[j], &self.coupling.column(j), 1.0);
        }
        for (a, &row) in self.rows.iter().enumerate() {
            percussion[row] = -self.basis.column(a).dot(&taken);
        }
    }

    /// The row that moves most where others contradict it, by more than drift of the velocities that rows which influence it have to
    /// take out; else the one that moves most. Of what percussions of others bring, which may run away, counts at most [`GROWN`]
    /// times the largest velocity without percussions.
    pub(super) fn mismatch(
        &self,
        step: &Arranged,
        percussion: &[f64],
        velocity: &[f64],
    ) -> Mismatch {
        let is_joint = |place: usize| step.items[place] == Rows::Bilateral;
        let most = GROWN * step.largest_velocity();
        let mut has_grown = false;
        let mut load = |joint: usize| {
            let (mut taken, mut brought) = (0.0, 0.0);
            for (other, block) in step.mobility.row(joint).filter(|(other, _)| !is_joint(*other)) {
                for (k, (g, p)) in block.iter().zip(&percussion[step.rows(other)]).enumerate() {
                    taken += (g * p).abs();
                    brought = f64::max(brought, (step.own(other, k, k) * p).abs());
                }
            }
            if brought > most {
                has_grown = true;
                taken *= most / brought;
            }
            step.free_velocity[step.rows(joint).start].abs() + taken
        };
        let loads: Vec<f64> = self.joints.iter().map(|&joint| load(joint)).collect();
        let rounding = ROUNDED * loads.iter().copied().fold(0.0, f64::max);
        let mut worst = Mismatch { is_drift: true, ..Mismatch::default() };
        for (&joint, &row) in self.joints.iter().zip(&self.rows) {
            let size = |place: usize| step.mobility.diagonal(place)[0];
            let meet = |other: usize| {
                let entry = step.mobility.between(joint, other).map_or(0.0, |block| block[0]);
                entry.abs() > ROUNDED * (size(joint) * size(other)).sqrt()
            };
            let all = self.joints.iter().zip(&loads);
            let own = all.filter(|(other, _)| **other == joint || meet(**other));
            let reach = own.map(|(_, load)| *load).fold(0.0, f64::max);
            let left = velocity[row].abs();
            // Also where it is not a number.
            let is_drift = left <= f64::max(DRIFT * reach, rounding);
            if left.is_nan() || (!is_drift, left) > (!worst.is_drift, worst.velocity) {
                worst = Mismatch { place: joint, velocity: left, is_drift, has_grown };
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
    /// The item.
    pub(super) place: usize,
    pub(super) velocity: f64,
    pub(super) is_drift: bool,
    /// Whether percussions have grown so far that this does not tell what is contradicted.
    pub(super) has_grown: bool,
}

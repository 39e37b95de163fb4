//! Derivatives: of the sliding forces by the laws, of what systems do not give by differences.

use super::collocation::Scale;
use super::field::{Field, add, dot};
use super::force;
use super::touch::{FieldError, ROWS, State};
use crate::contact::Phase;

impl Field<'_> {
    /// `Ẇᵀu + χ̇` and `ẇ_Nᵀu` of the closed contacts, by central differences of fourth order along the motion.
    pub(super) fn update_drift(&mut self, t: f64, q: &[f64], u: &[f64]) -> Result<(), FieldError> {
        let largest = |v: &[f64]| v.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        let step = f64::min(1e-4, 1e-3 * (largest(q) + 0.01) / largest(u).max(f64::MIN_POSITIVE));
        self.drift.fill(0.0);
        let n = self.n;
        for (k, weight) in [(-2.0, 1.0), (-1.0, -8.0), (1.0, 8.0), (2.0, -1.0)] {
            let time = t + k * step;
            self.system.advance(q, u, k * step, &mut self.scratch_q);
            for (i, touch) in self.touches.iter().enumerate() {
                if touch.mode == Phase::Open && !touch.resting {
                    continue;
                }
                let rows = &mut self.scratch;
                let mut chi = [0.0; ROWS];
                if touch.prescribed.is_none() {
                    self.system.gap(time, &self.scratch_q, i, &mut rows[..n])?;
                }
                let own = (1 + touch.p) * n;
                self.system.tangent(
                    time,
                    &self.scratch_q,
                    i,
                    &mut rows[n..own],
                    &mut chi[1..=touch.p],
                )?;
                let first = usize::from(touch.prescribed.is_some());
                for r in first..=touch.p {
                    let velocity = chi[r] + dot(&rows[r * n..(r + 1) * n], u);
                    self.drift[ROWS * i + r] += weight * velocity / (12.0 * step);
                }
            }
        }
        Ok(())
    }

    /// The smooth part of the Jacobian at `state`: forward differences at fixed sliding directions.
    pub(super) fn linearise(&mut self, state: &State, scale: Scale) -> Result<(), FieldError> {
        let n = self.n;
        let State { t, q, u } = state;
        let (mut q, mut u) = (q.clone(), u.clone());
        self.evaluate(*t, &q, &u, true)?;
        let (here, slips) = (self.acceleration.clone(), self.slips());
        let root = f64::EPSILON.sqrt();
        for j in 0..n {
            let (kept, step) = (u[j], root * u[j].abs().max(1e-3 * scale.u));
            u[j] += step;
            let step = u[j] - kept;
            self.evaluate(*t, &q, &u, true)?;
            u[j] = kept;
            for (k, (there, here)) in self.acceleration.iter().zip(&here).enumerate() {
                self.smooth_u[k * n + j] = (there - here) / step;
            }
        }
        for j in 0..n {
            let (kept, step) = (q[j], root * q[j].abs().max(1e-3 * scale.q));
            q[j] += step;
            let step = q[j] - kept;
            self.evaluate(*t, &q, &u, true)?;
            q[j] = kept;
            for (k, (there, here)) in self.acceleration.iter().zip(&here).enumerate() {
                self.smooth_q[k * n + j] = (there - here) / step;
            }
            for (i, (touch, here)) in self.touches.iter().zip(&slips).enumerate() {
                for (r, (there, here)) in touch.slip[..touch.p].iter().zip(here).enumerate() {
                    self.slip_gradient[(ROWS * i + 1 + r) * n + j] = (there - here) / step;
                }
            }
        }
        Ok(())
    }

    fn slips(&self) -> Vec<[f64; 3]> {
        self.touches.iter().map(|touch| touch.slip).collect()
    }

    /// Jacobian of the acceleration where it was evaluated last: the smooth part, which is kept, and that of
    /// the sliding directions.
    pub(super) fn jacobian(&mut self, ku: &mut [f64], kq: &mut [f64]) {
        let n = self.n;
        ku.copy_from_slice(&self.smooth_u);
        kq.copy_from_slice(&self.smooth_q);
        let mut column = std::mem::take(&mut self.scratch_q);
        for i in 0..self.touches.len() {
            let touch = self.touches[i];
            if touch.mode != Phase::Slip {
                continue;
            }
            let slope = force::jacobian(self.law(i), &touch.slip);
            for (r, slope) in slope[..touch.p].iter().enumerate() {
                let first = (ROWS * i + 1 + r) * n;
                column.copy_from_slice(&self.response[first..first + n]);
                self.constrain(&mut column);
                for (s, slope) in slope[..touch.p].iter().enumerate() {
                    let factor = touch.normal_force * slope;
                    let along = (ROWS * i + 1 + s) * n;
                    dyad(ku, factor, &column, &self.rows[along..along + n]);
                    if !self.constant {
                        dyad(kq, factor, &column, &self.slip_gradient[along..along + n]);
                    }
                }
            }
        }
        self.scratch_q = column;
    }
}

/// `matrix += factor column rowᵀ`.
fn dyad(matrix: &mut [f64], factor: f64, column: &[f64], row: &[f64]) {
    for (target, c) in matrix.chunks_exact_mut(row.len()).zip(column) {
        add(target, factor * c, row);
    }
}

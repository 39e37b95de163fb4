//! Derivatives that systems do not give, by differences.

use super::collocation::Scale;
use super::field::{Field, FieldError, ROWS, State, dot};
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
            for k in 0..n {
                self.smooth_u[k * n + j] = (self.acceleration[k] - here[k]) / step;
            }
        }
        for j in 0..n {
            let (kept, step) = (q[j], root * q[j].abs().max(1e-3 * scale.q));
            q[j] += step;
            let step = q[j] - kept;
            self.evaluate(*t, &q, &u, true)?;
            q[j] = kept;
            for k in 0..n {
                self.smooth_q[k * n + j] = (self.acceleration[k] - here[k]) / step;
            }
            for (i, touch) in self.touches.iter().enumerate() {
                for r in 0..touch.p {
                    self.slip_gradient[(ROWS * i + 1 + r) * n + j] =
                        (touch.slip[r] - slips[i][r]) / step;
                }
            }
        }
        Ok(())
    }

    fn slips(&self) -> Vec<[f64; 3]> {
        self.touches.iter().map(|touch| touch.slip).collect()
    }
}

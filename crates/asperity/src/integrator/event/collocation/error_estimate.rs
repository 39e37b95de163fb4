//! An estimate of the error of a step (\[HairerWanner1996\] IV.8).

use crate::integrator::event::collocation::radau::{STAGES, Tableau};
use crate::integrator::event::collocation::step::Step;
use crate::integrator::event::state::{Scale, State};
use crate::vectors::add;

impl Step {
    /// Estimate of the error, of order six and filtered by `(I − hγJ)⁻¹`; `a0` is the acceleration at the start. The
    /// larger of the errors in `q` and `u`, relative to the scales.
    pub(crate) fn error(&mut self, start: &State, a0: &[f64], scale: Scale) -> f64 {
        let (n, table) = (self.n, Tableau::radau());
        let width = self.h * table.gamma;
        let at_zero = |values: &[f64], k: usize| -> f64 {
            (0..STAGES).map(|j| table.at_start[j] * values[j * n + k]).sum()
        };
        self.residual.resize(2 * n + self.points.count(), 0.0);
        let (q, u) = self.residual.split_at_mut(n);
        u[n..].fill(0.0);
        for (k, q) in q.iter_mut().enumerate() {
            *q = width * (start.u[k] - at_zero(&self.u, k));
        }
        // The derivatives are those of the first stage: it is near the start, where they may not exist.
        for r in 0..n {
            let row = &self.by_q[r * n..(r + 1) * n];
            let coupled: f64 = row.iter().zip(q.iter()).map(|(k, e)| k * e).sum();
            u[r] = width * (a0[r] - at_zero(&self.a, r)) + width * coupled;
        }
        if !self.filter(width) {
            return f64::INFINITY;
        }
        let (q, u) = self.residual.split_at(n);
        q.iter().zip(u).fold(0.0, |m: f64, (q, u)| {
            m.max((u / scale.u).abs()).max(((q + width * u) / scale.q).abs())
        })
    }

    /// Multiplies the residual by `(I − width J)⁻¹` with the derivatives at the first stage; false if that is singular.
    fn filter(&mut self, width: f64) -> bool {
        let (n, m) = (self.n, self.points.count());
        let matrix = self.matrix.begin(n + m);
        for (r, row) in matrix.chunks_exact_mut(n + m).enumerate() {
            let (u, z) = row.split_at_mut(n);
            if r < n {
                for (k, u) in u.iter_mut().enumerate() {
                    let unit = f64::from(u8::from(k == r));
                    *u = unit - width * (self.by_u[r * n + k] + width * self.by_q[r * n + k]);
                }
                add(z, -width, self.points.acceleration_by_points(0, r));
            } else {
                add(u, -1.0, self.points.defect_by_u(0, r - n));
                add(u, -width, self.points.defect_by_q(0, r - n));
                add(z, 1.0, self.points.defect_by_points(0, r - n));
            }
        }
        self.matrix.factor(0.0) && self.matrix.solve(&mut self.residual[n..])
    }
}

//! Derivatives: of the sliding forces by the laws, of what systems do not give by differences.

use crate::contact::Phase;
use crate::integrator::event::collocation::step::Scale;
use crate::integrator::event::dynamics::contact_variables::{
    FieldError, ROUNDING, ROWS, State, Touch,
};
use crate::integrator::event::dynamics::sliding_force;
use crate::integrator::event::dynamics::{Field, add, dot};

/// Width of differences along the motion over the time scale of the rows: truncation and rounding are of one size.
const CHANGE: f64 = 1e-3;
/// What rounding may add to the product of a Jacobian and the length of a step: Newton's method hardly notices.
const NOISE: f64 = 1e-3;
/// Widths that are tried at the beginning.
const TRIALS: usize = 30;

impl Field<'_> {
    /// `Ẇᵀu + χ̇` and `ẇ_Nᵀu` of these contacts, zero of the others, by central differences of fourth order
    /// along the motion.
    pub(crate) fn update_drift(
        &mut self,
        t: f64,
        q: &[f64],
        u: &[f64],
        wanted: impl Fn(&Touch) -> bool,
    ) -> Result<(), FieldError> {
        let (n, step) = (self.n, self.stencil);
        self.along.fill([0.0; 4]);
        for (k, place) in [-2.0, -1.0, 1.0, 2.0].into_iter().enumerate() {
            let time = t + place * step;
            self.system.advance(q, u, place * step, &mut self.scratch_q);
            for (i, touch) in self.touches.iter().enumerate().filter(|(_, touch)| wanted(touch)) {
                let rows = &mut self.scratch;
                let mut chi = [0.0; ROWS];
                if touch.prescribed.is_none() {
                    self.system.gap(time, &self.scratch_q, i, &mut rows[..n])?;
                    self.along[ROWS * i][k] = dot(&rows[..n], u);
                }
                if touch.is_free() {
                    continue;
                }
                let (tangent, chi) = (&mut rows[n..(1 + touch.p) * n], &mut chi[..touch.p]);
                self.system.tangent(time, &self.scratch_q, i, tangent, chi)?;
                for (r, row) in tangent.chunks_exact(n).enumerate() {
                    self.along[ROWS * i + 1 + r][k] = chi[r] + dot(row, u);
                }
            }
        }
        for (drift, [a, b, c, d]) in self.drift.iter_mut().zip(&self.along) {
            *drift = (a - 8.0 * b + 8.0 * c - d) / (12.0 * step);
        }
        Ok(())
    }

    /// The drift of all contacts, open ones too, at a state where the field has been evaluated.
    pub(crate) fn drift_of_all(&mut self, State { t, q, u }: &State) -> Result<(), FieldError> {
        if !self.constant && self.touches.iter().any(Touch::is_free) {
            self.update_drift(*t, q, u, |_| true)?;
        }
        Ok(())
    }

    /// The drift of all contacts at a new state; the stencil widens where rows hardly change.
    pub(crate) fn survey(&mut self, state: &State) -> Result<(), FieldError> {
        self.drift_of_all(state)?;
        if self.constant {
            return Ok(());
        }
        let change = self.change(&state.u);
        if change < 0.25 * CHANGE {
            self.stencil = f64::min(self.stencil * wider(change), self.widest);
        }
        Ok(())
    }

    /// How much the rows change over the stencil: the stencil over their time scale.
    fn change(&self, u: &[f64]) -> f64 {
        let mut change = 0.0;
        for (i, touch) in self.touches.iter().enumerate() {
            let rows = ROWS * i..=ROWS * i + touch.p;
            let parts = |row: usize| {
                let terms = self.row(row).iter().zip(u).map(|(w, u)| (w * u).abs());
                terms.sum::<f64>() + self.chi[row].abs()
            };
            let size: f64 = rows.clone().map(parts).sum();
            for row in rows {
                let [a, b, c, d] = self.along[row];
                let here = dot(self.row(row), u) + self.chi[row];
                let size = [a, b, c, d].iter().fold(size, |m, v| m.max(v.abs()));
                if size > 0.0 && [a, b, c, d] != [0.0; 4] {
                    let second = (b - 2.0 * here + c).abs() / size;
                    let third = (d - 2.0 * c + 2.0 * b - a).abs() / (2.0 * size);
                    change = f64::max(change, second.sqrt().max(third.cbrt()));
                }
            }
        }
        change
    }

    /// Narrows a stencil over which the rows have changed too much; whether it has.
    pub(crate) fn narrow(&mut self, u: &[f64]) -> bool {
        if self.constant {
            return false;
        }
        let change = self.change(u);
        let narrow = change > 10.0 * CHANGE;
        if narrow {
            self.stencil *= wider(change);
        }
        narrow
    }

    /// Finds a stencil at the beginning, from a narrow one.
    pub(crate) fn begin(
        &mut self,
        State { t, q, u }: &State,
        t_end: f64,
    ) -> Result<(), FieldError> {
        self.widest = power_of_two(CHANGE * t_end);
        self.stencil = power_of_two(1e-9 * t_end);
        for _ in 0..TRIALS {
            if self.constant {
                break;
            }
            self.update_drift(*t, q, u, |_| true)?;
            let change = self.change(u);
            let fits = (0.25 * CHANGE..4.0 * CHANGE).contains(&change);
            if fits || (change < CHANGE && self.stencil >= self.widest) {
                break;
            }
            self.stencil = f64::min(self.stencil * wider(change), self.widest);
        }
        Ok(())
    }

    /// The smooth part of the Jacobian at `state` for steps up to about the length `h`: forward differences at
    /// fixed sliding directions.
    ///
    /// Where forces balance, what is left of their change by rounding must not look like a Jacobian: its product
    /// with `h`, or `h²`, has to be small beside one. Their `load` gives the least widths.
    pub(crate) fn linearise(
        &mut self,
        state: &State,
        h: f64,
        scale: Scale,
    ) -> Result<(), FieldError> {
        let n = self.n;
        let State { t, q, u } = state;
        let (mut q, mut u) = (q.clone(), u.clone());
        self.evaluate(*t, &q, &u, true)?;
        let least = ROUNDING / NOISE * self.load * h;
        let (here, slips) = (self.acceleration.clone(), self.slips());
        let root = f64::EPSILON.sqrt();
        for j in 0..n {
            let (kept, step) = (u[j], (root * u[j].abs().max(1e-3 * scale.u)).max(least));
            u[j] += step;
            let step = u[j] - kept;
            self.evaluate(*t, &q, &u, true)?;
            u[j] = kept;
            for (k, (there, here)) in self.acceleration.iter().zip(&here).enumerate() {
                self.smooth_u[k * n + j] = (there - here) / step;
            }
        }
        for j in 0..n {
            let (kept, step) = (q[j], (root * q[j].abs().max(1e-3 * scale.q)).max(least * h));
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
    pub(crate) fn jacobian(&mut self, ku: &mut [f64], kq: &mut [f64]) {
        let n = self.n;
        ku.copy_from_slice(&self.smooth_u);
        kq.copy_from_slice(&self.smooth_q);
        let mut column = std::mem::take(&mut self.scratch_q);
        for i in 0..self.touches.len() {
            let touch = self.touches[i];
            if touch.mode != Phase::Slip {
                continue;
            }
            let held = self.held.iter().find(|held| held.0 == i).map(|held| held.1);
            let slope = match held {
                None => sliding_force::jacobian(self.law(i), &touch.slip),
                Some(z) => sliding_force::at_point(self.law(i), &z, &touch.slip)
                    .map_or([[0.0; 3]; 3], |at| at.by_slip),
            };
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

/// The factor that brings a change over the stencil to what it should be, as far as one step of it is to be
/// trusted: powers of two, so that times are exact.
fn wider(change: f64) -> f64 {
    power_of_two((CHANGE / change).clamp(1.0 / 1024.0, 32.0))
}

fn power_of_two(x: f64) -> f64 {
    x.log2().round().exp2()
}

/// `matrix += factor column rowᵀ`.
fn dyad(matrix: &mut [f64], factor: f64, column: &[f64], row: &[f64]) {
    for (target, c) in matrix.chunks_exact_mut(row.len()).zip(column) {
        add(target, factor * c, row);
    }
}

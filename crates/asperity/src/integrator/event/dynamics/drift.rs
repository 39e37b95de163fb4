//! How rows change along the motion, `ẇ_Nᵀu` and `Ẇᵀu + χ̇`, by differences over a stencil of four states.

use crate::integrator::event::dynamics::Dynamics;
use crate::integrator::event::dynamics::buffers::Stencil;
use crate::integrator::event::dynamics::contact_variables::{ContactVariables, ROWS};
use crate::integrator::event::state::{EvaluationError, State};
use crate::vectors::dot;

/// Width of the stencil over the time scale of the rows. Truncation of fourth order and rounding are of one size
/// there.
const CHANGE: f64 = 1e-3;
/// Number of widths that are tried at the beginning, from a billionth of the whole time on.
const TRIALS: usize = 30;
/// The states of the stencil, in its widths from the present one.
const PLACES: [f64; 4] = [-2.0, -1.0, 1.0, 2.0];

impl Dynamics<'_> {
    /// The drift of these contacts, zero of the others.
    pub(crate) fn update_drift(
        &mut self,
        t: f64,
        q: &[f64],
        u: &[f64],
        wanted: impl Fn(&ContactVariables) -> bool,
    ) -> Result<(), EvaluationError> {
        let n = self.n;
        let Stencil { width, velocities, .. } = &mut self.stencil;
        velocities.fill([0.0; 4]);
        for (k, place) in PLACES.into_iter().enumerate() {
            let time = t + place * *width;
            self.chart.place_along(q, u, place * *width, &mut self.scratch);
            let u = &self.scratch[..];
            for (i, contact) in self.contacts.iter().enumerate().filter(|(_, c)| wanted(c)) {
                let (first, mut chi) = (usize::from(contact.prescribed.is_some()), [0.0; ROWS]);
                let chi = &mut chi[first..1 + contact.p];
                let rows = &mut self.scratch_rows[..chi.len() * n];
                self.chart.rows(time, i, rows, chi)?;
                for (r, row) in rows.chunks_exact(n).enumerate() {
                    velocities[ROWS * i + first + r][k] = chi[r] + dot(row, u);
                }
            }
        }
        for (drift, [a, b, c, d]) in self.drift.iter_mut().zip(velocities) {
            *drift = (*a - 8.0 * *b + 8.0 * *c - *d) / (12.0 * *width);
        }
        Ok(())
    }

    /// The drift of all contacts, open ones too, at a state where the dynamics have been evaluated.
    pub(crate) fn drift_of_all(
        &mut self,
        State { t, q, u }: &State,
    ) -> Result<(), EvaluationError> {
        if !self.constant && self.contacts.iter().any(ContactVariables::is_free) {
            self.update_drift(*t, q, u, |_| true)?;
        }
        Ok(())
    }

    /// The drift of all contacts at a new state. The stencil widens where rows hardly change.
    pub(crate) fn widen_stencil(&mut self, state: &State) -> Result<(), EvaluationError> {
        self.drift_of_all(state)?;
        if self.constant {
            return Ok(());
        }
        let change = self.stencil_change(&state.u);
        if change < 0.25 * CHANGE {
            self.rescale_stencil(change);
        }
        Ok(())
    }

    /// Narrows a stencil over which the rows have changed too much; whether it has.
    pub(crate) fn narrow_stencil(&mut self, u: &[f64]) -> bool {
        if self.constant {
            return false;
        }
        let change = self.stencil_change(u);
        let narrows = change > 10.0 * CHANGE;
        if narrows {
            self.stencil.width *= factor(change);
        }
        narrows
    }

    /// Finds the width of the stencil at the beginning of a motion, from a narrow one on.
    pub(crate) fn choose_stencil(
        &mut self,
        State { t, q, u }: &State,
        t_end: f64,
    ) -> Result<(), EvaluationError> {
        self.stencil.widest = power_of_two(CHANGE * t_end);
        self.stencil.width = power_of_two(1e-9 * t_end);
        for _ in 0..TRIALS {
            if self.constant {
                break;
            }
            self.update_drift(*t, q, u, |_| true)?;
            let change = self.stencil_change(u);
            let fits = (0.25 * CHANGE..4.0 * CHANGE).contains(&change);
            if fits || (change < CHANGE && self.stencil.width >= self.stencil.widest) {
                break;
            }
            self.rescale_stencil(change);
        }
        Ok(())
    }

    fn rescale_stencil(&mut self, change: f64) {
        let Stencil { width, widest, .. } = &mut self.stencil;
        *width = f64::min(*width * factor(change), *widest);
    }

    /// How much the rows change over the stencil: its width over their time scale.
    fn stencil_change(&self, u: &[f64]) -> f64 {
        let mut change = 0.0;
        for (i, contact) in self.contacts.iter().enumerate() {
            let rows = ROWS * i..=ROWS * i + contact.p;
            let parts = |row: usize| {
                let terms = self.row(row).iter().zip(u).map(|(w, u)| (w * u).abs());
                terms.sum::<f64>() + self.chi[row].abs()
            };
            let size: f64 = rows.clone().map(parts).sum();
            for row in rows {
                let [a, b, c, d] = self.stencil.velocities[row];
                let here = self.velocity(row, u);
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
}

/// The factor that brings a change over the stencil to what it should be, as far as one step of it can be trusted.
/// Widths are powers of two, so that differences of times are exact.
fn factor(change: f64) -> f64 {
    power_of_two((CHANGE / change).clamp(1.0 / 1024.0, 32.0))
}

fn power_of_two(x: f64) -> f64 {
    x.log2().round().exp2()
}

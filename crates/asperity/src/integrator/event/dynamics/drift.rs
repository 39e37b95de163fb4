//! How rows change along the motion, `ẇ_Nᵀu` and `Ẇᵀu + χ̇`, by differences over a stencil of four states.

use std::ops::Range;

use crate::integrator::event::dynamics::Dynamics;
use crate::integrator::event::dynamics::buffers::Stencil;
use crate::integrator::event::dynamics::contact_variables::{ContactVariables, ROWS};
use crate::integrator::event::resolution::ROUNDING;
use crate::integrator::event::state::{EvaluationError, State};
use crate::system::friction_map::scale_rows;
use crate::vectors::dot;

/// Width of the stencil over the time scale of the rows, at which truncation of fourth order and rounding are alike.
const CHANGE: f64 = 1e-3;
/// Number of widths that are tried at the beginning, from a billionth of the whole time on.
const TRIALS: usize = 30;
/// Narrowest stencil over the time of its middle at the beginning: times are rounded by a millionth of its width.
const UNROUNDED: f64 = 1e-10;
/// The states of a stencil in its widths from the present one, and the weights of the velocities there in their rate.
struct Differences {
    places: [f64; 4],
    here: f64,
    there: [f64; 4],
}

/// About the present state.
const CENTRAL: Differences = Differences {
    places: [-2.0, -1.0, 1.0, 2.0],
    here: 0.0,
    there: [1.0 / 12.0, -8.0 / 12.0, 8.0 / 12.0, -1.0 / 12.0],
};
/// From the present state on, where functions of time have just begun; backwards where they end.
const FORWARD: Differences = Differences {
    places: [1.0, 2.0, 3.0, 4.0],
    here: -25.0 / 12.0,
    there: [4.0, -3.0, 4.0 / 3.0, -1.0 / 4.0],
};

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
        let (differences, sign) = self.differences_at(t);
        let Stencil { width, velocities, .. } = &mut self.stencil;
        velocities.fill([0.0; 4]);
        for (k, place) in differences.places.into_iter().enumerate() {
            let ahead = sign * place * *width;
            self.chart.place_along(q, u, ahead, &mut self.scratch);
            let u = &self.scratch[..];
            for (i, contact) in self.contacts.iter().enumerate().filter(|(_, c)| wanted(c)) {
                let (first, mut chi) = (usize::from(contact.prescribed.is_some()), [0.0; ROWS]);
                let chi = &mut chi[first..1 + contact.p];
                let rows = &mut self.scratch_rows[..chi.len() * n];
                self.chart.rows(t + ahead, i, rows, chi)?;
                if let Some((map, place)) = self.chart.friction_place(t + ahead, i) {
                    let region = contact.region.unwrap_or_else(|| map.region(place));
                    let law = &self.system.contacts()[i];
                    scale_rows(map.factor(region, place), law, n, rows, chi);
                }
                for (r, row) in rows.chunks_exact(n).enumerate() {
                    velocities[ROWS * i + first + r][k] = chi[r] + dot(row, u);
                }
            }
        }
        self.stencil.one_sided = differences.here != 0.0;
        self.drift.fill(0.0);
        for (i, contact) in self.contacts.iter().enumerate().filter(|(_, c)| wanted(c)) {
            let first = ROWS * i + usize::from(contact.prescribed.is_some());
            for row in first..=ROWS * i + contact.p {
                let own = self.stencil.velocities[row].iter().zip(&differences.there);
                let here = differences.here * self.velocity(row, u);
                let sum = own.fold(here, |sum, (velocity, weight)| sum + weight * velocity);
                self.drift[row] = sign * sum / self.stencil.width;
            }
        }
        Ok(())
    }

    /// The differences at a time and their sign: functions of the user may be unknown outside of their piece.
    fn differences_at(&self, t: f64) -> (&'static Differences, f64) {
        let (reach, Range { start, end }) = (2.0 * self.stencil.width, &self.piece);
        match (t - reach < *start, t + reach > *end) {
            (true, _) if self.time_parts.depends_on_time => (&FORWARD, 1.0),
            (_, true) if self.time_parts.depends_on_time => (&FORWARD, -1.0),
            _ => (&CENTRAL, 1.0),
        }
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
        duration: f64,
    ) -> Result<(), EvaluationError> {
        self.stencil.widest = power_of_two(CHANGE * duration);
        self.stencil.width = power_of_two((1e-9 * duration).max(UNROUNDED * t));
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
            let rounding = ROUNDING * self.time_parts.velocity_of(i);
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
                    let (second, third) = if self.stencil.one_sided {
                        (here - 2.0 * a + b, d - 3.0 * c + 3.0 * b - a)
                    } else {
                        (b - 2.0 * here + c, 0.5 * (d - 2.0 * c + 2.0 * b - a))
                    };
                    // What rounding of functions of time leaves tells nothing of how fast they change.
                    let beyond = |difference: f64| (difference.abs() - rounding).max(0.0) / size;
                    let (second, third) = (beyond(second), beyond(third));
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

//! How long a step may be.

use crate::contact::Phase;
use crate::integrator::event::collocation::step::Scale;
use crate::integrator::event::dynamics::contact_variables::{ROUNDING, ROWS, STILL};
use crate::integrator::event::dynamics::sliding_force::norm;
use crate::integrator::event::dynamics::{Field, dot, largest};

/// Exponent of the error estimate, which is of lower order than the method: tolerances are made to fit it
/// (\[HairerWanner1996\] IV.8).
const ESTIMATE: f64 = 6.0;
/// Share of the time until a slip or a resistance vanishes that a step may take. Powers of the time that is left
/// are approximated to the tolerance then, which the estimate would not see to.
const APPROACH: f64 = 0.75;
/// Share of the time in which a gap closes at its present velocity that a step may take.
const BEYOND: f64 = 1.2;
/// Powers of e by which deviations may grow within a step. The method is exact to 1e-8 there, and to 1e-3 at 3; from
/// 6 on, beyond its pole, it damps.
pub(crate) const GROWTH: f64 = 1.0;
/// Relative change of the growth, between attempts one of which is at most 0.8 times as long, that counts as none.
const SAME: f64 = 0.05;

/// Tolerances, scales and the length of the next step.
#[derive(Debug)]
pub(crate) struct Control {
    /// Of the error estimate.
    pub(crate) estimate: f64,
    /// Of Newton's method.
    pub(crate) newton: f64,
    scale: Scale,
    /// The velocity of which the share [`STILL`] is what rounding may make of forces that balance.
    creep: f64,
    pub(crate) h: f64,
    last_error: f64,
    /// Rates at which the resistances of unilateral contacts change.
    rates: Vec<f64>,
    resistances: Vec<f64>,
    /// Rate at which deviations grow.
    unstable: f64,
    /// Growth within the last attempt from the present state that was too long for it.
    refused: f64,
}

impl Control {
    pub(crate) fn new(tolerance: f64, contacts: usize) -> Self {
        Self {
            estimate: 0.01 * tolerance.powf(0.6),
            newton: 0.01 * tolerance,
            scale: Scale { q: 0.0, u: 0.0 },
            creep: 0.0,
            h: 0.0,
            last_error: 1.0,
            rates: vec![0.0; contacts],
            resistances: vec![1.0; contacts],
            unstable: 0.0,
            refused: f64::INFINITY,
        }
    }

    /// Takes a state into account, to which a step of length `h` has led.
    pub(crate) fn see(&mut self, field: &mut Field<'_>, q: &[f64], u: &[f64], h: f64) {
        self.scale.q = self.scale.q.max(largest(q));
        self.scale.u = self.scale.u.max(largest(u));
        // Forces that balance let what rests creep by what rounding leaves of them.
        let creep = field.load * h * (ROUNDING / STILL);
        self.creep = self.creep.max(creep);
        for i in 0..field.touches.len() {
            let normal = field.row(ROWS * i).iter().zip(q);
            let (sum, sizes) =
                normal.fold((0.0, 0.0), |(s, a), (w, q)| (s + w * q, a + (w * q).abs()));
            let rows = (1..=field.touches[i].p).map(|r| largest(field.row(ROWS * i + r)));
            let creep = rows.fold(0.0, f64::max) * creep;
            let touch = &mut field.touches[i];
            touch.speed = touch.speed.max(touch.size);
            // The slip of what sticks is taken out again after every step, however long.
            touch.creep = if touch.mode == Phase::Stick { 0.0 } else { touch.creep.max(creep) };
            if touch.prescribed.is_none() {
                touch.reach = touch.reach.max(sizes).max((touch.gap - sum).abs());
            }
            self.scale.u = self.scale.u.max(touch.size);
        }
    }

    /// What errors of a step are compared with: the largest values so far, at least what this
    /// acceleration changes. `goal` is the relative error that counts: it must not be asked for below what
    /// rounding leaves of the forces, of which `load` is the largest, where these balance.
    pub(crate) fn scale(&self, h: f64, acceleration: f64, (goal, load): (f64, f64)) -> Scale {
        let rounding = ROUNDING / goal * load;
        let u = self.scale.u.max(h * acceleration.max(rounding)).max(1e-100);
        Scale { q: self.scale.q.max(h * u), u }
    }

    /// What velocities are compared with to tell whether they vanish: the largest one so far.
    pub(crate) fn speed(&self) -> f64 {
        self.scale.u.max(self.creep)
    }

    /// The longest first step: a share of the times in which velocities and coordinates change by themselves, as
    /// far as there are any, and of all the time.
    pub(crate) fn first(&self, t_end: f64, a0: &[f64]) -> f64 {
        let Scale { q, u } = self.scale;
        let times = [0.01 * u / largest(a0), 0.01 * q / u];
        let usable = times.into_iter().filter(|t| t.is_finite() && *t > 0.0);
        usable.fold(0.01 * t_end, f64::min)
    }

    /// The estimate relative to the tolerance decides whether a step is kept, and on the length of the next;
    /// false if it is not.
    pub(crate) fn judge(&mut self, h: f64, error: f64) -> bool {
        let error = (error / self.estimate).max(1e-12);
        // The comparison also turns away NaN.
        if !(error <= 1.0) {
            self.h = h * (0.9 * error.powf(-1.0 / ESTIMATE)).clamp(0.1, 0.8);
            if error.is_nan() {
                self.h = 0.1 * h;
            }
            return false;
        }
        let factor = 0.9 * error.powf(-0.7 / ESTIMATE) * self.last_error.powf(0.4 / ESTIMATE);
        self.h = h * factor.clamp(0.2, 8.0);
        self.last_error = error.max(1e-2);
        true
    }

    /// Whether deviations grow so much within a step of length `h` that the method would damp them; then the length
    /// of the next attempt. Where a shorter step would be the same, as at the beginning of slips from rest, it is kept.
    pub(crate) fn repels(&mut self, h: f64, growth: f64) -> bool {
        let repels = growth > GROWTH && !((growth / self.refused - 1.0).abs() < SAME);
        if repels {
            self.h = h * (0.9 * GROWTH / growth).clamp(0.1, 0.8);
            self.refused = growth;
        }
        repels
    }

    /// A step of length `h` has been made, at whose end deviations grow at the rate `unstable`.
    pub(crate) fn made(&mut self, field: &Field<'_>, h: f64, unstable: f64) {
        (self.unstable, self.refused) = (unstable, f64::INFINITY);
        for ((rate, last), touch) in
            self.rates.iter_mut().zip(&mut self.resistances).zip(&field.touches)
        {
            *rate = (touch.resistance - *last) / h;
            *last = touch.resistance;
        }
    }

    /// The resistances at the present state, whatever an attempt has met since.
    pub(crate) fn resistances(&self) -> &[f64] {
        &self.resistances
    }

    /// Forgets how fast resistances change: contacts do something else.
    pub(crate) fn forget(&mut self, field: &Field<'_>) {
        (self.unstable, self.refused) = (0.0, f64::INFINITY);
        self.rates.fill(0.0);
        for (last, touch) in self.resistances.iter_mut().zip(&field.touches) {
            *last = touch.resistance;
        }
    }

    /// A step must not go beyond half the flight of contacts that have just bounced or opened, nor far beyond
    /// the closing of gaps that are no polynomials of the motion.
    pub(crate) fn flight(&self, field: &Field<'_>, u: &[f64], a0: &[f64]) -> f64 {
        let mut limit = f64::INFINITY;
        for (i, touch) in field.touches.iter().enumerate() {
            if touch.is_free() {
                let (velocity, rate) = (dot(field.row(ROWS * i), u), field.rate(ROWS * i, a0));
                // From there on the gap is not smaller than it was.
                let near = touch.gap < velocity * velocity / rate.abs();
                if velocity > STILL * self.speed() && rate < 0.0 && near {
                    limit = limit.min(-velocity / rate);
                }
                if velocity < -STILL * self.speed() && !field.constant {
                    limit = limit.min(BEYOND * touch.gap.max(0.0) / -velocity);
                }
            }
        }
        limit
    }

    /// The longest step that reaches neither the end of a slip, where the direction is not defined, nor the end
    /// of a resistance.
    pub(crate) fn limit(&self, field: &Field<'_>, a0: &[f64]) -> f64 {
        let mut limit = GROWTH / self.unstable;
        for (i, touch) in field.touches.iter().enumerate() {
            if touch.mode != Phase::Slip {
                continue;
            }
            let (speed, rate) = (norm(&touch.slip), slip_rate(field, i, a0));
            if rate < 0.0 {
                limit = limit.min(-APPROACH * speed / rate);
            }
            if self.rates[i] < 0.0 {
                limit = limit.min(-APPROACH * self.resistances[i] / self.rates[i]);
            }
        }
        limit
    }
}

/// `d‖γ‖/dt` of a slipping contact.
pub(crate) fn slip_rate(field: &Field<'_>, contact: usize, acceleration: &[f64]) -> f64 {
    let touch = &field.touches[contact];
    let rows = ROWS * contact + 1..;
    let terms = rows.zip(&touch.slip[..touch.p]);
    let along = |(row, slip): (usize, &f64)| slip * field.rate(row, acceleration);
    terms.map(along).sum::<f64>() / norm(&touch.slip)
}

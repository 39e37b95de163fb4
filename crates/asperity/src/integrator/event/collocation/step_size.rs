//! How long a step may be.

use crate::contact::Phase;
use crate::integrator::event::collocation::growth::GROWTH;
use crate::integrator::event::dynamics::{Dynamics, ROWS};
use crate::integrator::event::resolution::{NOTHING, ROUNDING};
use crate::integrator::event::state::{Scale, State};
use crate::vectors::{largest, norm};

/// Exponent of the error estimate, which is of lower order than the method (\[HairerWanner1996\] IV.8); tolerances fit it.
const ESTIMATE: f64 = 6.0;
/// Share of the time until a slip or a resistance vanishes that a step may take. Powers of the remaining time are
/// approximated to the tolerance then, which the error estimate would not ensure.
const APPROACH: f64 = 0.75;
/// Share of the time in which a gap closes at its present velocity that a step may take.
const BEYOND: f64 = 1.2;
/// Relative change of the growth, between attempts one of which is at most 0.8 times as long, that counts as none.
const SAME_GROWTH: f64 = 0.05;

/// Tolerances, scales and the length of the next step.
#[derive(Debug)]
pub(crate) struct StepSize {
    /// The length of the next attempt.
    pub(crate) h: f64,
    /// Tolerance of the error estimate.
    pub(crate) estimate: f64,
    /// Tolerance of Newton's method.
    pub(crate) newton: f64,
    /// The largest coordinate and the largest velocity so far.
    scale: Scale,
    /// The velocity of which the share [`NOTHING`] is what rounding may make of forces that balance.
    creep: f64,
    /// The error of the last step over its tolerance.
    last_error: f64,
    /// The resistances of unilateral contacts at the present state, and the rates at which they change.
    resistances: Vec<f64>,
    rates: Vec<f64>,
    /// Rate at which deviations grow at the present state.
    growth_rate: f64,
    /// Growth within the last attempt from the present state that was too long for it.
    refused_growth: f64,
}

/// A relative error to be reached, and the quantities whose rounding limits it: the largest acceleration of forces that
/// balance and of parts of functions of time, and the velocity that these give while they grow.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Accuracy {
    pub(crate) goal: f64,
    pub(crate) load: f64,
    pub(crate) reach: f64,
}

impl StepSize {
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
            growth_rate: 0.0,
            refused_growth: f64::INFINITY,
        }
    }

    /// Takes into account that velocities are made of parts of this size.
    pub(crate) fn account_for_parts(&mut self, velocity: f64) {
        self.creep = self.creep.max(ROUNDING / NOTHING * velocity);
    }

    /// Takes a state into account, to which a step of length `h` has led.
    pub(crate) fn account_for(&mut self, dynamics: &mut Dynamics<'_>, state: &State, h: f64) {
        let (q, u) = (&state.q, &state.u);
        self.scale.q = self.scale.q.max(largest(q));
        self.scale.u = self.scale.u.max(largest(u));
        // Forces that balance let what rests creep by what rounding leaves of them.
        let creep = dynamics.load * h * (ROUNDING / NOTHING);
        self.creep = self.creep.max(creep);
        for i in 0..dynamics.contacts.len() {
            let normal = dynamics.row(ROWS * i).iter().zip(q);
            let (sum, sizes) =
                normal.fold((0.0, 0.0), |(s, a), (w, q)| (s + w * q, a + (w * q).abs()));
            let rows = (1..=dynamics.contacts[i].p).map(|r| largest(dynamics.row(ROWS * i + r)));
            let creep = rows.fold(0.0, f64::max) * creep;
            let contact = &mut dynamics.contacts[i];
            contact.speed = contact.speed.max(contact.size);
            // The slip of what sticks is taken out again after every step, however long.
            contact.creep =
                if contact.mode == Phase::Stick { 0.0 } else { contact.creep.max(creep) };
            if contact.prescribed.is_none() {
                contact.reach = contact.reach.max(sizes).max((contact.gap - sum).abs());
            }
            // Surfaces that move along their normal give velocities, too.
            let surface = dynamics.chi[ROWS * i].abs();
            self.scale.u = self.scale.u.max(contact.size / contact.by_place).max(surface);
        }
    }

    /// The scale of errors of a step of length `h`: the largest values so far, at least the change by this acceleration.
    pub(crate) fn scale(
        &self,
        h: f64,
        acceleration: f64,
        Accuracy { goal, load, reach }: Accuracy,
    ) -> Scale {
        let rounding = ROUNDING / goal * (h * load).max(reach);
        let u = self.scale.u.max(h * acceleration).max(rounding).max(1e-100);
        Scale { q: self.scale.q.max(h * u), u }
    }

    /// What velocities are compared with to tell whether they vanish: the largest one so far.
    pub(crate) fn speed(&self) -> f64 {
        self.scale.u.max(self.creep)
    }

    /// The longest first step: a share of the whole time and of the times in which velocities and coordinates change.
    pub(crate) fn first_step_limit(&self, duration: f64, a0: &[f64]) -> f64 {
        let Scale { q, u } = self.scale;
        // A velocity that is rounding, such as of a sine at its crest, tells no time.
        let u = if u > NOTHING * self.creep { u } else { 0.0 };
        let times = [0.01 * u / largest(a0), 0.01 * q / u];
        let usable = times.into_iter().filter(|t| t.is_finite() && *t > 0.0);
        usable.fold(0.01 * duration, f64::min)
    }

    /// Whether a step with this estimate of its error over the goal is accurate enough. Sets the length of the next attempt.
    pub(crate) fn accepts(&mut self, h: f64, error: f64) -> bool {
        let error = error.max(1e-12);
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

    /// Whether deviations grow so much within a step of length `h` that the method would damp them. Then sets the length of the
    /// next attempt, unless a shorter step would be the same, as at the beginning of slips from rest.
    pub(crate) fn is_unstable(&mut self, h: f64, growth: f64) -> bool {
        let repels = growth > GROWTH && !((growth / self.refused_growth - 1.0).abs() < SAME_GROWTH);
        if repels {
            self.h = h * (0.9 * GROWTH / growth).clamp(0.1, 0.8);
            self.refused_growth = growth;
        }
        repels
    }

    /// A step of length `h` has been made, at whose end deviations grow at this rate.
    pub(crate) fn step_taken(&mut self, dynamics: &Dynamics<'_>, h: f64, growth_rate: f64) {
        (self.growth_rate, self.refused_growth) = (growth_rate, f64::INFINITY);
        for ((rate, last), contact) in
            self.rates.iter_mut().zip(&mut self.resistances).zip(&dynamics.contacts)
        {
            *rate = (contact.resistance - *last) / h;
            *last = contact.resistance;
        }
    }

    /// The resistances at the present state, whatever an attempt has met since.
    pub(crate) fn resistances(&self) -> &[f64] {
        &self.resistances
    }

    /// Forgets how fast resistances change: contacts do something else.
    pub(crate) fn forget_rates(&mut self, dynamics: &Dynamics<'_>) {
        (self.growth_rate, self.refused_growth) = (0.0, f64::INFINITY);
        self.rates.fill(0.0);
        for (last, contact) in self.resistances.iter_mut().zip(&dynamics.contacts) {
            *last = contact.resistance;
        }
    }

    /// A step must not exceed half the flight of contacts that have just opened, nor go far beyond the closing of curved gaps.
    pub(crate) fn gap_limit(&self, dynamics: &Dynamics<'_>, u: &[f64], a0: &[f64]) -> f64 {
        let mut limit = f64::INFINITY;
        for (i, contact) in dynamics.contacts.iter().enumerate() {
            if contact.is_free() {
                let (velocity, rate) =
                    (dynamics.velocity(ROWS * i, u), dynamics.rate(ROWS * i, a0));
                // From there on the gap is not smaller than it was.
                let near = contact.gap < velocity * velocity / rate.abs();
                if velocity > NOTHING * self.speed() && rate < 0.0 && near {
                    limit = limit.min(-velocity / rate);
                }
                if velocity < -NOTHING * self.speed() && !dynamics.constant {
                    // The event is where the overlap is more than rounding explains.
                    let overlap =
                        if contact.gap.is_finite() { dynamics.rounded_overlap(i) } else { 0.0 };
                    let way = contact.gap.max(0.0) + overlap;
                    limit = limit.min(BEYOND * way / -velocity);
                }
            }
        }
        limit
    }

    /// The longest step that reaches neither the end of a slip, which has no direction there, nor that of a resistance.
    pub(crate) fn slip_limit(&self, dynamics: &Dynamics<'_>, a0: &[f64]) -> f64 {
        let mut limit = GROWTH / self.growth_rate;
        for (i, contact) in dynamics.contacts.iter().enumerate() {
            if contact.mode != Phase::Slip {
                continue;
            }
            let (speed, rate) = (norm(&contact.slip), slip_rate(dynamics, i, a0));
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
pub(crate) fn slip_rate(dynamics: &Dynamics<'_>, i: usize, acceleration: &[f64]) -> f64 {
    let contact = &dynamics.contacts[i];
    let rows = ROWS * i + 1..;
    let terms = rows.zip(&contact.slip[..contact.p]);
    let along = |(row, slip): (usize, &f64)| slip * dynamics.rate(row, acceleration);
    terms.map(along).sum::<f64>() / norm(&contact.slip)
}

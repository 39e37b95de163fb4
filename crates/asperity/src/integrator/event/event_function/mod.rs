//! When something happens: functions of the state whose zeros are events, and where these zeros are.

pub(crate) mod between_stages;

use crate::contact::Phase;
use crate::integrator::event::Section;
use crate::integrator::event::dynamics::Field;
use crate::integrator::event::dynamics::contact_variables::SLACK;
use crate::integrator::event::dynamics::sliding_force;

/// A function that is not positive while a contact goes on doing what it does: the gap closes, the force
/// leaves the reservoir or the normal force vanishes.
pub(crate) fn alarm(field: &Field<'_>, contact: usize) -> f64 {
    let touch = &field.touches[contact];
    match (touch.mode, touch.prescribed) {
        (Phase::Open, None) => -touch.gap - (SLACK * touch.reach).max(field.creep),
        (Phase::Stick | Phase::Slip, _) if touch.shared => -1.0,
        (Phase::Stick, _) => excess(field, contact),
        (Phase::Slip, None) => -touch.normal_force,
        _ => -1.0,
    }
}

/// How far the friction force of a sticking contact lies outside the reservoir.
pub(crate) fn excess(field: &Field<'_>, contact: usize) -> f64 {
    let touch = &field.touches[contact];
    sliding_force::gauge(field.law(contact), &touch.force) - touch.normal_force - touch.tolerated
}

impl Section {
    /// Height above the hyperplane.
    pub(crate) fn height(&self, q: &[f64], u: &[f64]) -> f64 {
        let point = q.iter().chain(u);
        self.normal.iter().zip(point).map(|(n, x)| n * x).sum::<f64>() - self.level
    }

    /// What heights are compared with.
    pub(crate) fn size(&self, q: &[f64], u: &[f64]) -> f64 {
        let point = q.iter().chain(u);
        self.normal.iter().zip(point).map(|(n, x)| (n * x).abs()).sum::<f64>() + self.level.abs()
    }
}

/// The zero of `f` between `low`, where it is not positive, and `high`, where it is, by Illinois' method with
/// bisections; the last argument was the one of the result. Arguments whose bracket is `width` wide count as
/// found.
pub(crate) fn zero<E>(
    (mut low, mut f_low): (f64, f64),
    (mut high, mut f_high): (f64, f64),
    width: f64,
    mut f: impl FnMut(f64) -> Result<f64, E>,
) -> Result<f64, E> {
    let mut at = high;
    let mut side = 0;
    for iteration in 0..100 {
        if f_low == 0.0 {
            f(low)?;
            return Ok(low);
        }
        let secant = low + (high - low) * (-f_low / (f_high - f_low));
        // Every fourth time, lest one end stays where it is.
        let next =
            if iteration % 4 == 3 || !secant.is_finite() { 0.5 * (low + high) } else { secant };
        if (next - at).abs() <= width || high - low <= width {
            f(next)?;
            return Ok(next);
        }
        at = next;
        let value = f(at)?;
        if value > 0.0 {
            (high, f_high) = (at, value);
            if side == 1 {
                f_low *= 0.5;
            }
            side = 1;
        } else {
            (low, f_low) = (at, value);
            if side == -1 {
                f_high *= 0.5;
            }
            side = -1;
        }
    }
    Ok(at)
}

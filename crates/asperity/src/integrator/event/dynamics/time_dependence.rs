//! How large that becomes which depends on time.
//!
//! A function of time may be the small difference of large parts, such as 1 − cos t near zero. Rounding leaves a share of
//! these parts in it, below which nothing can be known of it.

use crate::system::{Configuration, System, full_rows};

/// The largest parts from zero to the end of a run.
pub(super) struct TimeDependence {
    /// Of the forces, per velocity.
    pub(super) forces: Vec<f64>,
    /// Impulses that the forces give, per velocity, by the time at which they have reached half of their largest value.
    pub(super) impulses: Vec<f64>,
    /// Of the gap in m, per contact.
    pub(super) gaps: Vec<f64>,
    /// Of χ_N and χ in m/s, per contact.
    pub(super) velocities: Vec<f64>,
}

impl TimeDependence {
    /// As seen from the state `(q, u)`: at zero, and at three times per factor of ten up to `t_end`. What is not finite or
    /// fails there is left out.
    pub(super) fn of(system: &dyn System, q: &[f64], u: &[f64], t_end: f64) -> Self {
        let (n, contacts) = (system.dof(), system.contacts());
        let [forces, impulses] = [(); 2].map(|()| vec![0.0; n]);
        let [gaps, velocities] = [(); 2].map(|()| vec![0.0; contacts.len()]);
        let mut found = Self { forces, impulses, gaps, velocities };
        // A time at which each force has reached at least half of its size, and what it was then.
        let mut reached = vec![(0.0, 0.0); n];
        let (mut values, mut rows, mut chi) = (vec![0.0; n], vec![0.0; 4 * n], [0.0; 4]);
        let later = (0..100).rev().map(|k| t_end * 10f64.powf(-f64::from(k) / 3.0));
        for t in std::iter::once(0.0).chain(later) {
            let at = Configuration::new(t, q);
            if system.forces(&at, u, &mut values).is_ok() {
                for (k, value) in values.iter().map(|value| value.abs()).enumerate() {
                    found.forces[k] = larger_of_finite(found.forces[k], value);
                    if value.is_finite() && value > 2.0 * reached[k].1 {
                        reached[k] = (t, value);
                    }
                }
            }
            for (i, contact) in contacts.iter().enumerate() {
                let chi = &mut chi[..contact.rows()];
                let rows = &mut rows[..chi.len() * n];
                if let Ok(gap) = full_rows(system, &at, i, rows, chi) {
                    found.gaps[i] = larger_of_finite(found.gaps[i], gap);
                    let largest = chi.iter().copied().fold(found.velocities[i], larger_of_finite);
                    found.velocities[i] = largest;
                }
            }
        }
        for (k, impulse) in found.impulses.iter_mut().enumerate() {
            *impulse = reached[k].0 * found.forces[k];
        }
        found
    }
}

/// The larger of a size and the size of a value, which does not count if it is not finite.
fn larger_of_finite(size: f64, value: f64) -> f64 {
    if value.is_finite() { size.max(value.abs()) } else { size }
}

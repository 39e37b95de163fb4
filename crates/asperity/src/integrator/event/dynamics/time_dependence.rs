//! How large that becomes which depends on time.

use crate::system::time_function::sample_times;
use crate::system::{Configuration, System, TimeDependence, full_rows};

/// The largest values as seen from the state `(q, u)`: at zero and at times of all magnitudes up to `t_end`. What is not finite
/// or fails there is left out.
pub(super) fn sampled(system: &dyn System, q: &[f64], u: &[f64], t_end: f64) -> TimeDependence {
    let (n, contacts) = (system.dof(), system.contacts());
    let mut found = TimeDependence::none(n, contacts.len());
    // A time at which each force has reached at least half of its size, and what it was then.
    let mut reached = vec![(0.0, 0.0); n];
    let (mut values, mut rows, mut chi) = (vec![0.0; n], vec![0.0; 4 * n], [0.0; 4]);
    for t in sample_times(t_end) {
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

/// The larger of a size and the size of a value, which does not count if it is not finite.
fn larger_of_finite(size: f64, value: f64) -> f64 {
    if value.is_finite() { size.max(value.abs()) } else { size }
}

//! What to integrate, and what is refused.

use crate::integrator::options::{OptionsError, check_entries, check_positive, refuse};
use crate::system::{self, Rotation, System};

/// Latest end, so that no power of a time overflows.
const LATEST: f64 = 1e60;
/// Most samples: their memory is that of a small computer.
const MOST_SAMPLES: f64 = 1e8;
/// Most steps that a longest step may ask for: they take longer than anyone waits.
const MOST_STEPS: f64 = 1e10;

/// A hyperplane of states at which the integration ends.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// Normal vector in the space of `(q, u)`, pointing to where the motion goes.
    pub normal: Vec<f64>,
    /// `normal·(q, u)` on the hyperplane.
    pub level: f64,
    /// Crossings up to this time in s do not count.
    pub after: f64,
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

/// What to integrate.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// End time in s.
    pub t_end: f64,
    /// Initial coordinates.
    pub q0: Vec<f64>,
    /// Initial velocities.
    pub u0: Vec<f64>,
    /// Error that is aimed at, relative to the largest coordinate and the largest velocity.
    pub tolerance: f64,
    /// Time between samples in s; none keeps every step, before and after events.
    pub sample: Option<f64>,
    /// Longest step in s. Forces that depend on time are seen at five times of a step: what is shorter than a
    /// fifth of it may be missed. At least a ten billionth of the whole time.
    pub max_step: Option<f64>,
    /// Where to stop.
    pub section: Option<Section>,
    /// Events after which the integration gives up.
    pub max_events: usize,
}

impl Options {
    /// Refuses options, and systems that cannot be integrated from event to event.
    pub(crate) fn check(&self, system: &dyn System) -> Result<(), OptionsError> {
        system::check(system)?;
        let (n, coordinates) = (system.dof(), system.coordinates());
        // A rotation of space has four coordinates and three velocities.
        if coordinates != n + system.rotations().len() {
            let message = format!(
                "must have as many coordinates as velocities but for rotations of space, has {coordinates} and {n}"
            );
            return refuse("system", message);
        }
        for (i, contact) in system.contacts().iter().enumerate() {
            if !contact.law().has_strictly_convex_direction() {
                let message = format!(
                    "the direction set of contact {i} must be strictly convex: on a flat side one direction of the slip vanishes by itself"
                );
                return refuse("contacts", message);
            }
        }
        check_positive("t_end", self.t_end)?;
        check_positive("tolerance", self.tolerance)?;
        check_positive("dt", self.sample.unwrap_or(1.0))?;
        check_positive("max_step", self.max_step.unwrap_or(1.0))?;
        let Self { t_end, tolerance, .. } = *self;
        if !(1e-14..=1e-2).contains(&tolerance) {
            return refuse("tolerance", format!("must lie in [1e-14, 1e-2], got {tolerance}"));
        }
        if t_end > LATEST {
            return refuse("t_end", format!("must be at most {LATEST:e} s, got {t_end}"));
        }
        if let Some(samples) = self.sample.map(|dt| t_end / dt).filter(|n| *n > MOST_SAMPLES) {
            let message =
                format!("must not give more than {MOST_SAMPLES:e} samples, gives {samples:.3e}");
            return refuse("dt", message);
        }
        if let Some(steps) = self.max_step.map(|h| t_end / h).filter(|n| *n > MOST_STEPS) {
            let message = format!(
                "is too small for t_end = {t_end}: must not ask for more than {MOST_STEPS:e} steps, asks for {steps:.3e}"
            );
            return refuse("max_step", message);
        }
        if self.max_events == 0 {
            return refuse("max_events", "must be at least 1, got 0");
        }
        check_entries("q0", &self.q0, coordinates)?;
        check_entries("u0", &self.u0, n)?;
        if !rates_are_velocities(system, &self.q0) {
            let message = "must have its velocities as rates of its coordinates but for rotations of space, which `advance` contradicts";
            return refuse("system", message);
        }
        let Some(section) = &self.section else { return Ok(()) };
        check_entries("section", &section.normal, coordinates + n)?;
        if !(section.level.is_finite() && section.after.is_finite()) {
            return refuse("section", "must have a finite level and time");
        }
        Ok(())
    }
}

/// Whether a system moves the coordinates that are not rotations of space by `Δt u`, tried with velocities and a time
/// that are unlike each other.
fn rates_are_velocities(system: &dyn System, q: &[f64]) -> bool {
    let rotations = system.rotations();
    let is_free = |first: fn(&Rotation) -> usize, len: usize, place: usize| {
        !rotations.iter().any(|rotation| (first(rotation)..first(rotation) + len).contains(&place))
    };
    let coordinates = (0..q.len()).filter(|&i| is_free(|r| r.coordinate, 4, i));
    let velocities = (0..system.dof()).filter(|&k| is_free(|r| r.velocity, 3, k));
    let size = q.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let size = if size > 0.0 { size } else { 1.0 };
    let u: Vec<f64> = (0..system.dof()).map(|k| size * (1.0 + 0.3 * (k % 7) as f64)).collect();
    let (h, mut moved) = (0.01, q.to_vec());
    system.advance(q, &u, h, &mut moved);
    // The comparison also turns away NaN.
    coordinates.zip(velocities).all(|(i, k)| (moved[i] - (q[i] + h * u[k])).abs() <= 1e-12 * size)
}

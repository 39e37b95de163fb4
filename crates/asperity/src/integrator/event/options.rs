//! What to integrate, and what is refused.

use crate::argument::{ArgumentError, entries, finite, positive, refuse};
use crate::integrator::options::check_structure;
use crate::system::{InitialState, System, rotation};
use crate::vectors::largest;

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

/// What to integrate. What is not given has the value that stands beside it.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Options {
    /// Start time in s, not negative; 0.
    pub t_start: f64,
    /// End time in s, after the start.
    pub t_end: f64,
    /// Where to start; by default in the system's own state, [`System::initial_state`].
    pub start: Option<InitialState>,
    /// Error that is aimed at, relative to the largest coordinate and the largest velocity of each part; 1e-10.
    pub tolerance: f64,
    /// Time between samples in s; none, as by default, keeps every step, before and after events, and between the events of
    /// several parts as many as each has steps on average.
    pub sample: Option<f64>,
    /// Longest step in s; any by default. Forces that depend on time are seen at five times of a step: what is shorter than a
    /// fifth of it may be missed. At least a ten billionth of the whole time.
    pub max_step: Option<f64>,
    /// Where to stop; nowhere by default.
    pub section: Option<Section>,
    /// Whether the motion goes on beyond the section, so that its crossings are events among others, which do not count
    /// as those after which the integration gives up; not by default.
    pub goes_on: bool,
    /// Events after which the integration gives up; 10,000.
    pub max_events: usize,
}

impl Options {
    /// An integration from the time 0 up to `t_end` in s.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] if that is not finite and positive.
    pub fn new(t_end: f64) -> Result<Self, ArgumentError> {
        positive("t_end", t_end)?;
        Ok(Self {
            t_start: 0.0,
            t_end,
            start: None,
            tolerance: 1e-10,
            sample: None,
            max_step: None,
            section: None,
            goes_on: false,
            max_events: 10_000,
        })
    }

    /// The same from these coordinates and velocities.
    #[must_use]
    pub fn with_start(self, q0: &[f64], u0: &[f64]) -> Self {
        Self { start: Some(InitialState { q: q0.to_vec(), u: u0.to_vec() }), ..self }
    }

    /// The same from this time in s on, which is not negative.
    #[must_use]
    pub fn with_start_time(self, t_start: f64) -> Self {
        Self { t_start, ..self }
    }

    /// How long the motion is in s.
    pub(crate) fn duration(&self) -> f64 {
        self.t_end - self.t_start
    }

    /// The same to another tolerance.
    #[must_use]
    pub fn with_tolerance(self, tolerance: f64) -> Self {
        Self { tolerance, ..self }
    }

    /// The same with samples at this distance in s.
    #[must_use]
    pub fn with_sample(self, sample: f64) -> Self {
        Self { sample: Some(sample), ..self }
    }

    /// The same with no step longer than this in s.
    #[must_use]
    pub fn with_max_step(self, max_step: f64) -> Self {
        Self { max_step: Some(max_step), ..self }
    }

    /// The same, but ended where the motion crosses a section.
    #[must_use]
    pub fn with_section(self, section: Section) -> Self {
        Self { section: Some(section), ..self }
    }

    /// The same, but given up after so many events.
    #[must_use]
    pub fn with_max_events(self, max_events: usize) -> Self {
        Self { max_events, ..self }
    }

    /// Refuses options, and systems that cannot be integrated from event to event; else where to start.
    pub(crate) fn check(&self, system: &dyn System) -> Result<InitialState, ArgumentError> {
        check_structure(system)?;
        if system.has_joints() {
            return refuse(
                "system",
                "must have no joints: integrate it by time steps, with simulate",
            );
        }
        if system.constraints() > 0 {
            return refuse(
                "system",
                "must have no constraints: integrate it by time steps, with simulate",
            );
        }
        let (n, coordinates) = (system.dof(), system.coordinates());
        if n == 0 {
            return refuse("system", "must have velocities");
        }
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
        positive("t_end", self.t_end)?;
        positive("tolerance", self.tolerance)?;
        positive("sample_every", self.sample.unwrap_or(1.0))?;
        positive("max_step", self.max_step.unwrap_or(1.0))?;
        let Self { t_start, t_end, tolerance, .. } = *self;
        if !(1e-14..=1e-2).contains(&tolerance) {
            return refuse("tolerance", format!("must lie in [1e-14, 1e-2], got {tolerance:?}"));
        }
        if t_end > LATEST {
            return refuse("t_end", format!("must be at most {LATEST:e} s, got {t_end}"));
        }
        finite("t_start", &[t_start])?;
        if t_start < 0.0 {
            return refuse("t_start", format!("must not be negative, got {t_start}"));
        }
        if t_start >= t_end {
            let message = format!("must lie after the start at {t_start} s, got {t_end}");
            return refuse("t_end", message);
        }
        let duration = self.duration();
        if let Some(samples) = self.sample.map(|dt| duration / dt).filter(|n| *n > MOST_SAMPLES) {
            let message =
                format!("must not give more than {MOST_SAMPLES:e} samples, gives {samples:.3e}");
            return refuse("sample_every", message);
        }
        if let Some(steps) = self.max_step.map(|h| duration / h).filter(|n| *n > MOST_STEPS) {
            let message = format!(
                "is too small for {duration} s: must not ask for more than {MOST_STEPS:e} steps, asks for {steps:.3e}"
            );
            return refuse("max_step", message);
        }
        if self.max_events == 0 {
            return refuse("max_events", "must be at least 1, got 0");
        }
        let mut start = self.start.clone().unwrap_or_else(|| system.initial_state());
        entries("q0", &start.q, coordinates)?;
        entries("u0", &start.u, n)?;
        rotation::normalise(system.rotations(), &mut start.q)?;
        if !rates_are_velocities(system, &start.q) {
            let message = "must have its velocities as rates of its coordinates but for rotations of space, which `advance` contradicts";
            return refuse("system", message);
        }
        if let Some(section) = &self.section {
            entries("section", &section.normal, coordinates + n)?;
            finite("section", &[section.level, section.after])?;
        }
        Ok(start)
    }
}

/// Whether a system moves its coordinates as it says: rotations by `R exp(Δt Ω)` and the others by `Δt u`, tried with
/// velocities and a time that are unlike each other.
fn rates_are_velocities(system: &dyn System, q: &[f64]) -> bool {
    let size = largest(q);
    let size = if size > 0.0 { size } else { 1.0 };
    let u: Vec<f64> = (0..system.dof()).map(|k| size * (1.0 + 0.3 * (k % 7) as f64)).collect();
    let (h, mut moved, mut expected) = (0.01, q.to_vec(), q.to_vec());
    system.advance(q, &u, h, &mut moved);
    rotation::advance(system.rotations(), q, &u, h, &mut expected);
    // The comparison also turns away NaN.
    moved.iter().zip(&expected).all(|(a, b)| (a - b).abs() <= 1e-12 * size)
}

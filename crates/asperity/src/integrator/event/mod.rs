//! Event-driven integration: phases as smooth ordinary differential equations, stick, slip, opening and impacts
//! located between them.
//!
//! The independent check of Moreau's time stepping, and the flow of which limit cycles are fixed points.
//!
//! | file | concept |
//! |---|---|
//! | `collocation.rs` | Radau IIA of order nine, its error estimate |
//! | `growth.rs` | how fast deviations grow along a step |
//! | `points.rs` | Newton's method with points of *D* as unknowns, where *D* is nearly flat |
//! | `field.rs`, `mobility.rs`, `touch.rs`, `derivatives.rs`, `force.rs` | accelerations in a mode and their Jacobian |
//! | `decide.rs`, `part.rs`, `share.rs` | contact problems of accelerations and of impacts |
//! | `locate.rs`, `watch.rs`, `between.rs` | functions whose zeros are events, watched along steps |
//! | `sample.rs`, `dense.rs` | samples inside steps |
//! | `run.rs`, `control.rs`, `start.rs`, `poll.rs` | the loop over steps, the length of steps and of the first one, whether to go on |
//! | `happen.rs`, `impact.rs` | what is done at events |
//! | `motion.rs` | what is returned |

mod collocation;
mod contact_problem;
mod dynamics;
mod event_function;
mod integration;
mod motion;
mod observer;

use std::ops::ControlFlow;

use asperity_set::{Star, strict_convexity};
use thiserror::Error;

pub use dynamics::contact_variables::FieldError;
pub use motion::{Event, Kind, Motion};

use crate::law::{FrictionLaw, Law};
use crate::solver::Unsolvable;
use crate::system::System;

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

/// Why the integration ended.
#[derive(Debug)]
pub enum Outcome {
    /// The end time is reached.
    Finished,
    /// The section is crossed.
    Section,
    /// The observer asked to stop.
    Interrupted,
    /// There were as many events as are allowed.
    TooManyEvents,
    /// Contacts are squeezed, or friction and normal force enforce each other: no force or percussion satisfies the
    /// laws.
    NoSolution {
        /// The contact.
        contact: usize,
        /// The problem of accelerations or of percussions and the proof.
        unsolvable: Option<Box<Unsolvable>>,
    },
    /// The motion does not get on: the forces grow without bound or jump where the method does not know it.
    Stuck {
        /// How that shows.
        cause: Cause,
        /// The contact that is most likely to be the reason.
        contact: Option<usize>,
    },
    /// The accelerations cannot be evaluated.
    Error(FieldError),
}

/// How it shows that a motion does not get on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// Steps have become shorter than time resolves.
    Step,
    /// Most steps fail, and time hardly passes.
    Rejections,
    /// Events follow each other without time passing.
    Events,
    /// Friction and normal force enforce each other (Painlevé), and an impact without collision that stops every
    /// slip without a normal motion would break the laws; there may be another one.
    NoImpact,
    /// The forces or percussions of the contacts at an event have not been found to the accuracy that is needed.
    Unsolved,
}

/// Bad options.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{argument}: {message}")]
pub struct OptionsError {
    /// Name of the argument.
    pub argument: &'static str,
    /// What is allowed, and what was given.
    pub message: String,
}

/// The motion so far, and why it ended; the first is there whatever the second says.
#[derive(Debug)]
pub struct Run {
    /// The motion.
    pub motion: Motion,
    /// Why the integration ended.
    pub outcome: Outcome,
}

/// Integrates `system` from event to event.
///
/// `observer(t)` is called about every 50 ms and may stop the run.
pub fn integrate(
    system: &dyn System,
    options: &Options,
    observer: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<Run, OptionsError> {
    check(system, options)?;
    integration::time_loop::run(system, options, observer)
}

/// Latest end, so that no power of a time overflows.
const LATEST: f64 = 1e60;
/// Most samples.
const MOST: f64 = 1e8;
/// Most steps that a longest step may ask for.
const MOST_STEPS: f64 = 1e10;

fn check(system: &dyn System, options: &Options) -> Result<(), OptionsError> {
    let refuse = |argument, message: String| Err(OptionsError { argument, message });
    let (n, coordinates) = (system.dof(), system.coordinates());
    if coordinates != n {
        let message =
            format!("must have as many coordinates as velocities, has {coordinates} and {n}");
        return refuse("system", message);
    }
    for (i, contact) in system.contacts().iter().enumerate() {
        if !has_strictly_convex_direction(&contact.law) {
            let message = format!(
                "the direction set of contact {i} must be strictly convex: on a flat side one direction of the slip vanishes by itself"
            );
            return refuse("contacts", message);
        }
    }
    let positive = [
        ("t_end", options.t_end),
        ("tolerance", options.tolerance),
        ("dt", options.sample.unwrap_or(1.0)),
        ("max_step", options.max_step.unwrap_or(1.0)),
    ];
    for (argument, value) in positive {
        if !(value.is_finite() && value > 0.0) {
            return refuse(argument, format!("must be finite and positive, got {value}"));
        }
    }
    if !(1e-14..=1e-2).contains(&options.tolerance) {
        let value = options.tolerance;
        return refuse("tolerance", format!("must lie in [1e-14, 1e-2], got {value}"));
    }
    if options.t_end > LATEST {
        return refuse("t_end", format!("must be at most {LATEST:e} s, got {}", options.t_end));
    }
    if let Some(dt) = options.sample
        && options.t_end / dt > MOST
    {
        let count = options.t_end / dt;
        return refuse(
            "dt",
            format!("must not give more than {MOST:e} samples, gives {count:.3e}"),
        );
    }
    if let Some(longest) = options.max_step
        && options.t_end / longest > MOST_STEPS
    {
        let (count, end) = (options.t_end / longest, options.t_end);
        let message = format!(
            "is too small for t_end = {end}: must not ask for more than {MOST_STEPS:e} steps, asks for {count:.3e}"
        );
        return refuse("max_step", message);
    }
    if options.max_events == 0 {
        return refuse("max_events", "must be at least 1, got 0".into());
    }
    let normal = options.section.as_ref().map_or(&[][..], |section| &section.normal);
    let expected = if options.section.is_some() { 2 * n } else { 0 };
    for (argument, values, expected) in
        [("q0", &options.q0[..], n), ("u0", &options.u0, n), ("section", normal, expected)]
    {
        if values.len() != expected {
            let got = values.len();
            return refuse(argument, format!("must have {expected} entries, has {got}"));
        }
        if let Some(value) = values.iter().find(|v| !v.is_finite()) {
            return refuse(argument, format!("must be finite, got {value}"));
        }
    }
    if let Some(section) = &options.section
        && !(section.level.is_finite() && section.after.is_finite())
    {
        return refuse("section", "must have a finite level and time".into());
    }
    Ok(())
}

fn has_strictly_convex_direction(law: &Law) -> bool {
    fn strictly<const P: usize>(law: &FrictionLaw<P>) -> bool {
        law.isotropic_coefficient().is_some()
            || strict_convexity(&Star::Convex(law.direction().clone())).holds
    }
    match law {
        Law::One(_) => true,
        Law::Two(law) => strictly(law),
        Law::Three(law) => strictly(law),
    }
}

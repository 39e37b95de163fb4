//! Event-driven integration: phases as smooth ordinary differential equations, and stick, slip, opening and impacts
//! located between them.
//!
//! It is the independent check of Moreau's time stepping, and the flow of which limit cycles are fixed points. Rooms
//! use only those above them in this table:
//!
//! | file | concept |
//! |---|---|
//! | `options.rs` | options, sections and what is refused |
//! | `state.rs` | states, their scales, and what counts as zero |
//! | `outcome.rs` | why an integration ends |
//! | `dynamics/` | accelerations and contact forces in a mode, their drift and their Jacobian |
//! | `motion.rs` | what is returned |
//! | `event_function/` | functions whose zeros are events, also between the stages of a step |
//! | `collocation/` | steps of order nine: stages, errors, growth of deviations, lengths, dense output |
//! | `contact_problem/` | what contacts do next: accelerations, impacts, forces that are shared in many ways |
//! | `integration/` | the loop over steps: detection and location of events, and what is done at them |

mod collocation;
mod contact_problem;
mod dynamics;
mod event_function;
mod integration;
mod motion;
mod options;
mod outcome;
mod resolution;
mod state;

use std::ops::ControlFlow;

pub use motion::{Event, EventKind, Motion};
pub use options::{Options, Section};
pub use outcome::{Outcome, Stagnation};
pub use state::EvaluationError;

use crate::argument::ArgumentError;
use crate::system::System;

/// The motion so far, and why it ended; the first is there whatever the second says.
#[derive(Debug)]
#[non_exhaustive]
#[must_use = "an integration may end before its time"]
pub struct Run {
    /// The motion.
    pub motion: Motion,
    /// Why the integration ended.
    pub outcome: Outcome,
}

/// Integrates `system` from event to event.
///
/// Bodies that turn in space are integrated with rotation vectors in place of their quaternions, see
/// [`System::rotations`]. Each of the [`System::parts`] has steps of its own and moves as it would alone.
///
/// ```
/// use asperity::event::{EventKind, Options, Outcome, integrate};
/// use asperity::law::FrictionLaw;
/// use asperity::system::sliding_point;
///
/// let point = sliding_point(1.0, FrictionLaw::isotropic(0.5)?, 10.0)?;
/// let options = Options::new(1.0)?.with_start(&[0.0, 0.0], &[1.0, 0.0]);
/// let run = integrate(&point, &options)?;
/// assert!(matches!(run.outcome, Outcome::Finished));
/// // The point comes to rest after v₀/(μg) = 0.2 s.
/// let stick = &run.motion.events[0];
/// assert!(stick.kind == EventKind::Stick && (stick.time - 0.2).abs() < 1e-8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// [`ArgumentError`] if an option is out of range, if contacts overlap at the beginning, or if the system cannot be
/// integrated in this way: the direction sets of its laws must be strictly convex.
pub fn integrate(system: &dyn System, options: &Options) -> Result<Run, ArgumentError> {
    integrate_with(system, options, &mut |_| ControlFlow::Continue(()))
}

/// The same with an observer: `observer(t)` is called about every 50 ms and may stop the run.
///
/// # Errors
///
/// As [`integrate`].
pub fn integrate_with(
    system: &dyn System,
    options: &Options,
    observer: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<Run, ArgumentError> {
    let start = options.check(system)?;
    let (motion, outcome) = integration::run(system, &start, options, observer)?;
    Ok(Run { motion, outcome })
}

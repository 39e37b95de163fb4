//! The time loop.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use thiserror::Error;

use crate::solver::{Solver, Status};
use crate::stepper::{StepError, Stepper};
use crate::system::{System, SystemError};
use crate::trajectory::Trajectory;

/// What to simulate.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Step in s.
    pub dt: f64,
    /// Number of steps.
    pub steps: usize,
    /// Initial coordinates.
    pub q0: Vec<f64>,
    /// Initial velocities.
    pub u0: Vec<f64>,
    /// Contact solver.
    pub solver: Solver,
    /// Largest natural residual of a step.
    pub tolerance: f64,
    /// Every how many steps a sample is kept; the last state always is.
    pub save_every: usize,
    /// Whether to stop as soon as everything rests.
    pub until_rest: bool,
    /// Whether to stop at a step whose contact problem is not solved, or to count it and go on.
    pub stop_on_failure: bool,
}

/// Why the loop ended.
#[derive(Debug)]
pub enum Outcome {
    /// All steps were made.
    Finished,
    /// Everything rests.
    AtRest,
    /// The observer asked to stop.
    Interrupted,
    /// A contact problem was not solved; the samples end before that step.
    Failed(Failure),
    /// The system or the state failed.
    Error(StepError),
}

/// A contact problem that was not solved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Failure {
    /// Step, counted from 1.
    pub step: usize,
    /// Time at the end of the step in s.
    pub time: f64,
    /// The contact with the largest defect, in the order of the system's contacts.
    pub contact: usize,
    /// Natural residual.
    pub residual: f64,
    /// How the solver ended.
    pub status: Status,
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

/// The part computed so far, and why the loop ended; the first is there whatever the second says.
#[derive(Debug)]
pub struct Run {
    /// The samples.
    pub trajectory: Trajectory,
    /// Why the loop ended.
    pub outcome: Outcome,
}

/// How often the observer is called, whatever a step costs.
const POLL_EVERY: Duration = Duration::from_millis(50);

/// Simulates `system` with Moreau's midpoint scheme.
///
/// `observer(step, steps)` is called about every 50 ms and may stop the run.
pub fn simulate(
    system: &dyn System,
    options: &Options,
    observer: &mut dyn FnMut(usize, usize) -> ControlFlow<()>,
) -> Result<Run, OptionsError> {
    check(system, options)?;
    let Options { dt, tolerance, solver, .. } = *options;
    let mut trajectory = Trajectory::default();
    let outcome = Stepper::new(system, solver, tolerance, dt, &options.q0, &options.u0)
        .and_then(|mut stepper| run(system, options, &mut stepper, &mut trajectory, observer))
        .unwrap_or_else(Outcome::Error);
    Ok(Run { trajectory, outcome })
}

fn run(
    system: &dyn System,
    options: &Options,
    stepper: &mut Stepper<'_>,
    trajectory: &mut Trajectory,
    observer: &mut dyn FnMut(usize, usize) -> ControlFlow<()>,
) -> Result<Outcome, StepError> {
    let contacts = system.contacts().len();
    let p = system.contacts().iter().map(|c| c.law.dimension()).max().unwrap_or(0);
    *trajectory = Trajectory::new(stepper, p, contacts)?;
    let mut clock = Clock::new();
    let (mut rested, mut fastest) = (0, 0.0_f64);
    for step in 1..=options.steps {
        let report = stepper.step()?;
        if report.status != Status::Converged {
            if options.stop_on_failure {
                return Ok(Outcome::Failed(Failure {
                    step,
                    time: stepper.time(),
                    contact: stepper.contact_of(report.worst_contact),
                    residual: report.residual,
                    status: report.status,
                }));
            }
            trajectory.failed_steps += 1;
        }
        trajectory.count(stepper, report.ambiguous);
        if options.until_rest {
            let speed = stepper.u().iter().fold(0.0, |s: f64, v| s.max(v.abs()));
            fastest = fastest.max(speed);
            rested = if speed <= 1e-12 * fastest { rested + 1 } else { 0 };
        }
        // At rest for two steps: a turning point of a motion is at rest for one at the most.
        let outcome = if options.until_rest && rested >= 2 {
            Some(Outcome::AtRest)
        } else if clock.due() && observer(step, options.steps).is_break() {
            Some(Outcome::Interrupted)
        } else {
            None
        };
        if outcome.is_some() || step % options.save_every == 0 || step == options.steps {
            trajectory.record(stepper, report.iterations, report.residual)?;
        }
        if let Some(outcome) = outcome {
            return Ok(outcome);
        }
    }
    Ok(Outcome::Finished)
}

/// Polls by the clock, reading it only now and then while steps are short.
struct Clock {
    last: Instant,
    countdown: u32,
    interval: u32,
}

impl Clock {
    fn new() -> Self {
        Self { last: Instant::now(), countdown: 1, interval: 1 }
    }

    /// Whether the observer is to be called.
    #[inline]
    fn due(&mut self) -> bool {
        self.countdown -= 1;
        if self.countdown > 0 {
            return false;
        }
        let elapsed = self.last.elapsed();
        let due = elapsed >= POLL_EVERY;
        if due {
            self.last = Instant::now();
            self.interval = (self.interval / 2).max(1);
        } else if elapsed < POLL_EVERY / 8 && self.interval < 1 << 20 {
            self.interval *= 2;
        }
        self.countdown = self.interval;
        due
    }
}

fn check(system: &dyn System, options: &Options) -> Result<(), OptionsError> {
    let refuse = |argument, message: String| Err(OptionsError { argument, message });
    for (argument, value) in [("dt", options.dt), ("tolerance", options.tolerance)] {
        if !(value.is_finite() && value > 0.0) {
            return refuse(argument, format!("must be finite and positive, got {value}"));
        }
    }
    if options.save_every == 0 {
        return refuse("save_every", "must be at least 1, got 0".into());
    }
    let (q0, u0) = (&options.q0, &options.u0);
    for (argument, values, expected) in [("q0", q0, system.coordinates()), ("u0", u0, system.dof())]
    {
        if values.len() != expected {
            let got = values.len();
            return refuse(argument, format!("must have {expected} entries, has {got}"));
        }
        if let Some(value) = values.iter().find(|v| !v.is_finite()) {
            return refuse(argument, format!("must be finite, got {value}"));
        }
    }
    system.normalise(&mut q0.clone()).or_else(|error| match error {
        SystemError::Argument { argument, message } => refuse(argument, message),
        foreign => refuse("q0", foreign.to_string()),
    })
}

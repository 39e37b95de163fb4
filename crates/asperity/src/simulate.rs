//! The time loop.

use std::cell::Cell;
use std::ops::ControlFlow;

use crate::argument::{ArgumentError, positive, refuse};
use crate::integrator::midpoint::{State, StepError, Stepper};
use crate::integrator::observer::Observer;
use crate::solver::{SolveReport, Solver, Status, Unsolvable};
use crate::system::{InitialState, System, SystemError};
use crate::trajectory::Trajectory;
use crate::vectors::largest;

/// What to simulate. What is not given has the value that stands beside it.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Options {
    /// Step in s.
    pub dt: f64,
    /// Number of steps.
    pub steps: usize,
    /// Where to start; by default at the time 0 in the system's own state, [`System::initial_state`].
    pub start: Option<State>,
    /// Contact solver; [`Solver::default`].
    pub solver: Solver,
    /// Largest natural residual of a step; 1e-10.
    pub tolerance: f64,
    /// Every how many steps a sample is kept; the last state always is. By default all are.
    pub save_every: usize,
    /// Whether to stop as soon as everything rests; not by default.
    pub until_rest: bool,
    /// Whether to stop at a step whose contact problem is not solved, as by default, or to count it and go on.
    pub stop_on_failure: bool,
}

/// Difference of `t_end` from a multiple of the step that counts as rounding, as a part.
const MULTIPLE: f64 = 1e-9;

/// Part of the largest velocity so far up to which everything rests: of those that there were, and of those of contacts
/// that there would have been without contact forces. Stick leaves rounding of the latter.
pub(crate) const AT_REST: f64 = 1e-12;

impl Options {
    /// Steps of length `dt` up to the time `t_end`, both in s; the last one may lead beyond it.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] if one of both is not finite and positive, or if there are more steps than can be counted.
    pub fn new(dt: f64, t_end: f64) -> Result<Self, ArgumentError> {
        positive("dt", dt)?;
        positive("t_end", t_end)?;
        let ratio = t_end / dt;
        // Beyond 2⁵³ the numbers of two steps have the same floating-point number.
        if !(ratio < 2f64.powi(53)) {
            let message = format!("is too small for t_end = {t_end}, got {dt}");
            return refuse("dt", message);
        }
        let nearest = ratio.round();
        let steps =
            if (ratio - nearest).abs() <= MULTIPLE * nearest { nearest } else { ratio.ceil() };
        Ok(Self {
            dt,
            steps: steps as usize,
            start: None,
            solver: Solver::default(),
            tolerance: 1e-10,
            save_every: 1,
            until_rest: false,
            stop_on_failure: true,
        })
    }

    /// The same for so many steps.
    #[must_use]
    pub fn with_steps(self, steps: usize) -> Self {
        Self { steps, ..self }
    }

    /// The same from these coordinates and velocities at the time 0.
    #[must_use]
    pub fn with_start(self, q0: &[f64], u0: &[f64]) -> Self {
        self.with_state(State::new(0.0, q0, u0))
    }

    /// The same from where another run has ended, [`Run::end`], as if it had not ended: with the same options what
    /// follows is the same to the bit.
    #[must_use]
    pub fn with_state(self, start: State) -> Self {
        Self { start: Some(start), ..self }
    }

    /// The same with another contact solver.
    #[must_use]
    pub fn with_solver(self, solver: Solver) -> Self {
        Self { solver, ..self }
    }

    /// The same to another tolerance.
    #[must_use]
    pub fn with_tolerance(self, tolerance: f64) -> Self {
        Self { tolerance, ..self }
    }

    /// The same with a sample every so many steps.
    #[must_use]
    pub fn with_save_every(self, save_every: usize) -> Self {
        Self { save_every, ..self }
    }

    /// The same, but stopped as soon as everything rests.
    #[must_use]
    pub fn until_rest(self) -> Self {
        Self { until_rest: true, ..self }
    }

    /// The same, but failed steps are counted and the run goes on.
    #[must_use]
    pub fn counting_failures(self) -> Self {
        Self { stop_on_failure: false, ..self }
    }
}

/// Why the loop ended.
#[derive(Debug)]
#[non_exhaustive]
#[must_use = "a simulation may end before its time"]
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
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Failure {
    /// Step, counted from 1.
    pub step: usize,
    /// Time at the end of the step in s.
    pub time: f64,
    /// The contact with the largest defect, in the order of the system's contacts.
    pub contact: Option<usize>,
    /// Natural residual.
    pub residual: f64,
    /// How the solver ended.
    pub status: Status,
    /// The problem and the proof, if it has no solution.
    pub unsolvable: Option<Box<Unsolvable>>,
}

/// The part computed so far, and why the loop ended; the first is there whatever the second says.
#[derive(Debug)]
#[non_exhaustive]
#[must_use = "a simulation may end before its time"]
pub struct Run {
    /// The samples; the last one is the state of the last step that was made.
    pub trajectory: Trajectory,
    /// What [`Options::with_state`] asks for to go on after the last sample; nothing where there is no going on, as
    /// the motion has diverged.
    pub end: Option<State>,
    /// Why the loop ended.
    pub outcome: Outcome,
}

/// Simulates `system` with Moreau's midpoint scheme.
///
/// ```
/// use asperity::law::FrictionLaw;
/// use asperity::simulate::{Options, Outcome, simulate};
/// use asperity::system::sliding_point;
///
/// let point = sliding_point(1.0, FrictionLaw::isotropic(0.5)?, 10.0)?;
/// let options = Options::new(1e-3, 1.0)?.with_start(&[0.0, 0.0], &[1.0, 0.0]).until_rest();
/// let run = simulate(&point, &options)?;
/// assert!(matches!(run.outcome, Outcome::AtRest));
/// // The path is v₀²/(2μg) = 0.1 m.
/// let path = &run.trajectory.samples;
/// assert!((path.state(path.len() - 1).q[0] - 0.1).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// [`ArgumentError`] if an option or the state at the beginning is out of range. Whatever happens later is the
/// [`Outcome`] of the run.
pub fn simulate(system: &dyn System, options: &Options) -> Result<Run, ArgumentError> {
    simulate_with(system, options, &mut |_, _| ControlFlow::Continue(()))
}

/// The same with an observer: `observer(step, steps)` is called about every 50 ms, within long steps, too, and may stop
/// the run.
///
/// # Errors
///
/// As [`simulate`].
pub fn simulate_with(
    system: &dyn System,
    options: &Options,
    observer: &mut dyn FnMut(usize, usize) -> ControlFlow<()>,
) -> Result<Run, ArgumentError> {
    if options.save_every == 0 {
        return refuse("save_every", "must be at least 1, got 0");
    }
    let Options { dt, tolerance, solver, .. } = *options;
    let mut trajectory = Trajectory::empty(system);
    let own = || {
        let InitialState { q, u } = system.initial_state();
        State::new(0.0, &q, &u)
    };
    let start = options.start.clone().unwrap_or_else(own);
    let mut stepper = match Stepper::new(system, solver, tolerance, dt, &start) {
        Ok(stepper) => stepper,
        Err(StepError::Options(error)) => return Err(error),
        Err(StepError::System(SystemError::Argument(error))) => return Err(error),
        Err(error) => return Ok(Run { trajectory, end: None, outcome: Outcome::Error(error) }),
    };
    let mut after = |step| observer(step, options.steps);
    let observer = Observer::new(&mut after);
    let outcome = run(options, &mut stepper, &mut trajectory, &observer, &mut |_| {});
    let outcome = outcome.unwrap_or_else(Outcome::Error);
    let diverged = matches!(outcome, Outcome::Error(StepError::Reverses { .. }));
    let end = Some(stepper.state()).filter(|state| state.is_finite() && !diverged);
    Ok(Run { trajectory, end, outcome })
}

/// The loop, and a sample of where it has ended; `each_step` sees the state after every step.
pub(crate) fn run(
    options: &Options,
    stepper: &mut Stepper<'_>,
    trajectory: &mut Trajectory,
    observer: &Observer<'_, usize>,
    each_step: &mut impl FnMut(&Stepper<'_>),
) -> Result<Outcome, StepError> {
    trajectory.begin(stepper)?;
    let mut progress = Loop::new(options);
    let step = |before| {
        progress.step(before + 1, options, stepper, trajectory, observer, each_step).transpose()
    };
    let outcome = (0..options.steps).find_map(step).unwrap_or(Ok(Outcome::Finished));
    progress.end(outcome, stepper, trajectory)
}

/// What the loop remembers from step to step.
#[derive(Debug)]
pub(crate) struct Loop {
    /// Steps until the next sample.
    pub(crate) until_sample: usize,
    /// Steps in which everything has rested by now, and the largest velocity so far.
    pub(crate) rested: usize,
    pub(crate) fastest: f64,
    /// The report of the last step while that is not among the samples.
    unsaved: Option<SolveReport>,
}

impl Loop {
    pub(crate) fn new(options: &Options) -> Self {
        Self { until_sample: options.save_every, rested: 0, fastest: 0.0, unsaved: None }
    }

    /// Makes a step, counted from 1; how the run has ended, if it has.
    #[inline(always)]
    pub(crate) fn step(
        &mut self,
        step: usize,
        options: &Options,
        stepper: &mut Stepper<'_>,
        trajectory: &mut Trajectory,
        observer: &Observer<'_, usize>,
        each_step: &mut impl FnMut(&Stepper<'_>),
    ) -> Result<Option<Outcome>, StepError> {
        // A step that asks but once is over soon: the clock would be a part of its cost.
        let asked = Cell::new(false);
        let cancelled = || asked.replace(true) && observer.asks_to_stop(step - 1);
        let report = match stepper.step_unless(&cancelled, !options.stop_on_failure) {
            Err(StepError::Cancelled { .. }) => return Ok(Some(Outcome::Interrupted)),
            report => report?,
        };
        let failed = report.status != Status::Converged;
        if failed && options.stop_on_failure {
            return Ok(Some(Outcome::Failed(Failure {
                step,
                time: stepper.time_after(1),
                contact: stepper.contact_of(report.worst_contact),
                residual: report.residual,
                status: report.status,
                unsolvable: stepper.unsolvable().map(Box::new),
            })));
        }
        trajectory.failed_steps += usize::from(failed);
        trajectory.count(stepper, report.ambiguous);
        each_step(stepper);
        self.unsaved = Some(report);
        if options.until_rest {
            let speed = largest(stepper.u());
            let free = largest(stepper.problem().free_velocity());
            self.fastest = self.fastest.max(speed).max(free);
            self.rested = if speed <= AT_REST * self.fastest { self.rested + 1 } else { 0 };
        }
        // At rest for two steps: a turning point of a motion is at rest for one at the most.
        if options.until_rest && self.rested >= 2 {
            return Ok(Some(Outcome::AtRest));
        }
        if observer.asks_to_stop_after_step(step) {
            return Ok(Some(Outcome::Interrupted));
        }
        self.until_sample -= 1;
        if self.until_sample == 0 {
            trajectory.record(stepper, report.iterations, report.residual)?;
            (self.unsaved, self.until_sample) = (None, options.save_every);
        }
        Ok(None)
    }

    /// The end of a run with a sample of where it has ended.
    pub(crate) fn end(
        &self,
        outcome: Result<Outcome, StepError>,
        stepper: &mut Stepper<'_>,
        trajectory: &mut Trajectory,
    ) -> Result<Outcome, StepError> {
        let recorded = match (&outcome, self.unsaved) {
            (Err(StepError::NotFinite { .. } | StepError::Reverses { .. }), _) | (_, None) => {
                Ok(())
            }
            (_, Some(report)) => trajectory.record(stepper, report.iterations, report.residual),
        };
        outcome.and_then(|outcome| recorded.map(|()| outcome))
    }
}

//! Many runs of time stepping.

use std::ops::ControlFlow;

use super::keep::Keep;
use super::lanes::{self, Common, Run};
use super::outcome::{Counts, Ending, Ensemble, Reason, Rows};
use super::reduction::Reduction;
use super::runner::{Prepared, Runner};
use super::workers::{self, Stop};
use super::{Lanes, Members, Workers};
use crate::argument::{ArgumentError, refuse};
use crate::integrator::midpoint::{State, StepError, Stepper};
use crate::integrator::observer::Observer;
use crate::simulate::{Options, Outcome, run};
use crate::solver::Solver;
use crate::system::{InitialState, System};
use crate::trajectory::Trajectory;

/// Members that are run at once in lanes: a multiple of every number of lanes.
const AT_ONCE: usize = 8;

/// Runs every member of an ensemble as [`simulate`](crate::simulate::simulate) would.
///
/// `options` are those of every run but for its start, which the member has, and for its samples, of which `keep` decides.
/// There are as many threads as the machine has unless `threads` are given; with several of them each solver works with one.
/// A run whose contact problem is not solved ends there, unless the options count such steps.
///
/// `observer(done, count)` is called about every 50 ms in the calling thread and may stop the ensemble.
///
/// ```
/// use std::ops::ControlFlow;
///
/// use asperity::ensemble::{Ending, Keep, Members, simulate_many};
/// use asperity::law::FrictionLaw;
/// use asperity::simulate::Options;
/// use asperity::system::{InitialState, LinearSystem, System, sliding_point};
///
/// /// A point that is pushed with another velocity in every run.
/// struct Pushes(LinearSystem);
///
/// impl Members for Pushes {
///     fn count(&self) -> usize {
///         100
///     }
///
///     fn first(&self) -> &dyn System {
///         &self.0
///     }
///
///     fn start(&self, member: usize, _system: &dyn System) -> InitialState {
///         InitialState { q: vec![0.0, 0.0], u: vec![0.01 * (1 + member) as f64, 0.0] }
///     }
/// }
///
/// let pushes = Pushes(sliding_point(1.0, FrictionLaw::isotropic(0.5)?, 10.0)?);
/// let (options, keep) = (Options::new(1e-3, 1.0)?.until_rest(), Keep::default());
/// let many = simulate_many(&pushes, &options, &keep, None, &mut |_, _| ControlFlow::Continue(()))?;
/// assert!(many.endings.iter().all(|&ending| ending == Ending::AtRest));
/// // The paths are v₀²/(2μg), up to 0.1 m.
/// assert!((many.ends.q[2 * 99] - 0.1).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// [`ArgumentError`] if an option is out of range. What a single run comes to is among the results.
pub fn simulate_many(
    members: &dyn Members,
    options: &Options,
    keep: &Keep,
    workers: impl Into<Workers>,
    observer: &mut dyn FnMut(usize, usize) -> ControlFlow<()>,
) -> Result<Ensemble, ArgumentError> {
    if keep.every == Some(0) {
        return refuse("keep", "must be at least 1, got 0");
    }
    let mut options = options.clone();
    let Workers { threads, lanes } = workers.into();
    let threads = workers::threads(threads, members.count());
    if let Solver::Auto { threads: own, .. } = &mut options.solver
        && threads > 1
    {
        *own = 1;
    }
    options.save_every = keep.every.unwrap_or(usize::MAX);
    let samples = keep.every.map_or(0, |every| 1 + options.steps.div_ceil(every));
    let runner = Runner { members, keep, samples, threads };
    if lanes != Lanes::None {
        return runner.run_together(observer, AT_ONCE, &|members, stop, rows| {
            step_together(members, lanes, &options, (keep, stop), rows);
        });
    }
    runner.run(observer, &|system, start, stop, reduction, rows| {
        step_through(system, start, &options, (keep, stop), reduction, rows);
    })
}

/// Runs in lanes as far as lanes can make them, else one after the other. Their results become the next rows.
fn step_together(
    members: Vec<Prepared<'_>>,
    lanes: Lanes,
    options: &Options,
    (keep, stop): (&Keep, &Stop),
    rows: &mut Rows<'_>,
) {
    let mut asked = |_| stop.answer();
    let observer = Observer::new(&mut asked);
    let common = Common { options, keep, stop, observer: &observer };
    let (made, errors): (Vec<_>, Vec<_>) = members
        .into_iter()
        .map(|member| match member {
            Ok(made) => (Some(made), None),
            Err(error) => (None, Some(error)),
        })
        .unzip();
    let mut runs: Vec<Option<Run<'_>>> = made
        .iter()
        .map(|made| {
            let (made, start) = made.as_ref()?;
            Run::begin(made.system(), start, common)
        })
        .collect();
    let mut together: Vec<&mut Run<'_>> = runs.iter_mut().flatten().collect();
    lanes::go_on(&mut together, lanes, common);
    for ((made, error), run) in made.iter().zip(errors).zip(runs) {
        if let Some(error) = error {
            rows.push_failure(0.0, Reason::System(error));
        } else if let Some(run) = run.filter(Run::is_done) {
            let Run { outcome, stepper, trajectory, reduction, in_lanes, .. } = run;
            let outcome = outcome.unwrap_or(Ok(Outcome::Finished));
            finish(outcome, stepper.time(), (&trajectory, in_lanes), &reduction, rows);
        } else if let Some((made, start)) = made {
            // One that lanes cannot make, or that has failed there: what is reported is what it comes to by itself.
            let reduction = &mut Reduction::default();
            step_through(made.system(), start, options, (keep, stop), reduction, rows);
        }
    }
}

/// One run, whose results become the next row.
fn step_through(
    system: &dyn System,
    start: &InitialState,
    options: &Options,
    (keep, stop): (&Keep, &Stop),
    reduction: &mut Reduction,
    rows: &mut Rows<'_>,
) {
    let Options { dt, tolerance, solver, .. } = *options;
    let state = State::new(0.0, &start.q, &start.u);
    let mut stepper = match Stepper::new(system, solver, tolerance, dt, &state) {
        Ok(stepper) => stepper,
        Err(error) => return rows.push_failure(0.0, Reason::Step(error)),
    };
    let mut trajectory = Trajectory::empty(system);
    let mut asked = |_| stop.answer();
    let observer = Observer::new(&mut asked);
    reduction.begin_with(keep, &stepper);
    let outcome = run(options, &mut stepper, &mut trajectory, &observer, &mut |stepper| {
        reduction.go_on_with(keep, stepper);
    });
    finish(outcome, stepper.time(), (&trajectory, 0), reduction, rows);
}

/// Appends what came out of a run.
fn finish(
    outcome: Result<Outcome, StepError>,
    time: f64,
    (trajectory, in_lanes): (&Trajectory, usize),
    reduction: &Reduction,
    rows: &mut Rows<'_>,
) {
    let (ending, reason) = match outcome {
        Ok(Outcome::Finished) => (Ending::Finished, None),
        Ok(Outcome::AtRest) => (Ending::AtRest, None),
        Ok(Outcome::Interrupted) => (Ending::Interrupted, None),
        Ok(Outcome::Failed(failure)) => (Ending::Failed, Some(Reason::Unsolved(failure))),
        Ok(Outcome::Error(error)) | Err(error) => (Ending::Failed, Some(Reason::Step(error))),
    };
    // What is no longer finite is not the end of a motion.
    let ended = !matches!(reason, Some(Reason::Step(_)));
    if let Some(reason) = reason {
        rows.fail(time, reason);
    }
    let Trajectory { steps, ambiguous_steps: ambiguous, .. } = *trajectory;
    let counts = Counts { steps, ambiguous, in_lanes };
    rows.push(ending, ended, &trajectory.samples, counts, reduction);
}

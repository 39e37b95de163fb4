//! Many runs of time stepping.

use std::ops::ControlFlow;

use super::Members;
use super::crew::Crew;
use super::keep::Keep;
use super::outcome::{Ending, Ensemble, Reason, Rows};
use super::reduction::Reduction;
use super::workers::{self, Stop};
use crate::argument::{ArgumentError, refuse};
use crate::integrator::midpoint::{State, Stepper};
use crate::integrator::observer::Observer;
use crate::simulate::{Options, Outcome, run};
use crate::solver::Solver;
use crate::system::{InitialState, System};
use crate::trajectory::Trajectory;

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
    threads: Option<usize>,
    observer: &mut dyn FnMut(usize, usize) -> ControlFlow<()>,
) -> Result<Ensemble, ArgumentError> {
    if keep.every == Some(0) {
        return refuse("keep", "must be at least 1, got 0");
    }
    let mut options = options.clone();
    let threads = workers::threads(threads, members.count());
    if let Solver::Auto { threads: own, .. } = &mut options.solver
        && threads > 1
    {
        *own = 1;
    }
    options.save_every = keep.every.unwrap_or(usize::MAX);
    let samples = keep.every.map_or(0, |every| 1 + options.steps.div_ceil(every));
    let crew = Crew { members, keep, samples, threads };
    crew.run(observer, &|system, start, stop, reduction, rows| {
        step_through(system, start, &options, (keep, stop), reduction, rows);
    })
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
    let mut asked =
        |_| if stop.is_asked() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
    let observer = Observer::new(&mut asked);
    let outcome = if keep.reduces() {
        reduction.begin(keep, system.contacts().len(), 0.0, stepper.q(), stepper.u());
        run(options, &mut stepper, &mut trajectory, &observer, &mut |stepper| {
            let phases = stepper.phases().iter().copied();
            reduction.go_on(keep, stepper.time(), stepper.q(), stepper.u(), phases);
        })
    } else {
        run(options, &mut stepper, &mut trajectory, &observer, &mut |_| {})
    };
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
        rows.fail(stepper.time(), reason);
    }
    let counts = (trajectory.steps, trajectory.ambiguous_steps);
    rows.push(ending, ended, &trajectory.samples, counts, reduction);
}

//! Many runs of event-driven integration.

use std::ops::ControlFlow;

use super::Members;
use super::crew::Crew;
use super::keep::Keep;
use super::outcome::{Ending, Ensemble, Reason, Rows};
use super::reduction::Reduction;
use super::workers::{self, Stop};
use crate::argument::{ArgumentError, refuse};
use crate::integrator::event::{self, Options, Outcome, Section};
use crate::integrator::samples::Samples;
use crate::system::{InitialState, System};

/// Integrates every member of an ensemble as [`integrate`](crate::event::integrate) would.
///
/// `options` are those of every run but for its start, which the member has. A section of theirs ends a run; one of
/// `keep` is counted, and the run goes on. Samples on the way, where the options ask for some, are those of a grid from the
/// start on, and the end. There are as many threads as the machine has unless `threads` are given.
///
/// `observer(done, count)` is called about every 50 ms in the calling thread and may stop the ensemble.
///
/// # Errors
///
/// [`ArgumentError`] if an option is out of range. What a single run comes to is among the results.
pub fn integrate_many(
    members: &dyn Members,
    options: &Options,
    keep: &Keep,
    threads: Option<usize>,
    observer: &mut dyn FnMut(usize, usize) -> ControlFlow<()>,
) -> Result<Ensemble, ArgumentError> {
    if keep.every.is_some() {
        return refuse("keep", "counts steps of time stepping, which an integration has not");
    }
    if options.section.is_some() && keep.section.is_some() {
        return refuse("section", "either ends the runs or is counted, not both");
    }
    if options.sample.is_some() && keep.section.is_some() {
        return refuse("sample_every", "excludes a section that is counted");
    }
    options.check(members.first())?;
    let samples = options.sample.map_or(0, |dt| 1 + (options.duration() / dt).ceil() as usize);
    let threads = workers::threads(threads, members.count());
    let crew = Crew { members, keep, samples, threads };
    crew.run(observer, &|system, start, stop, reduction, rows| {
        integrate_one(system, start, options, (keep, stop), reduction, rows);
    })
}

/// One run, whose results become the next row.
fn integrate_one(
    system: &dyn System,
    start: &InitialState,
    options: &Options,
    (keep, stop): (&Keep, &Stop),
    reduction: &mut Reduction,
    rows: &mut Rows<'_>,
) {
    let mut options = Options { start: Some(start.clone()), ..options.clone() };
    if let Some(section) = &keep.section {
        let after = section.after.max(keep.after);
        options.section = Some(Section { after, ..section.clone() });
    }
    let mut asked =
        |_| if stop.is_asked() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
    let (mut begun, mut steps, mut ambiguous) = (false, 0, 0);
    let (outcome, samples) = loop {
        let run = match event::integrate(system, &options, &mut asked) {
            Ok(run) => run,
            Err(error) => return rows.push_failure(options.t_start, Reason::Argument(error)),
        };
        let (motion, samples) = (&run.motion, &run.motion.samples);
        steps += motion.steps;
        ambiguous += motion.ambiguous_events();
        if keep.reduces() {
            look_at(samples, system, keep, begun, reduction);
            begun = true;
        }
        let counted = matches!(run.outcome, Outcome::Section) && keep.section.is_some();
        let Some((t, q, u)) = samples.last().filter(|_| counted) else {
            break (run.outcome, run.motion.samples);
        };
        reduction.cross_here(t, q, u);
        if t >= options.t_end {
            break (Outcome::Finished, run.motion.samples);
        }
        // What lies on the section has crossed it.
        options = options.with_start(q, u).with_start_time(t);
        if let Some(section) = &mut options.section {
            section.after = section.after.max(t);
        }
    };
    let (ending, reason) = match outcome {
        Outcome::Finished => (Ending::Finished, None),
        Outcome::Section => (Ending::Section, None),
        Outcome::Interrupted => (Ending::Interrupted, None),
        failed => (Ending::Failed, Some(Reason::Event(failed))),
    };
    if let Some(reason) = reason {
        rows.fail(samples.t.last().copied().unwrap_or(options.t_start), reason);
    }
    rows.push(ending, true, &samples, (steps, ambiguous), reduction);
}

/// Shows the samples of a run, or of what follows what was seen before.
fn look_at(
    samples: &Samples,
    system: &dyn System,
    keep: &Keep,
    begun: bool,
    reduction: &mut Reduction,
) {
    // Of rotations the velocities are not the rates of the coordinates.
    let smooth = system.rotations().is_empty();
    for sample in 0..samples.len() {
        let (t, q, u) = samples.state(sample);
        if sample == 0 && !begun {
            reduction.begin(keep, samples.contacts, t, q, u);
            continue;
        }
        if smooth {
            reduction.widen_between(keep, t, q, u);
        }
        let phases = samples.phases(sample);
        // The section is looked for by the integration, which finds it exactly.
        reduction.go_on_beside_section(keep, t, q, u, phases);
    }
}

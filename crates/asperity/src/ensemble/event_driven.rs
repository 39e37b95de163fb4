//! Many runs of event-driven integration.

use std::ops::ControlFlow;

use super::Members;
use super::keep::Keep;
use super::outcome::{Counts, Ending, Ensemble, Reason, Rows};
use super::reduction::Reduction;
use super::runner::Runner;
use super::workers::{self, Stop};
use crate::argument::{ArgumentError, refuse};
use crate::integrator::StateSample;
use crate::integrator::event::{self, EventKind, Motion, Options, Outcome, Run, Section};
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
    let samples = options.sample.map_or(0, |dt| samples_of(options, dt));
    let threads = workers::threads(threads, members.count());
    let runner = Runner { members, keep, samples, threads };
    runner.run(observer, &|system, start, stop, reduction, rows| {
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
        options.goes_on = true;
    }
    let mut asked = |_| stop.answer();
    let Run { motion, outcome, .. } = match event::integrate_with(system, &options, &mut asked) {
        Ok(run) => run,
        Err(error) => return rows.push_failure(options.t_start, Reason::Argument(error)),
    };
    if keep.reduces() {
        look_at(&motion, system, keep, reduction);
    }
    let (ending, reason) = match outcome {
        Outcome::Finished => (Ending::Finished, None),
        Outcome::Section => (Ending::Section, None),
        Outcome::Interrupted => (Ending::Interrupted, None),
        failed => (Ending::Failed, Some(Reason::Event(failed))),
    };
    if let Some(reason) = reason {
        rows.fail(motion.samples.t.last().copied().unwrap_or(options.t_start), reason);
    }
    let counts = Counts { steps: motion.steps, ambiguous: motion.ambiguous_events(), in_lanes: 0 };
    rows.push(ending, true, &motion.samples, counts, reduction);
}

/// Shows a motion.
fn look_at(motion: &Motion, system: &dyn System, keep: &Keep, reduction: &mut Reduction) {
    let samples = &motion.samples;
    // Of rotations the velocities are not the rates of the coordinates.
    let smooth = system.rotations().is_empty();
    for sample in 0..samples.len() {
        let StateSample { t, q, u } = samples.state(sample);
        if sample == 0 {
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
    for event in motion.events.iter().filter(|event| event.kind == EventKind::Section) {
        // At a jump of the velocities the later of two samples is the one beyond the section.
        let until = samples.t.partition_point(|&t| t <= event.time);
        if let Some(sample) = until.checked_sub(1) {
            let StateSample { q, u, .. } = samples.state(sample);
            reduction.cross_here(event.time, q, u);
        }
    }
}

/// Number of samples of a motion: those of the grid before its end, and the end.
fn samples_of(options: &Options, dt: f64) -> usize {
    let (start, end) = (options.t_start, options.t_end);
    let mut before = (options.duration() / dt).ceil() as usize;
    while before > 0 && start + (before - 1) as f64 * dt >= end {
        before -= 1;
    }
    while start + before as f64 * dt < end {
        before += 1;
    }
    before + 1
}

//! What comes out of many runs.

use std::ops::Range;

use super::keep::Keep;
use super::reduction::{Reduced, Reduction};
use crate::argument::ArgumentError;
use crate::integrator::Samples;
use crate::integrator::event;
use crate::integrator::midpoint::StepError;
use crate::simulate;
use crate::system::{System, SystemError};

/// How a run has ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(i8)]
pub enum Ending {
    /// It was not begun, or given up, as the observer asked to stop.
    Interrupted = -1,
    /// All of its time has passed.
    Finished = 0,
    /// Everything rests.
    AtRest = 1,
    /// The section is crossed.
    Section = 2,
    /// It failed, see [`Ensemble::failures`].
    Failed = 3,
}

/// Why a run failed.
#[derive(Debug)]
#[non_exhaustive]
pub enum Reason {
    /// There is no such system.
    System(SystemError),
    /// The system cannot be run with these options.
    Argument(ArgumentError),
    /// A step of time stepping could not be made.
    Step(StepError),
    /// A contact problem of time stepping was not solved.
    Unsolved(simulate::Failure),
    /// Event-driven integration has not come to its end.
    Event(event::Outcome),
}

/// A run that failed.
#[derive(Debug)]
#[non_exhaustive]
pub struct MemberFailure {
    /// Its number.
    pub member: usize,
    /// Time up to which it came, in s.
    pub time: f64,
    /// Why.
    pub reason: Reason,
}

/// The ends of many runs, in the order of the members whatever the order in which they were computed.
#[derive(Debug, Default)]
#[non_exhaustive]
pub struct Ensemble {
    /// The last sample of every run as far as it came; NaN, and phases unknown, of a run that was not begun or of
    /// which a step could not be made.
    pub ends: Samples,
    /// How every run has ended.
    pub endings: Vec<Ending>,
    /// Steps made `(n)`.
    pub steps: Vec<i64>,
    /// Steps, or events, at which some contact had several solutions `(n)`.
    pub ambiguous: Vec<i64>,
    /// Steps that were made in lanes `(n)`.
    pub in_lanes: Vec<i64>,
    /// Number of samples of a run among those on the way; 0 unless they were asked for.
    pub samples_per_member: usize,
    /// Samples on the way, run after run; where a run has ended before, they are NaN.
    pub samples: Samples,
    /// Quantities that were found on the way.
    pub reduced: Reduced,
    /// The runs that failed, in the order of the members.
    pub failures: Vec<MemberFailure>,
}

/// Numbers of coordinates, velocities and contacts, and the dimension of each contact's law.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Layout {
    pub(super) coordinates: usize,
    pub(super) dof: usize,
    pub(super) dimensions: Vec<usize>,
}

impl Layout {
    pub(super) fn of(system: &dyn System) -> Self {
        let dimensions = system.contacts().iter().map(|contact| contact.law().dimension());
        let (coordinates, dof) = (system.coordinates(), system.dof());
        Self { coordinates, dof, dimensions: dimensions.collect() }
    }

    fn sizes(&self) -> [usize; 3] {
        [self.coordinates, self.dof, self.dimensions.len()]
    }

    fn samples(&self) -> Samples {
        Samples::new(self.coordinates, self.dof, &self.dimensions)
    }
}

/// Numbers of steps of a run: all, those, or events, at which some contact had several solutions, those in lanes.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Counts {
    pub(super) steps: usize,
    pub(super) ambiguous: usize,
    pub(super) in_lanes: usize,
}

/// Results of members that follow each other.
pub(super) struct Rows<'a> {
    layout: &'a Layout,
    keep: &'a Keep,
    /// The first of them.
    first: usize,
    pub(super) ensemble: Ensemble,
}

impl<'a> Rows<'a> {
    pub(super) fn new(
        layout: &'a Layout,
        keep: &'a Keep,
        first: usize,
        samples_per_member: usize,
    ) -> Self {
        let (ends, samples) = (layout.samples(), layout.samples());
        let ensemble = Ensemble { ends, samples, samples_per_member, ..Ensemble::default() };
        Self { layout, keep, first, ensemble }
    }

    /// Appends a run: how it ended, its samples, of which the last is its end if that is known, and its reduced quantities.
    pub(super) fn push(
        &mut self,
        ending: Ending,
        ended: bool,
        samples: &Samples,
        counts: Counts,
        found: &Reduction,
    ) {
        let (most, all) = (self.ensemble.samples_per_member, &mut self.ensemble);
        match samples.len().checked_sub(1).filter(|_| ended) {
            Some(last) => all.ends.copy(samples, last..last + 1),
            None => all.ends.leave_out(1),
        }
        let there = samples.len().min(most);
        all.samples.copy(samples, 0..there);
        all.samples.leave_out(most - there);
        all.endings.push(ending);
        all.steps.push(counts.steps as i64);
        all.ambiguous.push(counts.ambiguous as i64);
        all.in_lanes.push(counts.in_lanes as i64);
        found.finish(self.keep, self.layout.sizes(), &mut all.reduced);
    }

    /// Appends a run that was not begun.
    pub(super) fn push_nothing(&mut self, ending: Ending) {
        let none = self.layout.samples();
        self.push(ending, false, &none, Counts::default(), &Reduction::nothing());
    }

    /// Appends a run that failed before its first step.
    pub(super) fn push_failure(&mut self, time: f64, reason: Reason) {
        self.fail(time, reason);
        self.push_nothing(Ending::Failed);
    }

    /// Says why the next run to be appended fails.
    pub(super) fn fail(&mut self, time: f64, reason: Reason) {
        let member = self.first + self.ensemble.endings.len();
        self.ensemble.failures.push(MemberFailure { member, time, reason });
    }
}

impl Ensemble {
    /// An ensemble of which no run has been begun.
    pub(super) fn unbegun(
        layout: &Layout,
        keep: &Keep,
        count: usize,
        samples_per_member: usize,
    ) -> Self {
        let (mut ends, mut samples) = (layout.samples(), layout.samples());
        ends.leave_out(count);
        samples.leave_out(count * samples_per_member);
        let mut reduced = Reduced::default();
        let nothing = Reduction::nothing();
        for _ in 0..count {
            nothing.finish(keep, layout.sizes(), &mut reduced);
        }
        Self {
            ends,
            endings: vec![Ending::Interrupted; count],
            steps: vec![0; count],
            ambiguous: vec![0; count],
            in_lanes: vec![0; count],
            samples_per_member,
            samples,
            reduced,
            failures: Vec::new(),
        }
    }

    /// Puts the results of a chunk where they belong.
    pub(super) fn place(&mut self, members: Range<usize>, rows: Ensemble, layout: &Layout) {
        let first = members.start;
        self.ends.overwrite(first, &rows.ends);
        self.samples.overwrite(first * self.samples_per_member, &rows.samples);
        self.endings[members.clone()].copy_from_slice(&rows.endings);
        self.steps[members.clone()].copy_from_slice(&rows.steps);
        self.ambiguous[members.clone()].copy_from_slice(&rows.ambiguous);
        self.in_lanes[members.clone()].copy_from_slice(&rows.in_lanes);
        let mut reduced = rows.reduced;
        if !reduced.crossings.is_empty() {
            self.reduced.crossings[members].copy_from_slice(&reduced.crossings);
        }
        let sizes = layout.sizes();
        for ((to, width), (from, _)) in
            self.reduced.columns(sizes).into_iter().zip(reduced.columns(sizes))
        {
            if !from.is_empty() {
                to[first * width..first * width + from.len()].copy_from_slice(from);
            }
        }
        self.failures.extend(rows.failures);
    }

    /// Puts the failures in the order of the members.
    pub(super) fn finish(mut self) -> Self {
        self.failures.sort_by_key(|failure| failure.member);
        self
    }
}

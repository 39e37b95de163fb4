//! The loop over members that both kinds of runs have.

use std::ops::{ControlFlow, Range};

use super::keep::Keep;
use super::outcome::{Ending, Ensemble, Layout, Reason, Rows};
use super::reduction::Reduction;
use super::workers::{self, Stop};
use super::{Member, Members};
use crate::argument::{ArgumentError, entries, finite};
use crate::system::{InitialState, System, SystemError};

/// Runs one member from its start, and appends what comes out.
pub(super) type RunMember<'a> =
    dyn Fn(&dyn System, &InitialState, &Stop, &mut Reduction, &mut Rows<'_>) + Sync + 'a;

/// Threads that run the members of an ensemble.
pub(super) struct Crew<'a> {
    pub(super) members: &'a dyn Members,
    pub(super) keep: &'a Keep,
    /// Samples on the way that a member has.
    pub(super) samples: usize,
    pub(super) threads: usize,
}

impl Crew<'_> {
    /// Runs all members.
    pub(super) fn run(
        &self,
        observer: &mut dyn FnMut(usize, usize) -> ControlFlow<()>,
        run: &RunMember<'_>,
    ) -> Result<Ensemble, ArgumentError> {
        let Self { members, keep, samples, threads } = *self;
        let (count, layout) = (members.count(), Layout::of(members.first()));
        finite("after", &[keep.after])?;
        if let Some(section) = &keep.section {
            entries("section", &section.normal, layout.coordinates + layout.dof)?;
            finite("section", &[section.level, section.after])?;
        }
        let mut ensemble = Ensemble::unbegun(&layout, keep, count, samples);
        let (stop, shared) = (Stop::default(), &layout);
        workers::share(
            count,
            threads,
            &stop,
            || {
                let mut held = None;
                let stop = &stop;
                move |range: Range<usize>| {
                    let mut rows = Rows::new(shared, keep, range.start, samples);
                    for member in range {
                        run_member(members, member, &mut held, (shared, stop), run, &mut rows);
                    }
                    rows.ensemble
                }
            },
            |range, rows| ensemble.place(range, rows, shared),
            observer,
        );
        Ok(ensemble.finish())
    }
}

/// The system of the last run, and which it is.
type Last<'a> = Option<(usize, Member<'a>)>;

fn run_member<'a>(
    members: &'a dyn Members,
    member: usize,
    last: &mut Last<'a>,
    (layout, stop): (&Layout, &Stop),
    run: &RunMember<'_>,
    rows: &mut Rows<'_>,
) {
    if stop.is_asked() {
        return rows.push_nothing(Ending::Interrupted);
    }
    let variant = members.variant(member);
    if last.as_ref().is_none_or(|(of, _)| *of != variant) {
        *last = None;
        let made = members.system(variant).and_then(|made| {
            let fits = Layout::of(made.system()) == *layout;
            if fits { Ok(made) } else { Err(other_layout()) }
        });
        match made {
            Ok(made) => *last = Some((variant, made)),
            Err(error) => return rows.push_failure(0.0, Reason::System(error)),
        }
    }
    if let Some((_, made)) = last {
        let system = made.system();
        run(system, &members.start(member, system), stop, &mut Reduction::default(), rows);
    }
}

fn other_layout() -> SystemError {
    let message = "must have as many coordinates, velocities and contacts, and laws of the same dimensions, as the others";
    SystemError::Argument(ArgumentError::new("system", message))
}

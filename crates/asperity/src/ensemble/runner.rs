//! The loop over members that both kinds of runs have.

use std::ops::{ControlFlow, Range};
use std::rc::Rc;

use super::keep::Keep;
use super::outcome::{Ending, Ensemble, Layout, Reason, Rows};
use super::reduction::Reduction;
use super::workers::{self, Stop};
use super::{Member, Members};
use crate::argument::{ArgumentError, entries, finite, refuse};
use crate::system::{InitialState, System, SystemError};

/// Most samples on the way, as many as an integration may have: their memory is that of a small computer.
const MOST_SAMPLES: f64 = 1e8;

/// Runs one member from its start, and appends what comes out.
pub(super) type RunMember<'a> =
    dyn Fn(&dyn System, &InitialState, &Stop, &mut Reduction, &mut Rows<'_>) + Sync + 'a;

/// Runs members that follow each other at once, and appends what comes out of each.
pub(super) type RunTogether<'a> = dyn Fn(Vec<Prepared<'_>>, &Stop, &mut Rows<'_>) + Sync + 'a;

/// A member with its start, or why there is no such system.
pub(super) type Prepared<'a> = Result<(Rc<Member<'a>>, InitialState), SystemError>;

/// Threads that run the members of an ensemble.
pub(super) struct Runner<'a> {
    pub(super) members: &'a dyn Members,
    pub(super) keep: &'a Keep,
    /// Samples on the way that a member has.
    pub(super) samples: usize,
    pub(super) threads: usize,
}

impl Runner<'_> {
    /// Runs all members, one after the other.
    pub(super) fn run(
        &self,
        observer: &mut dyn FnMut(usize, usize) -> ControlFlow<()>,
        run: &RunMember<'_>,
    ) -> Result<Ensemble, ArgumentError> {
        self.run_together(observer, 1, &|members, stop, rows| {
            for member in members {
                match member {
                    Ok((made, start)) => {
                        run(made.system(), &start, stop, &mut Reduction::default(), rows);
                    }
                    Err(error) => rows.push_failure(0.0, Reason::System(error)),
                }
            }
        })
    }

    /// Runs all members, so many at once.
    pub(super) fn run_together(
        &self,
        observer: &mut dyn FnMut(usize, usize) -> ControlFlow<()>,
        at_once: usize,
        run: &RunTogether<'_>,
    ) -> Result<Ensemble, ArgumentError> {
        let Self { members, keep, samples, threads } = *self;
        let (count, layout) = (members.count(), Layout::of(members.first()));
        finite("after", &[keep.after])?;
        let kept = count as f64 * samples as f64;
        if kept > MOST_SAMPLES {
            let message = format!(
                "must not give more than {MOST_SAMPLES:e} samples of all runs together, gives {kept:.3e}"
            );
            return refuse("keep", message);
        }
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
                    let mut next = range.start;
                    while next < range.end {
                        let group = next..range.end.min(next + at_once);
                        next = group.end;
                        if stop.is_asked() {
                            group.for_each(|_| rows.push_nothing(Ending::Interrupted));
                            continue;
                        }
                        let prepared =
                            group.map(|member| prepare(members, member, &mut held, shared));
                        run(prepared.collect(), stop, &mut rows);
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
type Last<'a> = Option<(usize, Rc<Member<'a>>)>;

fn prepare<'a>(
    members: &'a dyn Members,
    member: usize,
    last: &mut Last<'a>,
    layout: &Layout,
) -> Prepared<'a> {
    let variant = members.variant(member);
    let made = match last.take().filter(|(of, _)| *of == variant) {
        Some((_, made)) => made,
        None => Rc::new(members.system(variant)?),
    };
    if Layout::of(made.system()) != *layout {
        let message = "must have as many coordinates, velocities and contacts, and laws of the same dimensions, as the others";
        return Err(ArgumentError::new("system", message).into());
    }
    let start = members.start(member, made.system());
    *last = Some((variant, made.clone()));
    Ok((made, start))
}

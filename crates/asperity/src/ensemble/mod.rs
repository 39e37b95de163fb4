//! Many runs of one kind: the same options for many start states, or for many systems of the same build.
//!
//! Every run is what [`simulate`](crate::simulate::simulate) or [`integrate`](crate::event::integrate) would do alone, to
//! the bit unless [`Lanes`] are asked for: threads take the runs in chunks, no run knows of its neighbours, and one that
//! fails ends alone. Kept are the ends of all runs, and what [`Keep`] asks for.
//!
//! | file | concept |
//! |---|---|
//! | `keep.rs` | what is kept of every run |
//! | `reduction.rs` | quantities that are found while a run goes on |
//! | `outcome.rs` | what comes out of all runs, and how each has ended |
//! | `workers.rs` | threads that share work |
//! | `runner.rs` | the loop over members that both kinds of runs have |
//! | `lanes/` | runs of time stepping side by side in wide registers |
//! | `time_stepping.rs`, `event_driven.rs` | the two kinds of runs |

mod event_driven;
mod keep;
mod lanes;
mod outcome;
mod reduction;
mod runner;
mod time_stepping;
mod workers;

use crate::system::{InitialState, System, SystemError};

pub use event_driven::integrate_many;
pub use keep::Keep;
pub use outcome::{Ending, Ensemble, MemberFailure, Reason};
pub use reduction::Reduced;
pub use time_stepping::simulate_many;

/// Whether runs of time stepping go side by side in the lanes of wide registers, which is for linear systems of two
/// velocities and one contact with a given normal force and a law of ellipses or superellipses; others run by
/// themselves.
///
/// What comes out is the same to the bit for any number of lanes and whatever the neighbours are, and that of runs by
/// themselves up to rounding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Lanes {
    /// Every run by itself: to the bit what [`simulate`](crate::simulate::simulate) does.
    #[default]
    None,
    /// As many as the processor's registers hold.
    Widest,
    /// One, whatever the registers hold.
    One,
    /// Four likewise.
    Four,
    /// Eight likewise.
    Eight,
}

/// Who runs an ensemble.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Workers {
    /// Number of threads; by default as many as the machine has.
    pub threads: Option<usize>,
    /// Runs side by side in a thread.
    pub lanes: Lanes,
}

impl From<Option<usize>> for Workers {
    /// So many threads, and every run by itself.
    fn from(threads: Option<usize>) -> Self {
        Self { threads, lanes: Lanes::None }
    }
}

/// A system of an ensemble.
#[derive(Debug)]
pub enum Member<'a> {
    /// One that somebody holds.
    Held(&'a dyn System),
    /// One that is made for its runs, and is gone after them.
    Made(Box<dyn System + 'a>),
}

impl Member<'_> {
    fn system(&self) -> &dyn System {
        match self {
            Self::Held(system) => *system,
            Self::Made(system) => system.as_ref(),
        }
    }
}

/// The runs of an ensemble. All its systems have as many coordinates, velocities and contacts, and laws of the same
/// dimensions, as the first one; others fail.
pub trait Members: Sync {
    /// Number of runs.
    fn count(&self) -> usize;

    /// The system that all others are built like.
    fn first(&self) -> &dyn System;

    /// Which of the systems a run is of. A system is asked for once for runs of it that follow each other.
    fn variant(&self, _member: usize) -> usize {
        0
    }

    /// A system; by default there is only the first one.
    ///
    /// # Errors
    ///
    /// [`SystemError`] if there is none with what it was to be made of: its runs fail with it, the others go on.
    fn system(&self, _variant: usize) -> Result<Member<'_>, SystemError> {
        Ok(Member::Held(self.first()))
    }

    /// Where a run starts, at the time 0; by default in the system's own state.
    fn start(&self, _member: usize, system: &dyn System) -> InitialState {
        system.initial_state()
    }
}

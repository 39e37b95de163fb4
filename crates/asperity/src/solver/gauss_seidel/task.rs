//! What a method is given, and what it may change.

use crate::contact::{ContactProblem, ContactState};
use crate::solver::infeasible::Infeasibility;
use crate::solver::measure::approach::Approach;
use crate::solver::measure::natural_residual::{Measured, Residual};
use crate::solver::measure::phase::classify;
use crate::solver::measure::stop::Stop;
use crate::solver::report::{Ended, Stage};
use crate::threads::Threads;

/// What sweeps have done to the percussions that a solve starts from; where they have done anything, the velocities of the
/// iterate are those of its percussions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Past {
    /// Nothing.
    Unswept,
    /// They have led there: they have solved the problem, but for what others have to find out, or promise nothing more.
    Swept,
    /// The same, and a contact had no solution in the last of them.
    Stuck,
}

/// What does not change during a solve.
#[derive(Clone, Copy)]
pub(crate) struct Task<'a> {
    pub(crate) problem: &'a ContactProblem,
    pub(crate) stop: Stop<'a>,
    /// Percussions that the solve began with.
    pub(crate) start: &'a [f64],
    /// States before the step, which decide between several solutions.
    pub(crate) history: &'a [ContactState],
    pub(crate) threads: &'a Threads,
    pub(crate) past: Past,
}

/// What a method has come to with the percussions of the iterate.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reached {
    pub(crate) iterations: usize,
    pub(crate) ended: Ended,
    /// By the measure of the stop.
    pub(crate) residual: Residual,
    /// How contacts move beside their loads, and how far percussions have grown.
    pub(crate) approach: Approach,
}

impl Reached {
    /// By a method that does not ask how contacts move.
    pub(crate) fn of(
        task: &Task<'_>,
        iterate: &Iterate<'_>,
        (iterations, ended): (usize, Ended),
        residual: Residual,
    ) -> Self {
        let Iterate { percussion, velocity, .. } = iterate;
        let measured = Measured { problem: task.problem, percussion, velocity };
        let contacts = 0..task.problem.contacts().len();
        let approach = Approach::of(&measured, contacts, task.stop.tolerance);
        Self { iterations, ended, residual, approach }
    }
}

/// What every method changes.
pub(crate) struct Iterate<'a> {
    pub(crate) percussion: &'a mut [f64],
    /// `γ_E` of the last percussions that were measured.
    pub(crate) velocity: &'a mut [f64],
    pub(crate) states: &'a mut [ContactState],
    /// Contacts that have several solutions.
    pub(crate) ambiguous: &'a mut [bool],
    /// What was done so far.
    pub(crate) stages: &'a mut Vec<Stage>,
    /// A proof that there is no solution.
    pub(crate) infeasibility: &'a mut Option<Infeasibility>,
}

impl Iterate<'_> {
    /// Velocities of the percussions, and the residual by which the stop decides.
    #[inline]
    pub(crate) fn measure(&mut self, task: &Task<'_>) -> Residual {
        task.problem.velocity(self.percussion, self.velocity);
        task.stop.residual(task.problem, self.percussion, self.velocity)
    }

    /// Tells from percussions and velocities what contacts do.
    pub(crate) fn classify(&mut self, problem: &ContactProblem) {
        let Self { percussion, velocity, states, .. } = self;
        classify(&Measured { problem, percussion, velocity }, states);
    }

    /// The same for a shorter time.
    pub(crate) fn reborrow(&mut self) -> Iterate<'_> {
        Iterate {
            percussion: self.percussion,
            velocity: self.velocity,
            states: self.states,
            ambiguous: self.ambiguous,
            stages: self.stages,
            infeasibility: self.infeasibility,
        }
    }
}

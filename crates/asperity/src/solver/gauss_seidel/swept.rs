//! What sweeps have come to.

use super::task::{Iterate, Past, Task};
use crate::solver::measure::natural_residual::{Residual, is_worse};
use crate::solver::measure::stop::Measure;
use crate::solver::report::Ended;

/// Of some contacts, until they are put together with others.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Swept {
    /// Most sweeps over a contact.
    pub(crate) sweeps: usize,
    /// Done, or why some contacts were left.
    pub(crate) ended: Ended,
    /// Square of the largest relative defect, negative without contacts, and the first contact that has it. Of an island it is
    /// that of its natural map by the global measure, and while that is far from small; the contact that has the largest defect
    /// is then looked for at the end.
    pub(super) defect: f64,
    pub(super) worst_contact: usize,
    /// Whether a contact had no solution in the last sweep.
    pub(crate) stuck: bool,
    /// Whether percussions may have grown.
    pub(super) may_grow: bool,
    /// Whether a contact has several solutions.
    pub(crate) ambiguous: bool,
    /// Whether there is only one contact, of which the one that continues its state was selected.
    pub(super) alone: bool,
}

impl Swept {
    /// Of no contacts.
    pub(crate) const NOTHING: Self = Self {
        sweeps: 0,
        ended: Ended::Done,
        defect: -1.0,
        worst_contact: 0,
        stuck: false,
        may_grow: false,
        ambiguous: false,
        alone: false,
    };

    /// With further contacts.
    #[inline(always)]
    pub(crate) fn and(self, other: Self) -> Self {
        // Of equals the first contact counts.
        let other_is_worse = if other.defect == self.defect {
            other.worst_contact < self.worst_contact
        } else {
            is_worse(other.defect, self.defect)
        };
        let worst = if other_is_worse { other } else { self };
        Self {
            sweeps: self.sweeps.max(other.sweeps),
            // A contact without a solution says more than a limit that was reached elsewhere.
            ended: match (self.ended, other.ended) {
                (Ended::TimeLimit, _) | (Ended::Stuck(_) | Ended::MaxIterations, Ended::Done) => {
                    self.ended
                }
                (Ended::Stuck(_), Ended::MaxIterations) => self.ended,
                _ => other.ended,
            },
            defect: worst.defect,
            worst_contact: worst.worst_contact,
            stuck: self.stuck || other.stuck,
            may_grow: self.may_grow || other.may_grow,
            ambiguous: self.ambiguous || other.ambiguous,
            alone: false,
        }
    }

    /// The same with the measure of the stop.
    pub(crate) fn measured(self, residual: Residual) -> Self {
        let Residual { value, worst_contact } = residual;
        Self { defect: value * value, worst_contact, ..self }
    }

    /// The same where time has ended before a proof or another method.
    pub(crate) fn given_up(self) -> Self {
        Self { ended: Ended::TimeLimit, ..self }
    }

    /// Whether every contact was solved, and none has percussions that may have grown.
    #[inline(always)]
    pub(crate) fn is_clear(&self) -> bool {
        self.ended == Ended::Done && !self.may_grow
    }

    /// Whether it is known which of several solutions continues the states of contacts, if there are several.
    pub(crate) fn is_decided(&self) -> bool {
        !self.ambiguous || self.alone
    }

    /// The same with places among these contacts.
    pub(crate) fn within(&self, contacts: &[usize]) -> Self {
        let place = |i: usize| contacts.binary_search(&i).unwrap_or(0);
        let ended = match self.ended {
            Ended::Stuck(i) => Ended::Stuck(place(i)),
            ended => ended,
        };
        Self { ended, worst_contact: place(self.worst_contact), ..*self }
    }

    /// What methods that follow know of these sweeps.
    pub(crate) fn past(&self) -> Past {
        if self.stuck { Past::Stuck } else { Past::Swept }
    }

    /// The measure of the stop, found on the way or, where not all contacts were visited or another one is asked for, anew.
    pub(crate) fn measure(&self, task: &Task<'_>, iterate: &mut Iterate<'_>) -> Residual {
        if self.ended == Ended::TimeLimit || task.stop.measure != Measure::Contact {
            return iterate.measure(task);
        }
        self.residual()
    }

    /// The residual, where all contacts were visited.
    #[inline(always)]
    pub(crate) fn residual(&self) -> Residual {
        let value = if self.defect < 0.0 { 0.0 } else { self.defect.sqrt() };
        Residual { value, worst_contact: self.worst_contact }
    }
}

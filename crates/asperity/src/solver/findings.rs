//! The verdict on the percussions in which a method ended.

use super::gauss_seidel::{Iterate, Reached, Task};
use super::infeasible::{prove_by_cases, prove_closing, prove_one_contact};

use super::report::{Ended, Findings};

/// What the percussions in which a method ended say, and the proof if there is no solution.
#[inline]
pub(crate) fn judge(task: &Task<'_>, reached: &Reached, iterate: &mut Iterate<'_>) -> Findings {
    let Task { problem, stop, .. } = *task;
    let Reached { ended, residual, approach, .. } = *reached;
    let Iterate { percussion, infeasibility, .. } = iterate;
    let (flaw, small) = (approach.flaw(), residual.value <= stop.tolerance);
    if small && flaw.is_none() && !approach.has_grown() {
        **infeasibility = None;
        return Findings::default();
    }
    if infeasibility.is_none() && !stop.early() {
        let thorough = !small || flaw.is_some() || approach.has_grown_far();
        **infeasibility = prove_closing(problem, percussion, thorough);
    }
    if let (None, Ended::Stuck(contact)) = (&**infeasibility, ended) {
        **infeasibility = prove_one_contact(problem, contact, percussion);
    }
    let given_up = matches!(ended, Ended::MaxIterations | Ended::NotApplicable) || stop.early();
    if infeasibility.is_none() && !(small && flaw.is_none()) && !given_up {
        **infeasibility = prove_by_cases(problem, stop);
    }
    let without_solution = infeasibility.as_ref().map(|proof| proof.contact);
    Findings { flaw, without_solution, ambiguous: false }
}

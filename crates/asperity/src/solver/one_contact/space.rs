//! One contact with sliding and drilling friction, `p = 3`.
//!
//! Stick is a linear system; slip has no boundary curve to walk along: Newton's method on the natural map
//! from the last percussions and from spread starts finds a solution, hulls of support points and proximal points lead
//! it where it does not. Several solutions are neither listed nor recognised, and that none is found proves nothing.

use asperity_set::Vector;

use super::effort::Effort;
use super::local::{LocalSolution, Selection};
use super::single::{FOUND, Graded, Single};
use crate::contact::{ContactState, Phase};
use crate::law::ContactVector;

/// The solution that continues `state`; `start` are the last percussions.
pub(crate) fn solve(
    single: &Single<'_, 3>,
    start: &[f64],
    state: &ContactState,
    effort: &mut Effort,
) -> Option<Selection<3>> {
    let selected = |p: &ContactVector, degenerate: bool| {
        let (phase, slip) = single.phase(p);
        let (normal, tangent) = (single.normal(p), single.tangent(p));
        let solution = LocalSolution { phase, normal, tangent, slip, degenerate };
        Some(Selection { solution, ambiguous: degenerate })
    };
    if single.opens() {
        return selected(&ContactVector::zeros(), false);
    }
    let stick = single.stick(effort).filter(Graded::sticks);
    let sticks = || {
        let Graded { percussion, degenerate, .. } = stick?;
        let (normal, tangent) = (single.normal(&percussion), single.tangent(&percussion));
        let (phase, slip) = (Phase::Stick, Vector::zeros());
        let solution = LocalSolution { phase, normal, tangent, slip, degenerate };
        Some(Selection { solution, ambiguous: degenerate })
    };
    if state.phase != Phase::Slip && stick.is_some() {
        return sticks();
    }
    // A slipping contact goes on slipping where it can: from its last slip, Newton's method finds that.
    let last = Vector::<3>::from_column_slice(&state.slip);
    let ahead = (last.amax() > 0.0).then_some(last);
    let slides = ahead
        .and_then(|last| single.newton_from_slip(&last, effort))
        .filter(|found| stick.is_none() || single.slips(&found.percussion));
    if let Some(found) = slides.filter(|found| found.defect <= FOUND) {
        return selected(&found.percussion, false);
    }
    if stick.is_some() {
        return sticks();
    }
    let given = ContactVector::from_fn(|i, _| start.get(i).copied().unwrap_or(0.0));
    let found = single.search(given, effort).into_iter().chain(slides);
    let found = found.min_by(|a, b| a.defect.total_cmp(&b.defect))?;
    selected(&found.percussion, found.degenerate)
}

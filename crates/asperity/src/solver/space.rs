//! One contact with sliding and drilling friction, `p = 3`.
//!
//! Stick is a linear system; slip has no boundary curve to walk along: Newton's method on the natural map
//! from the last percussions and from spread starts finds a solution, prox iterations lead it where it does
//! not. Several solutions are neither listed nor recognised, and that none is found proves nothing.

use asperity_set::Vector;

use super::effort::{Effort, Evaluations};
use super::single::{SOLUTION, Single, V};
use crate::contact::{ContactProblem, ContactState, Phase};
use crate::law::FrictionLaw;

/// A solution on the contact's own rows.
pub(super) struct SpaceSolution {
    pub(super) phase: Phase,
    pub(super) percussion: [f64; 4],
    pub(super) slip: [f64; 3],
    /// One of a continuum.
    pub(super) degenerate: bool,
}

impl SpaceSolution {
    fn new(single: &Single<'_, 3>, p: &V, degenerate: bool) -> Self {
        let (phase, slip) = single.phase(p);
        Self { phase, percussion: (*p).into(), slip: slip.into(), degenerate }
    }
}

/// The solution that continues `state`; `start` are the last percussions.
pub(super) fn solve(
    problem: &ContactProblem,
    contact: usize,
    law: &FrictionLaw<3>,
    (held, start): (&[f64; 4], &[f64]),
    state: &ContactState,
    effort: &mut Effort,
) -> Option<SpaceSolution> {
    let single = Single::of(problem, contact, law, held);
    if single.opens() {
        return Some(SpaceSolution::new(&single, &V::zeros(), false));
    }
    let stick = single.stick().filter(|found| found.defect <= SOLUTION);
    let sticks = || stick.map(|p| SpaceSolution::new(&single, &p.percussion, p.degenerate));
    if state.phase != Phase::Slip && stick.is_some() {
        return sticks();
    }
    // A slipping contact goes on slipping where it can: from its last slip, Newton's method finds that.
    let last = Vector::<3>::from_column_slice(&state.slip);
    let ahead = (last.amax() > 0.0).then(|| single.slipping(&last));
    let slides = ahead
        .and_then(|p| single.newton(p, &mut { Evaluations::FEW }))
        .filter(|p| stick.is_none() || single.slips(p));
    if let Some(p) = slides {
        return Some(SpaceSolution::new(&single, &p, false));
    }
    if stick.is_some() {
        return sticks();
    }
    let given = V::from_fn(|i, _| start.get(i).copied().unwrap_or(0.0));
    let found = single.search(&[given], effort)?;
    Some(SpaceSolution::new(&single, &found.percussion, found.degenerate))
}

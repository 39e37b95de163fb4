//! Sweeps that will come back to every contact.
//!
//! The one-contact solves of `exact.rs` without the proof that a solution is the only one: within an
//! iteration it would be made again and again, at the end it is made once (`exact::mark_ambiguous`).

use asperity_set::Vector;

use super::local::Local;
use super::{Workspace, exact, line, plane, space};
use crate::contact::{ContactProblem, ContactRows, Memory, Phase};
use crate::law::Law;

/// One sweep; the last contact that had no solution.
///
/// Newton's method starts from the slip before the step in the first sweep, from the last sweep's in others.
pub(super) fn sweep(
    problem: &ContactProblem,
    memory: &Memory,
    workspace: &mut Workspace,
    first: bool,
) -> Option<usize> {
    let mut stuck = None;
    let Workspace { percussion, blocks, planar, states, efforts, .. } = &mut *workspace;
    for (i, rows) in problem.contacts().iter().enumerate() {
        let (block, state, effort) = (&blocks[i], &mut states[i], &mut efforts[i]);
        let held = problem.contact_velocity(i, percussion, false);
        if block.pressed && held[0] >= 0.0 {
            percussion[rows.rows()].fill(0.0);
            state.phase = Phase::Open;
            continue;
        }
        let history = &memory.states[i];
        let found = match &rows.law {
            Law::One(law) => {
                let local = Local::from_held(law, rows, block, &held);
                line::solve(&local, history, effort).map(|found| {
                    let s = found.solution;
                    store(rows, (s.normal, &s.tangent), percussion);
                    (s.phase, [s.slip[0], 0.0, 0.0])
                })
            }
            Law::Two(law) => {
                let local = Local::from_held(law, rows, block, &held);
                let slip = if first { history.ahead() } else { state.slip };
                let guess = || exact::start(slip, &local);
                plane::quick(&local, history, guess, (planar, effort)).map(|s| {
                    store(rows, (s.normal, &s.tangent), percussion);
                    (s.phase, [s.slip[0], s.slip[1], 0.0])
                })
            }
            Law::Three(law) => {
                let own = rows.rows();
                let start = (&held, &percussion[own.clone()]);
                space::solve(problem, i, law, start, history, effort).map(|s| {
                    let len = own.len();
                    percussion[own].copy_from_slice(&s.percussion[..len]);
                    (s.phase, s.slip)
                })
            }
        };
        match found {
            Some((phase, slip)) => (state.phase, state.slip) = (phase, slip),
            None => stuck = Some(i),
        }
    }
    stuck
}

#[inline]
fn store<const P: usize>(
    rows: &ContactRows,
    (normal, tangent): (f64, &Vector<P>),
    percussion: &mut [f64],
) {
    let own = &mut percussion[rows.rows()];
    let first = rows.normal_rows();
    if first == 1 {
        own[0] = normal;
    }
    own[first..].copy_from_slice(tangent.as_slice());
}

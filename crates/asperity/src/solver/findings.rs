//! What is found out about the percussions in which a method ended.

use super::infeasibility::{ByCases, prove_closing, prove_one_contact, search_cases};
use super::measure::growth::GrowthKind;
use super::measure::natural_residual::ROUNDED;
use super::gauss_seidel::{Iterate, Reached, Task};
use super::report::{Ended, Findings};
use crate::contact::{ContactProblem, NormalForce};

/// Growth beyond which a proof that contacts close on each other is looked for at the end of a method, however small the
/// residual: spheres that walls squeeze slowly in twelve rows of a packing of 984 contacts (`squeezed_packing` in
/// `tests/test_certificate.py`) pass for solved at a tolerance of 1e-6 with a growth of 3·10³.
const WORTH_A_PROOF: f64 = 1e3;
/// Most contacts of a problem in which the proof is also looked for where a single contact has grown by as much, see
/// [`largest_growth`]. Ten chains each of 6, 12, 24 and 41 contacts between masses of 10⁻³ to 10³ kg, which have solutions,
/// took no longer to solve than without, as far as a noisy machine tells.
const FEW: usize = 48;

/// What the percussions in which a method ended say, and the proof if there is no solution.
#[inline]
pub(crate) fn judge(task: &Task<'_>, reached: &Reached, iterate: &mut Iterate<'_>) -> Findings {
    let Task { problem, stop, .. } = *task;
    let Reached { ended, residual, growth, solvable, .. } = *reached;
    let Iterate { percussion, infeasibility, .. } = iterate;
    let running = growth.and_then(|growth| growth.running());
    // Velocities are as far off as the residual, relative to what percussions bring.
    let hides = growth.is_some_and(|growth| growth.hides(residual.value));
    let kind = growth.map(|growth| growth.kind);
    let suspicious = growth.is_some_and(|growth| growth.is_suspicious(residual.value));
    // Where percussions have not grown much, it takes contacts that close on each other to hide something.
    let hidden = hides && kind != Some(GrowthKind::Grown);
    let small = residual.value <= stop.tolerance;
    let large = growth.is_some_and(|growth| growth.factor > WORTH_A_PROOF)
        || problem.contacts().len() <= FEW && largest_growth(problem, percussion) > WORTH_A_PROOF;
    if small && !suspicious && !large {
        **infeasibility = None;
        return Findings { solvable, ..Findings::default() };
    }
    if solvable {
        // There is no proof to the contrary.
        return Findings { running, solvable, ..Findings::default() };
    }
    if infeasibility.is_none() && (suspicious || large) && !stop.early() {
        **infeasibility = prove_closing(problem, percussion);
    }
    if small && running.is_none() && infeasibility.is_none() && !hidden {
        return Findings::default();
    }
    if let (None, Ended::Stuck(contact)) = (&**infeasibility, ended) {
        **infeasibility = prove_one_contact(problem, contact, percussion);
    }
    let contact = match (growth, ended) {
        (_, Ended::Stuck(contact) | Ended::Unbounded(contact)) => contact,
        (Some(growth), _) => growth.contact,
        _ => residual.worst_contact,
    };
    let early = matches!(ended, Ended::TimeLimit | Ended::NotApplicable | Ended::MaxIterations);
    // What rounding explains needs no other reason.
    let rounded = running.is_none() && residual.value <= ROUNDED && !hidden;
    let mut candidate = None;
    if infeasibility.is_none() && (small || !early) && !rounded && !stop.early() {
        match search_cases(problem, stop, contact) {
            ByCases::NoSolution(proof) => **infeasibility = Some(proof),
            ByCases::Candidate(percussion) if !small => candidate = Some(percussion),
            _ => {}
        }
    }
    let without_solution = infeasibility.as_ref().map(|proof| proof.contact);
    Findings { running, without_solution, solvable, candidate, ambiguous: false }
}

/// What a percussion brings to the normal row of its own contact, `G_NN P_N`, over the largest normal load of the problem.
///
/// Powers are summed over all contacts, so that a heavy body, most of whose power is its own load, hides the light ones that
/// walls squeeze beside it. A smaller tolerance need not tell them either: rounding hides how far they approach.
fn largest_growth(problem: &ContactProblem, percussion: &[f64]) -> f64 {
    if problem.delassus().is_matrix_free() {
        return 0.0;
    }
    let (mut brought, mut load) = (0.0_f64, 0.0_f64);
    for (i, rows) in problem.contacts().iter().enumerate() {
        if rows.normal == NormalForce::Unilateral {
            let row = rows.offset;
            brought = brought.max(problem.delassus().own(i, 0, 0) * percussion[row]);
            load = load.max((problem.free_velocity()[row] + problem.restitution()[row]).abs());
        }
    }
    // Contacts close on each other by their loads alone.
    if load > 0.0 { brought / load } else { 0.0 }
}

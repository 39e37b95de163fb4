//! Proofs that a contact that no other contact influences has no solution.

use asperity_set::{ConvexSet, StarSet, Vector};

use super::proof::{Infeasibility, InfeasibilityKind};
use crate::contact::{ContactProblem, NormalForce};
use crate::law::{FrictionLaw, Law};
use crate::solver::one_contact::block::Block;
use crate::solver::one_contact::solve::OneContact;

/// Relative margin of every inequality, as of the proofs in `one_contact/`.
const MARGIN: f64 = 1e-9;
/// Entries of a hinge's block relative to the largest ones that rounding explains.
const ROUNDING: f64 = 1e-13;
/// Angle to both sides of a slip direction within which friction must hardly change: there is no flat side of *D* then.
const BESIDE: f64 = 1e-6;

/// A proof by the search of all states of a contact that no other contact influences.
pub(crate) fn prove_one_contact(
    problem: &ContactProblem,
    contact: usize,
    percussion: &[f64],
) -> Option<Infeasibility> {
    let rows = &problem.contacts()[contact];
    let mut alone = true;
    for row in rows.rows() {
        problem.each_entry(contact, row, |j, _, g| alone &= j == contact || g == 0.0);
    }
    if !alone || problem.delassus().is_matrix_free() {
        return None;
    }
    let block = Block::new(problem, contact);
    let by_search = || OneContact::new(problem, contact, &block, percussion).proves_no_solution();
    let by_hinge = || match &rows.law {
        _ if rows.normal != NormalForce::Unilateral => false,
        Law::One(law) => hinge_has_none(problem, contact, law),
        Law::Two(law) => hinge_has_none(problem, contact, law),
        Law::Three(_) => false,
    };
    if !by_search() && !by_hinge() {
        return None;
    }
    let mut direction = vec![0.0; problem.rows()];
    let mut closing_velocity = 0.0;
    if rows.normal == NormalForce::Unilateral {
        direction[rows.offset] = 1.0;
        closing_velocity = -problem.load(contact)[0];
    }
    let kind = InfeasibilityKind::OneContact;
    Some(Infeasibility { kind, contact, direction, closing_velocity, residual: 0.0 })
}

/// Whether a hinge has no solution: all rows of its block `u wᵀ`, `w_N = 1`, see one direction of motion, `ξ = b + u s` with
/// `s = w·P`.
///
/// As `b_N < 0` it cannot open. With `ξ_N = 0` its velocity is known, `ξ_T = b_T − u_T b_N/u_N`: if that is no rest, so is
/// friction, `P_T = −P_N x`, and `P_N (1 − w_T·x) = −b_N/u_N > 0` asks for a pull where `1 − w_T·x < 0`.
fn hinge_has_none<const P: usize>(
    problem: &ContactProblem,
    contact: usize,
    law: &FrictionLaw<P>,
) -> bool {
    let (g, load) = (|a, b| problem.delassus().own(contact, a, b), problem.load(contact));
    let is_product = |a: usize, b: usize| {
        let size = (g(a, a) * g(b, b)).abs().sqrt();
        (g(a, b) - g(a, 0) * g(0, b) / g(0, 0)).abs() <= ROUNDING * size
    };
    let tangent = Vector::<P>::from_fn(|a, _| g(1 + a, 0)) / g(0, 0);
    let w = Vector::<P>::from_fn(|b, _| g(0, 1 + b)) / g(0, 0);
    let (free, moved) = (Vector::<P>::from_fn(|a, _| load[1 + a]), tangent * load[0]);
    let slip = free - moved;
    let moves = slip.norm() > MARGIN * (free.norm() + moved.norm());
    if !(load[0] < 0.0 && moves && (0..=P).all(|a| (0..=P).all(|b| is_product(a, b)))) {
        return false;
    }
    // On a line both sides are the same direction.
    let aside = |angle: f64| {
        Vector::<P>::from_fn(|a, _| {
            let across = if P == 2 { [-slip[1], slip[0]][a] } else { 0.0 };
            slip[a] + angle * across
        })
    };
    let [first, last] = [-BESIDE, BESIDE].map(|angle| {
        let end = law.direction().support_point(&(aside(angle) / slip.norm()));
        end / law.reservoir().gauge(&end)
    });
    let pulls = |x: &Vector<P>| {
        let lift = w.dot(x);
        1.0 - lift < -MARGIN * (1.0 + lift.abs())
    };
    (first - last).norm() <= f64::sqrt(BESIDE) * first.norm() && pulls(&first) && pulls(&last)
}

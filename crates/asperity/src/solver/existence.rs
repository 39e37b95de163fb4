//! Proofs that a problem of bodies has a solution.
//!
//! Let `K` be the product of the friction cones `{P_N ≥ 0, P_T ∈ P_N C}` of laws whose `C` and `D` are ellipsoids, and
//! `G = Wᵀ M⁻¹ W` with symmetric positive definite `M`. If some velocities `v` of the bodies bring the contacts into the interior of
//! the dual cone,
//!
//! `ξ̂ = Wᵀ v + b + e γ_B`, `ξ̂·P ≥ Σ δ_i P_Ni` for all `P ∈ K`, with `δ_i > 0`,
//!
//! then there is a solution, and all solutions have `Σ δ_i P_Ni ≤ ¼ vᵀ M v`. For at a solution, with `u = M⁻¹ W P`,
//! `ξ = Wᵀ u + b + e γ_B` has `P_N ξ_N = 0`, and friction dissipates, `P_T·ξ_T ≤ 0`, as `D` contains zero. Hence
//!
//! `Σ δ_i P_Ni ≤ P·ξ̂ = P·ξ + P·Wᵀ(v − u) ≤ uᵀ M (v − u) ≤ ¼ vᵀ M v`.
//!
//! The same bound holds where normal percussions are kept below a limit, `0 ≤ P_N ≤ R`, and contacts that reach it may
//! approach: `P_N ξ_N ≤ 0`. That problem asks for a fixed point on a compact convex set, which Kakutani's theorem grants, and with
//! `R` beyond the bound it is the problem itself. For Coulomb's law this is the condition of
//! \[AcaryCadouxLemarechalMalick2011\]. Bodies in free motion that touch each other and what does not move mostly
//! satisfy it: there are velocities that take them apart.
//!
//! Such velocities do not depend on the masses. They are those on the way to a solution of the associated problem, in which
//! contacts open as they slip, of bodies whose masses suit the numbers: its solutions minimise a convex function, and the
//! interior point method finds them.

use crate::contact::ContactProblem;
use crate::law::ContactVector;
use crate::solver::method::{Cones, Interior, Task};
use crate::solver::newton_matrix::NewtonMatrix;
use crate::solver::suitable_masses::with_suitable_masses;

/// Iterations of the interior point method. Piles of 112 contacts whose masses differ by a factor of 10⁸
/// (`pile_of_unequal_spheres` in `tests/test_certificate.py`) take two, the jaws of `existence/tests.rs` at most six.
const ITERATIONS: usize = 12;
/// Part of the largest load that velocities must be within the dual cone, and part of the velocities that percussions bring to
/// a contact, which cancel: rounding leaves far less of either.
const MARGIN: f64 = 1e-6;
const ROUNDING: f64 = 1e-12;

/// Whether a problem is proven to have a solution; false where that is not known. The cones are its own.
pub(crate) fn is_proven(task: &Task<'_>, cones: &Cones, interior: &mut Interior) -> bool {
    let Some(problem) = with_suitable_masses(task.problem) else { return false };
    proves(&Task { problem: &problem, ..*task }, cones, interior, |_| {})
}

/// Whether there are percussions that bring velocities within the dual cone, which are told.
fn proves(
    task: &Task<'_>,
    cones: &Cones,
    interior: &mut Interior,
    mut tell: impl FnMut(&[f64]),
) -> bool {
    let problem = task.problem;
    let (cones, mut matrix) = (cones.associated(), NewtonMatrix::default());
    matrix.prepare(problem);
    let mut velocity = vec![0.0; problem.rows()];
    let proves = |percussion: &[f64]| {
        let proves = separates(problem, &cones, percussion, &mut velocity);
        if proves {
            tell(percussion);
        }
        proves
    };
    interior.find_associated(task, &cones, &mut matrix, ITERATIONS, proves)
}

/// Whether percussions bring velocities within the dual cones of all contacts.
fn separates(
    problem: &ContactProblem,
    cones: &Cones,
    percussion: &[f64],
    velocity: &mut [f64],
) -> bool {
    problem.velocity(percussion, velocity);
    let largest = problem.free_velocity().iter().fold(0.0, |m: f64, b| m.max(b.abs()));
    problem.contacts().iter().enumerate().all(|(i, rows)| {
        let mut brought = [0.0; 4];
        problem.delassus().blocks().add_magnitudes(i, percussion, &mut brought);
        let own = &velocity[rows.rows()];
        let xi = ContactVector::from_fn(|row, _| own.get(row).copied().unwrap_or(0.0));
        let (k, brought) = (cones.k[i], ContactVector::from(brought));
        let hidden = k.abs() * (ContactVector::repeat(MARGIN * largest) + brought * ROUNDING);
        let dual = k * xi;
        dual[0] - dual.rows(1, 3).norm() > hidden[0] + hidden.rows(1, 3).norm()
    })
}

#[cfg(test)]
mod tests;

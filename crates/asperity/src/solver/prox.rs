//! The paper's prox iterations.
//!
//! With `u` eliminated and the Jacobian of `P + prox(…)` replaced by the identity ("modified Newton"):
//!
//! `P_N ← −prox_{R₀⁻}(−P_N + r_N ξ_N)` (\[WL19\] (21)),
//! `P ← −(1/α) prox_{P_N D}(−αP + rξ)`, `α = α(−P)` (\[WL19\] (69), (70)).
//!
//! `r` is one number per contact: one per component would change the law.

use asperity_set::{ConvexSet, StarSet, Vector};

use super::report::Ended;
use super::{Stop, Workspace};
use crate::contact::{ContactProblem, ContactRows, NormalForce};
use crate::law::{FrictionLaw, Law};

/// Prox parameter of the friction rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ProxStep {
    /// `r = α_k r̃` with `r̃` the reciprocal of the largest row sum of `|G|` over the contact's rows: the
    /// scale of *D* drops out of the step. All `r̃` are halved when the residual has stopped falling.
    Adaptive,
    /// A constant `r`, also for the normal rows: the paper's plain form.
    Constant(f64),
}

/// Iterations between two looks at the residual.
const CHECK_EVERY: usize = 10;
/// Looks without progress after which the adaptive step is halved.
const PATIENCE: usize = 30;

/// All contacts at once, `γ` from the percussions of the last iteration.
pub(super) fn jacobi(
    problem: &ContactProblem,
    stop: Stop<'_>,
    step: ProxStep,
    max_iterations: usize,
    workspace: &mut Workspace,
) -> (usize, Ended) {
    iterate(problem, stop, step, max_iterations, workspace, |workspace, factor| {
        problem.velocity(&workspace.percussion, &mut workspace.velocity);
        for (i, rows) in problem.contacts().iter().enumerate() {
            let rate = Rate::new(step, factor, problem.row_sum_bound(i, false));
            let Workspace { percussion, velocity, next, .. } = &mut *workspace;
            let xi = |row: usize| velocity[row] + problem.restitution()[row];
            update(rows, rate, xi, percussion, next);
        }
        std::mem::swap(&mut workspace.percussion, &mut workspace.next);
    })
}

/// Contact after contact, `γ` from the newest percussions.
pub(super) fn gauss_seidel(
    problem: &ContactProblem,
    stop: Stop<'_>,
    step: ProxStep,
    max_iterations: usize,
    workspace: &mut Workspace,
) -> (usize, Ended) {
    iterate(problem, stop, step, max_iterations, workspace, |workspace, factor| {
        for (i, rows) in problem.contacts().iter().enumerate() {
            let own = rows.rows();
            let rate = Rate::new(step, factor, problem.row_sum_bound(i, true));
            let Workspace { percussion, next, .. } = &mut *workspace;
            let velocity = problem.contact_velocity(i, percussion, true);
            let xi = |row: usize| velocity[row - rows.offset];
            update(rows, rate, xi, percussion, next);
            percussion[own.clone()].copy_from_slice(&next[own]);
        }
    })
}

/// Repeats `sweep` until the residual is below the tolerance.
fn iterate(
    problem: &ContactProblem,
    stop: Stop<'_>,
    step: ProxStep,
    max_iterations: usize,
    workspace: &mut Workspace,
    mut sweep: impl FnMut(&mut Workspace, f64),
) -> (usize, Ended) {
    let (mut factor, mut best, mut stalled) = (1.0, f64::INFINITY, 0);
    for iteration in 1..=max_iterations {
        sweep(workspace, factor);
        if iteration % CHECK_EVERY != 0 && iteration != max_iterations {
            continue;
        }
        problem.velocity(&workspace.percussion, &mut workspace.velocity);
        let residual = stop.residual(problem, &workspace.percussion, &workspace.velocity).value;
        if residual <= stop.tolerance {
            return (iteration, Ended::Done);
        }
        if !residual.is_finite() {
            // Too large a step size has run away beyond all numbers.
            workspace.percussion.fill(0.0);
            return (iteration, Ended::Stalled);
        }
        stalled = if residual < 0.9 * best { 0 } else { stalled + 1 };
        best = best.min(residual);
        if stalled > PATIENCE && step == ProxStep::Adaptive {
            (factor, stalled, best) = (0.5 * factor, 0, residual);
        }
        if stop.early() {
            return (iteration, Ended::TimeLimit);
        }
    }
    (max_iterations, Ended::MaxIterations)
}

/// The prox parameters of one update.
#[derive(Clone, Copy)]
struct Rate {
    r: f64,
    /// Whether `r` is multiplied by `α_k` in the friction rows.
    by_alpha: bool,
}

impl Rate {
    fn new(step: ProxStep, factor: f64, radius: f64) -> Self {
        match step {
            ProxStep::Adaptive => Self { r: factor / radius, by_alpha: true },
            ProxStep::Constant(r) => Self { r, by_alpha: false },
        }
    }
}

/// (21), then (69), (70) for one contact, from `percussion` to `next`.
fn update(
    rows: &ContactRows,
    rate: Rate,
    xi: impl Fn(usize) -> f64,
    percussion: &[f64],
    next: &mut [f64],
) {
    let normal = match rows.normal {
        NormalForce::Prescribed(value) => value,
        NormalForce::Unilateral => {
            let row = rows.offset;
            next[row] = f64::max(0.0, percussion[row] - rate.r * xi(row));
            next[row]
        }
    };
    let first = rows.tangent();
    match &rows.law {
        Law::One(law) => friction(law, normal, rate, first, xi, percussion, next),
        Law::Two(law) => friction(law, normal, rate, first, xi, percussion, next),
        Law::Three(law) => friction(law, normal, rate, first, xi, percussion, next),
    }
}

fn friction<const P: usize>(
    law: &FrictionLaw<P>,
    normal: f64,
    rate: Rate,
    first: usize,
    xi: impl Fn(usize) -> f64,
    percussion: &[f64],
    next: &mut [f64],
) {
    let mut result = Vector::<P>::zeros();
    if normal > 0.0 {
        let x = Vector::<P>::from_fn(|j, _| -percussion[first + j] / normal);
        // A falling normal percussion leaves −P far outside; α is taken on the boundary then.
        let gauge = law.reservoir().gauge(&x);
        let x = if gauge > 1.0 { x / gauge } else { x };
        let alpha = law.alpha(&x);
        let r = if rate.by_alpha { rate.r * alpha } else { rate.r } / normal;
        let slip = Vector::<P>::from_fn(|j, _| xi(first + j));
        let z = x * alpha;
        result = law.direction().project_from(&(z + slip * r), &z) * (-normal / alpha);
    }
    next[first..first + P].copy_from_slice(result.as_slice());
}

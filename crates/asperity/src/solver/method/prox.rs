//! The paper's prox iterations.
//!
//! With `u` eliminated and the Jacobian of `P + prox(…)` replaced by the identity ("modified Newton"):
//!
//! `P_N ← −prox_{R₀⁻}(−P_N + r_N ξ_N)` (\[WL19\] (21)),
//! `P ← −(1/α) prox_{P_N D}(−αP + rξ)`, `α = α(−P)` (\[WL19\] (69), (70)).
//!
//! `r` is one number per contact: one per component would change the law.

use crate::contact::{ContactProblem, ContactRows};
use crate::law::{Friction, ProxParameter};
use crate::solver::gauss_seidel::{Iterate, Task};
use crate::solver::report::Ended;

/// Prox parameter of the friction rows.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum ProxStep {
    /// `r = α_k r̃` with `r̃` the reciprocal of the largest row sum of `|G|` over the contact's rows: the
    /// scale of *D* drops out of the step. All `r̃` are halved when the residual has stopped falling.
    Adaptive,
    /// A constant `r`, also for the normal rows: the paper's plain form.
    Constant(f64),
}

/// Iterations between two looks at the residual: rarer looks see later that it is small, and more often that the step is
/// too long.
const CHECK_EVERY: usize = 10;
/// Looks without progress after which the adaptive step is halved.
const PATIENCE: usize = 30;

/// In which order contacts are updated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Order {
    /// All at once, `γ` from the percussions of the last iteration.
    Jacobi,
    /// Contact after contact, `γ` from the newest percussions.
    GaussSeidel,
}

/// The iteration with its options.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ProxIteration {
    pub(crate) order: Order,
    pub(crate) step: ProxStep,
    pub(crate) max_iterations: usize,
}

impl ProxIteration {
    /// Iterates until the residual is below the tolerance; `next` is a buffer.
    pub(crate) fn solve(
        self,
        task: &Task<'_>,
        iterate: &mut Iterate<'_>,
        next: &mut Vec<f64>,
    ) -> (usize, Ended) {
        let Self { order, step, max_iterations } = self;
        let problem = task.problem;
        next.resize(problem.rows(), 0.0);
        let (mut factor, mut best, mut stalled) = (1.0, f64::INFINITY, 0);
        for iteration in 1..=max_iterations {
            match order {
                Order::Jacobi => jacobi(problem, iterate, step, factor, next),
                Order::GaussSeidel => gauss_seidel(problem, iterate, step, factor, next),
            }
            if iteration % CHECK_EVERY != 0 && iteration != max_iterations {
                continue;
            }
            let residual = iterate.measure(task).value;
            if residual <= task.stop.tolerance {
                return (iteration, Ended::Done);
            }
            if !residual.is_finite() {
                // Too large a step size has run away beyond all numbers.
                iterate.percussion.fill(0.0);
                return (iteration, Ended::Stalled);
            }
            stalled = if residual < 0.9 * best { 0 } else { stalled + 1 };
            best = best.min(residual);
            if stalled > PATIENCE && step == ProxStep::Adaptive {
                (factor, stalled, best) = (0.5 * factor, 0, residual);
            }
            if task.stop.early() {
                return (iteration, Ended::TimeLimit);
            }
        }
        (max_iterations, Ended::MaxIterations)
    }
}

fn jacobi(
    problem: &ContactProblem,
    iterate: &mut Iterate<'_>,
    step: ProxStep,
    factor: f64,
    next: &mut [f64],
) {
    let Iterate { percussion, velocity, .. } = iterate;
    problem.velocity(percussion, velocity);
    for (i, rows) in problem.contacts().iter().enumerate() {
        let parameter = step.parameter(factor, problem.row_sum_bound(i, false));
        let own = rows.rows();
        let (velocity, restitution) = (&velocity[own.clone()], &problem.restitution()[own]);
        update(rows, parameter, velocity, restitution, percussion, next);
    }
    percussion.copy_from_slice(next);
}

fn gauss_seidel(
    problem: &ContactProblem,
    iterate: &mut Iterate<'_>,
    step: ProxStep,
    factor: f64,
    next: &mut [f64],
) {
    let percussion = &mut *iterate.percussion;
    for (i, rows) in problem.contacts().iter().enumerate() {
        let parameter = step.parameter(factor, problem.row_sum_bound(i, true));
        let velocity = problem.contact_velocity(i, percussion, true);
        // Restitution is in it.
        update(rows, parameter, &velocity, &[0.0; 4], percussion, next);
        percussion[rows.rows()].copy_from_slice(&next[rows.rows()]);
    }
}

impl ProxStep {
    /// The prox parameter of a contact, `radius` the largest row sum of `|G|`.
    fn parameter(self, factor: f64, radius: f64) -> ProxParameter {
        match self {
            Self::Adaptive => ProxParameter { r: factor / radius, by_alpha: true },
            Self::Constant(r) => ProxParameter { r, by_alpha: false },
        }
    }
}

/// (21), then (69), (70) for one contact, from `percussion` to `next`; velocities and restitution in its own rows.
fn update(
    rows: &ContactRows,
    parameter: ProxParameter,
    velocity: &[f64],
    restitution: &[f64],
    percussion: &[f64],
    next: &mut [f64],
) {
    let first = rows.normal_rows();
    if first == 1 {
        let xi = velocity[0] + restitution[0];
        next[rows.offset] = f64::max(0.0, percussion[rows.offset] - parameter.r * xi);
    }
    let friction = Friction {
        normal: rows.normal_percussion(next),
        tangent: &percussion[rows.tangential_rows()],
        velocity: &velocity[first..],
        restitution: &restitution[first..],
    };
    rows.law.prox_iteration(friction, parameter, &mut next[rows.tangential_rows()]);
}

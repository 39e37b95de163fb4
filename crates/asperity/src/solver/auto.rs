//! The order in which [`Solver::Auto`](super::Solver::Auto) asks the methods, and each of them alone.
//!
//! Sweeps end most problems and give the others a start; Newton's method ends those of full rank and, with other prox
//! parameters, those in which contacts creep; the interior point method, where the laws allow it, and the proximal
//! point iteration end the rest. Everything is cheap against sweeps because a factorisation costs as much as some tens
//! of them. Where it costs far more than the solution of a linear system, ADMM, which needs few of them, has a turn before
//! the proximal point iteration goes on to the end.

use crate::contact::{ContactState, Phase};
use crate::solver::infeasibility::prove_one_contact;
use crate::solver::method::{
    ALONE, Admm, BESIDE, Buffers, Cones, Interior, Iterate, Limit, Progress, ProximalPoint, Rate,
    Sweeper, TRIAL_SWEEPS, Task,
};
use crate::solver::newton_matrix::NewtonMatrix;
use crate::solver::report::{Ended, Method};

// Constants of this file and of `method/` were halved and doubled, those of a size of 1e-3 and less divided and multiplied
// by ten, on the "stored problems": those of up to 765 contacts in the folder that `ASPERITY_CONTACT_PROBLEMS` names,
// without the rock pile, 31 in all, by `asperity solve`. `Auto` solves all of them with 1787 iterations and 621
// factorisations, and did so with every value that this file names. Numbers changed by up to 5 % where only the rounding of
// factorisations did: what is less says that it hardly matters.

/// Newton iterations of a step of the first attempt: enough where `G` has full rank, and soon over where it has not.
/// Half as many save 14 factorisations on the stored problems, twice as many cost 59.
const ATTEMPT: usize = 6;
/// Iterations of the interior point method, after which the proximal point method starts: half as many cost 105
/// factorisations on the stored problems, twice as many 19.
const INTERIOR: usize = 40;
/// Outer steps of the last phase, which a limit of time ends before where there is one; those systems end in the same way
/// with a quarter and four times as many.
const OUTER: usize = 5000;
/// Factorisations of the last phase after which ADMM has its turn, where more than so many solutions of a linear system take
/// as long as a factorisation: its iterations are one solution each. `problems.pile(8)`, where it is 20 solutions, ends
/// after 61 factorisations of that phase and 400 iterations of ADMM; without them it is at 3e-5 after 300 factorisations.
/// Half and double the ratio change no stored problem: those that take 50 factorisations in that phase have ratios of 2 and
/// 3, and the rock pile takes 2490 factorisations with ADMM after 150 of them, 2480 without.
const DEAR: usize = 50;
const CHEAP: f64 = 10.0;
/// Natural map below which Newton's method finds the digits that rounding keeps from the interior point method;
/// tried earlier it fails, later it is not tried. No stored problem depends on it.
const POLISHED: f64 = 1e-4;
/// Natural map below which contacts that creep may be all that is left to be found. The attempt for them is in vain on
/// the stored problems: a tenth saves 107 factorisations, ten times as much costs 293.
const CREEPING: f64 = 1e-3;
/// Natural map at which the interior point method, whose digits end there, hands over: a tenth of it costs 44
/// factorisations on the stored problems, ten times as much saves eight.
const INTERIOR_GOAL: f64 = 1e-7;

/// The methods with their buffers, and the matrix that they share.
#[derive(Debug, Clone, Default)]
pub(crate) struct Methods {
    buffers: Buffers,
    matrix: NewtonMatrix,
    proximal: ProximalPoint,
    cones: Cones,
    interior: Interior,
    admm: Admm,
}

impl Methods {
    /// Forgets what depends on the pattern of `G`.
    pub(crate) fn reset(&mut self) {
        self.matrix.reset();
    }

    /// Sweeps, then Newton, then interior point and proximal point.
    pub(crate) fn automatic(
        &mut self,
        task: Task<'_>,
        iterate: Iterate<'_>,
        sweeper: &mut Sweeper,
        with_interior: bool,
    ) -> (usize, Ended) {
        let Self { buffers, matrix, proximal, cones, interior, admm } = self;
        let mut progress = Progress::new(task, iterate, sweeper, buffers);
        gauss_seidel(&mut progress);
        if !progress.is_over()
            && let Some(contact) = progress.stuck()
        {
            // A contact that sweeps could not solve may have no solution whatever the others do.
            let percussion = &*progress.iterate.percussion;
            let proof = prove_one_contact(task.problem, contact, percussion);
            *progress.iterate.infeasibility = proof;
        }
        if !progress.is_over() {
            proximal.prepare(task.problem);
            matrix.prepare(task.problem);
            proximal.attempt(&mut progress, matrix, ATTEMPT);
        }
        if !progress.is_over() && progress.best_grade() < CREEPING {
            proximal.attempt_matched(&mut progress, matrix);
        }
        let conic = with_interior && !progress.is_over() && cones.read(task.problem);
        if conic {
            interior.iterate(&mut progress, cones, matrix, INTERIOR, INTERIOR_GOAL);
        }
        if !progress.is_over() {
            let dear = conic && matrix.solutions_per_factorization() > CHEAP;
            let limits = (OUTER, if dear { DEAR } else { usize::MAX });
            if proximal.iterate(&mut progress, matrix, limits) == Some(Limit::Factorizations) {
                admm.iterate(&mut progress, cones, matrix, usize::MAX, (BESIDE, false));
                if !progress.is_over() {
                    proximal.iterate(&mut progress, matrix, (OUTER, usize::MAX));
                }
            }
        }
        let known = |state: &ContactState| state.phase != Phase::Unknown;
        if progress.is_solved() && task.history.iter().any(known) {
            progress.continue_states(TRIAL_SWEEPS);
        }
        progress.finish(false)
    }

    /// Newton's method from percussions near which there may be a solution; without success those before stay.
    #[cold]
    pub(crate) fn try_candidate(
        &mut self,
        task: Task<'_>,
        iterate: Iterate<'_>,
        sweeper: &mut Sweeper,
        start: &[f64],
    ) -> (usize, Ended) {
        let Self { buffers, matrix, proximal, .. } = self;
        let mut progress = Progress::new(task, iterate, sweeper, buffers);
        proximal.prepare(task.problem);
        matrix.prepare(task.problem);
        proximal.newton_from(&mut progress, matrix, start);
        progress.finish(false)
    }

    /// One method alone.
    pub(crate) fn single(
        &mut self,
        task: Task<'_>,
        iterate: Iterate<'_>,
        sweeper: &mut Sweeper,
        method: Method,
        max_iterations: usize,
    ) -> (usize, Ended) {
        let Self { buffers, matrix, proximal, cones, interior, admm } = self;
        let mut progress = Progress::new(task, iterate, sweeper, buffers);
        let conic = matches!(method, Method::InteriorPoint | Method::Admm);
        if conic && !cones.read(task.problem) {
            progress.finish(false);
            return (0, Ended::NotApplicable);
        }
        proximal.prepare(task.problem);
        matrix.prepare(task.problem);
        let limited = match method {
            Method::InteriorPoint => {
                let limited = interior.iterate(&mut progress, cones, matrix, max_iterations, 0.0);
                if !limited && !progress.is_over() && progress.best_grade() < POLISHED {
                    proximal.attempt(&mut progress, matrix, ATTEMPT);
                }
                limited
            }
            Method::Admm => {
                admm.iterate(&mut progress, cones, matrix, max_iterations, (ALONE, true))
            }
            Method::Newton => proximal.newton_alone(&mut progress, matrix, max_iterations),
            _ => {
                let limit = proximal.iterate(&mut progress, matrix, (max_iterations, usize::MAX));
                limit == Some(Limit::Steps)
            }
        };
        progress.finish(limited)
    }
}

/// Sweeps while their rate promises an end; one is enough where sweeps were made before, which tells of contacts that have
/// no solution.
fn gauss_seidel(progress: &mut Progress<'_>) {
    let mut rate = Rate::default();
    let mut k = 0;
    while !progress.is_solved() {
        progress.sweep();
        k += 1;
        let ends = progress.task.swept || progress.task.stop.early();
        if !ends && !rate.is_due(k) {
            continue;
        }
        let grade = progress.grade_sweeps();
        if ends || !rate.promises(k, grade, progress.task.stop.tolerance) {
            break;
        }
    }
    progress.record(Method::GaussSeidel, k, 0);
}

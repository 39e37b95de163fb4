//! The order in which [`Solver::Auto`](super::Solver::Auto) asks the methods, and each of them alone.
//!
//! Sweeps end most problems and give the others a start. Where hardly a contact separates, one factorisation tells whether
//! everything stands; where a factorisation is dear, accelerated sweeps come before it. Newton's method ends problems of
//! full rank and, with other prox parameters, those in which contacts creep; the interior point method, where the laws
//! allow it, and the proximal point iteration end the rest. Everything else is cheap against sweeps because a
//! factorisation costs as much as some tens of them.

use crate::contact::{ContactState, Phase};
use crate::solver::infeasibility::prove_one_contact;
use crate::solver::method::{
    Accelerated, Admm, Buffers, Cones, Course, Interior, Iterate, Progress, ProximalPoint, Rate,
    Standing, Sweeper, TRIAL_SWEEPS, Task,
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
/// Natural map below which Newton's method finds the digits that rounding keeps from the interior point method;
/// tried earlier it fails, later it is not tried. No stored problem depends on it.
const POLISHED: f64 = 1e-4;
/// Natural map below which contacts that creep may be all that is left to be found. The attempt for them is in vain on
/// the stored problems: a tenth saves 107 factorisations, ten times as much costs 293.
const CREEPING: f64 = 1e-3;
/// Natural map at which the interior point method, whose digits end there, hands over: a tenth of it costs 44
/// factorisations on the stored problems, ten times as much saves eight.
const INTERIOR_GOAL: f64 = 1e-7;

/// Floating-point operations of a factorisation that take as long as a sweep over one contact, which takes 0.2 µs.
const SWEEP: f64 = 4000.0;
/// Sweeps that a factorisation takes as long as, from which on accelerated ones are tried before it, and factorisations that
/// they may take as long as. No stored problem comes to more than 1.4 sweeps; of `columns` of spheres, ten upon each other,
/// 450 contacts come to 9, 960 to 28, 10 330 to 414. Those of 960 take 8 times as long without, and 44 times those of 1960.
const DEAR: f64 = 8.0;
const WORTH: f64 = 20.0;
/// Natural map from which on Newton's method itself, without a proximal term, ends what accelerated sweeps have begun, and
/// its iterations: from 5e-7 it takes 5 of them in columns of 960 contacts, from 2e-5 27; from 3e-5 in columns of 3000
/// contacts and from 5e-5 in those of 10 330 it finds nothing.
const IDENTIFIED: f64 = 1e-5;
const FROM_SWEEPS: usize = 30;
/// Fewest contacts of what may stand by itself: fewer are as soon solved by Newton's method.
const MANY: usize = 64;

/// The methods with their buffers, and the matrix that they share.
#[derive(Debug, Clone, Default)]
pub(crate) struct Methods {
    buffers: Buffers,
    matrix: NewtonMatrix,
    proximal: ProximalPoint,
    cones: Cones,
    interior: Interior,
    admm: Admm,
    standing: Standing,
    accelerated: Accelerated,
}

impl Methods {
    /// Forgets what depends on the pattern of `G`.
    pub(crate) fn reset(&mut self) {
        self.matrix.reset();
    }

    /// Sweeps, then what stands by itself, then Newton, then interior point and proximal point.
    pub(crate) fn automatic(
        &mut self,
        task: Task<'_>,
        iterate: Iterate<'_>,
        sweeper: &mut Sweeper,
        with_interior: bool,
    ) -> (usize, Ended) {
        let Self { buffers, matrix, proximal, cones, interior, standing, accelerated, .. } = self;
        let mut progress = Progress::new(task, iterate, sweeper, buffers);
        gauss_seidel(&mut progress);
        // Size of the percussions of bodies that rest upon each other.
        let mut expected = 0.0;
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
            if task.problem.contacts().len() >= MANY && progress.may_stand() {
                expected = standing.attempt(&mut progress, matrix);
            }
        }
        if !progress.is_over() {
            let sweeps = matrix.operations() / (SWEEP * task.problem.contacts().len() as f64);
            if sweeps > DEAR {
                accelerated.iterate(&mut progress, (WORTH * sweeps) as usize);
                if !progress.is_over() && progress.best_grade() < IDENTIFIED {
                    proximal.newton_alone(&mut progress, matrix, FROM_SWEEPS);
                }
            }
        }
        if !progress.is_over() {
            proximal.attempt(&mut progress, matrix, ATTEMPT);
        }
        if !progress.is_over() && progress.best_grade() < CREEPING {
            proximal.attempt_matched(&mut progress, matrix);
        }
        if !progress.is_over() && with_interior && cones.read(task.problem) {
            let goal = if expected > 0.0 { 0.0 } else { INTERIOR_GOAL };
            let course = Course { max_iterations: INTERIOR, goal, expected };
            interior.iterate(&mut progress, cones, matrix, course);
        }
        if !progress.is_over() {
            proximal.iterate(&mut progress, matrix, OUTER);
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
        let Self { buffers, matrix, proximal, cones, interior, admm, .. } = self;
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
                let course = Course { max_iterations, goal: 0.0, expected: 0.0 };
                let limited = interior.iterate(&mut progress, cones, matrix, course);
                if !limited && !progress.is_over() && progress.best_grade() < POLISHED {
                    proximal.attempt(&mut progress, matrix, ATTEMPT);
                }
                limited
            }
            Method::Admm => admm.iterate(&mut progress, cones, matrix, max_iterations),
            Method::Newton => proximal.newton_alone(&mut progress, matrix, max_iterations),
            _ => proximal.iterate(&mut progress, matrix, max_iterations),
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

//! The order in which [`Solver::Auto`](super::Solver::Auto) asks the methods, and each of them alone.
//!
//! Sweeps end many problems and give the others a start; Newton's method ends those of full rank and, with other prox
//! parameters, those in which contacts creep; the interior point method, where the laws allow it, and the proximal
//! point iteration end the rest.
//!
//! Where an attempt by Newton's method costs less than the sweeps that are still to come, after three of them at the
//! earliest, it is made at once: a step costs as much as three to ten sweeps, but where bodies are wide or many some tens
//! to hundreds (`method/cost.rs`). If it fails, sweeps go on as long as they promise an end.

use crate::contact::{ContactState, Phase};
use crate::solver::infeasibility::prove_one_contact;
use crate::solver::measure::natural_residual::Residual;
use crate::solver::method::{
    Admm, Buffers, Cones, Cost, Interior, Iterate, Progress, ProximalPoint, Rate, Sweeper,
    TRIAL_SWEEPS, Task,
};
use crate::solver::newton_matrix::NewtonMatrix;
use crate::solver::report::{Ended, Method};

// Constants of this file and of `method/` were halved and doubled, those of a size of 1e-3 and less divided and multiplied
// by ten, on the "stored problems": those of up to 765 contacts in the folder that `ASPERITY_CONTACT_PROBLEMS` names,
// without the rock pile, 31 in all, by `asperity solve`. `Auto` solves all of them by the global measure with 1448
// iterations and 1073 factorisations, in 0.63 of the time (geometric mean) of 2502 iterations and 828 factorisations
// without first attempts. Numbers at constants that were there before are from then, or from before islands were solved
// one by one, when it took 1787 iterations and 621 factorisations; it solved all of them with every value that this file
// names. Numbers changed by up to 5 % where only the rounding of factorisations did: what is less says that it hardly
// matters.

/// Newton iterations of a step of the attempt where none was made before: enough where `G` has full rank, and soon over
/// where it has not.
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
    /// Forgets what depends on `G`.
    pub(crate) fn reset(&mut self) {
        self.buffers.forget_operator();
        self.matrix.reset();
    }

    /// Sweeps, then Newton, then interior point and proximal point.
    pub(crate) fn automatic(
        &mut self,
        task: Task<'_>,
        iterate: Iterate<'_>,
        sweeper: &mut Sweeper,
        with_interior: bool,
    ) -> (usize, Ended, Residual) {
        let Self { buffers, matrix, proximal, cones, interior, .. } = self;
        let mut progress = Progress::new(task, iterate, sweeper, buffers);
        let tried = first_attempt(&mut progress, proximal, matrix);
        if !progress.is_over()
            && let Some(contact) = progress.stuck()
        {
            // A contact that sweeps could not solve may have no solution whatever the others do.
            let percussion = &*progress.iterate.percussion;
            let proof = prove_one_contact(task.problem, contact, percussion);
            *progress.iterate.infeasibility = proof;
        }
        if !progress.is_over() && !tried {
            proximal.prepare(task.problem);
            matrix.prepare(task.problem);
            proximal.attempt(&mut progress, matrix, ATTEMPT);
        }
        if !progress.is_over() && progress.best_grade() < CREEPING {
            proximal.attempt_matched(&mut progress, matrix);
        }
        if !progress.is_over() && with_interior && cones.read(task.problem) {
            interior.iterate(&mut progress, cones, matrix, INTERIOR, INTERIOR_GOAL);
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
    ) -> (usize, Ended, Residual) {
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
    ) -> (usize, Ended, Residual) {
        let Self { buffers, matrix, proximal, cones, interior, admm } = self;
        let mut progress = Progress::new(task, iterate, sweeper, buffers);
        let conic = matches!(method, Method::InteriorPoint | Method::Admm);
        if conic && !cones.read(task.problem) {
            let (_, _, residual) = progress.finish(false);
            return (0, Ended::NotApplicable, residual);
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
            Method::Admm => admm.iterate(&mut progress, cones, matrix, max_iterations),
            Method::Newton => proximal.newton_alone(&mut progress, matrix, max_iterations),
            _ => proximal.iterate(&mut progress, matrix, max_iterations),
        };
        progress.finish(limited)
    }
}

/// Sweeps, an attempt by Newton's method where that costs less than to go on, and further sweeps where it fails; whether
/// it was made.
fn first_attempt(
    progress: &mut Progress<'_>,
    proximal: &mut ProximalPoint,
    matrix: &mut NewtonMatrix,
) -> bool {
    let problem = progress.task.problem;
    let cost = Cost::of(problem, 0..problem.contacts().len());
    let estimate = cost.first_estimate();
    let mut sweeps = Sweeps::new(estimate);
    // One is enough where sweeps were made before, as long as they were worth it, which tells of contacts that have no
    // solution.
    let swept = progress.task.swept;
    sweeps.run(progress, swept);
    let mut instead = 0.0;
    if !progress.is_over() {
        matrix.prepare(problem);
        instead = cost.attempt(matrix.operations(problem));
        sweeps.rate.instead_of(instead);
        if !swept || instead > estimate {
            sweeps.run(progress, false);
        }
    }
    progress.record(Method::GaussSeidel, sweeps.count, 0);
    if progress.is_over() || instead > Rate::WORTHWHILE {
        return false;
    }
    proximal.prepare(problem);
    proximal.first_attempt(progress, matrix);
    if !progress.is_over() {
        let before = sweeps.count;
        // What follows may take hundreds of factorisations, and many more from a worse start.
        sweeps.rate = Rate::default();
        sweeps.run(progress, false);
        progress.record(Method::GaussSeidel, sweeps.count - before, 0);
    }
    true
}

/// Sweeps that go on.
struct Sweeps {
    rate: Rate,
    count: usize,
}

impl Sweeps {
    /// In place of something that takes as long as so many sweeps.
    fn new(instead: f64) -> Self {
        Self { rate: Rate::new(instead), count: 0 }
    }

    /// Sweeps while their rate promises an end, or once.
    fn run(&mut self, progress: &mut Progress<'_>, once: bool) {
        while !progress.is_solved() {
            progress.sweep();
            self.count += 1;
            let ends = once || progress.task.stop.early();
            if !ends && !self.rate.is_due(self.count) {
                continue;
            }
            let grade = progress.grade_sweeps();
            if ends || !self.rate.promises(self.count, grade, progress.task.stop.tolerance) {
                break;
            }
        }
    }
}

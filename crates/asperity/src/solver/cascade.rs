//! The steps that [`Solver::Auto`](super::Solver::Auto) takes on an island that the first sweeps have not solved, as data; and
//! each method alone.
//!
//! Sweeps go on while their rate promises an end sooner than a few factorisations. Most steps of [`CASCADE`] start from the
//! best percussions of those before them, and each ends as soon as the island is solved or has a proof that it cannot be. Where a
//! factorisation costs as much as many sweeps, accelerated sweeps come first and ADMM, which needs few factorisations; elsewhere
//! an attempt by Newton's method costs less than to go on sweeping.

use std::time::{Duration, Instant};

use super::gauss_seidel::{
    Cost, Iterate, Past, Rate, Reached, Sweeper, TRIAL_SWEEPS, Task, untimed_visits,
};
use super::incumbent::{Buffers, Incumbent};
use super::infeasible::prove_one_contact;
use super::method::{
    ALONE, Admm, Anderson, BESIDE, Cones, Course, Interior, LeastNorm, PATIENCE, ProximalPoint,
};
use super::newton_matrix::NewtonMatrix;
use super::report::{Ended, Method};
use super::settings::{Step, Steps};
use crate::contact::{ContactProblem, ContactState, Phase};
use crate::threads::LEAF;

/// Sweeps in the time of a factorisation from which on it is expensive: accelerated sweeps come first then.
const EXPENSIVE: f64 = 8.0;
/// Factorisations whose operations accelerated sweeps may take until they have halved the natural map.
const HALVING: f64 = 20.0;
/// Natural map from which on Newton's method ends what accelerated sweeps have begun.
const NEAR: f64 = 1e-5;
/// Newton iterations there, and of a first attempt after plain sweeps; such an attempt must halve `‖F‖` soon.
const NEWTON: usize = 20;
const SHORT: usize = 8;
/// Iterations of the interior point method, after which the proximal point iteration starts.
const INTERIOR: usize = 40;
/// Natural map from which on the digits of the interior point method may end.
const DIGITS: f64 = 1e-7;
/// Outer steps of the proximal point iteration, which a limit of time ends before where there is one.
const OUTER: usize = 5000;
/// Fewest contacts of bodies at rest that are worth a factorisation of their own: Newton's method solves fewer as soon.
const MANY: usize = 64;
/// Sweeps in the time of a factorisation up to which large islands are tried at rest after few sweeps.
const EARLY: f64 = 100.0;

/// One step of the cascade.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stage {
    /// Percussions of least norm with which no body moves, and the interior point method from their size.
    Rest,
    /// Sweeps with Anderson's acceleration.
    Acceleration,
    /// Newton's method from what sweeps have led to.
    Newton,
    /// Plain sweeps after a first attempt in vain.
    Sweeps,
    /// The alternating direction method of multipliers.
    Admm,
    /// Newton's method with prox parameters that suit contacts which creep.
    MatchedNewton,
    /// The interior point method.
    InteriorPoint,
    /// Plain sweeps once more: they may end where all steps before have failed, as beside bodies that move.
    MoreSweeps,
    /// The proximal point iteration, to the end.
    ProximalPoint,
}

/// The steps in their order, with the option that leaves them out.
const CASCADE: [(Stage, Step); 9] = [
    (Stage::Rest, Step::Rest),
    (Stage::Acceleration, Step::Acceleration),
    (Stage::Newton, Step::Newton),
    (Stage::Sweeps, Step::Newton),
    (Stage::Admm, Step::Admm),
    (Stage::MatchedNewton, Step::Newton),
    (Stage::InteriorPoint, Step::InteriorPoint),
    (Stage::MoreSweeps, Step::Acceleration),
    (Stage::ProximalPoint, Step::ProximalPoint),
];

/// The methods with their buffers, and the matrix that they share.
#[derive(Debug, Clone, Default)]
pub(super) struct Methods {
    buffers: Buffers,
    matrix: NewtonMatrix,
    proximal: ProximalPoint,
    cones: Cones,
    interior: Interior,
    admm: Admm,
    least_norm: LeastNorm,
    anderson: Anderson,
}

impl Methods {
    /// Forgets what depends on `G`.
    pub(super) fn reset(&mut self) {
        self.matrix.reset();
    }

    /// The steps of the cascade that a user has not left out.
    pub(super) fn automatic(
        &mut self,
        task: Task<'_>,
        iterate: Iterate<'_>,
        sweeper: &mut Sweeper,
        steps: Steps,
    ) -> Reached {
        let mut buffers = std::mem::take(&mut self.buffers);
        let mut incumbent = Incumbent::new(task, iterate, sweeper, &mut buffers);
        self.solve(&mut incumbent, steps);
        let known = |state: &ContactState| state.phase != Phase::Unknown;
        if incumbent.is_solved() && task.history.iter().any(known) {
            incumbent.continue_states(TRIAL_SWEEPS);
        }
        let reached = incumbent.finish(false);
        self.buffers = buffers;
        reached
    }

    fn solve(&mut self, incumbent: &mut Incumbent<'_>, steps: Steps) {
        let problem = incumbent.task.problem;
        let mut island = Island::of(incumbent, steps);
        let mut sweeps = Sweeps::new(problem, island.cost.first_estimate());
        // One sweep more says which contact has no solution.
        sweeps.run(incumbent, if incumbent.task.past == Past::Stuck { 1 } else { 0 });
        let early = !incumbent.is_over() && island.is_large && incumbent.may_rest();
        if early && sweeps.leave_time_for(incumbent, Cost::ANALYSIS) {
            // Data of large islands do not stay in the cache, which sweeps wait for and factorisations do not.
            self.matrix.prepare(problem);
            let factorization = island.cost.sweeps(self.matrix.operations(problem));
            if factorization <= EARLY && sweeps.leave_time_for(incumbent, factorization) {
                let ends = sweeps.leave_time_for(incumbent, INTERIOR as f64 * factorization);
                self.rest(incumbent, &mut island, ends);
            }
        }
        if island.is_large {
            sweeps.run(incumbent, usize::MAX);
        }
        if incumbent.is_over() {
            return sweeps.record(incumbent);
        }
        if sweeps.leave_time_for(incumbent, Cost::ANALYSIS) {
            self.matrix.prepare(problem);
            self.proximal.prepare(problem);
            island.read(self.matrix.operations(problem));
            sweeps.rate.instead_of(island.attempt);
            if island.attempt > island.cost.first_estimate() {
                sweeps.run(incumbent, usize::MAX);
            }
        }
        sweeps.record(incumbent);
        let few = if island.is_expensive() { INTERIOR as f64 } else { 2.0 };
        if !incumbent.is_over() && !sweeps.leave_time_for(incumbent, few * island.factorization) {
            let accelerated = steps.include(Step::Acceleration);
            return self.anderson.iterate(incumbent, usize::MAX, accelerated);
        }
        if !incumbent.is_over()
            && let Some(contact) = incumbent.stuck()
        {
            // A contact that sweeps could not solve may have no solution whatever the others do.
            let percussion = &*incumbent.iterate.percussion;
            let proof = prove_one_contact(problem, contact, percussion);
            *incumbent.iterate.infeasibility = proof;
        }
        for (stage, step) in CASCADE {
            if incumbent.is_over() {
                return;
            }
            if steps.include(step) {
                self.step(stage, incumbent, &mut island);
            }
        }
    }

    /// Takes one step, where it serves the island.
    fn step(&mut self, stage: Stage, incumbent: &mut Incumbent<'_>, island: &mut Island) {
        let Self { matrix, proximal, cones, interior, admm, anderson, .. } = self;
        match stage {
            Stage::Rest => {
                if island.contacts >= MANY && !island.asked_for_rest && incumbent.may_rest() {
                    self.rest(incumbent, island, true);
                }
            }
            Stage::Acceleration => {
                if island.is_expensive() {
                    let patience = (HALVING * island.factorization) as usize;
                    anderson.iterate(incumbent, patience, true);
                }
            }
            Stage::Newton => {
                let (worthwhile, patience) = match island.is_expensive() {
                    true => (incumbent.best_grade() < NEAR, PATIENCE),
                    false => (island.attempt <= Rate::WORTHWHILE, SHORT),
                };
                if worthwhile {
                    proximal.newton(incumbent, matrix, (NEWTON, patience));
                    island.tried = true;
                }
            }
            Stage::Sweeps => {
                if island.tried && !island.is_expensive() {
                    let mut sweeps = Sweeps::new(incumbent.task.problem, Rate::WORTHWHILE);
                    sweeps.run(incumbent, usize::MAX);
                    sweeps.record(incumbent);
                }
            }
            Stage::Admm => {
                if island.is_expensive() && cones.read(incumbent.task.problem) {
                    admm.iterate(incumbent, cones, matrix, usize::MAX, (BESIDE, false));
                }
            }
            Stage::MatchedNewton => {
                if !island.is_expensive() {
                    proximal.attempt_matched(incumbent, matrix);
                }
            }
            Stage::InteriorPoint => {
                if island.resting.is_none() && cones.read(incumbent.task.problem) {
                    let course = Course { max_iterations: INTERIOR, goal: DIGITS, expected: 0.0 };
                    interior.iterate(incumbent, cones, matrix, course);
                }
            }
            Stage::MoreSweeps => {
                if island.is_expensive() {
                    let patience = (HALVING * island.factorization) as usize;
                    anderson.iterate(incumbent, patience, false);
                }
            }
            Stage::ProximalPoint => {
                proximal.iterate(incumbent, matrix, OUTER);
            }
        }
    }

    /// Percussions of least norm, and the interior point method from their size where there is time for it.
    fn rest(&mut self, incumbent: &mut Incumbent<'_>, island: &mut Island, has_time: bool) {
        let Self { matrix, cones, interior, least_norm, .. } = self;
        island.asked_for_rest = true;
        if !island.steps.include(Step::Rest) {
            return;
        }
        island.resting = least_norm.attempt(incumbent, matrix);
        let conic = island.steps.include(Step::InteriorPoint);
        if let Some(expected) = island.resting
            && conic
            && has_time
            && !incumbent.is_over()
            && cones.read(incumbent.task.problem)
        {
            let course = Course { max_iterations: INTERIOR, goal: DIGITS, expected };
            interior.iterate(incumbent, cones, matrix, course);
        }
    }

    /// One method alone.
    pub(super) fn single(
        &mut self,
        task: Task<'_>,
        iterate: Iterate<'_>,
        sweeper: &mut Sweeper,
        method: Method,
        max_iterations: usize,
    ) -> Reached {
        let Self { buffers, matrix, proximal, cones, interior, admm, .. } = self;
        let mut incumbent = Incumbent::new(task, iterate, sweeper, buffers);
        let conic = matches!(method, Method::InteriorPoint | Method::Admm);
        if conic && !cones.read(task.problem) {
            let ended = Ended::NotApplicable;
            return Reached { iterations: 0, ended, ..incumbent.finish(false) };
        }
        proximal.prepare(task.problem);
        matrix.prepare(task.problem);
        let limited = match method {
            Method::InteriorPoint => {
                let course = Course { max_iterations, goal: 0.0, expected: 0.0 };
                let limited = interior.iterate(&mut incumbent, cones, matrix, course);
                // Newton's method finds the digits that rounding keeps from the interior point method.
                if !limited && !incumbent.is_over() && incumbent.best_grade() < NEAR {
                    proximal.newton(&mut incumbent, matrix, (NEWTON, PATIENCE));
                }
                limited
            }
            Method::Admm => {
                admm.iterate(&mut incumbent, cones, matrix, max_iterations, (ALONE, true))
            }
            Method::Newton => proximal.newton(&mut incumbent, matrix, (max_iterations, PATIENCE)),
            _ => proximal.iterate(&mut incumbent, matrix, max_iterations),
        };
        incumbent.finish(limited)
    }
}

/// What decides which steps serve an island.
struct Island {
    steps: Steps,
    contacts: usize,
    cost: Cost,
    /// Whether sweeps were ended early since its data do not stay in the cache of the processor.
    is_large: bool,
    /// Sweeps in the time of a factorisation, and of an attempt by Newton's method.
    factorization: f64,
    attempt: f64,
    /// Size of the percussions of bodies that rest upon each other, where they do, and whether that was asked.
    resting: Option<f64>,
    asked_for_rest: bool,
    /// Whether Newton's method was tried.
    tried: bool,
}

impl Island {
    fn of(incumbent: &Incumbent<'_>, steps: Steps) -> Self {
        let problem = incumbent.task.problem;
        let contacts = problem.contacts().len();
        let cost = Cost::of(problem, 0..contacts);
        let is_large = cost.is_large();
        let (resting, asked_for_rest, tried) = (None, false, false);
        let (factorization, attempt) = (f64::INFINITY, f64::INFINITY);
        Self {
            steps,
            contacts,
            cost,
            is_large,
            factorization,
            attempt,
            resting,
            asked_for_rest,
            tried,
        }
    }

    /// Takes in the operations of a factorisation.
    fn read(&mut self, operations: f64) {
        self.factorization = self.cost.sweeps(operations);
        self.attempt = self.cost.attempt(operations);
    }

    fn is_expensive(&self) -> bool {
        self.factorization > EXPENSIVE
    }
}

/// Plain sweeps that go on.
struct Sweeps {
    rate: Rate,
    count: usize,
    /// What a sweep counts for between two looks at the clock, and what has been counted since the last one: at first as much as
    /// asks for one.
    visits: usize,
    untimed: usize,
    /// Time that the sweeps took.
    spent: Duration,
}

impl Sweeps {
    /// In place of something that takes as long as so many sweeps.
    fn new(problem: &ContactProblem, instead: f64) -> Self {
        let visits = untimed_visits(problem, 0..problem.contacts().len());
        Self { rate: Rate::new(instead), count: 0, visits, untimed: LEAF, spent: Duration::ZERO }
    }

    /// Records what was done, if it was anything.
    fn record(&self, incumbent: &mut Incumbent<'_>) {
        if self.count > 0 {
            incumbent.record(Method::GaussSeidel, self.count, 0);
        }
    }

    /// Sweeps while their rate promises an end, at most so many in all.
    fn run(&mut self, incumbent: &mut Incumbent<'_>, most: usize) {
        let began = Instant::now();
        while !incumbent.is_solved() && self.count < most {
            incumbent.sweep();
            self.count += 1;
            let ends = self.count == most || self.is_late(incumbent.task);
            if !ends && !self.rate.is_due(self.count) {
                continue;
            }
            let grade = incumbent.grade_sweeps();
            if ends || !self.rate.promises(self.count, grade, incumbent.task.stop.tolerance) {
                break;
            }
        }
        self.spent += began.elapsed();
    }

    /// Whether the stop says, when it is asked, that nobody waits any longer.
    fn is_late(&mut self, task: Task<'_>) -> bool {
        self.untimed += self.visits;
        if self.untimed < LEAF {
            return false;
        }
        self.untimed = 0;
        task.stop.early()
    }

    /// Whether a limit of time leaves as long as so many sweeps take; one is made where it is not known how long that is.
    fn leave_time_for(&mut self, incumbent: &mut Incumbent<'_>, sweeps: f64) -> bool {
        let Some(deadline) = incumbent.task.stop.deadline else { return true };
        if self.count == 0 {
            self.run(incumbent, 1);
        }
        let one = self.spent.as_secs_f64() / self.count.max(1) as f64;
        one * sweeps <= deadline.saturating_duration_since(Instant::now()).as_secs_f64()
    }
}

//! Proximal point iteration with Newton's method inside.
//!
//! Each outer step solves the problem with `G + εI` around the last iterate: `ε` falls while the inner
//! solves succeed and rises where they fail. Where inner solves fail repeatedly, the prox parameters of the
//! natural map take turns; sweeps help out.

use super::newton::{Goal, Newton, PATIENCE};
use super::progress::Progress;
use crate::contact::ContactProblem;
use crate::solver::newton_matrix::NewtonMatrix;
use crate::solver::report::Method;

/// Factors of the prox parameters. Hyperstatic problems have percussions a hundred times their loads, and larger
/// parameters make up to ten times fewer factorisations there; others need small ones. As they follow each other in
/// turn where inner solves fail, none of them has to suit every problem.
const FACTORS: [f64; 4] = [10.0, 1.0, 30.0, 3.0];
/// Newton iterations of an inner solve, and how many count as few and very few: after few `ε` falls, after very few it
/// falls faster. More of either trades fewer outer steps against inner solves that fail. `ProximalPoint` solves the
/// stored problems of `auto.rs` with 2026 factorisations; of an inner solve, half of the iterations cost 348 more, twice
/// as many 181 more; with half of the other two 5 and 13 more, with twice as many 186 fewer and 2 more.
const INNER: usize = 20;
const FEW: usize = 12;
const VERY_FEW: usize = 4;
/// Sweeps after a failed inner solve: a quarter and four times as many cost 70 and 127 factorisations on the stored
/// problems, all of which are solved with either.
const SWEEPS: usize = 20;
/// Failed inner solves in turn after which sweeps have not left less than 0.9 of the natural map, from which on none are made
/// until an inner solve succeeds or the iteration starts anew. A problem that the fuzzer found
/// (`many_contacts/swept_in_vain_1` of its corpus) takes 5 s in the build of the fuzzers in place of 41 s; the stored
/// problems take as many iterations and factorisations as without this limit.
const SWEPT_IN_VAIN: usize = 10;
/// Sweeps before a new start: some problems only they solve, slowly. No stored one depends on it within a factor of four.
const LONG_SWEEPS: usize = 1000;
/// Outer steps without a new best after which the iteration is lost: what led it astray may be its start. The stored problems
/// take as many factorisations with a quarter and four times as many.
const LOST: usize = 300;
/// Newton iterations from where a neighbourhood leads.
const FROM_CASE: usize = 50;
/// New starts without success after which it gives up: two with every factor.
const STARTS: usize = 2 * FACTORS.len();

/// `ε` and the prox parameters from one outer step to the next.
struct Schedule {
    epsilon: f64,
    turn: usize,
    /// Steps for which `ε` does not fall after a failure, and how many there will be after the next one.
    hold: usize,
    patience: usize,
    restarts: usize,
    /// Failed inner solves in turn after which sweeps have not helped.
    swept_in_vain: usize,
}

impl Schedule {
    fn new(grade: f64) -> Self {
        let epsilon = (100.0 * grade).clamp(1e-6, 1e-2);
        Self { epsilon, turn: 0, hold: 0, patience: 2, restarts: 0, swept_in_vain: 0 }
    }

    fn factor(&self) -> f64 {
        FACTORS[self.turn]
    }

    /// An inner solve succeeded.
    fn tighten(&mut self, iterations: usize) {
        self.swept_in_vain = 0;
        self.hold = self.hold.saturating_sub(1);
        if self.hold == 0 && iterations <= FEW {
            let cut = if iterations <= VERY_FEW { 10.0 } else { 4.0 };
            self.epsilon = (self.epsilon / cut).max(1e-10);
        }
    }

    /// An inner solve failed and led nowhere.
    fn relax(&mut self) {
        self.turn = (self.turn + 1) % FACTORS.len();
        self.epsilon = (4.0 * self.epsilon).min(1e3);
        self.patience = (2 * self.patience).min(16);
        self.hold = self.patience;
    }

    /// Whether the next new start is where many sweeps lead, not at no percussions: in turn, and the other one of the two where
    /// parameters are taken for the second time.
    fn starts_after_sweeps(&self) -> bool {
        (self.restarts + self.restarts / FACTORS.len()).is_multiple_of(2)
    }

    /// A new start, with the next parameters in turn.
    fn restart(&mut self) {
        let turn = self.restarts % FACTORS.len();
        *self = Self { turn, restarts: self.restarts + 1, ..Self::new(1.0) };
    }
}

/// How long the iteration goes on.
pub(crate) struct Limits {
    /// Outer steps.
    pub(crate) steps: usize,
    /// Factorisations that have not halved the natural map, after which it is lost.
    pub(crate) patience: usize,
    /// New starts.
    pub(crate) starts: usize,
}

impl Limits {
    /// As many steps, without a limit of factorisations.
    pub(crate) fn of_steps(steps: usize) -> Self {
        Self { steps, patience: usize::MAX, starts: STARTS }
    }
}

/// The iteration over all its starts.
pub(crate) struct OuterIteration {
    schedule: Schedule,
    /// What is left of the limits.
    pub(crate) left: Limits,
    /// Natural map of the centre, and the lowest one of all steps.
    grade: f64,
    lowest: f64,
    /// Whether a stage was recorded.
    recorded: bool,
}

/// Regularisation of the matrices of Newton's method alone, relative to the blocks of `G`: elimination among bodies
/// divides by it, and half the digits of the steps are left on either side. A hundredth and a hundred times of it change
/// no factorisation on the stored problems.
const SHIFT: f64 = 1e-8;
/// Iterations of a first attempt, and those within which `‖F‖` must halve: on 240 problems of 4 to 100 contacts 6 and 10
/// for the latter, with 20 and 25, change the time by 1 %.
const FIRST: usize = 20;
const FIRST_PATIENCE: usize = 8;
/// Relative `‖F‖`, in tolerances, from which on it is worth while to look whether percussions pass the measure: by that of
/// contacts the last digits of all are not always needed.
const PROMISING: f64 = 100.0;
/// Part of the defect at the start that sweeps must have left: with a fifth and with any the same problems take as long, but
/// `OneObject-i100000-499` of the stored ones four times as long with any.
const NEARER: f64 = 0.5;
/// Factor by which matched prox parameters rise, Newton iterations with each, and the largest, at which rounding is
/// all that velocities hold. Of 209 steps of masses between walls that sweeps and plain steps had left unsolved
/// (relations `doubled_stop` and `scaled_direction` of the metamorphic tests) 5 and 10 solved all with 64 iterations
/// each, 10 and 20 all but one with 84, 100 and 20 all but eleven.
const RISE: f64 = 5.0;
const MATCHED: usize = 10;
const MOST_MATCHED: f64 = 1e12;
/// Regularisation of the matrices there, in units of `1/ρ`: without it redundant contacts leave nothing to divide by.
/// With 1e-2 and 1e-6 two more of these steps stayed unsolved, without any eleven.
const MATCHED_SHIFT: f64 = 1e-4;

/// Natural map below which contacts that creep may be all that is left to be found. The attempt for them is in vain on
/// the stored problems of `auto.rs`: a tenth saves 107 factorisations, ten times as much costs 293. Where the iteration is
/// lost, the attempt is made again from any percussions that are nearer to a solution: where they had to be twice as near,
/// a step of seed 104 of the relation `rigid_permutation` of the metamorphic tests stayed at 2e-11 with each of nine starts.
const CREEPING: f64 = 1e-3;

/// Newton's method for the problem itself or for a step of the iteration.
#[derive(Debug, Clone, Default)]
pub(crate) struct ProximalPoint {
    newton: Newton,
    /// The centre of the present step, and what Newton's method makes of it.
    centre: Vec<f64>,
    trial: Vec<f64>,
    /// Natural map that an attempt with matched prox parameters has left.
    matched: f64,
}

impl ProximalPoint {
    /// Buffers for this problem.
    pub(crate) fn prepare(&mut self, problem: &ContactProblem) {
        self.newton.prepare(problem);
        self.matched = f64::INFINITY;
        for list in [&mut self.centre, &mut self.trial] {
            list.clear();
            list.resize(problem.rows(), 0.0);
        }
    }

    /// Iterates until the problem is solved, the stop says so or so many outer steps are made; whether these ended it. Where
    /// it is lost it starts again somewhere else.
    pub(crate) fn iterate(
        &mut self,
        progress: &mut Progress<'_>,
        matrix: &mut NewtonMatrix,
        most: usize,
    ) -> bool {
        let mut outer = self.begin(progress, Limits::of_steps(most));
        while self.follow(progress, matrix, &mut outer)
            && self.start_anew(progress, matrix, &mut outer)
        {}
        outer.left.steps == 0
    }

    /// Begins with the best percussions.
    pub(crate) fn begin(&mut self, progress: &mut Progress<'_>, left: Limits) -> OuterIteration {
        let grade = progress.start_from_best(&mut self.centre);
        let schedule = Schedule::new(grade);
        self.newton.scale_rho(progress.task.problem, schedule.factor());
        OuterIteration { schedule, left, grade, lowest: grade, recorded: false }
    }

    /// Iterates from the centre; whether it is lost there, not over.
    pub(crate) fn follow(
        &mut self,
        progress: &mut Progress<'_>,
        matrix: &mut NewtonMatrix,
        outer: &mut OuterIteration,
    ) -> bool {
        let problem = progress.task.problem;
        let OuterIteration { schedule, left, grade, lowest, .. } = &mut *outer;
        let before = self.newton.factorizations;
        let (mut steps, mut lost, mut is_lost) = (0, 0, false);
        let (mut halved, mut halved_at) = (*grade, before);
        while !progress.is_solved() && left.steps > 0 && !progress.task.stop.early() {
            (steps, left.steps) = (steps + 1, left.steps - 1);
            let goal = self.inner_goal(progress, *grade, schedule.epsilon, INNER);
            let (norm, iterations) = self.newton_from_centre(progress, matrix, goal);
            let found = progress.grade(&self.trial);
            if progress.is_solved() || progress.is_hopeless() {
                break;
            }
            lost = if found < *lowest { 0 } else { lost + 1 };
            *lowest = lowest.min(found);
            if found < 0.5 * halved {
                (halved, halved_at) = (found, self.newton.factorizations);
            }
            let in_vain = self.newton.factorizations - halved_at;
            if lost == LOST || in_vain > left.patience {
                is_lost = true;
                break;
            }
            if norm <= goal.tolerance {
                *grade = self.adopt_trial(found);
                schedule.tighten(iterations);
            } else {
                if schedule.swept_in_vain < SWEPT_IN_VAIN {
                    let swept = self.sweep_from_centre(progress, *grade);
                    schedule.swept_in_vain =
                        if swept < *grade { 0 } else { schedule.swept_in_vain + 1 };
                    *grade = swept;
                }
                if found > 0.7 * *grade {
                    schedule.relax();
                    self.newton.scale_rho(problem, schedule.factor());
                } else {
                    *grade = self.adopt_trial(found);
                    schedule.epsilon *= 2.0;
                }
            }
        }
        if steps > 0 || !outer.recorded {
            outer.recorded = true;
            progress.record(Method::ProximalPoint, steps, self.newton.factorizations - before);
        }
        is_lost
    }

    /// Starts where the iteration has not been led astray; whether there is such a start.
    pub(crate) fn start_anew(
        &mut self,
        progress: &mut Progress<'_>,
        matrix: &mut NewtonMatrix,
        outer: &mut OuterIteration,
    ) -> bool {
        if outer.schedule.restarts == outer.left.starts {
            return false;
        }
        // Contacts that creep may be all that is left where the iteration has come nearer.
        self.attempt_matched(progress, matrix);
        if progress.is_over() {
            return false;
        }
        progress.begin_anew();
        self.new_start(progress, outer.schedule.starts_after_sweeps());
        outer.schedule.restart();
        self.newton.scale_rho(progress.task.problem, outer.schedule.factor());
        outer.grade = 1.0;
        true
    }

    /// Starts at given percussions, with Newton's method; whether that is not yet the end. The iteration goes on from the
    /// start: what Newton's method has led to is kept where it is the best.
    pub(crate) fn start_from(
        &mut self,
        progress: &mut Progress<'_>,
        matrix: &mut NewtonMatrix,
        outer: &mut OuterIteration,
        start: &[f64],
    ) -> bool {
        let grade = progress.grade(start);
        if progress.is_over() {
            return false;
        }
        self.newton.scale_rho(progress.task.problem, 1.0);
        self.newton_from(progress, matrix, start);
        if progress.is_over() {
            return false;
        }
        let restarts = outer.schedule.restarts;
        outer.schedule = Schedule { restarts, ..Schedule::new(grade) };
        outer.grade = grade;
        self.newton.scale_rho(progress.task.problem, outer.schedule.factor());
        true
    }

    /// A first attempt, after few sweeps: Newton's method on the problem itself. Where sweeps have not brought percussions
    /// nearer to a solution than they were, they run away along what `G` does not see, and it starts where they did.
    pub(crate) fn first_attempt(&mut self, progress: &mut Progress<'_>, matrix: &mut NewtonMatrix) {
        let grade = progress.start_from_best(&mut self.centre);
        if grade > NEARER * progress.first_grade() {
            progress.start_from_first(&mut self.centre);
        }
        let goal = self.inner_goal(progress, grade, 0.0, FIRST);
        let promising = PROMISING * progress.task.stop.tolerance * progress.scale(&self.centre);
        let goal = Goal { shift: SHIFT, promising, patience: FIRST_PATIENCE, ..goal };
        let before = self.newton.factorizations;
        let (_, iterations) = self.newton_from_centre(progress, matrix, goal);
        progress.grade(&self.trial);
        progress.record(Method::Newton, iterations, self.newton.factorizations - before);
    }

    /// A short attempt with little regularisation: it ends the work where `G` has full rank.
    pub(crate) fn attempt(
        &mut self,
        progress: &mut Progress<'_>,
        matrix: &mut NewtonMatrix,
        max_iterations: usize,
    ) {
        let mut grade = progress.start_from_best(&mut self.centre);
        self.newton.scale_rho(progress.task.problem, 1.0);
        let before = self.newton.factorizations;
        let (mut epsilon, mut total) = (1e-4, 0);
        for _ in 0..3 {
            let goal = self.inner_goal(progress, grade, epsilon, max_iterations);
            let (norm, iterations) = self.newton_from_centre(progress, matrix, goal);
            total += iterations;
            let found = progress.grade(&self.trial);
            let ends = progress.is_solved() || progress.task.stop.early();
            if ends || norm > goal.tolerance || found > 0.1 * grade {
                break;
            }
            grade = self.adopt_trial(found);
            epsilon *= 1e-2;
        }
        progress.record(Method::Newton, total, self.newton.factorizations - before);
    }

    /// Newton's method with prox parameters that rise step by step to where the velocity of every contact weighs as much
    /// as its percussion.
    ///
    /// A contact that creeps moves far slower than its load alone would move it, as one does that rubs while a wall
    /// hands back a part of what is left of an approach. Its direction of slip decides its friction nevertheless,
    /// but with `ρ ~ 1/G` the natural map hardly tells that direction: `ρξ` moves the argument of the projection out
    /// of the set by less than what is asked for.
    ///
    /// Where more than that is left to be found, nothing is tried.
    pub(crate) fn attempt_matched(
        &mut self,
        progress: &mut Progress<'_>,
        matrix: &mut NewtonMatrix,
    ) {
        let problem = progress.task.problem;
        let grade = progress.start_from_best(&mut self.centre);
        if !self.may_creep(grade) {
            return;
        }
        let (before, mut total, mut largest) = (self.newton.factorizations, 0, 1.0);
        while largest < MOST_MATCHED && !progress.is_over() {
            largest *= RISE;
            self.newton.match_rho(problem, &self.centre, largest);
            let tolerance = progress.floor() * progress.scale(&self.centre);
            let (shift, max_iterations) = (MATCHED_SHIFT, MATCHED);
            let patience = PATIENCE;
            let promising = 0.0;
            let goal = Goal { epsilon: 0.0, shift, tolerance, promising, max_iterations, patience };
            total += self.newton_from_centre(progress, matrix, goal).1;
            progress.grade(&self.trial);
            self.centre.copy_from_slice(&self.trial);
        }
        self.matched = progress.best_grade();
        progress.record(Method::Newton, total, self.newton.factorizations - before);
    }

    /// Whether contacts that creep may be all that is left to be found, and this was not tried as near to a solution before.
    fn may_creep(&self, grade: f64) -> bool {
        grade < CREEPING.min(self.matched)
    }

    /// Newton's method on the problem itself, its matrices with as much regularisation as rounding has; whether
    /// the limit of iterations ended it.
    pub(crate) fn newton_alone(
        &mut self,
        progress: &mut Progress<'_>,
        matrix: &mut NewtonMatrix,
        max_iterations: usize,
    ) -> bool {
        progress.start_from_best(&mut self.centre);
        self.newton_with_shift(progress, matrix, max_iterations)
    }

    /// The same from given percussions.
    pub(crate) fn newton_from(
        &mut self,
        progress: &mut Progress<'_>,
        matrix: &mut NewtonMatrix,
        start: &[f64],
    ) {
        self.centre.copy_from_slice(start);
        self.newton_with_shift(progress, matrix, FROM_CASE);
    }

    /// The same from the centre.
    fn newton_with_shift(
        &mut self,
        progress: &mut Progress<'_>,
        matrix: &mut NewtonMatrix,
        max_iterations: usize,
    ) -> bool {
        let goal = self.inner_goal(progress, progress.best_grade(), 0.0, max_iterations);
        let goal = Goal { shift: SHIFT, ..goal };
        let before = self.newton.factorizations;
        let (_, iterations) = self.newton_from_centre(progress, matrix, goal);
        progress.grade(&self.trial);
        progress.record(Method::Newton, iterations, self.newton.factorizations - before);
        iterations == max_iterations
    }

    /// Newton's method from the centre, the proximal point of which it looks for, to the trial.
    fn newton_from_centre(
        &mut self,
        progress: &Progress<'_>,
        matrix: &mut NewtonMatrix,
        goal: Goal,
    ) -> (f64, usize) {
        self.trial.copy_from_slice(&self.centre);
        self.newton.solve(&progress.task, matrix, &mut self.trial, &self.centre, goal)
    }

    /// Puts the centre where the iteration has not been led astray: where many sweeps lead or at no percussions.
    fn new_start(&mut self, progress: &mut Progress<'_>, after_sweeps: bool) {
        progress.iterate.percussion.fill(0.0);
        if after_sweeps {
            for k in 1..=LONG_SWEEPS {
                progress.sweep();
                if k % SWEEPS == 0 {
                    progress.grade_sweeps();
                }
                if progress.is_solved() || progress.task.stop.early() {
                    break;
                }
            }
        }
        self.centre.copy_from_slice(progress.iterate.percussion);
    }

    /// Makes the trial the centre, with its grade.
    fn adopt_trial(&mut self, found: f64) -> f64 {
        self.centre.copy_from_slice(&self.trial);
        found
    }

    /// Accuracy of an inner solve: a hundredth of the present defect, more where the outer step is long.
    fn inner_goal(
        &self,
        progress: &Progress<'_>,
        grade: f64,
        epsilon: f64,
        max_iterations: usize,
    ) -> Goal {
        let scale = progress.scale(&self.centre);
        let relative = (0.01 * grade * (10.0 * epsilon).min(1.0)).max(progress.floor());
        let epsilon = epsilon / progress.task.problem.global_rho();
        let (tolerance, patience) = (relative * scale, PATIENCE);
        Goal { epsilon, shift: 0.0, tolerance, promising: 0.0, max_iterations, patience }
    }

    /// Sweeps from the centre, kept if they improve it; the grade of the centre.
    fn sweep_from_centre(&mut self, progress: &mut Progress<'_>, grade: f64) -> f64 {
        progress.iterate.percussion.copy_from_slice(&self.centre);
        for _ in 0..SWEEPS {
            progress.sweep();
            if progress.task.stop.early() {
                break;
            }
        }
        let found = progress.grade_sweeps();
        if found < 0.9 * grade {
            self.centre.copy_from_slice(progress.iterate.percussion);
            return found;
        }
        grade
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The iteration is deterministic: a start that was lost would be lost again.
    #[test]
    fn no_start_is_made_twice() {
        let (mut schedule, mut seen) = (Schedule::new(1.0), Vec::new());
        for _ in 0..STARTS {
            let after_sweeps = schedule.starts_after_sweeps();
            schedule.restart();
            let start = (schedule.turn, after_sweeps);
            assert!(!seen.contains(&start), "{start:?} after {seen:?}");
            seen.push(start);
        }
    }
}

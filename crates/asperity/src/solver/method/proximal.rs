//! Proximal point iteration with Newton's method inside.
//!
//! Each outer step solves the problem with `G + εI` around the last iterate: `ε` falls while the inner
//! solves succeed and rises where they fail. Where inner solves fail repeatedly, the prox parameters of the
//! natural map take turns; sweeps help out.

use super::newton::{Goal, Newton};
use crate::contact::ContactProblem;
use crate::solver::incumbent::Incumbent;
use crate::solver::newton_matrix::NewtonMatrix;
use crate::solver::report::Method;

/// Factors of the prox parameters, which take turns where inner solves fail: hyperstatic problems have percussions a hundred
/// times their loads and need large ones, others small ones.
const FACTORS: [f64; 4] = [10.0, 1.0, 30.0, 3.0];
/// Newton iterations within which `‖F‖` must halve.
pub(crate) const PATIENCE: usize = 25;
/// Newton iterations of an inner solve, and how many count as few and very few: after few `ε` falls, after very few it
/// falls faster.
const INNER: usize = 20;
const FEW: usize = 12;
const VERY_FEW: usize = 4;
/// Sweeps after a failed inner solve, and before a new start.
const SWEEPS: usize = 20;
const LONG_SWEEPS: usize = 1000;
/// Failed inner solves in turn that sweeps have not helped, after which none are made until one succeeds: where a problem has
/// no solution sweeps would take most of the time.
const SWEPT_IN_VAIN: usize = 10;
/// Outer steps that have not halved the natural map after which the iteration starts anew: at this pace all of them would not
/// be enough.
const LOST: usize = 300;
/// Outer steps without a new best after which prox parameters are matched to contacts that creep.
const CREEP: usize = 30;
/// New starts: from no percussions, and from where many sweeps lead.
const STARTS: usize = 2;

/// Regularisation of the matrices of Newton's method alone, relative to the blocks of `G`: elimination among bodies
/// divides by it, and half the digits of the steps are left on either side.
const SHIFT: f64 = 1e-8;
/// Relative `‖F‖`, in tolerances, from which on it is worth while to look whether percussions pass the measure: by that of
/// contacts the last digits of all are not always needed.
const PROMISING: f64 = 100.0;
/// Part of the natural map at the start that sweeps must have left; else they run away along what `G` does not see.
const NEARER: f64 = 0.5;
/// Factor by which matched prox parameters rise, Newton iterations with each, and the largest, at which rounding is
/// all that velocities hold.
const RISE: f64 = 5.0;
const MATCHED: usize = 10;
const MOST_MATCHED: f64 = 1e12;
/// Regularisation of the matrices there, in units of `1/ρ`: without it redundant contacts leave nothing to divide by.
const MATCHED_SHIFT: f64 = 1e-4;
/// Natural map below which contacts that creep may be all that is left to be found.
const CREEPING: f64 = 1e-3;

/// `ε` and the prox parameters from one outer step to the next.
struct Schedule {
    epsilon: f64,
    turn: usize,
    /// Steps for which `ε` does not fall after a failure, and how many there will be after the next one.
    hold: usize,
    patience: usize,
    /// Failed inner solves in turn after which sweeps have not helped.
    swept_in_vain: usize,
}

impl Schedule {
    fn new(grade: f64) -> Self {
        let epsilon = (100.0 * grade).clamp(1e-6, 1e-2);
        Self { epsilon, turn: 0, hold: 0, patience: 2, swept_in_vain: 0 }
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
}

/// Newton's method for the problem itself or for a step of the iteration.
#[derive(Debug, Clone, Default)]
pub(crate) struct ProximalPoint {
    newton: Newton,
    /// The centre of the present step, and what Newton's method makes of it.
    centre: Vec<f64>,
    trial: Vec<f64>,
    /// The centre while prox parameters are matched.
    kept: Vec<f64>,
    /// Natural map that an attempt with matched prox parameters has left.
    matched: f64,
}

impl ProximalPoint {
    /// Buffers for this problem.
    pub(crate) fn prepare(&mut self, problem: &ContactProblem) {
        self.newton.prepare(problem);
        self.matched = f64::INFINITY;
        for list in [&mut self.centre, &mut self.trial, &mut self.kept] {
            list.clear();
            list.resize(problem.rows(), 0.0);
        }
    }

    /// Iterates until the problem is solved, the stop says so or so many outer steps are made; whether these ended it. Where no
    /// step comes nearer any more it starts again somewhere else.
    pub(crate) fn iterate(
        &mut self,
        incumbent: &mut Incumbent<'_>,
        matrix: &mut NewtonMatrix,
        most: usize,
    ) -> bool {
        let before = self.newton.factorizations;
        let mut grade = incumbent.start_from_best(&mut self.centre);
        let (mut schedule, mut steps) = (Schedule::new(grade), 0);
        for start in 0..=STARTS {
            self.newton.scale_rho(incumbent.task.problem, schedule.factor());
            let is_lost = self.follow(incumbent, matrix, &mut schedule, grade, (&mut steps, most));
            if !is_lost || start == STARTS {
                break;
            }
            incumbent.begin_anew();
            self.new_start(incumbent, start > 0);
            // Where percussions hardly matter, steps around the last ones only creep.
            let counted = self.newton.factorizations;
            self.newton_alone(incumbent, matrix, 1.0, (INNER, PATIENCE));
            self.newton.factorizations = counted;
            if incumbent.is_over() {
                break;
            }
            (schedule, grade) = (Schedule { turn: start, ..Schedule::new(1.0) }, 1.0);
        }
        incumbent.record(Method::ProximalPoint, steps, self.newton.factorizations - before);
        steps == most
    }

    /// Iterates from the centre, whose natural map is `grade`; whether no step comes nearer.
    fn follow(
        &mut self,
        incumbent: &mut Incumbent<'_>,
        matrix: &mut NewtonMatrix,
        schedule: &mut Schedule,
        mut grade: f64,
        (steps, most): (&mut usize, usize),
    ) -> bool {
        let problem = incumbent.task.problem;
        let (mut lowest, mut creeps) = (grade, 0);
        let (mut halved, mut lost) = (grade, 0);
        while !incumbent.is_solved() && *steps < most && !incumbent.task.stop.early() {
            *steps += 1;
            let goal = self.inner_goal(incumbent, grade, schedule.epsilon, INNER);
            let (norm, iterations) = self.newton_from_centre(incumbent, matrix, goal);
            let found = incumbent.grade(&self.trial);
            if incumbent.is_solved() || incumbent.is_hopeless() {
                return false;
            }
            creeps = if found < lowest { 0 } else { creeps + 1 };
            lowest = lowest.min(found);
            (halved, lost) = if found < 0.5 * halved { (found, 0) } else { (halved, lost + 1) };
            if lost == LOST {
                return true;
            }
            if creeps == CREEP {
                self.kept.clone_from(&self.centre);
                let before = self.newton.factorizations;
                self.attempt_matched(incumbent, matrix);
                self.newton.factorizations = before;
                self.centre.clone_from(&self.kept);
                self.newton.scale_rho(problem, schedule.factor());
                if incumbent.is_over() {
                    return false;
                }
            }
            if norm <= goal.tolerance {
                grade = self.adopt_trial(found);
                schedule.tighten(iterations);
                continue;
            }
            if schedule.swept_in_vain < SWEPT_IN_VAIN {
                let swept = self.sweep_from_centre(incumbent, grade);
                schedule.swept_in_vain = if swept < grade { 0 } else { schedule.swept_in_vain + 1 };
                grade = swept;
            }
            if found > 0.7 * grade {
                schedule.relax();
                self.newton.scale_rho(problem, schedule.factor());
            } else {
                grade = self.adopt_trial(found);
                schedule.epsilon *= 2.0;
            }
        }
        false
    }

    /// Newton's method on the problem itself, its matrices with as much regularisation as rounding has; whether the limit of
    /// iterations ended it. Where sweeps have not brought percussions nearer to a solution, it starts where they did.
    pub(crate) fn newton(
        &mut self,
        incumbent: &mut Incumbent<'_>,
        matrix: &mut NewtonMatrix,
        (max_iterations, patience): (usize, usize),
    ) -> bool {
        let grade = incumbent.start_from_best(&mut self.centre);
        if !incumbent.has_left(NEARER) {
            self.centre.copy_from_slice(incumbent.task.start);
        }
        self.newton_alone(incumbent, matrix, grade, (max_iterations, patience))
    }

    /// The same from the centre, whose natural map is `grade`.
    fn newton_alone(
        &mut self,
        incumbent: &mut Incumbent<'_>,
        matrix: &mut NewtonMatrix,
        grade: f64,
        (max_iterations, patience): (usize, usize),
    ) -> bool {
        self.newton.scale_rho(incumbent.task.problem, 1.0);
        let goal = self.inner_goal(incumbent, grade, 0.0, max_iterations);
        let promising = PROMISING * incumbent.task.stop.tolerance * incumbent.scale(&self.centre);
        let goal = Goal { shift: SHIFT, promising, patience, ..goal };
        let before = self.newton.factorizations;
        let (_, iterations) = self.newton_from_centre(incumbent, matrix, goal);
        incumbent.grade(&self.trial);
        incumbent.record(Method::Newton, iterations, self.newton.factorizations - before);
        iterations == max_iterations
    }

    /// Newton's method with prox parameters that rise step by step to where the velocity of every contact weighs as much
    /// as its percussion.
    ///
    /// A contact that creeps moves far slower than its load alone would move it, as one does that rubs while a wall
    /// hands back a part of what is left of an approach. Its direction of slip decides its friction nevertheless,
    /// but with `ρ ~ 1/G` the natural map hardly depends on that direction: `ρξ` moves the argument of the projection out
    /// of the set by less than what is asked for.
    ///
    /// Where more than that is left to be found, nothing is tried.
    pub(crate) fn attempt_matched(
        &mut self,
        incumbent: &mut Incumbent<'_>,
        matrix: &mut NewtonMatrix,
    ) {
        let problem = incumbent.task.problem;
        let grade = incumbent.start_from_best(&mut self.centre);
        if !(grade < CREEPING.min(self.matched)) {
            return;
        }
        let (before, mut total, mut largest) = (self.newton.factorizations, 0, 1.0);
        while largest < MOST_MATCHED && !incumbent.is_over() {
            largest *= RISE;
            self.newton.match_rho(problem, &self.centre, largest);
            let tolerance = incumbent.floor() * incumbent.scale(&self.centre);
            let (epsilon, shift, promising) = (0.0, MATCHED_SHIFT, 0.0);
            let (max_iterations, patience) = (MATCHED, PATIENCE);
            let goal = Goal { epsilon, shift, tolerance, promising, max_iterations, patience };
            total += self.newton_from_centre(incumbent, matrix, goal).1;
            incumbent.grade(&self.trial);
            self.centre.copy_from_slice(&self.trial);
        }
        self.matched = incumbent.best_grade();
        incumbent.record(Method::Newton, total, self.newton.factorizations - before);
    }

    /// Newton's method from the centre, the proximal point of which it looks for, to the trial.
    fn newton_from_centre(
        &mut self,
        incumbent: &Incumbent<'_>,
        matrix: &mut NewtonMatrix,
        goal: Goal,
    ) -> (f64, usize) {
        self.trial.copy_from_slice(&self.centre);
        self.newton.solve(&incumbent.task, matrix, &mut self.trial, &self.centre, goal)
    }

    /// Puts the centre where the iteration has not been led astray: where many sweeps lead or at no percussions.
    fn new_start(&mut self, incumbent: &mut Incumbent<'_>, after_sweeps: bool) {
        incumbent.iterate.percussion.fill(0.0);
        if after_sweeps {
            for k in 1..=LONG_SWEEPS {
                incumbent.sweep();
                if k % SWEEPS == 0 {
                    incumbent.grade_sweeps();
                }
                if incumbent.is_solved() || incumbent.task.stop.early() {
                    break;
                }
            }
        }
        self.centre.copy_from_slice(incumbent.iterate.percussion);
    }

    /// Makes the trial the centre, with its grade.
    fn adopt_trial(&mut self, found: f64) -> f64 {
        self.centre.copy_from_slice(&self.trial);
        found
    }

    /// Accuracy of an inner solve: a hundredth of the present defect, more where the outer step is long.
    fn inner_goal(
        &self,
        incumbent: &Incumbent<'_>,
        grade: f64,
        epsilon: f64,
        max_iterations: usize,
    ) -> Goal {
        let scale = incumbent.scale(&self.centre);
        let relative = (0.01 * grade * (10.0 * epsilon).min(1.0)).max(incumbent.floor());
        let epsilon = epsilon / incumbent.task.problem.global_rho();
        let (tolerance, patience) = (relative * scale, PATIENCE);
        Goal { epsilon, shift: 0.0, tolerance, promising: 0.0, max_iterations, patience }
    }

    /// Sweeps from the centre, kept if they improve it; the grade of the centre.
    fn sweep_from_centre(&mut self, incumbent: &mut Incumbent<'_>, grade: f64) -> f64 {
        incumbent.iterate.percussion.copy_from_slice(&self.centre);
        for _ in 0..SWEEPS {
            incumbent.sweep();
            if incumbent.task.stop.early() {
                break;
            }
        }
        let found = incumbent.grade_sweeps();
        if found < 0.9 * grade {
            self.centre.copy_from_slice(incumbent.iterate.percussion);
            return found;
        }
        grade
    }
}

//! Proximal point iteration with Newton's method inside.
//!
//! Each outer step solves the problem with `G + εI` around the last iterate: `ε` falls while the inner
//! solves succeed and rises where they fail. Where inner solves fail repeatedly, the prox parameters of the
//! natural map take turns; sweeps help out.

use super::newton::Goal;
use super::{Many, Method, Run};

/// Factors of the prox parameters. Hyperstatic problems have percussions a hundred times their loads; larger
/// parameters cut the factorisations there by up to ten, and taking turns makes the choice insensitive.
const FACTORS: [f64; 4] = [10.0, 1.0, 30.0, 3.0];
/// Newton iterations of an inner solve, and how many count as few and very few.
const INNER: usize = 20;
const FEW: usize = 12;
const VERY_FEW: usize = 4;
/// Sweeps after a failed inner solve.
const SWEEPS: usize = 20;
/// Sweeps before a new start: some problems only they solve, slowly.
const LONG_SWEEPS: usize = 1000;
/// Outer steps without a new best after which the iteration starts again somewhere else: what led it astray
/// may be its start.
const LOST: usize = 300;
/// New starts without success after which it gives up.
const STARTS: usize = 2 * FACTORS.len();

/// `ε` and the prox parameters from one outer step to the next.
struct Schedule {
    epsilon: f64,
    turn: usize,
    /// Steps for which `ε` does not fall after a failure, and how many there will be after the next one.
    hold: usize,
    patience: usize,
    restarts: usize,
}

impl Schedule {
    fn new(grade: f64) -> Self {
        let epsilon = (100.0 * grade).clamp(1e-6, 1e-2);
        Self { epsilon, turn: 0, hold: 0, patience: 2, restarts: 0 }
    }

    fn factor(&self) -> f64 {
        FACTORS[self.turn]
    }

    /// An inner solve succeeded.
    fn tighten(&mut self, iterations: usize) {
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

    /// A new start, with the next parameters in turn.
    fn restart(&mut self) {
        let turn = self.restarts % FACTORS.len();
        *self = Self { turn, restarts: self.restarts + 1, ..Self::new(1.0) };
    }
}

impl Run<'_, '_> {
    /// Iterates until the problem is solved, the stop says so or `max_iterations` outer steps are made; whether
    /// these are what ended it.
    pub(super) fn proximal_point(&mut self, max_iterations: usize) -> bool {
        let problem = self.problem;
        let mut grade = self.adopt_best();
        let mut schedule = Schedule::new(grade);
        self.many.newton.scale_rho(problem, schedule.factor());
        let before = self.many.newton.factorizations;
        let (mut outer, mut lost, mut lowest) = (0, 0, grade);
        while !self.solved && outer < max_iterations && !self.stop.early() {
            outer += 1;
            let goal = self.inner_goal(grade, schedule.epsilon, INNER);
            let (norm, iterations) = self.newton_from_centre(goal);
            let found = self.grade_trial();
            if self.solved || self.is_hopeless() {
                break;
            }
            lost = if found < lowest { 0 } else { lost + 1 };
            lowest = lowest.min(found);
            if lost == LOST {
                if schedule.restarts == STARTS {
                    break;
                }
                self.new_start(schedule.restarts);
                schedule.restart();
                self.many.newton.scale_rho(problem, schedule.factor());
                (grade, lost) = (1.0, 0);
            } else if norm <= goal.tolerance {
                grade = self.adopt_trial(found);
                schedule.tighten(iterations);
            } else {
                grade = self.sweep_from_centre(grade);
                if found > 0.7 * grade {
                    schedule.relax();
                    self.many.newton.scale_rho(problem, schedule.factor());
                } else {
                    grade = self.adopt_trial(found);
                    schedule.epsilon *= 2.0;
                }
            }
        }
        let factorizations = self.many.newton.factorizations - before;
        self.record(Method::ProximalPoint, outer, factorizations);
        outer == max_iterations
    }

    /// Newton's method from the centre, the proximal point of which it looks for, to the trial.
    pub(super) fn newton_from_centre(&mut self, goal: Goal) -> (f64, usize) {
        let Many { newton, matrix, centre, trial, .. } = &mut *self.many;
        trial.copy_from_slice(centre);
        newton.solve(self.problem, matrix, trial, centre, goal, self.stop)
    }

    /// Puts the centre where the iteration has not been led astray: in turn where many sweeps lead and at
    /// no percussions.
    fn new_start(&mut self, restarts: usize) {
        self.workspace.percussion.fill(0.0);
        if restarts.is_multiple_of(2) {
            for k in 1..=LONG_SWEEPS {
                self.sweep();
                if k % SWEEPS == 0 {
                    self.grade_sweeps();
                }
                if self.solved || self.stop.early() {
                    break;
                }
            }
        }
        self.many.centre.copy_from_slice(&self.workspace.percussion);
    }

    /// Makes the trial the centre, with its grade.
    fn adopt_trial(&mut self, found: f64) -> f64 {
        let Many { centre, trial, .. } = &mut *self.many;
        centre.copy_from_slice(trial);
        found
    }

    /// A short attempt with little regularisation: it ends the work where `G` has full rank.
    pub(super) fn newton_attempt(&mut self, max_iterations: usize) {
        let mut grade = self.adopt_best();
        self.many.newton.scale_rho(self.problem, 1.0);
        let before = self.many.newton.factorizations;
        let (mut epsilon, mut total) = (1e-4, 0);
        for _ in 0..3 {
            let goal = self.inner_goal(grade, epsilon, max_iterations);
            let (norm, iterations) = self.newton_from_centre(goal);
            total += iterations;
            let found = self.grade_trial();
            if self.solved || norm > goal.tolerance || found > 0.1 * grade || self.stop.early() {
                break;
            }
            grade = self.adopt_trial(found);
            epsilon *= 1e-2;
        }
        self.record(Method::Newton, total, self.many.newton.factorizations - before);
    }

    /// Accuracy of an inner solve: a hundredth of the present defect, more where the outer step is long.
    pub(super) fn inner_goal(&self, grade: f64, epsilon: f64, max_iterations: usize) -> Goal {
        let scale = self.scale(&self.many.centre);
        let relative = (0.01 * grade * (10.0 * epsilon).min(1.0)).max(self.floor());
        let epsilon = epsilon / self.problem.global_rho();
        Goal { epsilon, shift: 0.0, tolerance: relative * scale, max_iterations }
    }

    /// Sweeps from the centre, kept if they improve it; the grade of the centre.
    fn sweep_from_centre(&mut self, grade: f64) -> f64 {
        self.workspace.percussion.copy_from_slice(&self.many.centre);
        for _ in 0..SWEEPS {
            self.sweep();
            if self.stop.early() {
                break;
            }
        }
        let found = self.grade_sweeps();
        if found < 0.9 * grade {
            self.many.centre.copy_from_slice(&self.workspace.percussion);
            return found;
        }
        grade
    }
}

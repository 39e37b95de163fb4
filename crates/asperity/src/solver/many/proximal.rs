//! Proximal point iteration with Newton's method inside.
//!
//! Each outer step solves the problem with `G + εI` around the last iterate: `ε` falls while the inner
//! solves succeed and rises where they fail. Where inner solves fail repeatedly, the prox parameters of the
//! natural map take turns; sweeps help out.

use super::newton::Goal;
use super::{Many, Method, Run, runaway};

/// Factors of the prox parameters. Hyperstatic problems have percussions a hundred times their loads; larger
/// parameters cut the factorisations there by up to ten, and taking turns makes the choice insensitive.
const FACTORS: [f64; 4] = [10.0, 1.0, 30.0, 3.0];
/// Newton iterations of an inner solve, and how many count as few and very few.
const INNER: usize = 20;
const FEW: usize = 12;
const VERY_FEW: usize = 4;
/// Sweeps after a failed inner solve.
const SWEEPS: usize = 20;
/// Outer steps without a new best after which the iteration starts again, from no percussions at all: what
/// led it astray may be its start.
const LOST: usize = 300;
/// New starts without success after which it gives up.
const STARTS: usize = 2 * FACTORS.len();

impl Run<'_, '_> {
    /// Iterates until the problem is solved, the stop says so or `max_iterations` outer steps are made.
    pub(super) fn proximal_point(&mut self, max_iterations: usize) {
        let problem = self.problem;
        let unit = 1.0 / problem.global_rho();
        let mut grade = self.adopt_best();
        let mut epsilon = (100.0 * grade).clamp(1e-6, 1e-2);
        let (mut hold, mut patience, mut turn) = (0_usize, 2, 0);
        self.many.newton.scale_rho(problem, FACTORS[turn]);
        let before = self.many.newton.factorizations;
        let (mut outer, mut lost, mut restarts) = (0, 0, 0);
        let mut lowest = grade;
        while !self.solved && outer < max_iterations && !self.stop.early() {
            outer += 1;
            let goal = self.inner_goal(grade, epsilon, unit, INNER);
            let centre = std::mem::take(&mut self.many.centre);
            let mut trial = std::mem::take(&mut self.many.trial);
            trial.copy_from_slice(&centre);
            let (norm, iterations) = self.newton(&mut trial, &centre, goal);
            (self.many.centre, self.many.trial) = (centre, trial);
            let found = self.grade_trial();
            if self.solved {
                break;
            }
            lost = if found < lowest { 0 } else { lost + 1 };
            lowest = lowest.min(found);
            if lost == LOST && restarts == STARTS {
                break;
            }
            if lost == LOST {
                self.many.centre.fill(0.0);
                turn = restarts % FACTORS.len();
                self.many.newton.scale_rho(problem, FACTORS[turn]);
                restarts += 1;
                (grade, epsilon, hold, patience, lost) = (1.0, 1e-2, 0, 2, 0);
                continue;
            }
            if norm > goal.tolerance {
                grade = self.sweep_from_centre(grade);
                if found > 0.7 * grade {
                    turn = (turn + 1) % FACTORS.len();
                    self.many.newton.scale_rho(problem, FACTORS[turn]);
                    epsilon = (4.0 * epsilon).min(1e3);
                    patience = (2 * patience).min(16);
                    hold = patience;
                } else {
                    self.many.centre.copy_from_slice(&self.many.trial);
                    grade = found;
                    epsilon *= 2.0;
                }
                continue;
            }
            self.many.centre.copy_from_slice(&self.many.trial);
            grade = found;
            if self.runs_away() {
                break;
            }
            hold = hold.saturating_sub(1);
            if hold == 0 && iterations <= FEW {
                let cut = if iterations <= VERY_FEW { 10.0 } else { 4.0 };
                epsilon = (epsilon / cut).max(1e-10);
            }
        }
        let factorizations = self.many.newton.factorizations - before;
        self.record(Method::ProximalPoint, outer, factorizations);
    }

    /// Whether percussions grow without bound and yet some contact goes on approaching: there is no solution.
    fn runs_away(&mut self) -> bool {
        let Many { centre, velocity, .. } = &mut *self.many;
        self.problem.velocity(centre, velocity);
        self.runs_away = runaway(self.problem, centre, velocity);
        self.runs_away.is_some()
    }

    /// A short attempt with little regularisation: it ends the work where `G` has full rank.
    pub(super) fn newton_attempt(&mut self, max_iterations: usize) {
        let problem = self.problem;
        let unit = 1.0 / problem.global_rho();
        let mut grade = self.adopt_best();
        self.many.newton.scale_rho(problem, 1.0);
        let before = self.many.newton.factorizations;
        let mut epsilon = 1e-4;
        let mut total = 0;
        for _ in 0..3 {
            let goal = self.inner_goal(grade, epsilon, unit, max_iterations);
            let centre = std::mem::take(&mut self.many.centre);
            let mut trial = std::mem::take(&mut self.many.trial);
            trial.copy_from_slice(&centre);
            let (norm, iterations) = self.newton(&mut trial, &centre, goal);
            (self.many.centre, self.many.trial) = (centre, trial);
            total += iterations;
            let found = self.grade_trial();
            if self.solved || norm > goal.tolerance || found > 0.1 * grade || self.stop.early() {
                break;
            }
            self.many.centre.copy_from_slice(&self.many.trial);
            grade = found;
            epsilon *= 1e-2;
        }
        self.record(Method::Newton, total, self.many.newton.factorizations - before);
    }

    /// Accuracy of an inner solve: a hundredth of the present defect, more where the outer step is long.
    pub(super) fn inner_goal(
        &self,
        grade: f64,
        epsilon: f64,
        unit: f64,
        max_iterations: usize,
    ) -> Goal {
        let scale = self.scale(&self.many.centre);
        let relative = (0.01 * grade * (10.0 * epsilon).min(1.0)).max(self.floor());
        Goal { epsilon: epsilon * unit, tolerance: relative * scale, max_iterations }
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

//! Attempts of steps, and states inside them.

use crate::integrator::event::collocation::{NewtonGoal, STAGES, SlidingStart, Tableau};
use crate::integrator::event::contact_problem::{Solving, redundancy};
use crate::integrator::event::dynamics::SlidingForces;
use crate::integrator::event::integration::impact::touches;
use crate::integrator::event::integration::variables::Integration;
use crate::integrator::event::state::EvaluationError;
use crate::vectors::largest;

/// Why there is no state inside a step.
pub(crate) enum StateError {
    /// Newton's method has not converged.
    Diverged,
    Evaluation(EvaluationError),
}

impl From<EvaluationError> for StateError {
    fn from(error: EvaluationError) -> Self {
        Self::Evaluation(error)
    }
}

impl Integration<'_> {
    /// Newton's method from the continued accelerations of the step before, or else from constant ones; whether it converged.
    pub(crate) fn attempt_step(&mut self, h: f64) -> Result<bool, EvaluationError> {
        let goal = self.newton_goal(h, self.largest_acceleration(h));
        if self.smooth && h <= 2.0 * self.last.h {
            self.step.guess_from(h, &self.last, self.last.h);
            if self.solve(h, goal, self.last.points.used)? {
                return Ok(true);
            }
        }
        self.step.guess_line(h, &self.a0, self.slope.as_deref());
        self.solve(h, goal, false)
    }

    fn solve(
        &mut self,
        h: f64,
        goal: NewtonGoal,
        with_points: bool,
    ) -> Result<bool, EvaluationError> {
        let sliding = SlidingStart { forces: &self.sliding, with_points };
        self.step.solve(&mut self.dynamics, &self.state, h, goal, sliding)
    }

    /// Evaluates the dynamics at a stage of the attempt.
    pub(crate) fn evaluate_stage(&mut self, stage: usize) -> Result<(), EvaluationError> {
        let n = self.dynamics.n;
        let (t, own) = (self.state.t + Tableau::radau().c[stage] * self.step.h, stage * n..);
        let (q, u) = (&self.step.q[own.clone()][..n], &self.step.u[own][..n]);
        self.step.points.apply(&mut self.dynamics, stage);
        let solving = Solving { memory: &self.memory, observer: self.observer, t };
        let updated = SlidingForces::Updated;
        let evaluated = redundancy::evaluate(&mut self.dynamics, q, u, updated, &solving);
        self.dynamics.direction_points.clear();
        evaluated
    }

    /// Makes the step to another time of the attempt, into `probe`, with the full order; evaluates the dynamics at its end.
    pub(crate) fn solve_to(&mut self, h: f64) -> Result<(), StateError> {
        let goal = self.newton_goal(self.step.h, largest(&self.step.a));
        self.probe.guess_from(h, &self.step, 0.0);
        let sliding = SlidingStart { forces: &self.sliding, with_points: self.step.points.used };
        if !self.probe.solve(&mut self.dynamics, &self.state, h, goal, sliding)? {
            return Err(StateError::Diverged);
        }
        self.probe.points.apply(&mut self.dynamics, STAGES - 1);
        let t = self.state.t + h;
        let (q, u) = (self.probe.end(&self.probe.q), self.probe.end(&self.probe.u));
        let sliding_forces =
            if h == 0.0 && self.starting { SlidingForces::Kept } else { SlidingForces::Updated };
        let solving = Solving { memory: &self.memory, observer: self.observer, t };
        let evaluated = redundancy::evaluate(&mut self.dynamics, q, u, sliding_forces, &solving);
        self.dynamics.direction_points.clear();
        Ok(evaluated?)
    }

    /// Contacts without load that others have kept closed, and do no more, have opened.
    fn part_unloaded_contacts(&mut self) {
        for contact in &mut self.dynamics.contacts {
            contact.unloaded &= touches(contact);
        }
    }

    /// Takes the end of the attempt, or of the last step by [`solve_to`](Self::solve_to), as the present state.
    pub(crate) fn take_end(&mut self, t: f64, of_attempt: bool) -> Result<(), EvaluationError> {
        let step = if of_attempt { &self.step } else { &self.probe };
        let (h, growth_rate) = (step.h, step.growth_rate);
        self.state.t = t;
        self.state.q.copy_from_slice(step.end(&step.q));
        self.state.u.copy_from_slice(step.end(&step.u));
        // The end of a step is its last stage, whose acceleration is known as well as velocities are. Where a slip comes to
        // its end with its acceleration, rounding of the slip turns the sliding force by more than the acceleration is.
        if h > 0.0 {
            self.a0.copy_from_slice(step.end(&step.a));
        } else {
            self.a0.copy_from_slice(&self.dynamics.acceleration);
        }
        self.keep_sliding();
        self.slope = None;
        self.step_size.account_for(&mut self.dynamics, &self.state, h);
        self.part_unloaded_contacts();
        if h > 0.0 {
            self.motion.steps += 1;
            self.step_size.step_taken(&self.dynamics, h, growth_rate);
        }
        self.dynamics.widen_stencil(&self.state)
    }
}

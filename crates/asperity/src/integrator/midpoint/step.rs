//! One step.

use std::cell::Cell;

use super::closed::Change;
use super::outcome::StepError;
use super::rated::Correction;
use super::stepper::Stepper;
use crate::contact::{ContactRows, Memory};
use crate::solver::{self, Given, Shares, SolveReport, Status, Stop};
use crate::system::Step;
use crate::vectors::{are_finite, largest, square};

/// Solves of ordinary cost after which the search for factors of the speed at the end of the step gives up. One or two
/// suffice while contacts do not disturb each other.
const MOST_CORRECTIONS: usize = 120;
/// Corrections after which the search is for solutions in which speed and factor of every contact agree by itself, and
/// after which factors are kept within bounds. Half of a round has bounds; then it begins anew.
const UNAIDED: usize = 6;
const SETTLING: usize = 12;
const WHOLE_CORRECTIONS: usize = 30;
const ROUND: usize = 2 * WHOLE_CORRECTIONS;
/// Residual that is asked for after a solve of the same step that did not come farther, over what that one has left: a
/// solver goes through all that it can before it gives up, which a step would pay for with every correction.
const LEFT_OVER: f64 = 2.0;
/// Iterations of a solve that count as one correction: those that contacts without solutions at a factor in between, or
/// with solutions that are hard to find, take for thousands of others are no reason to go on.
const ORDINARY: usize = 100;

impl Stepper<'_> {
    /// One step, whether or not its contact problem is solved to the tolerance: the report says how it was.
    ///
    /// # Errors
    ///
    /// [`StepError`] if the system fails or its mass matrix is not positive definite, and if the contact problem or the
    /// new state is not finite.
    pub fn step(&mut self) -> Result<SolveReport, StepError> {
        self.step_unless(&|| false, true)
    }

    /// One step, unless `cancelled` gives it up, or its contact problem is not solved to the tolerance and `keep_unsolved`
    /// does not take what was found: the state is then the one before the step, to the bit.
    ///
    /// It is asked again and again while the contact problem is being solved, and should be quick to answer.
    ///
    /// # Errors
    ///
    /// [`StepError::Cancelled`] if the step was given up; else as [`step`](Self::step).
    pub fn step_unless(
        &mut self,
        cancelled: &dyn Fn() -> bool,
        keep_unsolved: bool,
    ) -> Result<SolveReport, StepError> {
        let updated = self.update();
        // Also after an error, so that the memory fits the contacts and the run can go on from before the step.
        self.closed.carry_over(&mut self.memory);
        if updated.is_err() {
            self.closed.ready = false;
        }
        match updated? {
            Change::None => {}
            Change::Operator => self.workspace.refresh(&self.closed.problem),
            Change::Contacts => {
                self.workspace.prepare(&self.closed.problem);
                self.shares = Shares::default();
            }
        }
        self.check_problem()?;
        std::mem::swap(&mut self.before, &mut self.memory);
        let was_cancelled = Cell::new(false);
        let ask = || {
            was_cancelled.set(was_cancelled.get() || cancelled());
            was_cancelled.get()
        };
        let mut report = self.solve(Stop { cancelled: Some(&ask), ..Stop::at(self.tolerance) });
        let wedged = self.assembly.wedged(&self.closed.problem, &self.memory.percussion);
        if let (Status::Converged, Some(contact)) = (report.status, wedged) {
            (report.status, report.worst_contact) = (Status::Unbounded, contact);
        }
        let solved = report.status == Status::Converged;
        let given_up = was_cancelled.get() && !solved;
        if given_up || !(solved || keep_unsolved) {
            self.take_back();
            return if given_up {
                Err(StepError::Cancelled { time: self.time() })
            } else {
                Ok(report)
            };
        }
        let Self { system, assembly, memory, dt, q, u, .. } = self;
        let moved = assembly.finish(*system, &memory.percussion, *dt, q, u);
        if let Err(error) = moved {
            self.take_back();
            return Err(error.into());
        }
        let Self { outputs, closed, memory, workspace, assembly, .. } = self;
        outputs.keep(closed, memory, &workspace.velocity, assembly.factors_of_forces());
        self.steps += 1;
        self.check_state()?;
        Ok(report)
    }

    /// Contacts remember what they did before a step that is not made.
    #[cold]
    fn take_back(&mut self) {
        self.memory.copy_from(&self.before);
    }

    /// The contact problem of the step.
    #[inline]
    fn update(&mut self) -> Result<Change, StepError> {
        let midpoint = self.origin + (self.steps as f64 + 0.5) * self.dt;
        let step = Step { midpoint, dt: self.dt, q: &self.q, u: &self.u };
        self.assembly.update(self.system, &step, &mut self.closed)
    }

    /// Solves the contact problem, again and again where factors of the friction follow from the solution.
    #[inline]
    fn solve(&mut self, stop: Stop<'_>) -> SolveReport {
        let Self { solver, closed, assembly, memory, before, workspace, shares, .. } = self;
        if assembly.factors().rises() {
            return self.solve_with_rising_factors(stop);
        }
        let report = solver.solve_from(&closed.problem, stop, before, memory, workspace);
        if closed.problem.is_uncoupled() || report.status != Status::Converged {
            return report;
        }
        let (history, (_, by_place)) = (&before.states[..], assembly.factors_of_forces());
        let given = Given { report: &report, history, by_place };
        shares.find(&closed.problem, stop, &given, memory, workspace).unwrap_or(report)
    }

    #[inline(never)]
    fn solve_with_rising_factors(&mut self, stop: Stop<'_>) -> SolveReport {
        let Self { system, solver, closed, assembly, memory, before, workspace, .. } = self;
        memory.copy_from(before);
        let (mut iterations, mut correction, mut effort) = (0, 0, 0);
        let (mut settled, mut following) = (false, false);
        // What the solver has left over in this step though more was asked for.
        let mut attained: f64 = 0.0;
        loop {
            // The error of a solve must not hide the defect of the factors, which stiff factors of one body magnify.
            let part = if correction < UNAIDED { 0.1 } else { 1e-3 };
            let asked = (part * stop.tolerance).max(LEFT_OVER * attained).min(stop.tolerance);
            let sharp = Stop { tolerance: asked, ..stop };
            // Where contacts were moved to solutions one by one, that may be the solution of all.
            let graded = settled.then(|| solver::grade(&closed.problem, sharp, memory, workspace));
            let mut report = match graded.filter(|report| report.status == Status::Converged) {
                Some(report) => report,
                None => solver.solve_prepared(&closed.problem, sharp, memory, workspace),
            };
            effort += 1 + report.iterations / ORDINARY;
            iterations += report.iterations;
            report.iterations = iterations;
            let runs_away = matches!(report.status, Status::NoSolution | Status::Unbounded);
            let solved = !runs_away && report.residual <= stop.tolerance;
            let ends = effort > MOST_CORRECTIONS || stop.cancelled.is_some_and(|ask| ask());
            if !solved {
                if ends || !following && correction >= UNAIDED {
                    return report;
                }
                // A factor in between may have no solution, or none that is found.
                correction = correction.max(UNAIDED);
            }
            let factors = assembly.factors();
            let (mut defect, mut contact) = (f64::INFINITY, report.worst_contact);
            if solved {
                if report.status != Status::Converged {
                    attained = attained.max(report.residual);
                }
                report.status = Status::Converged;
                let Memory { percussion, states } = &*memory;
                let velocity = &workspace.velocity;
                (defect, contact) = factors.defect(&closed.problem, percussion, velocity, states);
            }
            report.residual = report.residual.max(defect);
            if defect <= stop.tolerance {
                if following {
                    report.ambiguous = factors.several();
                    for (state, before) in memory.states.iter_mut().zip(&before.states) {
                        *state = before.after(state.phase, state.slip);
                    }
                }
                return report;
            }
            if ends {
                // No option of the user sets the number of corrections.
                let status = Status::Stalled;
                return SolveReport { status, worst_contact: contact, ..report };
            }
            following &= solved && !correction.is_multiple_of(WHOLE_CORRECTIONS);
            let place = correction % ROUND;
            settled = place < WHOLE_CORRECTIONS && place % SETTLING == UNAIDED;
            if settled {
                let states = &before.states;
                following = factors.settle(&closed.problem, states, stop, memory, workspace);
                settled = following;
            } else if solved {
                let kind = match place {
                    _ if following => Correction::Following,
                    ..WHOLE_CORRECTIONS => Correction::Whole,
                    _ => Correction::Bounded,
                };
                factors.apply_correction(&closed.problem, kind, &mut memory.percussion);
            }
            if !following {
                // The states before the step decide between several solutions, whatever was found meanwhile.
                memory.states.clone_from(&before.states);
            } else if !settled {
                factors.follow(&closed.problem, &mut memory.states);
            }
            assembly.fill(*system, closed);
            workspace.refresh(&closed.problem);
            correction += 1;
        }
    }

    #[inline]
    fn check_problem(&self) -> Result<(), StepError> {
        if are_finite(self.closed.problem.free_velocity()) { Ok(()) } else { Err(self.broken()) }
    }

    /// The contact whose free velocities are not finite.
    #[cold]
    fn broken(&self) -> StepError {
        let problem = &self.closed.problem;
        let broken = |contact: &ContactRows| !are_finite(&problem.free_velocity()[contact.rows()]);
        let broken = problem.contacts().iter().position(broken);
        let contact = broken.map_or(0, |place| self.closed.active[place]);
        StepError::NotFiniteContact { time: self.time(), contact }
    }

    #[inline]
    fn check_state(&mut self) -> Result<(), StepError> {
        let is_slow = square(&self.u) < self.reversals.bound;
        if is_slow && are_finite(&self.q) { Ok(()) } else { self.check_growth() }
    }

    /// Refuses a state that is not finite, with its first such coordinate, and one that diverges, with the fastest.
    #[cold]
    fn check_growth(&mut self) -> Result<(), StepError> {
        let time = self.time();
        let broken = |state: &[f64]| state.iter().position(|v| !v.is_finite());
        if let Some(coordinate) = broken(&self.u).or_else(|| broken(&self.q)) {
            return Err(StepError::NotFinite { time, coordinate });
        }
        let (before, after) = self.assembly.change();
        if self.reversals.look_at(self.steps, before, after) {
            let coordinate = self.u.iter().map(|u| u.abs()).position(|u| u == largest(&self.u));
            return Err(StepError::Reverses { time, coordinate: coordinate.unwrap_or(0) });
        }
        Ok(())
    }
}

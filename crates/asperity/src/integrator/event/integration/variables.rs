//! Everything that changes during an integration.

use crate::contact::{ContactState, Phase};
use crate::integrator::event::collocation::{Accuracy, DenseOutput, NewtonGoal, Step, StepSize};
use crate::integrator::event::contact_problem::{Solving, redundancy};
use crate::integrator::event::dynamics::{Chart, ContactVariables, Dynamics, ROWS, SlidingForces};
use crate::integrator::event::event_function::{NODES, border_function, contact_event_function};
use crate::integrator::event::motion::{Event, EventKind, Motion};
use crate::integrator::event::options::Options;
use crate::integrator::event::outcome::Outcome;
use crate::integrator::event::resolution::NOTHING;
use crate::integrator::event::state::{EvaluationError, Scale, State};
use crate::integrator::observer::Observer;
use crate::system::{Break, Configuration, InitialState, MotionBounds, System};
use crate::vectors::largest;

/// Why the integration ends here, if it does.
pub(crate) type Ending = Result<Option<Outcome>, EvaluationError>;

/// What an integration does next, found before it is done.
pub(crate) enum Next {
    /// The attempt is taken, up to this time.
    Step(f64),
    /// An event in the attempt.
    Event(Located),
    /// Slips of these contacts end, after a time from the present state.
    EndOfSlips { contacts: Vec<usize>, after: f64 },
    /// A slipping contact that no longer resists.
    Paradox(usize),
    /// The end of a smooth piece of functions of time, or of the motion.
    EndOfPiece(f64),
    /// The motion does not get on, or is interrupted.
    Ended(Outcome),
}

/// An event whose time is known.
pub(crate) struct Located {
    /// The contact, or for the section the number of contacts.
    pub(crate) number: usize,
    /// Time from the start of the step, and how well it is known.
    pub(crate) at: f64,
    pub(crate) width: f64,
    /// Where all steps are kept, the contacts with the last forces before it that all of them could carry, if any were found.
    pub(crate) carried: Vec<ContactVariables>,
}

/// The numbers of steps at one time, with which those at a later time are compared.
#[derive(Default)]
pub(crate) struct Progress {
    pub(crate) steps: usize,
    pub(crate) rejected_steps: usize,
    pub(crate) t: f64,
}

/// An integration and all its buffers.
pub(crate) struct Integration<'a> {
    pub(crate) options: &'a Options,
    pub(crate) dynamics: Dynamics<'a>,
    pub(crate) state: State,
    /// Velocity that rounding of the loads gives until the end: it counts as none at the beginning.
    pub(crate) rounded_velocity: f64,
    /// What the contacts did last.
    pub(crate) memory: Vec<ContactState>,
    pub(crate) step_size: StepSize,
    pub(crate) motion: Motion,
    /// Accelerations at the present state, and where a slip begins without a jump of them their rate.
    pub(crate) a0: Vec<f64>,
    pub(crate) slope: Option<Vec<f64>>,
    /// The change of a velocity that turns the slowest of the slips at the present state by about one.
    pub(crate) slowest_slip: f64,
    /// Forces of sliding contacts for unit normal force at the present state.
    pub(crate) sliding: Vec<[f64; 3]>,
    /// The present attempt, the step before, and steps from the same start to other times.
    pub(crate) step: Step,
    pub(crate) last: Step,
    pub(crate) probe: Step,
    /// Whether a slip begins at the present state.
    pub(crate) starting: bool,
    /// How often the first step has been shortened for an event far too early in it.
    pub(crate) shortened: u8,
    /// Whether the step before was of the same modes, so that its accelerations can be continued.
    pub(crate) smooth: bool,
    /// Whether the Jacobian can be used again, and the length of the step for which it was computed.
    pub(crate) linearised: Option<f64>,
    /// Whether the dynamics are where a rejected attempt has left them.
    pub(crate) stale: bool,
    /// The end of the smooth piece of functions of time in which the motion is, if it has one.
    pub(crate) next_break: Option<Break>,
    /// Events after which the integration does not give up: kinks, and crossings of a section beyond which it goes on.
    pub(crate) uncounted: usize,
    /// Event functions at the present state, contacts first, then the section, then where some contact has a map of friction
    /// the borders that contacts cross; those along the attempt.
    pub(crate) event_values: Vec<f64>,
    pub(crate) stage_values: Vec<[f64; NODES]>,
    /// The places of contacts along the attempt, where some have a map of friction.
    pub(crate) stage_places: Vec<[[f64; 2]; NODES]>,
    /// Bounds on the motion along the attempt.
    pub(crate) bounds: MotionBounds,
    /// Number of the next sample, what samples are read from, and the last one.
    pub(crate) samples: usize,
    pub(crate) dense_output: DenseOutput,
    pub(crate) sampled: State,
    pub(crate) observer: &'a Observer<'a, f64>,
    /// What comes next, whether samples within have left the dynamics elsewhere, and whether the dense output is the motion
    /// until then.
    pub(crate) next: Option<Next>,
    pub(crate) interpolated: bool,
    pub(crate) is_dense: bool,
    /// The end of slips that the last step has shown.
    pub(crate) ending: Option<Next>,
    pub(crate) progress: Progress,
    /// The length of the attempt by the errors alone.
    pub(crate) wanted: f64,
}

impl<'a> Integration<'a> {
    pub(crate) fn new(
        system: &'a dyn System,
        start: &InitialState,
        options: &'a Options,
        observer: &'a Observer<'a, f64>,
    ) -> Self {
        let (n, contacts) = (system.dof(), system.contacts().len());
        let (chart, mut state) = Chart::new(system, &start.q, &start.u);
        state.t = options.t_start;
        let at = Configuration::new(options.t_start, &start.q);
        let has_map = (0..contacts).any(|i| system.friction_place(&at, i).is_some());
        let borders = if has_map { contacts } else { 0 };
        let dynamics = Dynamics::new(system, chart, options.t_start..options.t_end);
        Self {
            options,
            state,
            rounded_velocity: 0.0,
            memory: vec![ContactState::default(); contacts],
            step_size: StepSize::new(options.tolerance, contacts),
            motion: Motion::new(&dynamics),
            dynamics,
            a0: vec![0.0; n],
            slope: None,
            slowest_slip: f64::INFINITY,
            sliding: vec![[0.0; 3]; contacts],
            step: Step::new(n),
            last: Step::new(n),
            probe: Step::new(n),
            starting: false,
            shortened: 0,
            smooth: false,
            linearised: None,
            stale: false,
            next_break: None,
            uncounted: 0,
            event_values: vec![0.0; contacts + 1 + borders],
            stage_values: vec![[0.0; NODES]; contacts + 1 + borders],
            stage_places: vec![[[0.0; 2]; NODES]; borders],
            bounds: MotionBounds::default(),
            samples: 1,
            dense_output: DenseOutput::new(n),
            sampled: State { t: 0.0, q: vec![0.0; n], u: vec![0.0; n] },
            observer,
            next: None,
            interpolated: false,
            is_dense: false,
            ending: None,
            progress: Progress::default(),
            wanted: 0.0,
        }
    }

    /// Evaluates the dynamics at the present state.
    pub(crate) fn evaluate(
        &mut self,
        sliding_forces: SlidingForces,
    ) -> Result<(), EvaluationError> {
        let State { t, q, u } = &self.state;
        let solving = Solving { memory: &self.memory, observer: self.observer, t: *t };
        redundancy::evaluate(&mut self.dynamics, q, u, sliding_forces, &solving)
    }

    /// Tries again with a shorter step.
    pub(crate) fn reject(&mut self, h: f64) -> Option<Outcome> {
        self.step_size.h = h;
        (self.linearised, self.stale) = (None, true);
        self.motion.rejected_steps += 1;
        None
    }

    /// The largest known acceleration until the time `h`; at the beginning of a slip from rest it is zero.
    pub(crate) fn largest_acceleration(&self, h: f64) -> f64 {
        largest(&self.a0) + h * self.slope.as_deref().map_or(0.0, largest)
    }

    /// A relative error that is aimed at, with what decides whether rounding allows it.
    pub(crate) fn accuracy(&self, goal: f64) -> Accuracy {
        let (load, reach) = (self.dynamics.rounded_load(), self.dynamics.time_parts.reach);
        Accuracy { goal, load, reach }
    }

    /// The scale of errors of Newton's method in a step of length `h` with accelerations up to `largest`.
    pub(crate) fn newton_scale(&self, h: f64, largest: f64) -> Scale {
        self.step_size.scale(h, largest, self.accuracy(self.step_size.newton))
    }

    /// The goal of Newton's method in a step of length `h` with accelerations up to `largest`.
    pub(crate) fn newton_goal(&self, h: f64, largest: f64) -> NewtonGoal {
        let scale = self.newton_scale(h, largest);
        NewtonGoal::new(self.step_size.newton, scale, self.slowest_slip)
    }

    /// Keeps the sliding forces of the present state, at which the dynamics have been evaluated.
    pub(crate) fn keep_sliding(&mut self) {
        for (kept, contact) in self.sliding.iter_mut().zip(&self.dynamics.contacts) {
            *kept = contact.sliding;
        }
    }

    pub(crate) fn modes(&self) -> Vec<Option<Phase>> {
        self.dynamics.contacts.iter().map(|contact| Some(contact.mode)).collect()
    }

    /// `γ_N`.
    pub(crate) fn approach(&self, contact: usize) -> f64 {
        self.dynamics.velocity(ROWS * contact, &self.state.u)
    }

    /// A normal velocity that counts as none.
    pub(crate) fn zero_velocity(&self) -> f64 {
        NOTHING * self.step_size.speed()
    }

    /// Keeps the present state.
    pub(crate) fn record(&mut self) {
        self.motion.record(&mut self.dynamics, &self.state);
    }

    pub(crate) fn record_event(
        &mut self,
        contact: Option<usize>,
        kind: EventKind,
        ambiguous: bool,
    ) {
        let time = self.state.t;
        self.motion.events.push(Event { time, contact, kind, phase: None, ambiguous });
    }

    /// An event function at the evaluated state: of a contact, of the section, whose number is that of the contacts, or of the
    /// borders that a contact crosses.
    pub(crate) fn event_function(&self, number: usize, q: &[f64], u: &[f64]) -> f64 {
        match &self.options.section {
            Some(section) if number == self.memory.len() => {
                let (q, u) = self.dynamics.chart.to_system(q, u);
                section.height(&q, &u)
            }
            _ if number == self.memory.len() => -1.0,
            _ if number > self.memory.len() => {
                border_function(&self.dynamics, number - self.memory.len() - 1)
            }
            _ => contact_event_function(&self.dynamics, number),
        }
    }

    /// Sets the event functions to those at the evaluated state: no contact that has just been decided on has a positive one.
    /// `jumped` says whether velocities may have jumped, over the section too.
    pub(crate) fn reset_event_functions(&mut self, jumped: bool) {
        for contact in 0..self.memory.len() {
            self.event_values[contact] = contact_event_function(&self.dynamics, contact).min(0.0);
        }
        for contact in 0..self.stage_places.len() {
            let value = border_function(&self.dynamics, contact).min(0.0);
            self.event_values[self.memory.len() + 1 + contact] = value;
            self.stage_places[contact][0] = self.dynamics.contacts[contact].place;
        }
        if let Some(section) = &self.options.section {
            let (q, u) = self.dynamics.chart.to_system(&self.state.q, &self.state.u);
            let height = section.height(&q, &u);
            let on = height.abs() <= NOTHING * section.size(&q, &u);
            let last = &mut self.event_values[self.memory.len()];
            *last = match *last < 0.0 {
                // Arrives from below, or has got above: the next step crosses it at its start.
                true if on || (jumped && self.state.t > section.after) => {
                    height.min(-f64::MIN_POSITIVE)
                }
                // Starts on it: does not cross it there.
                false if on => 0.0,
                _ => height,
            };
        }
    }
}

//! Runs of time stepping side by side in the lanes of wide registers.
//!
//! A lane takes runs of linear systems of two velocities and one contact with a given normal force and a law of ellipses
//! or superellipses. Where a step asks for more than stick, or than Newton's method from the last slip with a proof that
//! there is no other solution, the stepper makes it, lane by lane, and so it does where a sample is kept. A lane knows
//! nothing of its neighbours: what is computed is the same to the bit for any number of lanes. A run that fails is made
//! again without lanes, so that what is reported is what it comes to by itself.
//!
//! | file | concept |
//! |---|---|
//! | `vector.rs` | numbers and truth values of several runs |
//! | `kernel.rs` | a time step of several runs: the equations |
//! | `newton.rs` | Newton's method for a direction |
//! | `ellipses.rs`, `superellipses.rs` | the slip equation of both kinds of laws |
//! | `plan.rs` | from a system to the constants of its step, and between its states and those of lanes |

mod ellipses;
mod kernel;
mod newton;
mod plan;
mod superellipses;
mod vector;

use pulp::{Simd, WithSimd};

use self::ellipses::Ellipses;
use self::kernel::{Coefficients, Sets, State};
use self::plan::Plan;
use self::superellipses::Superellipses;
use self::vector::{MOST, Mask, Number, Pair};
use super::Lanes;
use super::keep::Keep;
use super::reduction::Reduction;
use super::workers::Stop;
use crate::contact::Phase;
use crate::integrator::midpoint::{self, StepError, Stepper};
use crate::integrator::observer::{MOST_UNSEEN, Observer};
use crate::simulate::{AT_REST, Loop, Options, Outcome};
use crate::system::{InitialState, System};
use crate::trajectory::Trajectory;

/// A run in a lane.
pub(super) struct Run<'a> {
    pub(super) stepper: Stepper<'a>,
    pub(super) trajectory: Trajectory,
    pub(super) reduction: Reduction,
    progress: Loop,
    plan: Plan<'a>,
    /// Steps that lanes have made.
    pub(super) in_lanes: usize,
    /// How it has ended, once it has.
    pub(super) outcome: Option<Result<Outcome, StepError>>,
}

/// What all runs have in common.
#[derive(Clone, Copy)]
pub(super) struct Common<'a, 'o> {
    pub(super) options: &'a Options,
    pub(super) keep: &'a Keep,
    pub(super) stop: &'a Stop,
    pub(super) observer: &'a Observer<'o, usize>,
}

impl<'a> Run<'a> {
    /// A run from a start that has made its first step; nothing if lanes cannot go on with it.
    pub(super) fn begin(
        system: &'a dyn System,
        start: &InitialState,
        common: Common<'_, '_>,
    ) -> Option<Self> {
        let Common { options, keep, observer, .. } = common;
        if options.steps < 2 {
            return None;
        }
        system.as_linear()?.planar_motion()?;
        let state = midpoint::State::new(0.0, &start.q, &start.u);
        let Options { dt, tolerance, solver, .. } = *options;
        let mut stepper = Stepper::new(system, solver, tolerance, dt, &state).ok()?;
        let (mut trajectory, mut reduction) = (Trajectory::empty(system), Reduction::default());
        let mut progress = Loop::new(options);
        trajectory.begin(&mut stepper).ok()?;
        reduction.begin_with(keep, &stepper);
        let first =
            progress.step(1, options, &mut stepper, &mut trajectory, observer, &mut |stepper| {
                reduction.go_on_with(keep, stepper);
            });
        let plan = match first {
            Ok(None) => Plan::new(system, &stepper, options)?,
            _ => return None,
        };
        Some(Self { stepper, trajectory, reduction, progress, plan, in_lanes: 0, outcome: None })
    }

    /// Whether it has come to an end without a failure. Steps that the stepper does not make are not looked at for
    /// divergence, but the last one is the stepper's.
    pub(super) fn is_done(&self) -> bool {
        let fine = |outcome: &Outcome| !matches!(outcome, Outcome::Failed(_) | Outcome::Error(_));
        let ended = matches!(&self.outcome, Some(Ok(outcome)) if fine(outcome));
        ended && !self.stepper.may_diverge()
    }

    /// A step by the stepper from a state; the next state, if the run goes on.
    #[inline(never)]
    fn step(
        &mut self,
        step: usize,
        until_sample: usize,
        before: &State<f64>,
        common: Common<'_, '_>,
    ) -> Option<State<f64>> {
        let Common { options, keep, stop, observer } = common;
        let Self { stepper, trajectory, reduction, progress, plan, in_lanes, .. } = self;
        plan.hand_over(before, step - 1, stepper);
        *in_lanes += step - 1 - trajectory.steps;
        trajectory.steps = step - 1;
        progress.until_sample = until_sample;
        let ended = progress.step(step, options, stepper, trajectory, observer, &mut |stepper| {
            reduction.go_on_with(keep, stepper);
        });
        let outcome = match ended {
            Ok(None) if stop.is_asked() => Ok(Outcome::Interrupted),
            Ok(None) if step == options.steps => Ok(Outcome::Finished),
            Ok(None) => return Some(plan.state_of(stepper, Some(before))),
            Ok(Some(outcome)) => Ok(outcome),
            Err(error) => Err(error),
        };
        self.outcome = Some(progress.end(outcome, stepper, trajectory));
        None
    }

    /// Looks at a state that a step in a lane has led to.
    #[inline(never)]
    fn look_at(&mut self, step: usize, state: &State<f64>, common: Common<'_, '_>) {
        let Common { options, keep, .. } = common;
        let (q, u) = self.plan.motion(state);
        if keep.reduces() {
            let phase = if state.slips > 0.0 { Phase::Slip } else { Phase::Stick };
            let t = step as f64 * options.dt;
            let phases = std::iter::once(phase);
            self.reduction.go_on(keep, t, q.as_slice(), u.as_slice(), phases);
        }
        let Loop { fastest, rested, .. } = &mut self.progress;
        *fastest = fastest.max(u.amax());
        let rests = options.until_rest && u.amax() <= AT_REST * *fastest;
        *rested = usize::from(rests);
    }
}

/// Goes on with runs that have begun, side by side. All of them have ended afterwards.
pub(super) fn go_on(runs: &mut [&mut Run<'_>], lanes: Lanes, common: Common<'_, '_>) {
    let together = Together { runs, common };
    match lanes {
        Lanes::None | Lanes::Widest => pulp::Arch::new().dispatch(together),
        Lanes::One => together.with_simd(pulp::Scalar),
        Lanes::Four => together.with_simd(pulp::Scalar256b),
        Lanes::Eight => together.with_simd(pulp::Scalar512b),
    }
}

struct Together<'g, 'r, 's, 'a, 'o> {
    runs: &'g mut [&'r mut Run<'s>],
    common: Common<'a, 'o>,
}

impl WithSimd for Together<'_, '_, '_, '_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { runs, common } = self;
        runs.sort_by_key(|run| run.plan.of_ellipses);
        for alike in runs.chunk_by_mut(|a, b| a.plan.of_ellipses == b.plan.of_ellipses) {
            if alike[0].plan.of_ellipses {
                in_groups::<S, Ellipses<Number<S>>>(simd, alike, common, plan::ellipses);
            } else {
                let sets = plan::superellipses;
                in_groups::<S, Superellipses<Number<S>>>(simd, alike, common, sets);
            }
        }
    }
}

#[inline(always)]
fn in_groups<S: Simd, L: Sets<S>>(
    simd: S,
    runs: &mut [&mut Run<'_>],
    common: Common<'_, '_>,
    sets: for<'p> fn(&'p Plan<'_>) -> &'p L::Plain,
) {
    for group in runs.chunks_mut(S::F64_LANES) {
        Group::<S, L>::new(simd, group, sets).go_on(simd, group, common);
    }
}

/// Runs side by side.
struct Group<S: Simd, L> {
    coefficients: Coefficients<Number<S>>,
    sets: L,
    state: State<Number<S>>,
}

#[inline(always)]
fn pair<S: Simd>(simd: S, of: impl Fn(usize) -> Pair<f64>) -> Pair<Number<S>> {
    [0, 1].map(|i| Number::from_fn(simd, |lane| of(lane)[i]))
}

#[inline(always)]
fn square<S: Simd>(simd: S, of: impl Fn(usize) -> [Pair<f64>; 2]) -> [Pair<Number<S>>; 2] {
    [0, 1].map(|i| pair(simd, |lane| of(lane)[i]))
}

impl<S: Simd, L: Sets<S>> Group<S, L> {
    /// Lanes without a run of their own do what the first one does, and nobody looks at it.
    fn new(simd: S, runs: &[&mut Run<'_>], sets: for<'p> fn(&'p Plan<'_>) -> &'p L::Plain) -> Self {
        let plan = |lane: usize| &runs[if lane < runs.len() { lane } else { 0 }].plan;
        let of = |lane: usize| &plan(lane).coefficients;
        let coefficients = Coefficients {
            half: Number::from_fn(simd, |lane| of(lane).half),
            belt: pair(simd, |lane| of(lane).belt),
            by_position: square(simd, |lane| of(lane).by_position),
            by_velocity: square(simd, |lane| of(lane).by_velocity),
            constant: pair(simd, |lane| of(lane).constant),
            resistance: square(simd, |lane| of(lane).resistance),
            compliance: square(simd, |lane| of(lane).compliance),
            strongest: Number::from_fn(simd, |lane| of(lane).strongest),
            doubtful: pair(simd, |lane| of(lane).doubtful),
        };
        let zero = Number::splat(simd, 0.0);
        let (position, velocity, slip) = ([zero; 2], [zero; 2], [zero; 2]);
        let (change, bend, slips) = ([zero; 2], [zero; 2], zero);
        let state = State { position, velocity, slip, change, bend, slips };
        let mut group =
            Self { coefficients, sets: L::gather(simd, |lane| sets(plan(lane))), state };
        for (lane, run) in runs.iter().enumerate() {
            group.state.set(lane, &run.plan.state_of(&run.stepper, None));
        }
        group
    }

    #[inline(always)]
    fn go_on(&mut self, simd: S, runs: &mut [&mut Run<'_>], common: Common<'_, '_>) {
        let Common { options, keep, stop, .. } = common;
        let watched = options.until_rest || keep.reduces();
        // Lanes with a run that has not ended.
        let mut running = (1 << runs.len()) - 1;
        let mut active = Mask::from_bits(simd, running);
        let mut until_sample = runs.first().map_or(1, |run| run.progress.until_sample);
        for step in 2..=options.steps {
            if running == 0 {
                return;
            }
            let interrupted = step.is_multiple_of(MOST_UNSEEN as usize) && stop.is_asked();
            let before = self.state;
            let mut alone = running;
            if until_sample > 1 && step < options.steps && !interrupted {
                let tried = kernel::step(simd, &self.coefficients, &self.sets, &before, active);
                self.state = tried.state;
                // A second step at rest is the last one.
                let rests = |lane: &usize| options.until_rest && runs[*lane].progress.rested > 0;
                alone = match watched {
                    true => lanes(running).filter(rests).fold(0, |bits, lane| bits | 1 << lane),
                    false => 0,
                };
                if (tried.failed | tried.doubtful).any() {
                    alone |= tried.failed.bits();
                    for lane in lanes(tried.doubtful.bits() & !alone) {
                        let load = tried.load.map(|x| x.of(lane));
                        let plan = &mut runs[lane].plan;
                        let several = plan.may_have_several(load);
                        alone |= u32::from(several) << lane;
                        for (end, own) in
                            self.coefficients.doubtful.iter_mut().zip(plan.coefficients.doubtful)
                        {
                            end.set(lane, own);
                        }
                    }
                }
                if watched {
                    for lane in lanes(running & !alone) {
                        runs[lane].look_at(step, &self.state.of(lane), common);
                    }
                }
            }
            for lane in lanes(alone) {
                let next = runs[lane].step(step, until_sample, &before.of(lane), common);
                match next {
                    Some(state) => self.state.set(lane, &state),
                    None => {
                        running &= !(1 << lane);
                        active = Mask::from_bits(simd, running);
                    }
                }
            }
            until_sample = if until_sample == 1 { options.save_every } else { until_sample - 1 };
        }
    }
}

/// The lanes whose bits are set.
fn lanes(bits: u32) -> impl Iterator<Item = usize> {
    (0..MOST).filter(move |lane| bits >> lane & 1 == 1)
}

impl<S: Simd> State<Number<S>> {
    fn of(&self, lane: usize) -> State<f64> {
        let of = |pair: Pair<Number<S>>| pair.map(|number| number.of(lane));
        State {
            position: of(self.position),
            velocity: of(self.velocity),
            slip: of(self.slip),
            change: of(self.change),
            bend: of(self.bend),
            slips: self.slips.of(lane),
        }
    }

    fn set(&mut self, lane: usize, from: &State<f64>) {
        let put = |pair: &mut Pair<Number<S>>, from: Pair<f64>| {
            pair.iter_mut().zip(from).for_each(|(number, value)| number.set(lane, value));
        };
        put(&mut self.position, from.position);
        put(&mut self.velocity, from.velocity);
        put(&mut self.slip, from.slip);
        put(&mut self.change, from.change);
        put(&mut self.bend, from.bend);
        self.slips.set(lane, from.slips);
    }
}

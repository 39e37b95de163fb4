//! How long the first step may be.
//!
//! As the starting step of \[HairerNorsettWanner1993\] II.4 it follows from trial steps. These become longer and longer
//! until forces, stiffness, damping or the time in the forces bend the accelerations along them. Only a step that is
//! short beside the time in which that happens shows how far a motion from rest goes, which its error is compared
//! with. The end of the motion is an upper limit only.

use crate::integrator::event::dynamics::{ContactVariables, Dynamics, ROWS, SlidingForces};
use crate::integrator::event::resolution::ROUNDING;
use crate::integrator::event::state::{EvaluationError, State};
use crate::vectors::largest;

/// Number of trials, and how much longer each is than the one before.
const TRIALS: i32 = 32;
const LENGTHENING: f64 = 10.0;
/// How far accelerations may bend along a step, relative to the largest of them: an oscillation from rest does so
/// within a fifth of a radian, which the method follows to all digits.
const BEND: f64 = 0.01;
/// Relative change of the coordinates that shows which forces balance: the root of rounding.
const SHARE: f64 = 1.490_116_119_384_765_6e-8;

/// The longest trial step, at most `longest`, along which accelerations and contact forces from `state` on, where
/// the accelerations are `a0`, change as a straight line does. The dynamics are left at its end.
pub(crate) fn initial_step(
    dynamics: &mut Dynamics<'_>,
    state: &State,
    a0: &[f64],
    longest: f64,
) -> Result<f64, EvaluationError> {
    let mut ahead = state.clone();
    let kept = SlidingForces::Kept;
    dynamics.evaluate(state.t, &state.q, &state.u, kept)?;
    let mut start = Loads::of(dynamics);
    start.load += cancelled(dynamics, state, &start.accelerations)?;
    let mut h = longest * LENGTHENING.powi(-TRIALS);
    for _ in 0..TRIALS {
        let next = (LENGTHENING * h).min(longest);
        // With the accelerations at the start to the middle, with those in the middle to the end.
        ahead.extrapolate(state, a0, 0.5 * next);
        dynamics.evaluate(ahead.t, &ahead.q, &ahead.u, kept)?;
        let middle = Loads::of(dynamics);
        ahead.extrapolate(state, &middle.accelerations, next);
        dynamics.evaluate(ahead.t, &ahead.q, &ahead.u, kept)?;
        if !start.is_straight(&middle, &Loads::of(dynamics)) {
            break;
        }
        h = next;
    }
    Ok(h)
}

/// The accelerations that forces give which balance within the system, such as a spring that is relaxed at its length: a
/// share of the coordinates of the size of rounding leaves this share of them, of which the system tells nothing.
fn cancelled(
    dynamics: &mut Dynamics<'_>,
    state: &State,
    accelerations: &[f64],
) -> Result<f64, EvaluationError> {
    let mut largest_change: f64 = 0.0;
    // Signs that differ from coordinate to coordinate, lest a translation of all bodies shows nothing.
    for phase in [0.0, 1.0] {
        let shifted = |(i, q): (usize, &f64)| q * (1.0 + SHARE * (i as f64 + phase).cos().signum());
        let q: Vec<f64> = state.q.iter().enumerate().map(shifted).collect();
        dynamics.evaluate(state.t, &q, &state.u, SlidingForces::Kept)?;
        let change = dynamics.acceleration.iter().zip(accelerations).map(|(a, b)| (a - b).abs());
        largest_change = change.fold(largest_change, f64::max);
    }
    // What is not a number ends the first step.
    Ok(if largest_change.is_finite() { largest_change / SHARE } else { 0.0 })
}

/// Accelerations, and the contact forces, in which alone the load of what sticks shows.
struct Loads {
    accelerations: Vec<f64>,
    load: f64,
    forces: Vec<[f64; ROWS]>,
}

impl Loads {
    fn of(dynamics: &Dynamics<'_>) -> Self {
        let force = |contact: &ContactVariables| {
            let [x, y, z] = contact.force;
            [contact.normal_force, x, y, z]
        };
        Self {
            accelerations: dynamics.acceleration.clone(),
            load: dynamics.rounded_load(),
            forces: dynamics.contacts.iter().map(force).collect(),
        }
    }

    /// Whether a straight line leads from here through `middle` to `end`.
    fn is_straight(&self, middle: &Self, end: &Self) -> bool {
        let load = self.load.max(middle.load).max(end.load);
        straight([&self.accelerations, &middle.accelerations, &end.accelerations], ROUNDING * load)
            && self
                .forces
                .iter()
                .zip(&middle.forces)
                .zip(&end.forces)
                .all(|((a, b), c)| straight([a, b, c], 0.0))
    }
}

fn straight([start, middle, end]: [&[f64]; 3], rounding: f64) -> bool {
    let size = largest(start).max(largest(middle)).max(largest(end));
    let mut bends = start.iter().zip(middle).zip(end).map(|((a, b), c)| (a - 2.0 * b + c).abs());
    // The comparison also turns away NaN.
    bends.all(|bend| bend <= BEND * size + rounding)
}

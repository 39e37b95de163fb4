//! How long the first step may be.
//!
//! As the starting step of \[HairerNorsettWanner1993\] II.4 it follows from trial steps: these become longer and
//! longer until forces, stiffness, damping or the time in the forces bend the accelerations along them. Only a step
//! that is short beside the time in which that happens shows how far a motion from rest goes, which its error is
//! compared with. The end of the motion is an upper limit only.

use crate::integrator::event::dynamics::contact_variables::{
    FieldError, ROUNDING, ROWS, State, Touch,
};
use crate::integrator::event::dynamics::{Field, add, largest};

/// Number of trials, and how much longer each is than the one before.
const TRIALS: i32 = 32;
const LONGER: f64 = 10.0;
/// How far accelerations may bend along a step, relative to the largest of them: an oscillation from rest does so
/// within a fifth of a radian, which the method follows to all digits.
const BEND: f64 = 0.01;

/// The longest trial step, at most `longest`, along which accelerations and contact forces from `state` on, where
/// the accelerations are `a0`, change as a straight line does. The field is left at its end.
pub(crate) fn first_step(
    field: &mut Field<'_>,
    state: &State,
    a0: &[f64],
    longest: f64,
) -> Result<f64, FieldError> {
    let mut ahead = state.clone();
    field.evaluate(state.t, &state.q, &state.u, true)?;
    let start = Shape::of(field);
    let mut h = longest * LONGER.powi(-TRIALS);
    for _ in 0..TRIALS {
        let next = (LONGER * h).min(longest);
        // With the accelerations at the start to the middle, with those in the middle to the end.
        go(&mut ahead, state, a0, 0.5 * next);
        field.evaluate(ahead.t, &ahead.q, &ahead.u, true)?;
        let middle = Shape::of(field);
        go(&mut ahead, state, &middle.accelerations, next);
        field.evaluate(ahead.t, &ahead.q, &ahead.u, true)?;
        if !start.is_straight(&middle, &Shape::of(field)) {
            break;
        }
        h = next;
    }
    Ok(h)
}

/// What a trial looks at: what contacts hold shows in their forces only.
struct Shape {
    accelerations: Vec<f64>,
    load: f64,
    forces: Vec<[f64; ROWS]>,
}

impl Shape {
    fn of(field: &Field<'_>) -> Self {
        let force = |touch: &Touch| {
            let [x, y, z] = touch.force;
            [touch.normal_force, x, y, z]
        };
        Self {
            accelerations: field.acceleration.clone(),
            load: field.load,
            forces: field.touches.iter().map(force).collect(),
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

/// The state after a time with constant accelerations.
fn go(ahead: &mut State, start: &State, accelerations: &[f64], time: f64) {
    ahead.t = start.t + time;
    ahead.q.copy_from_slice(&start.q);
    ahead.u.copy_from_slice(&start.u);
    add(&mut ahead.q, time, &start.u);
    add(&mut ahead.q, 0.5 * time * time, accelerations);
    add(&mut ahead.u, time, accelerations);
}

//! Random linear systems from event to event.

use std::ops::ControlFlow;

use asperity::event::{Options, Outcome, integrate_with};

use crate::decode::{Range, Source};
use crate::systems::{self, Forces};

/// Steps that are plenty for what these systems do in their time; more means that the motion does not get on.
const STEPS: usize = 50_000;
/// Calls of the observer, one in 50 ms, after which a run is cut short and its steps are counted.
const PATIENCE: usize = 40;

/// An integration ends; what is finished keeps to the laws.
pub fn check(data: &[u8]) {
    let mut source = Source::new(data);
    let Some(scene) = systems::scene(&mut source, true) else { return };
    let Ok(options) = Options::new(0.2 * source.size(Range::Narrow).min(20.0)) else { return };
    let options = options.with_start(&scene.q0, &scene.u0).with_max_events(200);
    let options = options.with_tolerance([1e-6, 1e-9][source.below(2)]);
    let mut calls = 0;
    let result = integrate_with(&scene.system, &options, &mut |_| {
        calls += 1;
        if calls > PATIENCE { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    let Ok(run) = result else { return };
    let motion = &run.motion;
    let steps = motion.steps + motion.rejected_steps;
    assert!(
        steps < STEPS,
        "{steps} steps to t = {:?} of {options:?}: {scene:?}",
        motion.samples.t.last()
    );
    if !matches!(run.outcome, Outcome::Finished) {
        return;
    }
    let states = motion.samples.q.iter().chain(&motion.samples.u);
    assert!(states.clone().all(|v| v.is_finite()), "not finite: {options:?} {scene:?}");
    assert_eq!(*motion.samples.t.last().unwrap(), options.t_end);
    if !scene.tame {
        return;
    }
    scene.check_forces(&Forces {
        p: motion.samples.p,
        lag: 0,
        slip: &motion.samples.slip,
        u: &motion.samples.u,
        force: &motion.samples.force,
        normal_force: &motion.samples.normal_force,
        phase: &motion.samples.phase,
        with_phase: false,
        slack: 1e-3,
        tolerance: 0.0,
        dt: 0.0,
    });
    let size = states.fold(1.0, |m: f64, v| m.max(v.abs()));
    for contact in &scene.contacts {
        if !contact.normal_force.is_unilateral() {
            continue;
        }
        for q in motion.samples.q.chunks_exact(motion.samples.dof) {
            let now = contact.gap + q.iter().zip(&contact.normal).map(|(q, w)| q * w).sum::<f64>();
            assert!(now > -1e-5 * size, "overlap {now:e}: {options:?} {scene:?}");
        }
    }
}

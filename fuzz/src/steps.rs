//! Random linear systems by Moreau's time stepping.

use asperity::simulate::{Options, Outcome, simulate};

use crate::decode::{Range, Source};
use crate::systems::{self, Forces};

/// Steps give finite states and forces that the laws allow.
pub fn check(data: &[u8]) {
    let mut source = Source::new(data);
    let Some(scene) = systems::scene(&mut source, true) else { return };
    let dt = 0.01 * source.size(Range::Narrow);
    let Ok(options) = Options::new(dt, dt) else { return };
    let options = options.with_steps(30).with_start(&scene.q0, &scene.u0);
    let result = simulate(&scene.system, &options);
    let Ok(run) = result else { return };
    let path = &run.trajectory.samples;
    if !scene.tame {
        return;
    }
    scene.check_forces(&Forces {
        p: path.p,
        lag: 1,
        slip: &path.slip,
        u: &path.u,
        force: &path.force,
        normal_force: &path.normal_force,
        phase: &path.phase,
        with_phase: true,
        slack: 1e-6,
        tolerance: 10.0 * options.tolerance,
        dt: options.dt,
    });
    if matches!(run.outcome, Outcome::Finished) {
        assert!(path.u.iter().all(|v| v.is_finite()), "not finite: {options:?} {scene:?}");
    }
}

//! Runs and what is read from them.

use asperity::event::{Event, EventKind, Motion, Options, Outcome, Section, integrate};
use asperity::system::System;

/// Options that matter seldom.
pub fn options(q0: &[f64], u0: &[f64], t_end: f64) -> Options {
    Options::new(t_end).unwrap().with_start(q0, u0).with_tolerance(1e-12)
}

/// A motion that comes to its end.
pub fn run(system: &dyn System, options: &Options) -> Motion {
    let run = integrate(system, options).unwrap();
    let wanted = matches!(run.outcome, Outcome::Finished | Outcome::Section);
    assert!(wanted, "{:?} after {:?}", run.outcome, run.motion.events);
    run.motion
}

/// The state in which the hyperplane is crossed.
pub fn cross(system: &dyn System, from: &Options, normal: &[f64], level: f64) -> (f64, Vec<f64>) {
    let section = Section { normal: normal.to_vec(), level, after: 0.0 };
    let motion = run(system, &from.clone().with_section(section));
    assert_eq!(motion.events.last().unwrap().kind, EventKind::Section);
    let state = [last_q(&motion), last_u(&motion)].concat();
    (*motion.samples.t.last().unwrap(), state)
}

pub fn last_q(motion: &Motion) -> &[f64] {
    &motion.samples.q[motion.samples.q.len() - motion.samples.coordinates..]
}

pub fn last_u(motion: &Motion) -> &[f64] {
    &motion.samples.u[motion.samples.u.len() - motion.samples.dof..]
}

pub fn times(motion: &Motion, kind: EventKind) -> Vec<f64> {
    motion.events.iter().filter(|e| e.kind == kind).map(|e| e.time).collect()
}

pub fn first(motion: &Motion, kind: EventKind) -> Event {
    *motion.events.iter().find(|event| event.kind == kind).unwrap()
}

#[track_caller]
pub fn close(value: f64, expected: f64, tolerance: f64) {
    assert!((value - expected).abs() <= tolerance, "{value} instead of {expected}");
}

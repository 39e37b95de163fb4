//! Functions of time: signals, loads, and planes that move.

use std::sync::Arc;

use asperity::ArgumentError;
use asperity::event::{self, EventKind};
use asperity::stepper::Stepper;
use asperity::system::rigid::{
    Body, Pair, PlanarBody, Plane, PlaneMotion, RigidBodies, Shape, Spring,
};
use asperity::system::{Derivative, Moment, Signal, Smoothness, TimeFunction};

use crate::support::*;

const OMEGA: f64 = 60.0;

fn value(signal: &Signal, t: f64) -> f64 {
    signal.component(Moment::new(t), 0, Derivative::Value)
}

#[test]
fn cubics_know_their_integrals_and_breaks() {
    let p = |t: f64| 1.0 - 2.0 * t + 0.5 * t * t + 0.25 * t * t * t;
    let times = [0.0, 0.3, 1.0, 1.1, 2.5];
    // Taylor's polynomial at every knot.
    let taylor = |t: f64| [p(t), -2.0 + t + 0.75 * t * t, 0.5 + 0.75 * t, 0.25];
    let pieces = times[..4].iter().flat_map(|&t| [taylor(t), taylor(t).map(|c| -c)]);
    let mut coefficients: Vec<_> = pieces.collect();
    let end = [p(2.5), -p(2.5)];
    let spline = Signal::cubic(&times, &coefficients, &end, false).unwrap();
    for t in [0.0, 0.2, 0.7, 1.05, 2.4] {
        assert!((value(&spline, t) - p(t)).abs() < 1e-13);
        let rate = spline.component(Moment::new(t), 1, Derivative::First);
        assert!((rate - (2.0 - t - 0.75 * t * t)).abs() < 1e-12);
    }
    let primitive = |t: f64| t - t * t + t * t * t / 6.0 + t * t * t * t / 16.0;
    let integral = spline.integral(0.2, 2.4, 0);
    assert!((integral - primitive(2.4) + primitive(0.2)).abs() < 1e-13);
    // One polynomial all over, that is held at its ends.
    assert_eq!(value(&spline, 9.0), p(2.5));
    let breaks: Vec<_> =
        std::iter::successors(spline.next_break(-1.0), |b| spline.next_break(b.time)).collect();
    // Rounding makes a knot of some of the others.
    assert_eq!((breaks[0].time, breaks[0].smoothness), (0.0, Smoothness::Kink));
    assert_eq!(breaks.last().unwrap().time, 2.5);
    assert!(breaks[1..breaks.len() - 1].iter().all(|b| b.smoothness == Smoothness::Knot));
    coefficients[5][1] += 1e-3;
    let kinked = Signal::cubic(&times, &coefficients, &end, false).unwrap();
    let found = [0.5, 1.0].map(|t| kinked.next_break(t).unwrap());
    assert_eq!(found.map(|b| b.time), [1.0, 1.1]);
    assert_eq!(found.map(|b| b.smoothness), [Smoothness::Kink; 2]);
    assert!(Signal::cubic(&times, &coefficients[1..], &end, false).is_err());
    assert!(Signal::cubic(&[0.0; 5], &coefficients, &end, false).is_err());
}

#[test]
fn a_moment_says_which_piece_is_continued() {
    let saw = Signal::linear(&[0.0, 1.0, 1.5], &[0.0, 2.0, 0.0], true).unwrap();
    for periods in [0.0, 40.0] {
        let t = 1.5 * periods + 1.0;
        let of = |piece: f64| saw.component(Moment { t, piece }, 0, Derivative::First);
        assert!((of(t - 0.5) - 2.0).abs() < 1e-12 && (of(t + 0.25) + 4.0).abs() < 1e-12);
        let next = saw.next_break(t - 0.1).unwrap();
        assert!((next.time - t).abs() < 1e-12 && next.smoothness == Smoothness::Kink);
        assert!(saw.next_break(next.time).unwrap().time > t + 0.4);
    }
    assert!(!saw.jumps() && (saw.integral(0.0, 150.0, 0) - 150.0).abs() < 1e-9);
    let step = Signal::linear(&[0.0, 1.0, 1.0, 2.0], &[0.0, 0.0, 3.0, 3.0], false).unwrap();
    assert!(step.jumps() && value(&step, 1.0) == 3.0);
    assert_eq!(step.component(Moment { t: 1.0, piece: 0.5 }, 0, Derivative::Value), 0.0);
}

#[test]
fn signals_are_checked() {
    let new = |times: &[f64], values: &[f64]| match Signal::linear(times, values, false) {
        Err(ArgumentError { argument, .. }) => argument,
        other => panic!("{other:?}"),
    };
    assert_eq!(new(&[], &[]), "times");
    assert_eq!(new(&[0.0], &[1.0]), "times");
    assert_eq!(new(&[0.0, 1.0], &[1.0]), "values");
    assert_eq!(new(&[0.0, 0.0], &[1.0, 2.0]), "times");
    assert_eq!(new(&[0.0, 1.0, 0.5], &[1.0; 3]), "times");
    assert_eq!(new(&[0.0, f64::NAN], &[1.0; 2]), "times");
    assert_eq!(new(&[0.0, 1.0], &[f64::INFINITY; 2]), "values");
    assert!(Signal::sine(0.0, &[1.0], &[0.0], &[0.0]).is_err());
    assert!(Signal::sine(1.0, &[1.0], &[0.0, 0.0], &[0.0]).is_err());
}

/// A table that goes up and down from rest with this amplitude.
fn shaken(amplitude: f64) -> Signal {
    let frequency = OMEGA / std::f64::consts::TAU;
    let quarter = -std::f64::consts::FRAC_PI_2;
    Signal::sine(frequency, &[0.0, amplitude], &[0.0, quarter], &[0.0, amplitude]).unwrap()
}

fn on_a_table(displacement: impl Into<TimeFunction<2>>) -> Result<RigidBodies, ArgumentError> {
    let motion = PlaneMotion::planar(&displacement.into(), &TimeFunction::ZERO)?;
    let plane = Plane { motion: Some(motion), ..ground() };
    let body = PlanarBody { position: [0.0, 0.1], ..PlanarBody::new(1.0, 0.1) };
    let shape = Shape::BoxPlane { body: 0, half_sizes: [0.1, 0.1, 0.0], plane };
    RigidBodies::new(vec![body], &[Pair::new(shape, line(0.3))], vec![], [0.0, -G, 0.0])
}

#[test]
fn a_box_stays_on_a_table_that_is_shaken_gently() {
    let system = on_a_table(shaken(1e-3)).unwrap();
    assert!(system.depends_on_time());
    let height = |t: f64| 0.1 + 1e-3 * (1.0 - (OMEGA * t).cos());
    let error = |dt: f64| (run(&system, dt, 0.5, |_| {}).q[1] - height(0.5)).abs();
    let errors = [error(1e-3), error(5e-4)];
    assert!(errors[0] < 1e-6 && order(errors) > 1.9, "{errors:?}");
    let options = event::Options::new(0.5).unwrap().with_start(system.q0(), system.u0());
    let motion = event::integrate(&system, &options).unwrap();
    let samples = &motion.motion.samples;
    assert!(motion.motion.events.is_empty());
    assert!((samples.q[samples.q.len() - 2] - height(0.5)).abs() < 1e-10);
}

#[test]
fn a_table_that_starts_with_a_jump_of_its_velocity_strikes() {
    let rises = Signal::linear(&[0.1, 1.0], &[0.0, 0.0, 0.0, 0.9], false).unwrap();
    let system = on_a_table(rises).unwrap();
    let options = event::Options::new(0.5).unwrap().with_start(system.q0(), system.u0());
    let run = event::integrate(&system, &options).unwrap();
    let (events, samples) = (&run.motion.events, &run.motion.samples);
    assert_eq!((events[0].kind, events[0].time), (EventKind::Kink, 0.1));
    assert!((samples.q[samples.q.len() - 2] - 0.5).abs() < 1e-12);
    assert!((samples.u[samples.u.len() - 2] - 1.0).abs() < 1e-12);
}

#[test]
fn functions_and_signals_are_the_same_to_the_scheme() {
    let table = shaken(1e-3);
    let function = move |t: f64| {
        [Derivative::Value, Derivative::First].map(|derivative| {
            [0, 1].map(|component| table.component(Moment::new(t), component, derivative))
        })
    };
    let custom = on_a_table(TimeFunction::WithRate(Arc::new(function))).unwrap();
    let own = on_a_table(shaken(1e-3)).unwrap();
    let end = |system: &RigidBodies| run(system, 1e-3, 0.2, |_| {}).q[1];
    assert!((end(&custom) - end(&own)).abs() < 1e-15);
}

#[test]
fn motions_of_planes_are_checked() {
    let refused = |displacement: TimeFunction<2>| match on_a_table(displacement) {
        Err(ArgumentError { argument, message, .. }) => (argument, message),
        other => panic!("{other:?}"),
    };
    let jump = Signal::linear(&[0.0, 1.0, 1.0, 2.0], &[0.0; 8], false).unwrap();
    assert!(on_a_table(jump).is_ok());
    let jump = Signal::linear(&[0.0, 1.0], &[0.0, 0.0, 0.0, 1.0], true).unwrap();
    assert!(refused(jump.into()).1.contains("jump"));
    let function = TimeFunction::Custom(Arc::new(|t| [t, 0.0]));
    assert_eq!(refused(function).0, "displacement");
    let wide = Signal::linear(&[0.0, 1.0], &[0.0; 6], false).unwrap();
    assert_eq!(refused(TimeFunction::Signal(Arc::new(wide))).0, "displacement");
}

/// Loads and lengths of springs at the midpoints of steps.
#[test]
fn a_driven_oscillator_converges_at_second_order() {
    let length = Signal::sine(1.0, &[0.2], &[0.0], &[6.0]).unwrap();
    let spring = Spring {
        body: 0,
        point: [0.0; 3],
        other: None,
        other_point: [-5.0, 0.0, 0.0],
        stiffness: 36.0,
        damping: 0.0,
        length: length.into(),
    };
    let force = Signal::sine(1.0, &[0.3, 0.0, 0.0], &[0.5; 3], &[0.0; 3]).unwrap();
    let body = Body { position: [1.0, 0.0, 0.0], force: force.into(), ..Body::new(1.0, [1.0; 3]) };
    let system = RigidBodies::new(vec![body], &[], vec![spring], [0.0; 3]).unwrap();
    let end = |dt: f64| {
        let mut stepper =
            Stepper::new(&system, EXACT, 1e-12, dt, &State::new(0.0, system.q0(), system.u0()))
                .unwrap();
        run_on(&mut stepper, 1.0, &mut |_| {});
        stepper.q()[0]
    };
    let [a, b, c] = [4e-3, 2e-3, 1e-3].map(end);
    assert!(((a - b) / (b - c)).log2() > 1.9);
}

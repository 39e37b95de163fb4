//! Many runs are the runs, one by one.

#[path = "../common/mod.rs"]
mod common;
mod lanes;

use std::ops::ControlFlow;

use asperity::ArgumentError;
use asperity::ensemble::{
    Ending, Ensemble, Keep, Member, Members, Reason, integrate_many, simulate_many,
};
use asperity::event;
use asperity::law::FrictionLaw;
use asperity::set::{Convex, Ellipse, Matrix, Star, Vector};
use asperity::simulate::{Options, simulate};
use asperity::solver::{Solver, Steps};
use asperity::system::{InitialState, LinearSystem, System, SystemError, mass_on_belt};
use nalgebra::DMatrix;

fn ellipse(a: f64, b: f64) -> Convex<2> {
    Ellipse::new(Vector::<2>::new(a, b)).unwrap().into()
}

/// A mass on a belt in front of which the reservoir is so wide.
fn belt(width: f64) -> LinearSystem {
    let law = FrictionLaw::new(Star::from(ellipse(width, 0.5)), ellipse(0.6, 0.5)).unwrap();
    mass_on_belt(1.0, Matrix::<2>::identity(), law, 1.0, Vector::<2>::new(0.3, 0.2)).unwrap()
}

/// Belts of several widths, each from several velocities; the widths that are not positive are no laws.
#[derive(Debug)]
struct Belts {
    first: LinearSystem,
    widths: Vec<f64>,
    velocities: usize,
}

impl Belts {
    fn new(widths: &[f64], velocities: usize) -> Self {
        Self { first: belt(0.7), widths: widths.to_vec(), velocities }
    }

    fn velocity(&self, member: usize) -> Vec<f64> {
        let k = (member % self.velocities) as f64;
        vec![0.1 + 0.01 * k, 0.3 - 0.02 * k]
    }
}

impl Members for Belts {
    fn count(&self) -> usize {
        self.widths.len() * self.velocities
    }

    fn first(&self) -> &dyn System {
        &self.first
    }

    fn variant(&self, member: usize) -> usize {
        member / self.velocities
    }

    fn system(&self, variant: usize) -> Result<Member<'_>, SystemError> {
        let width = self.widths[variant];
        if width > 0.0 {
            return Ok(Member::Made(Box::new(belt(width))));
        }
        Err(SystemError::Foreign(format!("no width: {width}").into()))
    }

    fn start(&self, member: usize, _system: &dyn System) -> InitialState {
        InitialState { q: vec![0.0, 0.1], u: self.velocity(member) }
    }
}

fn on(_: usize, _: usize) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn row(values: &[f64], member: usize, width: usize) -> &[f64] {
    &values[member * width..(member + 1) * width]
}

fn options() -> Options {
    Options::new(1e-2, 1.0).unwrap()
}

fn many(members: &Belts, threads: usize) -> Ensemble {
    simulate_many(members, &options(), &Keep::default(), Some(threads), &mut on).unwrap()
}

#[test]
fn runs_of_time_stepping_are_to_the_bit_what_they_are_alone() {
    let belts = Belts::new(&[0.6, 0.8, 1.0], 5);
    for threads in [1, 3] {
        let found = many(&belts, threads);
        for member in 0..belts.count() {
            let system = belt(belts.widths[belts.variant(member)]);
            let alone = options().with_start(&[0.0, 0.1], &belts.velocity(member));
            let run = simulate(&system, &alone).unwrap();
            let samples = run.trajectory.samples;
            let last = samples.len() - 1;
            for (ends, own, width) in [
                (&found.ends.q, &samples.q, 2),
                (&found.ends.u, &samples.u, 2),
                (&found.ends.force, &samples.force, 2),
                (&found.ends.normal_force, &samples.normal_force, 1),
            ] {
                assert_eq!(row(ends, member, width), row(own, last, width));
            }
            assert_eq!(found.endings[member], Ending::Finished);
            assert_eq!(found.steps[member], 100);
        }
    }
}

#[test]
fn runs_from_event_to_event_are_to_the_bit_what_they_are_alone() {
    let belts = Belts::new(&[0.6, 0.9], 3);
    let options = event::Options::new(2.0).unwrap();
    let found = integrate_many(&belts, &options, &Keep::default(), Some(2), &mut on).unwrap();
    for member in 0..belts.count() {
        let system = belt(belts.widths[belts.variant(member)]);
        let alone = options.clone().with_start(&[0.0, 0.1], &belts.velocity(member));
        let run = event::integrate(&system, &alone).unwrap();
        let samples = run.motion.samples;
        assert_eq!(row(&found.ends.q, member, 2), row(&samples.q, samples.len() - 1, 2));
        assert_eq!(found.steps[member], run.motion.steps as i64);
    }
}

#[test]
fn a_system_that_there_is_not_fails_its_runs_alone() {
    let belts = Belts::new(&[0.6, -1.0, 0.8], 4);
    let found = many(&belts, 2);
    let failed: Vec<usize> = found.failures.iter().map(|failure| failure.member).collect();
    assert_eq!(failed, [4, 5, 6, 7]);
    for failure in &found.failures {
        assert!(
            matches!(&failure.reason, Reason::System(error) if error.to_string() == "no width: -1")
        );
        assert_eq!(found.endings[failure.member], Ending::Failed);
        assert!(row(&found.ends.q, failure.member, 2).iter().all(|x| x.is_nan()));
    }
    let whole = Belts::new(&[0.6, 0.8], 4);
    let alone = many(&whole, 1);
    assert_eq!(found.ends.q[..8], alone.ends.q[..8]);
    assert_eq!(found.ends.q[16..], alone.ends.q[8..]);
}

/// A system that is not built like the first one.
struct Other(LinearSystem, LinearSystem);

impl Members for Other {
    fn count(&self) -> usize {
        2
    }

    fn first(&self) -> &dyn System {
        &self.0
    }

    fn variant(&self, member: usize) -> usize {
        member
    }

    fn system(&self, variant: usize) -> Result<Member<'_>, SystemError> {
        Ok(Member::Held(if variant == 0 { &self.0 } else { &self.1 }))
    }
}

#[test]
fn a_system_of_another_build_is_refused() {
    let (zero, one) = (DMatrix::zeros(2, 2), DMatrix::identity(2, 2));
    let free = LinearSystem::new(one, zero.clone(), zero, vec![0.0; 2], Vec::new()).unwrap();
    let found = simulate_many(&Other(belt(0.7), free), &options(), &Keep::default(), None, &mut on)
        .unwrap();
    assert_eq!(found.endings, [Ending::Finished, Ending::Failed]);
    assert!(matches!(
        &found.failures[0].reason,
        Reason::System(SystemError::Argument(ArgumentError { argument: "system", .. }))
    ));
}

#[test]
fn samples_on_the_way_end_with_the_run() {
    let belts = Belts::new(&[0.7], 2);
    let keep = Keep { every: Some(30), ..Keep::default() };
    let found = simulate_many(&belts, &options(), &keep, Some(1), &mut on).unwrap();
    assert_eq!((found.samples_per_member, found.samples.len()), (5, 10));
    let times: Vec<f64> = found.samples.t[..5].iter().map(|t| (t * 100.0).round()).collect();
    assert_eq!(times, [0.0, 30.0, 60.0, 90.0, 100.0]);
    assert_eq!(row(&found.samples.q, 9, 2), row(&found.ends.q, 1, 2));
}

#[test]
fn an_observer_that_stops_leaves_the_rest_out() {
    let belts = Belts::new(&[0.7], 20_000);
    let long = Options::new(1e-3, 10.0).unwrap();
    let mut asked = 0;
    let found = simulate_many(&belts, &long, &Keep::default(), Some(2), &mut |_, _| {
        asked += 1;
        ControlFlow::Break(())
    });
    let found = found.unwrap();
    assert_eq!(asked, 1);
    let done = found.endings.iter().filter(|&&ending| ending == Ending::Finished).count();
    assert!(done < 20_000);
    let left = found.endings.iter().position(|&ending| ending == Ending::Interrupted).unwrap();
    assert!(found.failures.is_empty() && left < 20_000);
}

#[test]
fn options_that_mean_nothing_are_refused() {
    let belts = Belts::new(&[0.7], 1);
    let section = event::Section { normal: vec![1.0, 0.0], level: 0.0, after: 0.0 };
    let wrong = [
        Keep { every: Some(0), ..Keep::default() },
        Keep { after: f64::NAN, ..Keep::default() },
        Keep { section: Some(section), ..Keep::default() },
    ];
    for keep in wrong {
        assert!(simulate_many(&belts, &options(), &keep, None, &mut on).is_err());
        assert!(
            integrate_many(&belts, &event::Options::new(1.0).unwrap(), &keep, None, &mut on)
                .is_err()
        );
    }
}

#[test]
fn threads_of_the_solver_and_of_the_ensemble_do_not_multiply_nor_change_results() {
    let belts = Belts::new(&[0.7], 8);
    let many = |threads| {
        let solver = Solver::Auto { steps: Steps::ALL, threads };
        simulate_many(&belts, &options().with_solver(solver), &Keep::default(), Some(2), &mut on)
    };
    assert_eq!(many(1).unwrap().ends, many(4).unwrap().ends);
}

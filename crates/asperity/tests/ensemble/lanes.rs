//! Runs in lanes are the runs by themselves up to rounding, and the same to the bit for any number of lanes.

use std::mem::discriminant;
use std::ops::ControlFlow;

use asperity::ensemble::{Ending, Ensemble, Keep, Lanes, Member, Members, Workers, simulate_many};
use asperity::event::Section;
use asperity::law::{Fall, FrictionLaw, Law, Stribeck};
use asperity::set::{Convex, Ellipse, Polygon, Star, Superellipse, Vector};
use asperity::simulate::Options;
use asperity::solver::Solver;
use asperity::system::{
    Contact, InitialState, LinearSystem, System, SystemError, mass_on_belt, sliding_point,
};
use nalgebra::{DMatrix, Matrix2, Vector2};

use crate::common::Random;

const EVERY: [Lanes; 4] = [Lanes::One, Lanes::Four, Lanes::Eight, Lanes::Widest];

/// Runs of systems that are held.
struct Runs(Vec<(LinearSystem, InitialState)>);

impl Members for Runs {
    fn count(&self) -> usize {
        self.0.len()
    }

    fn first(&self) -> &dyn System {
        &self.0[0].0
    }

    fn variant(&self, member: usize) -> usize {
        member
    }

    fn system(&self, variant: usize) -> Result<Member<'_>, SystemError> {
        Ok(Member::Held(&self.0[variant].0))
    }

    fn start(&self, member: usize, _system: &dyn System) -> InitialState {
        self.0[member].1.clone()
    }
}

fn many(runs: &Runs, options: &Options, keep: &Keep, lanes: Lanes) -> Ensemble {
    let workers = Workers { threads: Some(1), lanes };
    simulate_many(runs, options, keep, workers, &mut |_, _| ControlFlow::Continue(())).unwrap()
}

fn ellipse(a: f64, b: f64, angle: f64) -> Convex<2> {
    Convex::from(Ellipse::new(Vector::<2>::new(a, b)).unwrap()).rotated(angle).unwrap()
}

fn superellipse(a: f64, b: f64, exponent: f64, angle: f64) -> Convex<2> {
    let set = Superellipse::new(Vector::<2>::new(a, b), exponent).unwrap();
    Convex::try_from(set).unwrap().rotated(angle).unwrap()
}

fn law(c: Convex<2>, d: Convex<2>) -> FrictionLaw<2> {
    FrictionLaw::new(Star::from(c), d).unwrap()
}

/// Belts that turn all around, from rest: in about a fortieth of the steps there are several solutions.
fn belts(count: usize) -> Runs {
    let belt = |k: usize| {
        let (sine, cosine) = (3.0 * k as f64 / count as f64).sin_cos();
        let law = law(ellipse(30.0, 10.0, 0.5), ellipse(3.0, 1.0, 0.0));
        let velocity = Vector2::new(cosine, sine);
        let belt = mass_on_belt(1.0, Matrix2::identity(), law, 1.0, velocity).unwrap();
        (belt, InitialState { q: vec![20.0, 3.0], u: vec![0.0, 0.0] })
    };
    Runs((0..count).map(belt).collect())
}

/// What the sets of a random law are.
#[derive(Clone, Copy, PartialEq)]
enum Shapes {
    Ellipses,
    /// Superellipses, with an ellipse in some of the laws.
    Superellipses,
}

/// A system that is driven and damped, with any directions, law and start.
fn random_run(
    random: &mut Random,
    shapes: Shapes,
    associated: bool,
) -> (LinearSystem, InitialState) {
    let matrix = |random: &mut Random, own: f64, other: f64| {
        let entries = [own, 0.0, 0.0, own].map(|own| own + other * random.normal());
        DMatrix::from_row_slice(2, 2, &entries)
    };
    let root = matrix(random, 1.0, 0.2);
    let mass = &root * root.transpose() + DMatrix::identity(2, 2) * 0.2;
    let (stiffness, damping) = (matrix(random, 3.0, 1.0), matrix(random, 0.3, 0.1));
    let force = vec![random.normal(), random.normal()];
    let set = |random: &mut Random| {
        let [a, b, angle] = [1.5, 1.5, 3.0].map(|most| random.within(0.2 * most, most));
        match shapes {
            Shapes::Superellipses if random.within(0.0, 1.0) < 0.8 => {
                superellipse(a, b, random.within(1.2, 6.0), angle)
            }
            _ => ellipse(a, b, angle),
        }
    };
    let reservoir = set(random);
    let direction = if associated { reservoir.clone() } else { set(random) };
    let law = law(reservoir, direction);
    let contact = Contact::with_force(law, matrix(random, 1.0, 0.3), random.within(0.2, 3.0));
    let velocity = vec![0.5 * random.normal(), 0.5 * random.normal()];
    let contacts = vec![Contact { velocity, ..contact }];
    let system = LinearSystem::new(mass, stiffness, damping, force, contacts).unwrap();
    let [a, b, c, d] = [0; 4].map(|_| random.normal());
    (system, InitialState { q: vec![a, b], u: vec![c, d] })
}

fn random_runs(count: usize, seed: u64, shapes: Shapes) -> Runs {
    let mut random = Random::new(seed);
    Runs((0..count).map(|k| random_run(&mut random, shapes, k % 3 == 0)).collect())
}

/// Runs with laws of ellipses and of superellipses in turn, which are not made side by side.
fn mixed_runs(count: usize) -> Runs {
    let [mut some, others] = [(5, Shapes::Ellipses), (6, Shapes::Superellipses)]
        .map(|(seed, shapes)| random_runs(count, seed, shapes));
    for (place, other) in some.0.iter_mut().zip(others.0).step_by(2) {
        *place = other;
    }
    some
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs() / (1.0 + a.abs())).fold(0.0, f64::max)
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

fn steps_in_lanes(many: &Ensemble) -> f64 {
    let sum = |numbers: &[i64]| numbers.iter().sum::<i64>() as f64;
    sum(&many.in_lanes) / sum(&many.steps)
}

#[test]
fn the_bits_are_the_same_for_any_number_of_lanes_and_any_neighbours() {
    let options = Options::new(1e-3, 1.5).unwrap();
    let keep = Keep { every: Some(100), ..Keep::default() };
    for mut runs in [
        belts(21),
        random_runs(21, 1, Shapes::Ellipses),
        random_runs(21, 1, Shapes::Superellipses),
        mixed_runs(21),
    ] {
        let one = many(&runs, &options, &keep, Lanes::One);
        assert!(steps_in_lanes(&one) > 0.5);
        for lanes in EVERY {
            let found = many(&runs, &options, &keep, lanes);
            let (here, there) = (&found.samples, &one.samples);
            assert!(bits(&here.q) == bits(&there.q) && bits(&here.u) == bits(&there.u));
            assert!(bits(&here.force) == bits(&there.force) && here.phase == there.phase);
            assert_eq!((&found.ambiguous, &found.in_lanes), (&one.ambiguous, &one.in_lanes));
        }
        runs.0.reverse();
        runs.0.truncate(10);
        let turned = many(&runs, &options, &keep, Lanes::Widest);
        for member in 0..10 {
            let (here, there) = (2 * member, 2 * (20 - member));
            assert_eq!(turned.ends.q[here..here + 2], one.ends.q[there..there + 2]);
            assert_eq!(turned.ends.u[here..here + 2], one.ends.u[there..there + 2]);
        }
    }
}

#[test]
fn runs_in_lanes_are_the_runs_by_themselves() {
    let options = Options::new(1e-3, 3.0).unwrap();
    let keep = Keep { every: Some(50), ..Keep::default() };
    for runs in [
        belts(64),
        random_runs(150, 2, Shapes::Ellipses),
        random_runs(150, 2, Shapes::Superellipses),
        mixed_runs(30),
    ] {
        let alone = many(&runs, &options, &keep, Lanes::None);
        let found = many(&runs, &options, &keep, Lanes::Widest);
        assert!(steps_in_lanes(&found) > 0.3, "{}", steps_in_lanes(&found));
        assert_eq!((&found.endings, &found.steps), (&alone.endings, &alone.steps));
        assert_eq!(found.ambiguous, alone.ambiguous);
        assert_eq!(found.samples.phase, alone.samples.phase);
        assert!(largest_difference(&found.samples.q, &alone.samples.q) < 1e-10);
        assert!(largest_difference(&found.samples.u, &alone.samples.u) < 1e-9);
        assert!(largest_difference(&found.samples.slip, &alone.samples.slip) < 1e-9);
    }
}

#[test]
fn steps_with_several_solutions_are_those_of_the_scalar_solver() {
    let (runs, options) = (belts(64), Options::new(1e-3, 3.0).unwrap());
    let found = many(&runs, &options, &Keep::default(), Lanes::Widest);
    let several: i64 = found.ambiguous.iter().sum();
    assert!(several > 200, "{several}");
    for ((steps, in_lanes), ambiguous) in
        found.steps.iter().zip(&found.in_lanes).zip(&found.ambiguous)
    {
        assert!(in_lanes + ambiguous <= *steps);
    }
    assert!(steps_in_lanes(&found) > 0.9, "{}", steps_in_lanes(&found));
}

#[test]
fn runs_of_few_steps_and_samples_of_every_step_are_the_runs_by_themselves() {
    let runs = belts(3);
    for steps in [1, 2, 3] {
        let options = Options::new(1e-3, 1.0).unwrap().with_steps(steps);
        for every in [None, Some(1), Some(2)] {
            let keep = Keep { every, ..Keep::default() };
            let alone = many(&runs, &options, &keep, Lanes::None);
            let found = many(&runs, &options, &keep, Lanes::Widest);
            assert_eq!((&found.endings, &found.steps), (&alone.endings, &alone.steps));
            assert_eq!(found.samples.len(), alone.samples.len());
            assert!(largest_difference(&found.ends.q, &alone.ends.q) < 1e-14);
            assert_eq!(found.samples.phase, alone.samples.phase);
        }
    }
}

#[test]
fn quantities_on_the_way_are_those_of_runs_by_themselves() {
    let section = Section { normal: vec![1.0, 0.0, 0.0, 0.0], level: 0.0, after: 0.0 };
    let keep = Keep {
        extent: true,
        stick_share: true,
        rest_time: true,
        section: Some(section),
        after: 0.2,
        ..Keep::default()
    };
    let (runs, options) = (mixed_runs(40), Options::new(1e-3, 4.0).unwrap());
    let alone = many(&runs, &options, &keep, Lanes::None);
    let found = many(&runs, &options, &keep, Lanes::Widest);
    assert_eq!(found.reduced.crossings, alone.reduced.crossings);
    assert!(alone.reduced.crossings.iter().sum::<i64>() > 10);
    let near = |a: &[f64], b: &[f64]| {
        for (a, b) in a.iter().zip(b) {
            assert!((a - b).abs() < 1e-8 || a.is_nan() && b.is_nan(), "{a} {b}");
        }
    };
    near(&found.reduced.extent, &alone.reduced.extent);
    near(&found.reduced.stick_share, &alone.reduced.stick_share);
    near(&found.reduced.rest_time, &alone.reduced.rest_time);
    near(&found.reduced.crossing_q, &alone.reduced.crossing_q);
}

#[test]
fn points_that_come_to_rest_end_where_they_do_by_themselves() {
    let mut random = Random::new(4);
    let point = |k| {
        let law = match k % 2 {
            0 => law(ellipse(0.6, 0.2, 0.5), ellipse(3.0, 1.0, 0.0)),
            _ => law(superellipse(0.6, 0.2, 2.5, 0.5), superellipse(3.0, 1.0, 1.5, 0.0)),
        };
        // The first two rest from the beginning.
        let start = [random.normal(), random.normal()].map(|v| if k < 2 { 0.0 } else { v });
        let start = InitialState { q: vec![0.0; 2], u: start.to_vec() };
        (sliding_point(2.0, law, 9.81).unwrap(), start)
    };
    let runs = Runs((0..30).map(point).collect());
    let options = Options::new(1e-3, 5.0).unwrap().until_rest();
    let alone = many(&runs, &options, &Keep::default(), Lanes::None);
    let found = many(&runs, &options, &Keep::default(), Lanes::Widest);
    assert!(alone.endings.iter().all(|&ending| ending == Ending::AtRest));
    assert_eq!((&found.endings, &found.steps), (&alone.endings, &alone.steps));
    assert!(largest_difference(&found.ends.q, &alone.ends.q) < 1e-12);
    assert_eq!(found.ends.phase, alone.ends.phase);
}

#[test]
fn what_lanes_cannot_do_is_done_alone_to_the_bit() {
    let disk = || Ellipse::new(Vector::<2>::new(0.5, 0.5)).unwrap();
    let nearly_rhombus = superellipse(0.5, 0.3, 1.05, 0.3);
    let polygon = Polygon::new(&[[0.5, 0.0], [0.0, 0.4], [-0.3, -0.1]].map(Vector::<2>::from));
    let falling = Stribeck::new(Fall::Hyperbolic, 0.1, 0.5, 1.0, 0.0).unwrap();
    let laws: [FrictionLaw<2>; 4] = [
        law(nearly_rhombus, disk().into()),
        FrictionLaw::new(polygon.unwrap().into(), disk().into()).unwrap(),
        FrictionLaw::isotropic(0.4).unwrap().with_rate(falling),
        law(ellipse(0.5, 1e-4, 0.0), disk().into()),
    ];
    let mut runs: Vec<_> =
        laws.into_iter().map(|law| sliding_point(1.0, law, 9.81).unwrap()).collect();
    let unit = DMatrix::identity(2, 2);
    let contact = |restitution| {
        let law = Law::from(FrictionLaw::<2>::isotropic(0.4).unwrap());
        Contact { restitution, ..Contact::with_force(law, unit.clone(), 9.81) }
    };
    let zero = DMatrix::zeros(2, 2);
    let bouncing = vec![contact((0.0, 0.5))];
    runs.push(LinearSystem::new(unit.clone(), zero.clone(), zero, vec![0.0; 2], bouncing).unwrap());
    let start = InitialState { q: vec![0.0; 2], u: vec![1.0, 0.4] };
    let runs = Runs(runs.into_iter().map(|system| (system, start.clone())).collect());
    let options = Options::new(1e-3, 0.3).unwrap();
    let exact = options.clone().with_solver(Solver::SemismoothNewton { max_iterations: 50 });
    let plain = Runs(vec![belts(1).0.remove(0)]);
    for (runs, options) in
        [(&runs, &options), (&plain, &exact), (&plain, &options.clone().with_tolerance(1e-13))]
    {
        let alone = many(runs, options, &Keep::default(), Lanes::None);
        let found = many(runs, options, &Keep::default(), Lanes::Widest);
        assert_eq!(found.ends, alone.ends);
        assert!(found.in_lanes.iter().all(|&steps| steps == 0));
    }
}

#[test]
fn a_run_that_leaves_the_range_of_numbers_fails_as_it_does_alone() {
    let mut runs = belts(6);
    let law = law(ellipse(30.0, 10.0, 0.5), ellipse(3.0, 1.0, 0.0));
    let velocity = Vector2::new(1.0, 0.0);
    runs.0[3].0 = mass_on_belt(1.0, Matrix2::identity() * -1e6, law, 1.0, velocity).unwrap();
    let options = Options::new(1e-2, 5.0).unwrap();
    let alone = many(&runs, &options, &Keep::default(), Lanes::None);
    for lanes in EVERY {
        let found = many(&runs, &options, &Keep::default(), lanes);
        assert_eq!(found.endings, alone.endings);
        assert_eq!(found.endings[3], Ending::Failed);
        let [failure] = &found.failures[..] else { panic!("{:?}", found.failures) };
        assert_eq!(discriminant(&failure.reason), discriminant(&alone.failures[0].reason));
        assert_eq!((failure.member, failure.time), (3, alone.failures[0].time));
        assert!(largest_difference(&found.ends.q[..6], &alone.ends.q[..6]) < 1e-10);
    }
}

#[test]
fn a_call_that_is_stopped_keeps_where_its_runs_are() {
    let runs = belts(9);
    let options = Options::new(1e-4, 1e4).unwrap();
    let workers = Workers { threads: Some(1), lanes: Lanes::Widest };
    let stop = &mut |_, _| ControlFlow::Break(());
    let found = simulate_many(&runs, &options, &Keep::default(), workers, stop).unwrap();
    assert!(found.endings.iter().all(|&ending| ending == Ending::Interrupted));
    assert!(found.steps[0] > 0 && found.ends.q[0].is_finite() && found.steps[8] == 0);
    let steps = found.steps[0] as usize;
    let again = many(&runs, &options.with_steps(steps), &Keep::default(), Lanes::One);
    assert_eq!(again.ends.q[..2], found.ends.q[..2]);
}

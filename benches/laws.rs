//! Cost of a law, with and without what its first run asks of it, and of the start of a run, beside floors: the sets
//! alone, and a step of a run that goes on.
//!
//! With `count` and a name it does the same thing 1,000 times and makes no measurement, for tools that count
//! instructions.

mod report;

use std::hint::black_box;
use std::time::Instant;

use asperity::law::FrictionLaw;
use asperity::set::{Convex, Ellipse, Star, Superellipse, Vector};
use asperity::solver::Solver;
use asperity::stepper::{State, Stepper};
use asperity::system::{LinearSystem, mass_on_belt, sliding_point};
use nalgebra::{Matrix2, Vector2};

type V = Vector<2>;
type Sets = (Star<2>, Convex<2>);
type Kind = (&'static str, fn(usize) -> Sets);

const DT: f64 = 1e-3;
const MANY: usize = 1000;

fn ellipse(a: f64, b: f64, angle: f64) -> Convex<2> {
    Convex::from(Ellipse::new(V::new(a, b)).unwrap()).rotated(angle).unwrap()
}

fn superellipse(a: f64, b: f64, s: f64) -> Convex<2> {
    Superellipse::new(V::new(a, b), s).unwrap().try_into().unwrap()
}

/// Sets that differ from each other in the number.
fn ellipses(k: usize) -> Sets {
    (ellipse(0.6 + 1e-5 * k as f64, 0.3, 0.4).into(), ellipse(3.0, 2.0, 0.0))
}

/// Of these some loads have several solutions.
fn slender(k: usize) -> Sets {
    (ellipse(0.6 + 1e-5 * k as f64, 0.2, 0.5).into(), ellipse(3.0, 1.0, 0.0))
}

fn superellipses(k: usize) -> Sets {
    (superellipse(0.54 + 1e-5 * k as f64, 0.46, 2.94).into(), superellipse(1.84, 1.19, 2.51))
}

fn turned(k: usize) -> Sets {
    let reservoir = superellipse(0.54 + 1e-5 * k as f64, 0.46, 2.94).rotated(0.4).unwrap();
    (reservoir.into(), superellipse(1.84, 1.19, 2.51))
}

fn law((reservoir, direction): Sets) -> FrictionLaw<2> {
    FrictionLaw::new(reservoir, direction).unwrap()
}

fn stepper<'a>(system: &'a LinearSystem, start: &State) -> Stepper<'a> {
    Stepper::new(system, Solver::default(), 1e-10, DT, start).unwrap()
}

fn at_speed(u: [f64; 2]) -> State {
    State::new(0.0, &[0.0; 2], &u)
}

/// Two steps of a mass on a belt with this law, the first one in stick.
fn first_steps(law: FrictionLaw<2>) -> f64 {
    let belt = Vector2::new(0.6, 0.8);
    let system = mass_on_belt(1.0, Matrix2::identity() * 1e4, law, 10.0, belt).unwrap();
    let mut stepper = stepper(&system, &at_speed([0.6, 0.8]));
    (0..2).for_each(|_| assert!(stepper.step().is_ok()));
    stepper.u()[0]
}

/// Microseconds, the best of several rounds of many, every one with a number of its own.
fn microseconds(run: &mut dyn FnMut(usize) -> f64) -> f64 {
    let mut best = f64::INFINITY;
    for round in 0..5 {
        let start = Instant::now();
        for k in 0..MANY {
            black_box(run(round * MANY + k));
        }
        best = best.min(start.elapsed().as_secs_f64() * 1e6 / MANY as f64);
    }
    best
}

fn main() {
    let kinds: [Kind; 4] = [
        ("ellipses", ellipses),
        ("slender ellipses", slender),
        ("superellipses", superellipses),
        ("superellipse, turned", turned),
    ];
    let system = sliding_point(1.0, law(ellipses(0)), 9.81).unwrap();
    let states: Vec<State> = (0..MANY).map(|k| at_speed([1.0 + 1e-3 * k as f64, 1.0])).collect();
    let mut going = stepper(&system, &at_speed([1e6, 1e6]));
    let mut again = stepper(&system, &states[0]);
    let step = |stepper: &mut Stepper<'_>| {
        assert!(stepper.step().is_ok());
        stepper.u()[0]
    };
    let mut next = |_: usize| step(&mut going);
    let mut new = |k: usize| step(&mut stepper(&system, &states[k % MANY]));
    let mut restart = |k: usize| {
        again.restart(&states[k % MANY]).unwrap();
        step(&mut again)
    };
    let mut arguments = std::env::args().skip_while(|argument| argument != "count").skip(1);
    if let Some(name) = arguments.next() {
        let kind = kinds.iter().find(|kind| kind.0 == name);
        for k in 0..MANY {
            black_box(match (&name[..], kind) {
                ("new", _) => new(k),
                ("restart", _) => restart(k),
                (_, Some((_, sets))) => first_steps(law(sets(k))),
                _ => panic!("there is no {name}"),
            });
        }
        return;
    }
    println!("law, µs                    sets      law   + alpha_min   + first two steps");
    for (name, sets) in kinds {
        let alone = microseconds(&mut |k| {
            black_box(sets(k));
            0.0
        });
        let made = microseconds(&mut |k| law(sets(k)).direction_scale());
        let smallest = microseconds(&mut |k| law(sets(k)).alpha_min());
        let run = microseconds(&mut |k| first_steps(law(sets(k))));
        println!("{name:22} {alone:8.2} {made:8.2} {smallest:13.2} {run:19.2}");
        report::ratio(
            &format!("a law of {name}"),
            made / alone,
            "its two sets alone",
            "what it costs to make a law, as one does for every member of an ensemble",
        );
    }
    println!("\nstart of a run, µs       step  restart + step   new + step   allowed");
    let [step, restart, new] =
        [&mut next as &mut dyn FnMut(usize) -> f64, &mut restart, &mut new].map(microseconds);
    println!("sliding point        {step:8.3} {restart:15.3} {new:12.3}   4.9");
    report::ratio(
        "a new run and its first step",
        new / step,
        "a step of a run that goes on",
        "below how many steps the start of a run is the larger part",
    );
}

//! Cost of many runs in one call, as a ratio to the same runs one after the other.
//!
//! The mass on a belt from random velocities, 1,000 steps each, some of them in stick; what is printed are ratios of the
//! shortest of several runs, which alternate so that noise meets them alike. Allowed are 1.10 times the cost of single
//! runs on one thread, a speedup of 1.85 by two threads, and 200 bytes per run.

mod report;

use std::fs;
use std::hint::black_box;
use std::ops::ControlFlow;
use std::time::Instant;

use asperity::ensemble::{Keep, Members, simulate_many};
use asperity::law::FrictionLaw;
use asperity::set::{Convex, Ellipse, Vector};
use asperity::simulate::{Options, simulate};
use asperity::system::{InitialState, LinearSystem, System, mass_on_belt};
use nalgebra::{Matrix2, Vector2};

const DT: f64 = 1e-2;
const STEPS: usize = 1000;

/// A mass on a belt from so many velocities.
struct Belt {
    system: LinearSystem,
    count: usize,
}

impl Belt {
    fn new(count: usize) -> Self {
        let reservoir: Convex<2> = Ellipse::new(Vector::<2>::new(30.0, 10.0)).unwrap().into();
        let direction = Ellipse::new(Vector::<2>::new(3.0, 1.0)).unwrap().into();
        let reservoir = reservoir.rotated(30f64.to_radians()).unwrap();
        let law = FrictionLaw::new(reservoir.into(), direction).unwrap();
        let (sine, cosine) = 50f64.to_radians().sin_cos();
        let velocity = Vector2::new(cosine, sine);
        let system = mass_on_belt(1.0, Matrix2::identity(), law, 1.0, velocity).unwrap();
        Self { system, count }
    }

    fn velocity(member: usize) -> [f64; 2] {
        // Fractions of multiples of irrational numbers fill the square evenly.
        [0.618_033_988_749_895, 0.414_213_562_373_095]
            .map(|irrational| 20.0 * (irrational * (member + 1) as f64).fract() - 10.0)
    }
}

impl Members for Belt {
    fn count(&self) -> usize {
        self.count
    }

    fn first(&self) -> &dyn System {
        &self.system
    }

    fn start(&self, member: usize, _system: &dyn System) -> InitialState {
        InitialState { q: vec![0.0; 2], u: Self::velocity(member).to_vec() }
    }
}

fn options(steps: usize) -> Options {
    Options::new(DT, DT).unwrap().with_steps(steps)
}

fn go_on(_: usize, _: usize) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Seconds that the runs take one after the other.
fn alone(belt: &Belt, steps: usize) -> f64 {
    let start = Instant::now();
    for member in 0..belt.count {
        let options = options(steps).with_save_every(steps);
        let options = options.with_start(&[0.0; 2], &Belt::velocity(member));
        let run = simulate(&belt.system, &options).unwrap();
        black_box(run.trajectory.samples.q[2]);
    }
    start.elapsed().as_secs_f64()
}

/// Seconds that they take in one call.
fn together(belt: &Belt, steps: usize, threads: usize) -> f64 {
    let start = Instant::now();
    let keep = Keep::default();
    let found = simulate_many(belt, &options(steps), &keep, Some(threads), &mut go_on).unwrap();
    assert!(found.failures.is_empty());
    black_box(found.ends.q[0]);
    start.elapsed().as_secs_f64()
}

/// The shortest of several times of each kind.
fn shortest<const N: usize>(times: usize, measure: [&dyn Fn() -> f64; N]) -> [f64; N] {
    let mut best = [f64::INFINITY; N];
    for _ in 0..times {
        for (best, measure) in best.iter_mut().zip(measure) {
            *best = best.min(measure());
        }
    }
    best
}

/// Memory of this process in bytes, where the system tells it.
fn memory() -> Option<f64> {
    let pages = fs::read_to_string("/proc/self/statm").ok()?;
    let resident: f64 = pages.split_whitespace().nth(1)?.parse().ok()?;
    Some(resident * 4096.0)
}

fn main() {
    let belt = Belt::new(4000);
    let [single, one, two] = shortest(
        5,
        [&|| alone(&belt, STEPS), &|| together(&belt, STEPS, 1), &|| together(&belt, STEPS, 2)],
    );
    let per_step = 1e9 / (STEPS * belt.count) as f64;
    println!("4,000 runs of 1,000 steps      ns/step    ratio   allowed");
    println!("one after the other           {:8.1}", single * per_step);
    println!(
        "in one call, one thread       {:8.1}  {:7.2}      1.10",
        one * per_step,
        one / single
    );
    println!(
        "in one call, two threads      {:8.1}  {:7.2}      {:.2}",
        two * per_step,
        two / one,
        1.0 / 1.85
    );
    report::ratio(
        "4,000 runs in one call, on one thread",
        one / single,
        "the same runs, one call after the other",
        "what it costs to have many runs looked after: nothing, if it is 1",
    );
    report::ratio(
        "4,000 runs in one call, on two threads",
        two / one,
        "the same on one thread",
        "what a second core saves: half would be 0.5",
    );
    let [starts] = shortest(5, [&|| together(&Belt::new(100_000), 1, 1)]);
    println!("start and first step          {:8.1} ns per run", starts * 1e9 / 1e5);
    println!("\nruns of 100 steps         us/run");
    for count in [100, 1000, 10_000, 100_000, 1_000_000] {
        let belt = Belt::new(count);
        let [time] = shortest(if count < 100_000 { 3 } else { 1 }, [&|| together(&belt, 100, 2)]);
        println!("{count:<22} {:9.2}", time * 1e6 / count as f64);
    }
    let before = memory();
    let (belt, keep) = (Belt::new(1_000_000), Keep::default());
    let found = simulate_many(&belt, &options(1), &keep, Some(2), &mut go_on).unwrap();
    if let (Some(before), Some(after)) = (before, memory()) {
        let bytes = (after - before) / found.endings.len() as f64;
        println!("\nmemory of a run of which the end is kept   {bytes:6.0} bytes, allowed 200");
    }
}

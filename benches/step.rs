//! Cost of a time step, as a ratio to a hand-written loop for the same problem.
//!
//! `cargo bench` prints the ratios of the shortest of several runs. With the argument `million` it only prints the
//! nanoseconds per step of a million belt steps with every 100th saved, the floor that `python_overhead.py` compares
//! Python with. With `count` and `hand` or `exact` it makes 20,000 belt steps and no
//! measurement, for tools that count instructions; a third argument is another number of steps.

mod report;

use std::hint::black_box;
use std::time::Instant;

use asperity::law::FrictionLaw;
use asperity::set::{Convex, Ellipse, Superellipse, Vector};
use asperity::simulate::{Options, Outcome, simulate};
use asperity::solver::Solver;
use asperity::system::{LinearSystem, mass_on_belt, sliding_point};
use nalgebra::{Matrix2, Vector2};

const STEPS: usize = 200_000;
const DT: f64 = 1e-3;

fn belt_law() -> FrictionLaw<2> {
    let reservoir: Convex<2> = Ellipse::new(Vector::<2>::new(30.0, 10.0)).unwrap().into();
    let direction = Ellipse::new(Vector::<2>::new(3.0, 1.0)).unwrap().into();
    FrictionLaw::new(reservoir.rotated(30f64.to_radians()).unwrap().into(), direction).unwrap()
}

fn belt() -> LinearSystem {
    let (sine, cosine) = 50f64.to_radians().sin_cos();
    mass_on_belt(1.0, Matrix2::identity(), belt_law(), 1.0, Vector2::new(cosine, sine)).unwrap()
}

/// Table 1 of [WL19], sliding at 1 km/s so that it never stops.
fn disk() -> LinearSystem {
    let superellipse =
        |a: f64, b: f64, s: f64| Superellipse::new(Vector::<2>::new(a / 9.3, b / 9.3), s).unwrap();
    let direction = Convex::try_from(superellipse(1.84, 1.19, 2.51)).unwrap();
    let law = FrictionLaw::new(superellipse(4.99, 4.25, 2.94).into(), direction).unwrap();
    sliding_point(0.018, law, 9.81).unwrap()
}

fn run(system: &LinearSystem, u0: [f64; 2], steps: usize, save_every: usize) -> f64 {
    let options = Options::new(DT, DT).unwrap().with_steps(steps).with_save_every(save_every);
    let options = options.with_start(&[0.0; 2], &u0).with_solver(Solver::Exact { max_sweeps: 1 });
    let run = simulate(system, &options).unwrap();
    assert!(matches!(run.outcome, Outcome::Finished));
    run.trajectory.samples.q[2]
}

/// The floor: the belt problem by hand, with nothing that this problem does not need. Stick where the
/// force fits into the ellipse, else Newton's method in the angle of the normal from the last one.
fn floor(steps: usize) -> f64 {
    let (sine, cosine) = 50f64.to_radians().sin_cos();
    let (s, c) = 30f64.to_radians().sin_cos();
    let (p, r) = (1.0 / 900.0, 1.0 / 100.0);
    let shape = [p * c * c + r * s * s, (p - r) * c * s, p * s * s + r * c * c];
    let gauge = |x: [f64; 2]| {
        (shape[0] * x[0] * x[0] + 2.0 * shape[1] * x[0] * x[1] + shape[2] * x[1] * x[1]).sqrt()
    };
    let (mut q, mut u, mut n) = ([0.0_f64; 2], [0.0_f64; 2], [-cosine, -sine]);
    for _ in 0..steps {
        let mid = [q[0] + 0.5 * DT * u[0], q[1] + 0.5 * DT * u[1]];
        let b = [u[0] - DT * mid[0] - cosine, u[1] - DT * mid[1] - sine];
        let mut x = [b[0] / DT, b[1] / DT];
        if gauge(x) > 1.0 {
            // From another start where the last direction leads to a root with n·v < 0: rare.
            let mut starts = (0..8).map(|k| (f64::from(k) * 0.8).sin_cos());
            while !slip(&gauge, shape, b, &mut n, &mut x) {
                (n[0], n[1]) = starts.next().expect("a slip solution exists");
            }
        }
        for i in 0..2 {
            u[i] += -DT * mid[i] - DT * x[i];
            q[i] = mid[i] + 0.5 * DT * u[i];
        }
    }
    q[0]
}

/// Newton's method for `n × (b − Δt x) = 0`; whether it found a slip solution.
#[inline(always)]
fn slip(
    gauge: &impl Fn([f64; 2]) -> f64,
    shape: [f64; 3],
    b: [f64; 2],
    n: &mut [f64; 2],
    x: &mut [f64; 2],
) -> bool {
    for _ in 0..20 {
        let support = (9.0 * n[0] * n[0] + n[1] * n[1]).sqrt();
        let z = [9.0 * n[0] / support, n[1] / support];
        let k = gauge(z);
        *x = [z[0] / k, z[1] / k];
        let v = [b[0] - DT * x[0], b[1] - DT * x[1]];
        let value = n[0] * v[1] - n[1] * v[0];
        if value.abs() < 1e-15 {
            return n[0] * v[0] + n[1] * v[1] > 0.0;
        }
        let t = [-n[1], n[0]];
        let along = (9.0 * n[0] * t[0] + n[1] * t[1]) / support;
        let dz = [(9.0 * t[0] - z[0] * along) / support, (t[1] - z[1] * along) / support];
        let slope = ((shape[0] * z[0] + shape[1] * z[1]) * dz[0]
            + (shape[1] * z[0] + shape[2] * z[1]) * dz[1])
            / k;
        let dx = [(dz[0] - x[0] * slope) / k, (dz[1] - x[1] * slope) / k];
        let step = value / (n[0] * v[0] + n[1] * v[1] + DT * (n[0] * dx[1] - n[1] * dx[0]));
        let m = [n[0] + t[0] * step, n[1] + t[1] * step];
        let length = (m[0] * m[0] + m[1] * m[1]).sqrt();
        *n = [m[0] / length, m[1] / length];
    }
    false
}

/// Nanoseconds per step: the best of several runs, alternating so that noise meets all alike.
fn nanoseconds(candidates: &[&dyn Fn() -> f64]) -> Vec<f64> {
    let mut best = vec![f64::INFINITY; candidates.len()];
    for _ in 0..7 {
        for (candidate, best) in candidates.iter().zip(&mut best) {
            let start = Instant::now();
            black_box(candidate());
            *best = best.min(start.elapsed().as_secs_f64() * 1e9 / STEPS as f64);
        }
    }
    best
}

fn main() {
    let (belt, disk) = (belt(), disk());
    if std::env::args().any(|argument| argument == "million") {
        let steps = 5 * STEPS;
        let million = || run(&belt, [0.0; 2], steps, 100);
        println!("{}", nanoseconds(&[&million])[0] * STEPS as f64 / steps as f64);
        return;
    }
    let mut arguments = std::env::args().skip_while(|argument| argument != "count").skip(1);
    if let Some(candidate) = arguments.next() {
        let steps = arguments.next().and_then(|steps| steps.parse().ok()).unwrap_or(20_000);
        let count =
            if candidate == "hand" { floor(steps) } else { run(&belt, [0.0; 2], steps, steps) };
        black_box(count);
        return;
    }
    let difference = (floor(STEPS) - run(&belt, [0.0; 2], STEPS, STEPS)).abs();
    assert!(difference < 1e-6, "the floor solves another problem: {difference:e} m apart");
    let times = nanoseconds(&[&|| floor(STEPS), &|| run(&belt, [0.0; 2], STEPS, STEPS), &|| {
        run(&disk, [1e3, 5e2], STEPS, STEPS)
    }]);
    println!("step                        ns    ratio   allowed");
    println!("belt, hand-written   {:9.1}", times[0]);
    println!("belt, default solver {:9.1}  {:7.2}   2", times[1], times[1] / times[0]);
    println!("disk, superellipses  {:9.1}            1000 ns", times[2]);
    report::ratio(
        "a step of a mass on a belt with elliptic sets",
        times[1] / times[0],
        "a loop written by hand for this problem alone",
        "what the general solver, its checks and its measure of the residual cost at one contact",
    );
    report::ratio(
        "a step of a disk that slides under superellipses",
        times[2] / times[1],
        "the step on the belt with ellipses",
        "what exponents other than 2 cost, whose powers have no closed form",
    );
}

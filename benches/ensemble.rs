//! Cost of a step of an ensemble on one thread, alone and in lanes, as a ratio to the runs one after the other.
//!
//! The mass on a belt that turns all around, 64 directions from near slip. `cargo bench --bench ensemble` prints the shortest of
//! several runs that alternate; `cargo bench --bench ensemble -- steps 1000` makes so many steps.

use std::ops::ControlFlow;
use std::time::Instant;

use asperity::ensemble::{Ensemble, Keep, Lanes, Member, Members, Workers, simulate_many};
use asperity::law::FrictionLaw;
use asperity::set::{Convex, Ellipse, Vector};
use asperity::simulate::Options;
use asperity::system::{InitialState, LinearSystem, System, SystemError, mass_on_belt};
use nalgebra::{Matrix2, Vector2};

const RUNS: usize = 64;

struct Belts(Vec<LinearSystem>);

impl Members for Belts {
    fn count(&self) -> usize {
        self.0.len()
    }

    fn first(&self) -> &dyn System {
        &self.0[0]
    }

    /// Near the place where it begins to slide.
    fn start(&self, _member: usize, _system: &dyn System) -> InitialState {
        InitialState { q: vec![20.0, 3.0], u: vec![0.0; 2] }
    }

    fn variant(&self, member: usize) -> usize {
        member
    }

    fn system(&self, variant: usize) -> Result<Member<'_>, SystemError> {
        Ok(Member::Held(&self.0[variant]))
    }
}

fn ellipses(angle: f64) -> FrictionLaw<2> {
    let reservoir: Convex<2> = Ellipse::new(Vector::<2>::new(30.0, 10.0)).unwrap().into();
    let direction = Ellipse::new(Vector::<2>::new(3.0, 1.0)).unwrap().into();
    FrictionLaw::new(reservoir.rotated(angle).unwrap().into(), direction).unwrap()
}

/// Directions of a belt, all around.
fn belts(law: impl Fn() -> FrictionLaw<2>) -> Belts {
    let belt = |k: usize| {
        let (sine, cosine) = (std::f64::consts::PI * k as f64 / RUNS as f64).sin_cos();
        mass_on_belt(1.0, Matrix2::identity(), law(), 1.0, Vector2::new(cosine, sine)).unwrap()
    };
    Belts((0..RUNS).map(belt).collect())
}

fn run(belts: &Belts, steps: usize, lanes: Lanes) -> Ensemble {
    let options = Options::new(1e-3, 1e-3).unwrap().with_steps(steps);
    let workers = Workers { threads: Some(1), lanes };
    let go_on = &mut |_, _| ControlFlow::Continue(());
    simulate_many(belts, &options, &Keep::default(), workers, go_on).unwrap()
}

/// Largest difference of the ends of two ensembles.
fn apart(a: &Ensemble, b: &Ensemble) -> f64 {
    let pairs = a.ends.q.iter().zip(&b.ends.q);
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn main() {
    let mut arguments = std::env::args().skip_while(|argument| argument != "steps").skip(1);
    let steps = arguments.next().and_then(|steps| steps.parse().ok()).unwrap_or(10_000);
    let kinds = [
        ("alone", Lanes::None),
        ("1 lane", Lanes::Of(1)),
        ("4 lanes", Lanes::Of(4)),
        ("8 lanes", Lanes::Of(8)),
        ("widest", Lanes::Widest),
    ];
    let laws: [(&str, Box<dyn Fn() -> FrictionLaw<2>>); 2] = [
        ("ellipses", Box::new(|| ellipses(30f64.to_radians()))),
        ("isotropic", Box::new(|| FrictionLaw::isotropic(20.0).unwrap())),
    ];
    println!("belt, ns per step      ns    ratio   in lanes   ambiguous   apart");
    for (name, law) in laws {
        let belts = belts(law);
        let reference = run(&belts, steps, Lanes::None);
        let mut best = [f64::INFINITY; 5];
        let mut found = Vec::new();
        for round in 0..15 {
            for ((_, lanes), best) in kinds.iter().zip(&mut best) {
                let start = Instant::now();
                let many = run(&belts, steps, *lanes);
                *best = best.min(start.elapsed().as_secs_f64() * 1e9 / (steps * RUNS) as f64);
                if round == 0 {
                    found.push(many);
                }
            }
        }
        for ((kind, _), (time, many)) in kinds.iter().zip(best.iter().zip(&found)) {
            let part = |numbers: &[i64]| numbers.iter().sum::<i64>() as f64 / (steps * RUNS) as f64;
            println!(
                "{name:10} {kind:8} {time:7.1}  {:7.2}   {:8.4}   {:9.6}   {:.1e}",
                time / best[0],
                part(&many.in_lanes),
                part(&many.ambiguous),
                apart(&reference, many),
            );
        }
    }
}

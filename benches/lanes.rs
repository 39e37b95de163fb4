//! Cost of a step of an ensemble on one thread: runs one after the other, and side by side in lanes.
//!
//! Masses on belts that move in 64 directions, from near the place where they begin to slip: first in a long slip, whose
//! end is where the contact has several solutions in a fortieth of the steps, later in cycles of stick and slip.
//! `cargo bench --bench lanes` prints the shortest of several runs that alternate, and by how much coordinates at the
//! end differ; `cargo bench --bench lanes -- steps 10000` makes so many steps.
//!
//! On an Intel Xeon with AVX-512, four lanes of AVX2 took 0.23 of the time of the runs alone with ellipses, 0.17 with
//! isotropic friction and 0.40 with superellipses; over the first 10,000 steps 0.49, 0.18 and 0.39. Eight lanes of AVX-512
//! took 0.29, 0.26 and 0.45 (0.55, 0.28 and 0.43): roots and divisions are no faster there, and a group waits for its
//! slowest lane. `pulp` is built without them.

mod report;

use std::ops::ControlFlow;
use std::time::Instant;

use asperity::ensemble::{Ensemble, Keep, Lanes, Member, Members, Workers, simulate_many};
use asperity::law::FrictionLaw;
use asperity::set::{Convex, Ellipse, Superellipse, Vector};
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

/// A reservoir and a direction set with the exponents that were measured for PVC on ground steel (\[WL19\] Table 1).
fn superellipses(angle: f64) -> FrictionLaw<2> {
    let set = |a: f64, b: f64, exponent: f64| -> Convex<2> {
        Superellipse::new(Vector::<2>::new(a, b), exponent).unwrap().try_into().unwrap()
    };
    let reservoir = set(30.0, 10.0, 2.94).rotated(angle).unwrap();
    FrictionLaw::new(reservoir.into(), set(3.0, 1.0, 2.51)).unwrap()
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
    let steps = arguments.next().and_then(|steps| steps.parse().ok()).unwrap_or(100_000);
    let kinds = [("alone", Lanes::None), ("in lanes", Lanes::Widest)];
    println!("belts                       ns    ratio   allowed   in lanes   ambiguous   apart");
    let turned = belts(|| ellipses(30f64.to_radians()));
    let isotropic = belts(|| FrictionLaw::isotropic(20.0).unwrap());
    let powers = belts(|| superellipses(30f64.to_radians()));
    for (name, belts) in [("ellipses", turned), ("isotropic", isotropic), ("superellipses", powers)]
    {
        let reference = run(&belts, steps, Lanes::None);
        let mut best = [f64::INFINITY; 2];
        let mut found = Vec::new();
        for round in 0..7 {
            for ((_, lanes), best) in kinds.iter().zip(&mut best) {
                let start = Instant::now();
                let many = run(&belts, steps, *lanes);
                *best = best.min(start.elapsed().as_secs_f64() * 1e9 / (steps * RUNS) as f64);
                if round == 0 {
                    found.push(many);
                }
            }
        }
        for ((kind, lanes), (time, many)) in kinds.iter().zip(best.iter().zip(&found)) {
            let part = |numbers: &[i64]| numbers.iter().sum::<i64>() as f64 / (steps * RUNS) as f64;
            println!(
                "{name:14} {kind:8} {time:7.1}  {:7.2}   {:7}   {:8.4}   {:9.6}   {:.1e}",
                time / best[0],
                if *lanes == Lanes::None { "" } else { "0.7" },
                part(&many.in_lanes),
                part(&many.ambiguous),
                apart(&reference, many),
            );
        }
        report::ratio(
            &format!("64 runs side by side in lanes, {name}"),
            best[1] / best[0],
            "the same runs, one after the other, on the same thread",
            "what `lanes=True` saves where runs of one kind of law are many",
        );
    }
}

//! Cost of a step of many rigid bodies: `cargo bench --bench bodies` prints nanoseconds per body for
//! independent sliders, boxes that slide and turn on off-centre points with an elliptic law, tumbling boxes, boxes at
//! rest and rolling balls; arguments name one of them and the number of bodies.

mod report;

use std::hint::black_box;
use std::time::Instant;

use asperity::law::{FrictionLaw, Law};
use asperity::set::{Convex, Ellipse, Vector};
use asperity::solver::Solver;
use asperity::stepper::{State, Stepper};
use asperity::system::rigid::{Body, Pair, Plane, RigidBodies, Shape};

const G: [f64; 3] = [0.0, 0.0, -9.81];
const HALF: [f64; 3] = [0.1, 0.07, 0.05];

fn law() -> Law {
    FrictionLaw::<2>::isotropic(0.3).unwrap().into()
}

/// Points that slide on a plane, fast enough never to stop.
fn sliders(n: usize) -> RigidBodies {
    let slider = |i: usize| Body {
        position: [i as f64, 0.0, 0.0],
        velocity: [1e3, 5e2 + i as f64, 0.0],
        ..Body::new(1.0, [0.1; 3])
    };
    let shape = |body| Shape::PointPlane { body, point: [0.0; 3], plane: Plane::floor() };
    system(n, slider, shape)
}

/// Boxes that slide on three points each, off centre, which turns them: the law is an ellipse, directions change.
fn turning(n: usize) -> RigidBodies {
    let ellipse: Convex<2> = Ellipse::new(Vector::<2>::new(0.4, 0.25)).unwrap().into();
    let law = Law::from(FrictionLaw::associated(ellipse));
    let body = |i: usize| Body {
        position: [i as f64, 0.0, HALF[2]],
        velocity: [1e3, 5e2 + i as f64, 0.0],
        angular_velocity: [0.0, 0.0, 3.0],
        ..Body::cuboid(1.0, HALF)
    };
    let feet = [[0.1, 0.06, -HALF[2]], [-0.07, 0.05, -HALF[2]], [0.02, -0.07, -HALF[2]]];
    let pairs: Vec<Pair> = (0..n)
        .flat_map(|body| feet.map(|point| (body, point)))
        .map(|(body, point)| {
            Pair::new(Shape::PointPlane { body, point, plane: Plane::floor() }, law.clone())
        })
        .collect();
    RigidBodies::new((0..n).map(body).collect::<Vec<_>>(), &pairs, vec![], G).unwrap()
}

/// Free flight of boxes, above the plane.
fn tumbling(n: usize) -> RigidBodies {
    let body = |i: usize| Body {
        position: [0.0, 0.0, 1e3],
        angular_velocity: [1.0, 5.0 + i as f64 / n as f64, 0.3],
        ..Body::cuboid(1.0, HALF)
    };
    system(n, body, |body| Shape::BoxPlane { body, half_sizes: HALF, plane: Plane::floor() })
}

/// Boxes that lie on the plane.
fn resting(n: usize) -> RigidBodies {
    let body = |_| Body { position: [0.0, 0.0, HALF[2]], ..Body::cuboid(1.0, HALF) };
    system(n, body, |body| Shape::BoxPlane { body, half_sizes: HALF, plane: Plane::floor() })
}

/// Balls that roll: their directions change in every step.
fn rolling(n: usize) -> RigidBodies {
    let body = |_| Body {
        position: [0.0, 0.0, 0.1],
        velocity: [1.0, 0.0, 0.0],
        angular_velocity: [0.0, 10.0, 1.0],
        ..Body::ball(1.0, 0.1)
    };
    let shape =
        |body| Shape::SpherePlane { body, centre: [0.0; 3], radius: 0.1, plane: Plane::floor() };
    system(n, body, shape)
}

fn system(n: usize, body: impl Fn(usize) -> Body, shape: impl Fn(usize) -> Shape) -> RigidBodies {
    let law = law();
    let pairs: Vec<Pair> = (0..n).map(|body| Pair::new(shape(body), law.clone())).collect();
    RigidBodies::new((0..n).map(body).collect::<Vec<_>>(), &pairs, vec![], G).unwrap()
}

/// Nanoseconds per step and body: the best of several.
fn nanoseconds(system: &RigidBodies, solver: Solver) -> f64 {
    let (q, u) = (system.q0(), system.u0());
    let mut stepper = Stepper::new(system, solver, 1e-10, 1e-3, &State::new(0.0, q, u)).unwrap();
    for _ in 0..5 {
        stepper.step().unwrap();
    }
    let steps = (200_000 / system.bodies()).clamp(3, 1000);
    let mut best = f64::INFINITY;
    for _ in 0..5 {
        let start = Instant::now();
        for _ in 0..steps {
            black_box(stepper.step().unwrap());
        }
        best = best.min(start.elapsed().as_secs_f64());
    }
    best * 1e9 / (steps * system.bodies()) as f64
}

fn main() {
    let solvers = [("exact", Solver::Exact { max_sweeps: 100 }), ("auto", Solver::AUTO)];
    type Kind = (&'static str, fn(usize) -> RigidBodies);
    let kinds: [Kind; 5] = [
        ("sliders", sliders),
        ("turning", turning),
        ("tumbling", tumbling),
        ("resting", resting),
        ("rolling", rolling),
    ];
    println!("{:10} {:6} {:>8} ns per body and step", "", "", "bodies");
    let mut arguments = std::env::args().skip(1).filter(|argument| !argument.starts_with("--"));
    let wanted = arguments.next();
    let count: Option<usize> = arguments.next().and_then(|count| count.parse().ok());
    let counts = count.map_or(vec![1000, 10_000, 100_000], |count| vec![count]);
    let mut found = Vec::new();
    for (name, kind) in kinds.into_iter().filter(|k| wanted.as_ref().is_none_or(|w| w == k.0)) {
        for (solver_name, solver) in solvers {
            for &n in &counts {
                let ns = nanoseconds(&kind(n), solver);
                println!("{name:10} {solver_name:6} {n:8} {ns:8.0}");
                found.push(((name, solver_name, n), ns));
            }
        }
    }
    let cost = |name, n| found.iter().find(|one| one.0 == (name, "auto", n)).map(|one| one.1);
    let contacts = [
        ("resting", "boxes at rest", "what detection and solution of four contacts each cost"),
        ("turning", "boxes that slide and turn", "what three contacts of changing direction cost"),
        ("rolling", "balls that roll", "what a rolling contact costs; balls turn with less work"),
    ];
    for (name, what, meaning) in contacts {
        if let (Some(own), Some(floor)) = (cost(name, 1000), cost("tumbling", 1000)) {
            let case = format!("a step of 1,000 {what}");
            report::ratio(&case, own / floor, "as many boxes in free flight", meaning);
        }
    }
    if let (Some(many), Some(few)) = (cost("resting", 100_000), cost("resting", 1000)) {
        report::ratio(
            "a step per box of 100,000 boxes at rest",
            many / few,
            "the same per box of 1,000 boxes",
            "how cost grows with size: 1 is in proportion, caches that overflow are more",
        );
    }
}

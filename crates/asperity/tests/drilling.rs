//! One contact that slides and drills (p = 3): the solver against the measure of the residual.
//!
//! `cargo test --release -p asperity --test drilling -- --ignored --nocapture` runs 10⁵ problems per law and family
//! and prints the failures.

mod common;

use asperity::contact::{ContactProblem, ContactState, Memory, NormalForce, Phase};
use asperity::law::{FrictionLaw, Law};
use asperity::set::{
    Ball, Convex, ConvexSet, CoulombContensou, Cuboid, Ellipsoid, Matrix, Pressure, Star,
    Superellipsoid, Vector,
};
use asperity::solver::{SolveReport, Solver, Stop, Workspace, natural_residual};
use common::{Random, gram};
use nalgebra::DMatrix;

type W = Vector<3>;

fn ellipsoid(a: f64, b: f64, c: f64) -> Convex<3> {
    Ellipsoid::new(W::new(a, b, c)).unwrap().into()
}

/// Half a radian about the diagonal of the room.
fn turned(set: &Convex<3>) -> Convex<3> {
    let axis = nalgebra::Unit::new_normalize(W::new(1.0, 1.0, 1.0));
    let turn = nalgebra::Rotation3::from_axis_angle(&axis, 0.5);
    set.mapped(&Matrix::<3>::from(*turn.matrix())).unwrap()
}

fn laws() -> Vec<(&'static str, FrictionLaw<3>)> {
    let drilling = |p| Convex::from(CoulombContensou::new(0.4, p).unwrap());
    let rounded = |s| {
        let set = Superellipsoid::new(W::new(0.5, 0.3, 0.2), s).unwrap();
        Convex::try_from(set).unwrap()
    };
    let cuboid = Convex::from(Cuboid::symmetric(W::new(0.5, 0.3, 0.2)).unwrap());
    let extended = |c: Convex<3>, d| FrictionLaw::new(Star::from(c), d).unwrap();
    vec![
        ("ball", FrictionLaw::isotropic(0.4).unwrap()),
        ("ellipsoid", FrictionLaw::associated(ellipsoid(0.6, 0.3, 0.2))),
        ("flat ellipsoid", FrictionLaw::associated(ellipsoid(0.6, 0.4, 0.02))),
        ("Hertz", FrictionLaw::associated(drilling(Pressure::Hertz))),
        ("uniform", FrictionLaw::associated(drilling(Pressure::Uniform))),
        ("superellipsoid 1.5", FrictionLaw::associated(rounded(1.5))),
        ("superellipsoid 4", FrictionLaw::associated(rounded(4.0))),
        ("octahedron", FrictionLaw::associated(rounded(1.0))),
        ("box", FrictionLaw::associated(cuboid.clone())),
        ("turned box", FrictionLaw::associated(turned(&cuboid))),
        ("C ellipsoid, D ball", extended(ellipsoid(0.6, 0.3, 0.2), Ball::new(1.0).unwrap().into())),
        ("C ball, D ellipsoid", extended(Ball::new(0.4).unwrap().into(), ellipsoid(3.0, 2.0, 1.0))),
        ("ellipsoids", extended(turned(&ellipsoid(0.6, 0.3, 0.2)), ellipsoid(3.0, 1.5, 1.0))),
        ("C box, D ellipsoid", extended(cuboid, ellipsoid(3.0, 2.0, 1.0))),
        ("C Hertz, D ball", extended(drilling(Pressure::Hertz), Ball::new(1.0).unwrap().into())),
    ]
}

#[derive(Debug, Clone, Copy)]
enum Family {
    /// Prescribed normal percussion.
    Prescribed,
    /// Unilateral, normal and tangential rows coupled.
    Unilateral,
    /// Prescribed, one velocity out of reach of the percussions.
    Singular,
}

const FAMILIES: [Family; 3] = [Family::Prescribed, Family::Unilateral, Family::Singular];

/// A random problem that has a solution: where the normal force is not given, no force in the reservoir lifts the
/// contact by itself, `g_NN > G_NT x`.
fn problem(law: &Law, family: Family, random: &mut Random) -> ContactProblem {
    let Law::Three(inner) = law else { unreachable!() };
    loop {
        let rows = match family {
            Family::Prescribed | Family::Singular => 3,
            Family::Unilateral => 4,
        };
        let delassus = match family {
            Family::Singular => gram(3, 2, random),
            _ => {
                let skewed = DMatrix::from_fn(rows, rows, |_, _| 1e-2 * random.normal());
                gram(rows, rows + 2, random) + skewed
            }
        };
        let mut free: Vec<f64> = (0..rows).map(|_| random.within(-1.0, 1.0)).collect();
        // Half of the loads near the boundary of the reservoir, where stick and slip meet.
        let size = 10f64.powf(random.within(-2.0, 0.5));
        free.iter_mut().for_each(|b| *b *= size);
        let normal = match family {
            Family::Prescribed | Family::Singular => NormalForce::Prescribed(1.0),
            Family::Unilateral => {
                free[0] = -random.unit();
                let row = W::new(delassus[(0, 1)], delassus[(0, 2)], delassus[(0, 3)]);
                // C is convex in all these laws.
                let lift = inner.reservoir().as_convex().unwrap().support(&row);
                if delassus[(0, 0)] <= lift {
                    continue;
                }
                NormalForce::Unilateral
            }
        };
        let made = ContactProblem::new(delassus, free, [(law.clone(), normal)]);
        // A diagonal entry may have become negative.
        if let Ok(problem) = made {
            return problem;
        }
    }
}

fn solve(problem: &ContactProblem, state: ContactState) -> (SolveReport, Memory) {
    let mut memory = Memory::new(problem.rows(), 1);
    memory.states[0] = state;
    let mut workspace = Workspace::default();
    workspace.prepare(problem);
    let solver = Solver::Exact { max_sweeps: 1 };
    let report = solver.solve(problem, Stop::at(1e-11), &mut memory, &mut workspace);
    (report, memory)
}

fn failures(count: usize) -> usize {
    let mut all = 0;
    for (place, (name, law)) in laws().into_iter().enumerate() {
        let law = Law::from(law);
        for family in FAMILIES {
            let mut random = Random::new(place as u64 + 1);
            let (mut failed, mut slips, mut worst) = (0, 0, 0.0_f64);
            let started = std::time::Instant::now();
            for _ in 0..count {
                let problem = problem(&law, family, &mut random);
                let phase =
                    [Phase::Unknown, Phase::Stick, Phase::Slip][(3.0 * random.unit()) as usize];
                let slip = [random.normal(), random.normal(), random.normal()];
                let (_, memory) = solve(&problem, ContactState::new(phase, slip));
                let mut velocity = vec![0.0; problem.rows()];
                problem.velocity(&memory.percussion, &mut velocity);
                let residual = natural_residual(&problem, &memory.percussion, &velocity).value;
                failed += usize::from(!(residual <= 1e-11));
                if residual <= 1e-11 {
                    worst = worst.max(residual);
                }
                slips += usize::from(memory.states[0].phase == Phase::Slip);
            }
            let each = started.elapsed().as_secs_f64() * 1e6 / count as f64;
            println!(
                "{name}, {family:?}: {failed} of {count} failed, {slips} slip, worst {worst:.1e}, {each:.0} us"
            );
            all += failed;
        }
    }
    all
}

#[test]
fn every_problem_is_solved() {
    assert_eq!(failures(500), 0);
}

#[test]
#[ignore = "minutes: part of `make long`"]
fn every_one_of_a_hundred_thousand_problems_is_solved() {
    assert_eq!(failures(100_000), 0);
}

/// A contact that can open, opens, although it could stick too: coupling presses it down against the load.
#[test]
fn opening_comes_first() {
    let law = Law::from(FrictionLaw::<3>::isotropic(1.5).unwrap());
    let mut delassus = DMatrix::identity(4, 4);
    (delassus[(0, 1)], delassus[(1, 0)]) = (-0.9, -0.9);
    let free = vec![0.1, -0.5, 0.0, 0.0];
    let stick =
        -delassus.clone().try_inverse().unwrap() * nalgebra::DVector::from_vec(free.clone());
    assert!(stick[0] > 0.0 && stick[1] < 1.5 * stick[0], "{stick}");
    let contacts = [(law, NormalForce::Unilateral)];
    let problem = ContactProblem::new(delassus, free, contacts).unwrap();
    let (_, memory) = solve(&problem, ContactState::new(Phase::Stick, [0.0; 3]));
    assert_eq!((memory.states[0].phase, memory.percussion), (Phase::Open, vec![0.0; 4]));
}

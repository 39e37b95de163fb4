//! Steps do not allocate while the same contacts are closed; in a binary of its own, for the count is of
//! the whole process.

use asperity::contact::{ContactProblem, ContactState, Memory, NormalForce};
use asperity::event;
use asperity::law::{Fall, FrictionLaw, Law, Stribeck};
use asperity::mechanism::{ContactStepper, Mobility, Rows, StepRows};
use asperity::set::{Convex, CoulombContensou, Ellipse, Ellipsoid, Pressure, Vector};
use asperity::solver::{Measure, Solver, Status, Stop, Workspace};
use asperity::stepper::{State, Stepper};
use asperity::system::rigid::{Body, Pair, Plane, PlaneMotion, RigidBodies, Shape};
use asperity::system::{Contact, LinearSystem, Signal, System, TimeFunction, mass_on_belt};
use nalgebra::{DMatrix, DVector, Matrix2, Vector2};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System as Allocator;

#[global_allocator]
static ALLOCATOR: &StatsAlloc<Allocator> = &INSTRUMENTED_SYSTEM;

fn ellipse() -> FrictionLaw<2> {
    let set: Convex<2> = Ellipse::new(Vector::<2>::new(0.5, 0.3)).unwrap().into();
    FrictionLaw::associated(set)
}

/// Sliding, resting and spinning bodies, and one that lies on another.
fn bodies(law: impl Into<Law>) -> RigidBodies {
    let (law, half) = (law.into(), [0.1, 0.07, 0.05]);
    let at = |x: f64, z: f64, velocity: f64| Body {
        position: [x, 0.0, z],
        velocity: [velocity, 0.1 * velocity, 0.0],
        ..Body::cuboid(1.0, half)
    };
    let on = |body, plane| Shape::BoxPlane { body, half_sizes: half, plane };
    let top = Plane { point: [0.0, 0.0, 0.05], body: Some(0), ..Plane::floor() };
    let ball = Body { position: [3.0, 0.0, 0.1], velocity: [1.0; 3], ..Body::ball(1.0, 0.1) };
    let ball = Body { velocity: [1.0, 0.2, 0.0], angular_velocity: [1.0, 2.0, 3.0], ..ball };
    let shapes = [
        on(0, Plane::floor()),
        on(1, top),
        on(2, Plane::floor()),
        Shape::SpherePlane { body: 3, centre: [0.0; 3], radius: 0.1, plane: Plane::floor() },
    ];
    let bodies = vec![at(0.0, 0.05, 0.0), at(0.01, 0.15, 0.0), at(1.0, 0.05, 5.0), ball];
    let pairs = shapes.map(|shape| Pair::new(shape, law.clone()));
    RigidBodies::new(bodies, &pairs, vec![], [0.0, 0.0, -9.81]).unwrap()
}

/// Bodies on a belt that changes its velocity and on a table that is shaken, one of them pushed by a load.
fn moving(law: impl Into<Law>) -> RigidBodies {
    let (law, half) = (law.into(), [0.1, 0.07, 0.05]);
    let times: Vec<f64> = (0..40).map(f64::from).collect();
    let values: Vec<f64> = times.iter().flat_map(|t| [3.0 + t.sin(), t.cos()]).collect();
    let belt = Signal::linear(&times, &values, false).unwrap();
    let shaking = Signal::sine(5.0, &[1e-3, 0.0, 1e-3], &[0.0; 3], &[0.0; 3]).unwrap();
    let motion = PlaneMotion { displacement: shaking.into(), rotation: TimeFunction::ZERO };
    let planes = [
        Plane { velocity: belt.into(), ..Plane::floor() },
        Plane { motion: Some(motion), ..Plane::floor() },
    ];
    let push = Signal::sine(2.0, &[0.5, 0.0, 0.0], &[0.0; 3], &[0.0; 3]).unwrap();
    let body = Body { position: [0.0, 0.0, 0.05], ..Body::cuboid(1.0, half) };
    let pushed = Body { force: push.into(), ..body.clone() };
    let on =
        |(body, plane)| Pair::new(Shape::BoxPlane { body, half_sizes: half, plane }, law.clone());
    let pairs: Vec<Pair> = planes.into_iter().enumerate().map(on).collect();
    RigidBodies::new(vec![body, pushed], &pairs, vec![], [0.0, 0.0, -9.81]).unwrap()
}

/// Allocations in steps during which the same contacts are closed.
fn allocations(solver: Solver, system: &dyn System, q: &[f64], u: &[f64]) -> usize {
    let mut stepper = Stepper::new(system, solver, 1e-9, 1e-3, &State::new(0.0, q, u)).unwrap();
    // Until the solver's buffers have met every kind of contact.
    for _ in 0..200 {
        stepper.step().unwrap();
    }
    let rows = stepper.problem().rows();
    let mut count = || {
        let region = Region::new(ALLOCATOR);
        for _ in 0..100 {
            stepper.step().unwrap();
            assert_eq!(stepper.problem().rows(), rows);
        }
        let change = region.change();
        change.allocations + change.reallocations
    };
    // The thread that runs the tests allocates, too, but not again and again.
    (0..3).map(|_| count()).min().unwrap()
}

/// A mass pressed on a line by its weight, which a spring pulls along.
fn on_a_line() -> LinearSystem {
    let column = |x: f64, z: f64| DMatrix::from_column_slice(2, 1, &[x, z]);
    let law = FrictionLaw::<1>::isotropic(0.3).unwrap();
    let at_rest = Contact::unilateral(law, column(1.0, 0.2), vec![0.0, 1.0], 0.0);
    let contact = Contact { velocity: vec![-0.1], ..at_rest };
    let stiffness = DMatrix::from_diagonal(&nalgebra::DVector::from_vec(vec![50.0, 0.0]));
    let (mass, damping) = (DMatrix::identity(2, 2), DMatrix::zeros(2, 2));
    LinearSystem::new(mass, stiffness, damping, vec![0.0, -9.81], vec![contact]).unwrap()
}

/// A ball that slides and drills, and one that lies still.
fn drilling(law: &Law) -> RigidBodies {
    let ball = |x| Body { position: [x, 0.0, 0.1], ..Body::ball(1.0, 0.1) };
    let sliding =
        Body { velocity: [3.0, 0.2, 0.0], angular_velocity: [0.0, 0.0, 40.0], ..ball(0.0) };
    let pair = |body| {
        let plane = Plane::floor();
        let shape = Shape::SpherePlane { body, centre: [0.0; 3], radius: 0.1, plane };
        Pair { patch_radius: Some(0.01), ..Pair::new(shape, law.clone()) }
    };
    let bodies = vec![sliding, ball(1.0)];
    RigidBodies::new(bodies, &[pair(0), pair(1)], vec![], [0.0, 0.0, -9.81]).unwrap()
}

/// Allocations of an event-driven integration in which a contact always slips, and its steps.
fn allocations_of_integration(system: &dyn System, max_step: f64) -> (usize, usize) {
    let options = event::Options::new(10.0).unwrap().with_tolerance(1e-9).with_sample(20.0);
    let options = options.with_max_step(max_step).with_max_events(10);
    let region = Region::new(ALLOCATOR);
    let run = event::integrate(system, &options).unwrap();
    let allocations = region.change().allocations;
    assert!(run.motion.events.is_empty(), "{:?}", run.motion.events);
    (allocations, run.motion.steps)
}

/// Allocations of solving problems again, from no percussions, that need sweeps, Newton's method and what comes after.
fn allocations_of_solving(contacts: usize, measure: Measure) -> usize {
    // Bodies in a column, each twice: of two contacts one would do.
    let place = |row: usize| (row / 2 / 2, row % 2);
    let delassus = DMatrix::from_fn(2 * contacts, 2 * contacts, |i, j| {
        let ((a, kind), (b, other)) = (place(i), place(j));
        match a.abs_diff(b) {
            _ if kind != other => 0.0,
            0 => 2.0,
            1 => -1.0,
            _ => 0.0,
        }
    });
    let free = (0..2 * contacts).map(|row| if row < 4 { -0.7 } else { 0.01 }).collect();
    let contact = (FrictionLaw::<1>::isotropic(0.3).unwrap().into(), NormalForce::Unilateral);
    let problem = ContactProblem::new(delassus, free, vec![contact; contacts]).unwrap();
    let (mut memory, mut workspace) = (Memory::default(), Workspace::default());
    let stop = Stop::at(1e-9).with_measure(measure);
    let mut solve = || {
        memory.percussion.fill(0.0);
        memory.states.fill(ContactState::default());
        let report = Solver::default().solve(&problem, stop, &mut memory, &mut workspace);
        assert_eq!(report.status, Status::Converged, "{report:?}");
        assert!(workspace.stages().iter().any(|stage| stage.factorizations > 0));
    };
    let mut count = || {
        let region = Region::new(ALLOCATOR);
        (0..3).for_each(|_| solve());
        let change = region.change();
        change.allocations + change.reallocations
    };
    (0..4).map(|_| count()).min().unwrap()
}

/// Allocations of further steps of a mechanism whose contacts stay the same, without joints.
fn allocations_of_a_mechanism() -> usize {
    let mut stepper = ContactStepper::new(vec![ellipse().into()], Solver::AUTO).unwrap();
    let delassus: Vec<f64> = (0..64)
        .map(|k| {
            if k % 9 == 0 {
                1.0
            } else if k / 8 % 3 == k % 8 % 3 {
                0.3
            } else {
                0.0
            }
        })
        .collect();
    let items = [Rows::Contact(0), Rows::Contact(0), Rows::Frictionless, Rows::DryFriction(0.1)];
    let mut speed = 1.0;
    let mut step = || {
        speed += 0.01;
        let rows = StepRows {
            delassus: Mobility::Dense(&delassus),
            free_velocity: &[-1.0, speed, 0.3, -0.5, 0.1, speed, -0.2, 0.4],
            items: &items,
            keys: Some(&[9, 3, 7, 5]),
            factors: None,
        };
        assert_eq!(stepper.step(&rows, Stop::default()).unwrap().status, Status::Converged);
    };
    (0..20).for_each(|_| step());
    let mut count = || {
        let region = Region::new(ALLOCATOR);
        (0..20).for_each(|_| step());
        let change = region.change();
        change.allocations + change.reallocations
    };
    (0..3).map(|_| count()).min().unwrap()
}

/// Allocations of further steps of a body that slides and turns on four feet, whose shares are those of equal compliance: no proof
/// is looked for where rounding ends what is solved.
fn allocations_of_four_feet() -> usize {
    let law = FrictionLaw::<2>::isotropic(0.3).unwrap();
    let mut stepper = ContactStepper::new(vec![law.into()], Solver::AUTO).unwrap();
    let feet = [[0.2, 0.15], [-0.2, 0.15], [0.2, -0.15], [-0.2, -0.15]];
    let rows = feet.iter().flat_map(|&[x, y]| {
        [[0.0, 0.0, 1.0, y, -x, 0.0], [1.0, 0.0, 0.0, 0.0, -0.1, -y], [0.0, 1.0, 0.0, 0.1, 0.0, x]]
    });
    let rows = DMatrix::from_row_iterator(12, 6, rows.flatten());
    let inverse = DMatrix::from_diagonal(&[1.0, 1.0, 1.0, 60.0, 40.0, 30.0].to_vec().into());
    let delassus = &rows * inverse * rows.transpose();
    let delassus = 0.5 * (&delassus + delassus.transpose());
    let mut step = |k: usize| {
        let (along, turns) = (0.1 * k as f64, 1.0 + 0.03 * k as f64);
        let free = &rows * DVector::from_vec(vec![along, 0.3, -0.01, 0.0, 0.0, turns]);
        let rows = StepRows {
            delassus: Mobility::Dense(delassus.as_slice()),
            free_velocity: free.as_slice(),
            items: &[Rows::Contact(0); 4],
            keys: None,
            factors: None,
        };
        let region = Region::new(ALLOCATOR);
        let report = stepper.step(&rows, Stop::default()).unwrap();
        let change = region.change();
        assert_eq!(report.status, Status::Converged);
        change.allocations + change.reallocations
    };
    let mut count = || (0..40).map(&mut step).sum();
    count();
    (0..3).map(|_| count()).min().unwrap()
}

/// Bytes that the scheme keeps per slider, with its solver and all states.
fn bytes_per_slider() -> f64 {
    let law = Law::from(ellipse());
    let kept = |count: usize| {
        let shape = |body| Shape::PointPlane { body, point: [0.0; 3], plane: Plane::floor() };
        let pairs: Vec<Pair> = (0..count).map(|body| Pair::new(shape(body), law.clone())).collect();
        let body = Body { velocity: [1.0, 0.5, 0.0], ..Body::new(1.0, [1.0; 3]) };
        let system =
            RigidBodies::new(vec![body; count], &pairs, vec![], [0.0, 0.0, -9.81]).unwrap();
        let solver = Solver::Exact { max_sweeps: 500 };
        let region = Region::new(ALLOCATOR);
        let mut stepper =
            Stepper::new(&system, solver, 1e-9, 1e-3, &State::new(0.0, system.q0(), system.u0()))
                .unwrap();
        for _ in 0..3 {
            stepper.step().unwrap();
        }
        let change = region.change();
        (change.bytes_allocated - change.bytes_deallocated) as f64
    };
    (kept(4000) - kept(2000)) / 2000.0
}

#[test]
fn steps_do_not_allocate_while_contacts_stay() {
    assert_eq!(allocations_of_a_mechanism(), 0, "mechanism");
    assert_eq!(allocations_of_four_feet(), 0, "four feet");
    let rated = || {
        let rate = Stribeck::new(Fall::Exponential, 0.1, 0.5, 1.0, 0.0).unwrap();
        ellipse().with_rate(rate)
    };
    let laws: [&dyn Fn() -> FrictionLaw<2>; 2] = [&ellipse, &rated];
    let solvers = [
        Solver::Exact { max_sweeps: 500 },
        Solver::AUTO,
        Solver::ProximalPoint { max_iterations: 1000 },
    ];
    for (law, solver) in laws.iter().flat_map(|law| solvers.map(|solver| (law, solver))) {
        let (stiffness, velocity) = (Matrix2::identity(), Vector2::new(0.3, 0.4));
        let belt = mass_on_belt(1.0, stiffness, law(), 1.0, velocity).unwrap();
        assert_eq!(allocations(solver, &belt, &[0.0; 2], &[0.0; 2]), 0, "dense, {solver:?}");
        let system = bodies(law());
        assert_eq!(
            allocations(solver, &system, system.q0(), system.u0()),
            0,
            "body by body, {solver:?}"
        );
        let system = moving(law());
        let count = allocations(solver, &system, system.q0(), system.u0());
        assert_eq!(count, 0, "functions of time, {solver:?}");
    }
    let fast = mass_on_belt(1.0, Matrix2::identity(), ellipse(), 1.0, Vector2::new(30.0, 40.0));
    let fast = fast.unwrap();
    // Once for what is kept from then on.
    let [_, few, many] = [0.2, 0.2, 0.05].map(|step| allocations_of_integration(&fast, step));
    assert!(many.1 > 3 * few.1, "{} and {} steps", few.1, many.1);
    assert_eq!(few.0, many.0, "event-driven");
    let contensou = |p| Convex::from(CoulombContensou::new(0.3, p).unwrap());
    let ellipsoid = Convex::from(Ellipsoid::new(Vector::<3>::new(0.3, 0.3, 0.1)).unwrap());
    let laws = [contensou(Pressure::Hertz), contensou(Pressure::Uniform), ellipsoid];
    for solver in &solvers[..2] {
        let line = on_a_line();
        assert_eq!(allocations(*solver, &line, &[0.0; 2], &[0.0; 2]), 0, "p = 1, {solver:?}");
        for law in &laws {
            let system = drilling(&Law::from(FrictionLaw::associated(law.clone())));
            let count = allocations(*solver, &system, system.q0(), system.u0());
            assert_eq!(count, 0, "p = 3, {law:?}, {solver:?}");
        }
    }
    for contacts in [6, 12, 60] {
        for measure in [Measure::Contact, Measure::Global] {
            let count = allocations_of_solving(contacts, measure);
            assert_eq!(count, 0, "{contacts} contacts solved again by {measure:?}");
        }
    }
    let bytes = bytes_per_slider();
    println!("{bytes} bytes per slider");
    assert!(bytes < 2500.0, "{bytes} bytes per slider");
}

//! No call with wrong lengths, numbers that are none, nothing at all, or parts of another problem ends in a panic: it
//! gives an error that names the argument, or an answer.

use std::fmt::Display;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use asperity::contact::{
    BlockMatrix, ContactProblem, Csr, Delassus, DelassusOperator, Factored, MatrixFree, Memory,
    NormalForce, Phase,
};
use asperity::event;
use asperity::law::{Fall, FrictionLaw, Law, Stribeck, flow_sets};
use asperity::set::{
    Ball, CappedRectangle, Checked, Convex, CoulombContensou, Cuboid, Ellipsoid, PolarCurve,
    Polygon, Pressure, Star, Superellipsoid, SupportCurve, Vector, WedgeAsperity,
};
use asperity::simulate::{self, simulate};
use asperity::solver::{
    Certificate, Measure, ProxStep, Solution, Solver, Steps, Stop, Workspace, natural_map,
    natural_residual, solutions,
};
use asperity::stepper::{State, Stepper};
use asperity::system::rigid::{
    Body, ContactLabel, Pair, Partners, PlanarBody, Plane, RigidBodies, Shape, Spring,
};
use asperity::system::{
    Blocks, Configuration, Contact, ContactLaw, LinearSystem, Rotation, System, SystemError,
    mass_on_belt, sliding_point,
};
use nalgebra::{DMatrix, Matrix2, Vector2, Vector3};

const NAN: f64 = f64::NAN;
/// Numbers that are none, or none that physics knows.
const WRONG: [f64; 5] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300];
const SOLVERS: [Solver; 8] = [
    Solver::AUTO,
    Solver::Exact { max_sweeps: 20 },
    Solver::SemismoothNewton { max_iterations: 20 },
    Solver::ProximalPoint { max_iterations: 20 },
    Solver::InteriorPoint { max_iterations: 20 },
    Solver::Admm { max_iterations: 20 },
    Solver::ProxJacobi { step: ProxStep::Adaptive, max_iterations: 20 },
    Solver::ProxGaussSeidel { step: ProxStep::Adaptive, max_iterations: 20 },
];

/// What a call gives, without a panic.
fn calm<T>(name: impl Display, call: impl FnOnce() -> T) -> T {
    match catch_unwind(AssertUnwindSafe(call)) {
        Ok(answer) => answer,
        Err(_) => panic!("{name} panics"),
    }
}

/// The error of a call, which names this argument.
fn refused<T, E: Display>(argument: &str, call: impl FnOnce() -> Result<T, E>) {
    match calm(argument, call) {
        Ok(_) => panic!("{argument} is not refused"),
        Err(error) => {
            let message = error.to_string();
            assert!(message.starts_with(argument), "{argument}: {message}");
        }
    }
}

fn ellipse() -> Convex<2> {
    Ellipsoid::new(Vector::<2>::new(0.5, 0.3)).unwrap().into()
}

fn law() -> Law {
    FrictionLaw::associated(ellipse()).into()
}

/// Contacts with these normal percussions in this order, unilateral where there is none.
fn problem(normal: &[Option<f64>]) -> ContactProblem {
    let contacts: Vec<_> = normal
        .iter()
        .map(|p| (law(), p.map_or(NormalForce::Unilateral, NormalForce::Prescribed)))
        .collect();
    let rows = normal.iter().map(|p| 2 + usize::from(p.is_none())).sum();
    let delassus = DMatrix::from_fn(rows, rows, |i, j| if i == j { 2.0 } else { 0.1 });
    ContactProblem::new(delassus, vec![-0.7; rows], contacts).unwrap()
}

#[test]
fn problems_are_checked_where_they_are_made() {
    let one = || [(law(), NormalForce::Unilateral)];
    let identity = || DMatrix::<f64>::identity(3, 3);
    refused("free_velocity", || ContactProblem::new(identity(), vec![], one()));
    refused("free_velocity", || ContactProblem::new(identity(), vec![0.0; 4], one()));
    refused("delassus", || ContactProblem::new(DMatrix::zeros(0, 0), vec![0.0; 3], one()));
    refused("delassus", || ContactProblem::new(DMatrix::zeros(3, 2), vec![0.0; 3], one()));
    refused("delassus", || ContactProblem::new(DMatrix::zeros(3, 3), vec![0.0; 3], one()));
    refused("delassus", || ContactProblem::new(-identity(), vec![0.0; 3], one()));
    let none: [(Law, NormalForce); 0] = [];
    refused("delassus", || ContactProblem::new(identity(), vec![], none.clone()));
    assert!(ContactProblem::new(DMatrix::<f64>::zeros(0, 0), vec![], none).is_ok());
    let blocks = BlockMatrix::from_pattern(&[1, 2], &[vec![], vec![]]).unwrap();
    refused("delassus", || ContactProblem::new(blocks, vec![0.0; 3], one()));
    for wrong in WRONG {
        refused("delassus", || {
            ContactProblem::new(identity() * wrong, vec![0.0; 3], one())
                .and_then(|p| {
                    // An operator of this size is one, but nothing has its size.
                    p.with_restitution(&[1.0], &[1.0], &[NAN; 3]).map(drop)
                })
                .map_err(|error| error.to_string().replace("initial_velocity", "delassus"))
        });
        refused("free_velocity", || ContactProblem::new(identity(), vec![wrong; 3], one()));
        refused("normal_force", || {
            let contact = (law(), NormalForce::Prescribed(wrong));
            ContactProblem::new(DMatrix::<f64>::identity(2, 2), vec![0.0; 2], [contact])
        });
        let whole = || problem(&[None]);
        refused("normal_restitution", || {
            let wrong = if wrong.is_finite() { NAN } else { wrong };
            whole().with_restitution(&[wrong], &[0.0], &[0.0; 3])
        });
        refused("initial_velocity", || whole().with_restitution(&[1.0], &[1.0], &[wrong; 3]));
    }
    refused("normal_force", || {
        let contact = (Law::frictionless(), NormalForce::Prescribed(1.0));
        ContactProblem::new(DMatrix::<f64>::zeros(0, 0), vec![], [contact])
    });
    let whole = || problem(&[None]);
    refused("normal_restitution", || whole().with_restitution(&[], &[0.0], &[0.0; 3]));
    refused("tangential_restitution", || whole().with_restitution(&[0.0], &[], &[0.0; 3]));
    refused("initial_velocity", || whole().with_restitution(&[0.0], &[0.0], &[]));
    let rate = Stribeck::new(Fall::Exponential, 0.1, 0.5, 1.0, 0.0).unwrap();
    let rated = FrictionLaw::associated(ellipse()).with_rate(rate).into();
    refused("laws", || {
        ContactProblem::new(identity(), vec![0.0; 3], [(rated, NormalForce::Unilateral)])
    });
}

/// Products only; `rows` may be a lie.
#[derive(Debug)]
struct Products {
    rows: usize,
    diagonal: f64,
}

impl DelassusOperator for Products {
    fn rows(&self) -> usize {
        self.rows
    }

    fn apply(&self, percussion: &[f64], velocity: &mut [f64]) {
        velocity.iter_mut().zip(percussion).for_each(|(v, p)| *v = self.diagonal * p);
    }
}

#[test]
fn operators_are_checked_where_they_are_made() {
    let csr = |size, starts: &[usize], indices: &[usize], values: &[f64]| {
        Csr::new(size, size, starts.to_vec(), indices.to_vec(), values.to_vec())
    };
    refused("matrix", || csr(2, &[], &[], &[]));
    refused("matrix", || csr(usize::MAX, &[], &[], &[]));
    refused("matrix", || csr(2, &[0, 1, 3], &[0, 1], &[1.0, 1.0]));
    refused("matrix", || csr(2, &[1, 1, 2], &[0, 1], &[1.0, 1.0]));
    refused("matrix", || csr(2, &[0, 2, 1], &[0, 1], &[1.0, 1.0]));
    refused("matrix", || csr(2, &[0, 1, 2], &[0, 2], &[1.0, 1.0]));
    refused("matrix", || csr(2, &[0, 2, 2], &[1, 0], &[1.0, 1.0]));
    refused("matrix", || csr(2, &[0, 1, 2], &[0, 1], &[1.0]));
    refused("matrix", || csr(2, &[0, 1, 2], &[0, 1], &[1.0, NAN]));
    let identity = |n: usize| {
        let all: Vec<usize> = (0..=n).collect();
        csr(n, &all, &all[..n], &vec![1.0; n]).unwrap()
    };
    let pattern =
        |sizes: &[usize], neighbours: &[Vec<usize>]| BlockMatrix::from_pattern(sizes, neighbours);
    refused("delassus", || pattern(&[3], &[]));
    refused("delassus", || pattern(&[0], &[vec![0]]));
    refused("delassus", || pattern(&[5], &[vec![0]]));
    refused("delassus", || pattern(&[3, 3], &[vec![1, 0], vec![]]));
    refused("delassus", || pattern(&[3, 3], &[vec![2], vec![]]));
    for sizes in [&[][..], &[2], &[3, 1], &[usize::MAX, 4]] {
        refused("delassus", || BlockMatrix::from_csr(&identity(3), sizes));
        refused("d", || Factored::new(identity(3), identity(3), sizes));
        refused("delassus", || {
            MatrixFree::new(Arc::new(Products { rows: 3, diagonal: 1.0 }), sizes)
        });
    }
    refused("mass", || Factored::new(identity(2), identity(3), &[3]));
    let singular = csr(3, &[0, 1, 1, 1], &[0], &[1.0]).unwrap();
    refused("mass", || Factored::new(singular, identity(3), &[3]));
    let blocks = BlockMatrix::from_csr(&identity(3), &[3]).unwrap();
    refused("directions", || Factored::with_blocks(identity(3), identity(2), blocks));
    for diagonal in [NAN, f64::INFINITY, 0.0, -1.0] {
        calm("an operator without numbers", || {
            let operator = Arc::new(Products { rows: 3, diagonal });
            let free = MatrixFree::new(operator, &[3]).map(Delassus::from);
            let contacts = [(law(), NormalForce::Unilateral)];
            let made = free.and_then(|free| ContactProblem::new(free, vec![-1.0; 3], contacts));
            assert!(made.is_err(), "{diagonal}");
        });
    }
}

#[test]
fn measures_refuse_what_does_not_fit_the_problem() {
    let whole = problem(&[None, Some(1.0)]);
    let fits = vec![0.1; 5];
    for length in [0, 1, 4, 6] {
        let other = vec![0.1; length];
        refused("percussion", || natural_residual(&whole, &other, &fits));
        refused("velocity", || natural_residual(&whole, &fits, &other));
        refused("percussion", || natural_map(&whole, &other, &fits));
        refused("velocity", || natural_map(&whole, &fits, &other));
        refused("percussion", || Certificate::new(&whole, &other));
        refused("percussion", || whole.velocities(&other));
        refused("percussion", || solutions(&whole, 0, &other));
        refused("percussion", || Memory::from_solution(&whole, &other, &fits, [Phase::Slip; 2]));
        refused("velocity", || Memory::from_solution(&whole, &fits, &other, [Phase::Slip; 2]));
    }
    refused("phases", || Memory::from_solution(&whole, &fits, &fits, [Phase::Slip]));
    refused("contact", || solutions(&whole, 2, &fits));
    let space = FrictionLaw::<3>::isotropic(0.5).unwrap().into();
    let drilling = [(space, NormalForce::Prescribed(1.0))];
    let drilling = ContactProblem::new(DMatrix::identity(3, 3), vec![1.0; 3], drilling).unwrap();
    refused("contact", || solutions(&drilling, 0, &[0.0; 3]));
    for wrong in WRONG {
        let percussion = [wrong; 5];
        calm("measures", || {
            let velocity = whole.velocities(&percussion).unwrap();
            let found = natural_residual(&whole, &percussion, &velocity).unwrap();
            assert!(!(found.value <= 1e-10), "{wrong}: {found:?}");
            assert!(!(natural_map(&whole, &percussion, &velocity).unwrap() <= 1e-10), "{wrong}");
            let found = Certificate::new(&whole, &percussion).unwrap();
            assert!(!(found.natural_map <= 1e-10), "{wrong}: {found:?}");
        });
        let _ = calm("solutions", || solutions(&whole, 0, &percussion));
    }
}

/// Workspaces and memories of other problems, also of the same number of rows and contacts, change nothing.
#[test]
fn solvers_take_what_belongs_to_other_problems() {
    let problems = [
        problem(&[None, Some(1.0)]),
        problem(&[Some(1.0), None]),
        problem(&[None]),
        problem(&[]),
        problem(&[None, None, Some(0.0)]),
    ];
    for solver in &SOLVERS {
        let expected: Vec<_> =
            problems.iter().map(|p| calm("solve", || p.solve(solver, Stop::default()))).collect();
        let mut workspace = Workspace::default();
        for round in 0..2 {
            for (k, (whole, expected)) in problems.iter().zip(&expected).enumerate() {
                let mut memory = match round {
                    0 => Memory::default(),
                    _ => Memory::new(whole.rows(), whole.contacts().len()),
                };
                let report = calm(format!("{solver:?} on problem {k}"), || {
                    solver.solve(whole, Stop::default(), &mut memory, &mut workspace)
                });
                assert_eq!(report, expected.report, "{solver:?} on problem {k}");
                assert_eq!(memory.percussion, expected.percussion, "{solver:?} on problem {k}");
                assert_eq!(workspace.velocity(), expected.velocity);
                assert_eq!(workspace.ambiguous().len(), whole.contacts().len());
            }
        }
        // The memory of every other problem, and ones that no solve has left behind.
        for (whole, expected) in problems.iter().zip(&expected) {
            for other in &problems {
                let mut memory = Memory::new(other.rows(), other.contacts().len());
                let mut workspace = Workspace::default();
                calm("a foreign memory", || {
                    let _ = solver.solve(whole, Stop::default(), &mut memory, &mut workspace);
                });
                assert_eq!(memory.percussion, expected.percussion);
                // Only what belongs to a problem is a solution of it.
                let found = |memory| {
                    let (stop, report) = (Stop::default(), expected.report);
                    Solution::new(whole, stop, memory, report, &workspace)
                };
                assert_eq!(found(memory).unwrap().percussion, expected.percussion);
                assert_eq!(found(Memory::new(1, 0)).unwrap_err().argument, "memory");
            }
            for wrong in WRONG {
                let mut memory = Memory::new(whole.rows(), whole.contacts().len());
                memory.percussion.fill(wrong);
                memory.states.iter_mut().for_each(|state| state.slip = [wrong; 3]);
                memory.states.iter_mut().for_each(|state| state.phase = Phase::Slip);
                calm(format!("{solver:?} from {wrong}"), || {
                    let mut workspace = Workspace::default();
                    let _ = solver.solve(whole, Stop::default(), &mut memory, &mut workspace);
                });
            }
        }
    }
}

#[test]
fn solvers_take_any_options() {
    let whole = problem(&[None, Some(1.0), None]);
    let other = |step, max_iterations| Solver::ProxJacobi { step, max_iterations };
    let mut solvers = vec![
        Solver::Auto { steps: Steps::ALL, threads: 0 },
        Solver::Auto { steps: Steps::ALL, threads: usize::MAX },
        Solver::Exact { max_sweeps: 0 },
        Solver::SemismoothNewton { max_iterations: 0 },
        Solver::ProximalPoint { max_iterations: 0 },
        Solver::InteriorPoint { max_iterations: 0 },
        Solver::Admm { max_iterations: 0 },
        other(ProxStep::Adaptive, 0),
    ];
    solvers.extend(WRONG.map(|r| other(ProxStep::Constant(r), 10)));
    for solver in solvers {
        for tolerance in [1e-10, 0.0, -1.0, NAN, f64::INFINITY] {
            for measure in [Measure::Contact, Measure::Global] {
                let stop = Stop::at(tolerance).with_measure(measure);
                let _ = calm(format!("{solver:?} to {tolerance}"), || whole.solve(&solver, stop));
            }
        }
    }
}

#[test]
fn laws_are_checked_where_they_are_made_and_asked() {
    for wrong in [NAN, f64::INFINITY, 0.0, -1.0, 1e300] {
        refused("radius", || FrictionLaw::<2>::isotropic(wrong));
        refused("speed", || {
            let wrong = if wrong == 1e300 { NAN } else { wrong };
            Stribeck::new(Fall::Exponential, wrong, 0.5, 1.0, 0.0)
        });
    }
    let laws = [
        FrictionLaw::associated(ellipse()),
        FrictionLaw::collinear(ellipse().into()).unwrap(),
        FrictionLaw::new(
            Superellipsoid::new(Vector::<2>::new(0.5, 0.3), 0.5).unwrap().into(),
            Cuboid::symmetric(Vector::<2>::new(0.5, 0.2)).unwrap().into(),
        )
        .unwrap(),
    ];
    for law in &laws {
        for wrong in WRONG {
            for slip in [Vector::<2>::new(wrong, 0.0), Vector::<2>::new(1.0, wrong)] {
                let huge = wrong.is_finite();
                let force = calm("force", || law.force(&slip, 1.0));
                assert!(huge || force.is_err(), "{slip:?}: {force:?}");
                let jacobian = calm("jacobian", || law.jacobian(&slip, 1.0));
                assert!(huge || jacobian.is_err(), "{slip:?}");
                let direction = calm("slip_direction", || law.slip_direction(&slip, 1.0, 1e-9));
                assert!(direction.is_err(), "{slip:?}");
                calm("dissipation", || law.dissipation(&slip, 1.0));
                calm("alpha", || law.alpha(&slip));
            }
            refused("normal_force", || {
                law.slip_direction(&Vector::<2>::new(0.1, 0.0), -wrong.abs(), 1e-9)
            });
            let _ = calm("rotated", || law.rotated(wrong));
        }
        refused("slip", || law.force(&Vector::<2>::zeros(), 1.0));
        refused("slip", || law.jacobian(&Vector::<2>::zeros(), 1.0));
    }
    let force = [Vector::<2>::new(1.0, 0.0); 3];
    refused("force", || flow_sets(&[], &force, 0.1, 0.1));
    refused("phi", || flow_sets(&[], &[], 0.1, 0.1));
    for wrong in WRONG {
        let phi: Vec<f64> = (0..12).map(|k| 0.5 * f64::from(k)).collect();
        let force = vec![Vector::<2>::new(wrong, 1.0); 12];
        assert!(calm("flow_sets", || flow_sets(&phi, &force, 0.1, 0.1)).is_err());
        let force: Vec<_> = phi.iter().map(|a| Vector::<2>::new(a.cos(), a.sin())).collect();
        assert!(calm("flow_sets", || flow_sets(&[wrong; 12], &force, 0.1, 0.1)).is_err());
    }
}

#[test]
fn sets_are_checked_where_they_are_made_and_asked() {
    type V = Vector<2>;
    for wrong in [NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0, -1.0, 1e300, 1e-300] {
        refused("radius", || Ball::new(wrong));
        refused("a", || CappedRectangle::new(wrong, 1.0, 1.0));
        refused("cap", || CappedRectangle::new(1.0, 1.0, wrong));
        refused("mu", || WedgeAsperity::new(wrong, 0.1));
        refused("mu", || CoulombContensou::new(wrong, Pressure::Hertz));
        assert!(calm("ellipsoid", || Ellipsoid::new(V::new(1.0, wrong))).is_err());
        assert!(calm("superellipsoid", || Superellipsoid::new(V::new(wrong, 1.0), 2.0)).is_err());
        assert!(calm("cuboid", || Cuboid::new(V::new(-1.0, -1.0), V::new(wrong, 1.0))).is_err());
        let angle: Vec<f64> = (0..12).map(|k| 0.5 * f64::from(k)).collect();
        refused("radius", || PolarCurve::new(&angle, &[wrong; 12]));
        refused("support", || SupportCurve::new(&angle, &[wrong; 12]));
        assert!(calm("scaled", || ellipse().scaled(wrong)).is_err());
        assert!(
            calm("mapped", || ellipse().mapped(&(Matrix2::identity() * wrong))).is_err()
                || wrong == -1.0
        );
        assert!(calm("polygon", || Polygon::new(&[V::new(wrong, wrong); 4])).is_err());
    }
    for length in [0, 1, 3, 5] {
        let angle: Vec<f64> = (0..4).map(f64::from).collect();
        assert!(calm("polar curve", || PolarCurve::new(&angle, &vec![1.0; length])).is_err());
        assert!(calm("support curve", || SupportCurve::new(&angle, &vec![1.0; length])).is_err());
        let points = vec![V::new(1.0, 0.0); length];
        assert!(calm("polygon", || Polygon::new(&points)).is_err());
    }
    assert!(calm("intersection", || Star::<2>::intersection(&[])).is_err());
    assert!(calm("union", || Star::<2>::union(&[])).is_err());
    assert!(calm("sum", || Star::<2>::minkowski_sum(&[])).is_err());
    let set = ellipse();
    let checked = Checked(&set);
    for wrong in [NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let x = V::new(wrong, 1.0);
        assert!(calm("gauge", || checked.gauge(&x)).is_err());
        assert!(calm("gradient", || checked.gauge_gradient(&x)).is_err());
        assert!(calm("support", || checked.support(&x)).is_err());
        assert!(calm("support point", || checked.support_point(&x)).is_err());
        assert!(calm("hessian", || checked.support_hessian(&x)).is_err());
        assert!(calm("project", || checked.project(&x)).is_err());
        assert!(calm("normal cone", || checked.normal_cone(&x, 1e-9)).is_err());
    }
}

/// A system of a user, with what it says of itself.
#[derive(Debug)]
struct Own {
    blocks: Blocks,
    contacts: Vec<ContactLaw>,
    touched: Vec<usize>,
    rotations: Vec<Rotation>,
    coordinates: usize,
    mass: f64,
    force: f64,
    row: f64,
}

impl Own {
    fn new() -> Self {
        let law = FrictionLaw::<1>::isotropic(0.5).unwrap();
        let contact = ContactLaw::new(law, NormalForce::Prescribed(1.0)).unwrap();
        Self {
            blocks: Blocks::one(1),
            contacts: vec![contact],
            touched: vec![0],
            rotations: Vec::new(),
            coordinates: 1,
            mass: 1.0,
            force: 2.0,
            row: 1.0,
        }
    }
}

impl System for Own {
    fn blocks(&self) -> &Blocks {
        &self.blocks
    }

    fn coordinates(&self) -> usize {
        self.coordinates
    }

    fn contacts(&self) -> &[ContactLaw] {
        &self.contacts
    }

    fn touched(&self, _contact: usize) -> &[usize] {
        &self.touched
    }

    fn rotations(&self) -> &[Rotation] {
        &self.rotations
    }

    fn mass(&self, _q: &[f64], _block: usize, mass: &mut [f64]) -> Result<(), SystemError> {
        mass.fill(self.mass);
        Ok(())
    }

    fn forces(
        &self,
        _at: &Configuration<'_>,
        _u: &[f64],
        out: &mut [f64],
    ) -> Result<(), SystemError> {
        out.fill(self.force);
        Ok(())
    }

    fn rows(
        &self,
        _at: &Configuration<'_>,
        _contact: usize,
        rows: &mut [f64],
        velocity: &mut [f64],
    ) -> Result<f64, SystemError> {
        rows.fill(self.row);
        velocity.fill(0.0);
        Ok(0.0)
    }
}

/// Both integrators on a system: whether each has refused it or said that the motion does not get on.
fn both(system: &dyn System) -> [bool; 2] {
    let options = simulate::Options::new(1e-2, 0.1).unwrap();
    let stepped = calm("simulate", || simulate(system, &options));
    let options = event::Options::new(0.1).unwrap();
    let integrated = calm("integrate", || event::integrate(system, &options));
    [
        !stepped.is_ok_and(|run| matches!(run.outcome, simulate::Outcome::Finished)),
        !integrated.is_ok_and(|run| matches!(run.outcome, event::Outcome::Finished)),
    ]
}

#[test]
fn what_systems_of_users_say_of_themselves_is_checked() {
    assert_eq!(both(&Own::new()), [false, false]);
    let rotation = Rotation { coordinate: 0, velocity: 0 };
    let systems = [
        Own { touched: vec![], ..Own::new() },
        Own { touched: vec![1], ..Own::new() },
        Own { touched: vec![0, 0], ..Own::new() },
        Own { rotations: vec![rotation], ..Own::new() },
        Own { rotations: vec![rotation], coordinates: 4, ..Own::new() },
        Own { rotations: vec![Rotation { coordinate: usize::MAX, velocity: 0 }], ..Own::new() },
        // A rotation beside a coordinate more than velocities, and two in one place.
        Own { rotations: vec![rotation], coordinates: 5, blocks: Blocks::one(3), ..Own::new() },
        Own { rotations: vec![rotation; 2], coordinates: 8, blocks: Blocks::one(6), ..Own::new() },
        Own { mass: 0.0, ..Own::new() },
        Own { mass: NAN, ..Own::new() },
        Own { force: NAN, ..Own::new() },
        Own { row: NAN, ..Own::new() },
        Own { row: 0.0, ..Own::new() },
    ];
    for (k, system) in systems.iter().enumerate() {
        assert_eq!(both(system), [true, true], "system {k}");
    }
    // Coordinates of its own are nothing to steps, but to integration from event to event.
    assert_eq!(both(&Own { coordinates: 3, ..Own::new() }), [false, true]);
    let nothing = Own { contacts: vec![], blocks: Blocks::one(0), coordinates: 0, ..Own::new() };
    calm("a system without velocities", || both(&nothing));
}

#[test]
fn integrators_refuse_wrong_options_and_states() {
    let point = sliding_point(1.0, FrictionLaw::associated(ellipse()), 10.0).unwrap();
    for wrong in [NAN, f64::INFINITY, 0.0, -1.0] {
        refused("dt", || simulate::Options::new(wrong, 1.0));
        refused("t_end", || simulate::Options::new(1e-3, wrong));
        refused("t_end", || event::Options::new(wrong));
    }
    refused("dt", || simulate::Options::new(1e-300, 1e300));
    let good = || simulate::Options::new(1e-3, 1e-2).unwrap();
    let run = |options: simulate::Options| simulate(&point, &options);
    let other = |change: fn(&mut simulate::Options)| {
        let mut options = good();
        change(&mut options);
        options
    };
    refused("dt", || run(other(|o| o.dt = NAN)));
    refused("tolerance", || run(good().with_tolerance(0.0)));
    refused("tolerance", || run(good().with_tolerance(NAN)));
    refused("save_every", || run(good().with_save_every(0)));
    refused("q0", || run(good().with_start(&[], &[])));
    refused("u0", || run(good().with_start(&[0.0; 2], &[0.0; 3])));
    refused("q0", || run(good().with_start(&[NAN; 2], &[0.0; 2])));
    assert!(run(good().with_steps(0)).is_ok());
    let state = |change: fn(&mut State)| {
        let mut state = State::new(0.0, &[0.0; 2], &[0.0; 2]);
        change(&mut state);
        state
    };
    for wrong in [
        state(|s| s.origin = NAN),
        state(|s| s.contacts = vec![Default::default(); 3]),
        state(|s| s.contacts[..].iter().for_each(drop)),
        state(|s| s.momenta = vec![0.0]),
        state(|s| s.q.clear()),
        state(|s| s.steps = usize::MAX),
        state(|s| (s.dt, s.steps) = (Some(NAN), 3)),
        state(|s| s.steps = 3),
    ] {
        let resumed = calm(format!("{wrong:?}"), || run(good().with_state(wrong.clone())));
        drop(resumed);
    }
    let solver = Solver::default();
    refused("u0", || Stepper::new(&point, solver, 1e-9, 1e-3, &State::new(0.0, &[0.0; 2], &[])));
    refused("dt", || {
        Stepper::new(&point, solver, 1e-9, NAN, &State::new(0.0, &[0.0; 2], &[0.0; 2]))
    });
    let mut stepper =
        Stepper::new(&point, solver, 1e-9, 1e-3, &State::new(0.0, &[0.0; 2], &[1.0; 2])).unwrap();
    refused("contact", || stepper.output(1));
    assert_eq!(calm("phase", || stepper.phase(7)), Phase::Unknown);
    let integrate = |options: event::Options| event::integrate(&point, &options);
    let good = || event::Options::new(0.1).unwrap();
    let section = |normal: Vec<f64>| event::Section { normal, level: 0.0, after: 0.0 };
    refused("q0", || integrate(good().with_start(&[], &[])));
    refused("u0", || integrate(good().with_start(&[0.0; 2], &[NAN; 2])));
    refused("sample_every", || integrate(good().with_sample(0.0)));
    refused("max_step", || integrate(good().with_max_step(NAN)));
    refused("max_events", || integrate(good().with_max_events(0)));
    for wrong in [NAN, -1.0] {
        refused("t_start", || integrate(good().with_start_time(wrong)));
    }
    refused("t_end", || integrate(good().with_start_time(0.1)));
    refused("section", || integrate(good().with_section(section(vec![]))));
    refused("section", || integrate(good().with_section(section(vec![NAN; 4]))));
}

#[test]
fn linear_systems_are_checked_where_they_are_made() {
    let square = |n: usize| DMatrix::<f64>::identity(n, n);
    let system = |n: [usize; 4], contacts: Vec<Contact>| {
        LinearSystem::new(square(n[0]), square(n[1]), square(n[2]), vec![0.0; n[3]], contacts)
    };
    refused("stiffness", || system([2, 1, 2, 2], vec![]));
    refused("damping", || system([2, 2, 0, 2], vec![]));
    refused("force", || system([2, 2, 2, 3], vec![]));
    refused("law", || ContactLaw::new(Law::frictionless(), NormalForce::Unilateral));
    calm("no velocities", || system([0, 0, 0, 0], vec![])).ok();
    let uneven = DMatrix::zeros(2, 3);
    refused("mass", || LinearSystem::new(uneven, square(2), square(2), vec![0.0; 2], vec![]));
    for wrong in [NAN, f64::INFINITY, 0.0, -1.0] {
        let mass = square(2) * wrong;
        refused("mass", || LinearSystem::new(mass, square(2), square(2), vec![0.0; 2], vec![]));
        let law = || FrictionLaw::associated(ellipse());
        refused("mass", || sliding_point(wrong, law(), 10.0));
        refused("gravity", || sliding_point(1.0, law(), wrong));
    }
    let good = || Contact::with_force(law(), DMatrix::identity(2, 2), 1.0);
    let with = |change: fn(&mut Contact)| {
        let mut contact = good();
        change(&mut contact);
        move || system([2, 2, 2, 2], vec![contact])
    };
    refused("direction", with(|c| c.direction = DMatrix::zeros(1, 2)));
    refused("direction", with(|c| c.direction.fill(NAN)));
    refused("velocity", with(|c| c.velocity.clear()));
    refused("normal_force", with(|c| c.normal_force = NormalForce::Prescribed(-1.0)));
    refused("normal_restitution", with(|c| c.restitution.0 = NAN));
    refused("normal", with(|c| c.normal_force = NormalForce::Unilateral));
    let unilateral = |normal, gap| {
        let contact = Contact::unilateral(law(), DMatrix::identity(2, 2), normal, gap);
        move || system([2, 2, 2, 2], vec![contact])
    };
    refused("normal", unilateral(vec![1.0], 0.0));
    refused("gap", unilateral(vec![1.0, 0.0], NAN));
    let law = || FrictionLaw::associated(ellipse());
    let belt = |stiffness, force, velocity| mass_on_belt(1.0, stiffness, law(), force, velocity);
    let (one, still) = (Matrix2::identity(), Vector2::zeros());
    refused("stiffness", || belt(one * NAN, 1.0, still));
    refused("normal_force", || belt(one, NAN, still));
    refused("velocity", || belt(one, 1.0, still.add_scalar(NAN)));
}

#[test]
fn rigid_bodies_are_checked_where_they_are_made() {
    let body = || Body::new(1.0, [1.0; 3]);
    let bodies = |bodies: Vec<Body>| RigidBodies::new(bodies, &[], vec![], [0.0; 3]);
    for wrong in [NAN, f64::INFINITY, 0.0, -1.0] {
        refused("mass", || bodies(vec![Body { mass: wrong, ..body() }]));
        assert!(calm("inertia", || bodies(vec![Body::new(1.0, [wrong; 3])])).is_err());
    }
    refused("orientation", || bodies(vec![Body { orientation: [0.0; 4], ..body() }]));
    refused("gravity", || RigidBodies::new(vec![body()], &[], vec![], [NAN; 3]));
    let planar = vec![PlanarBody::new(1.0, 1.0)];
    refused("gravity", || RigidBodies::new(planar.clone(), &[], vec![], [0.0, 0.0, 1.0]));
    let spring = |body, other| Spring {
        body,
        point: [0.0; 3],
        other,
        other_point: [0.0; 3],
        stiffness: 1.0,
        damping: 0.0,
        length: 0.0.into(),
    };
    for spring in
        [spring(1, None), spring(0, Some(1)), Spring { stiffness: NAN, ..spring(0, None) }]
    {
        let made = calm("spring", || RigidBodies::new(vec![body()], &[], vec![spring], [0.0; 3]));
        assert!(made.is_err());
    }
    let plane = |normal| Plane { normal, ..Plane::floor() };
    for (index, centre, radius, normal) in [
        (1, [0.0; 3], 1.0, [0.0, 0.0, 1.0]),
        (0, [NAN; 3], 1.0, [0.0, 0.0, 1.0]),
        (0, [0.0; 3], -1.0, [0.0, 0.0, 1.0]),
        (0, [0.0; 3], 1.0, [0.0; 3]),
        (0, [0.0; 3], 1.0, [1.0, 0.0, 0.0]),
    ] {
        let shape = Shape::SpherePlane { body: index, centre, radius, plane: plane(normal) };
        let pair = Pair::new(shape, law());
        let made = calm("pair", || RigidBodies::new(vec![body()], &[pair], vec![], [0.0; 3]));
        assert!(made.is_err());
    }
    calm("no bodies", || both(&bodies(vec![]).unwrap()));
}

#[test]
fn rigid_bodies_are_asked_for_what_they_have() {
    let shape =
        Shape::SpherePlane { body: 0, centre: [0.0; 3], radius: 0.1, plane: Plane::floor() };
    let body = Body::ball(1.0, 0.1);
    let pairs = [Pair::new(shape, law())];
    let system = RigidBodies::new(vec![body], &pairs, vec![], [0.0; 3]).unwrap();
    let (q, u) = (system.q0(), system.u0());
    assert_eq!(calm("label", || system.label(0)), Some(ContactLabel { pair: 0, number: 0 }));
    assert_eq!(calm("partners", || system.partners(0)), Some(Partners { body: 0, other: None }));
    for wrong in [1, usize::MAX] {
        assert_eq!(calm("label", || system.label(wrong)), None);
        assert_eq!(calm("partners", || system.partners(wrong)), None);
        refused("body", || system.pose(q, wrong));
        refused("contact", || system.contact_geometry(0.0, q, wrong));
    }
    let about = Vector3::zeros();
    for wrong in [&[][..], &[1.0], &[NAN; 7], &[0.5; 14]] {
        refused("q", || system.pose(wrong, 0));
        refused("q", || system.contact_geometry(0.0, wrong, 0));
        refused("q", || system.potential_energy(0.0, wrong));
        refused("u", || system.kinetic_energy(wrong));
        refused("u", || system.momentum(wrong));
        refused("q", || system.angular_momentum(wrong, u, &about));
        refused("u", || system.angular_momentum(q, wrong, &about));
    }
    refused("t", || system.contact_geometry(NAN, q, 0));
    refused("t", || system.potential_energy(NAN, q));
}

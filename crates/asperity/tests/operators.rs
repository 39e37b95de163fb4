//! One operator in all its forms: the same products, the same solutions.

mod common;

use std::sync::Arc;

use asperity::ArgumentError;
use asperity::contact::{
    BlockMatrix, ContactProblem, Csr, Delassus, DelassusOperator, Factored, MatrixFree, Memory,
    NormalForce,
};
use asperity::law::{FrictionLaw, Law};
use asperity::solver::{
    Certificate, InfeasibilityKind, ProxStep, SolveReport, Solver, Status, Stop, Workspace,
    natural_map, natural_residual, solutions,
};
use common::random::random;
use nalgebra::DMatrix;

const CONTACTS: usize = 6;
const DOF: usize = 24;

#[derive(Debug)]
struct Products(DMatrix<f64>);

impl DelassusOperator for Products {
    fn rows(&self) -> usize {
        self.0.nrows()
    }

    fn apply(&self, percussion: &[f64], velocity: &mut [f64]) {
        for (i, value) in velocity.iter_mut().enumerate() {
            *value = percussion.iter().enumerate().map(|(j, p)| self.0[(i, j)] * p).sum();
        }
    }
}

/// Mass and directions of bodies with four velocities each, two contacts sharing each pair of bodies.
fn bodies() -> (DMatrix<f64>, DMatrix<f64>) {
    let mut seed = 3;
    let mut mass = DMatrix::zeros(DOF, DOF);
    for body in 0..DOF / 4 {
        let root = DMatrix::from_fn(4, 4, |_, _| random(&mut seed));
        let block = &root * root.transpose() + DMatrix::identity(4, 4);
        mass.view_mut((4 * body, 4 * body), (4, 4)).copy_from(&block);
    }
    let mut directions = DMatrix::zeros(3 * CONTACTS, DOF);
    for contact in 0..CONTACTS {
        for body in [contact, (contact + 1) % (DOF / 4)] {
            for row in 0..3 {
                for velocity in 0..4 {
                    directions[(3 * contact + row, 4 * body + velocity)] = random(&mut seed);
                }
            }
        }
    }
    (mass, directions)
}

fn forms() -> Vec<(&'static str, Delassus)> {
    let (mass, directions) = bodies();
    let dense = &directions * mass.clone().try_inverse().unwrap() * directions.transpose();
    let sizes = [3; CONTACTS];
    let factored = Factored::new(
        Csr::from_dense(&mass).unwrap(),
        Csr::from_dense(&directions).unwrap(),
        &sizes,
    );
    let blocks = BlockMatrix::from_csr(&Csr::from_dense(&dense).unwrap(), &sizes).unwrap();
    let free = MatrixFree::new(Arc::new(Products(dense.clone())), &sizes).unwrap();
    vec![
        ("dense", BlockMatrix::from_dense(&dense, &sizes).unwrap().into()),
        ("blocks", blocks.into()),
        ("factored", factored.unwrap().into()),
        ("matrix-free", free.into()),
    ]
}

fn problem(delassus: Delassus) -> ContactProblem {
    let mut seed = 9;
    let free = (0..3 * CONTACTS).map(|row| random(&mut seed) - f64::from(u8::from(row % 3 == 0)));
    let law: Law = FrictionLaw::<2>::isotropic(0.4).unwrap().into();
    let contacts = (0..CONTACTS).map(|_| (law.clone(), NormalForce::Unilateral));
    ContactProblem::new(delassus, free.collect(), contacts).unwrap()
}

fn solve(solver: Solver, problem: &ContactProblem) -> (SolveReport, Vec<f64>) {
    let mut workspace = Workspace::default();
    let mut memory = Memory::new(problem.rows(), problem.contacts().len());
    let report = solver.solve(problem, Stop::at(1e-11), &mut memory, &mut workspace);
    (report, workspace.velocity().to_vec())
}

#[test]
fn forms_of_one_operator_agree() {
    let auto = Solver::AUTO;
    let (_, reference) = solve(Solver::Exact { max_sweeps: 10_000 }, &problem(forms().remove(0).1));
    let dense = forms()[0].1.to_dense();
    let extremes = dense.clone().symmetric_eigenvalues();
    for (name, delassus) in forms() {
        assert!((delassus.to_dense() - &dense).amax() < 1e-12, "{name}");
        assert!((delassus.assembled().to_dense() - &dense).amax() < 1e-12, "{name}");
        let (low, high) = delassus.spectrum().unwrap();
        assert!((high - extremes.max()).abs() < 1e-9 * high, "{name}: {high}");
        assert!((low - extremes.min()).abs() < 1e-6 * high, "{name}: {low}");
        let (report, velocity) = solve(auto, &problem(delassus));
        assert_eq!(report.status, Status::Converged, "{name}");
        for (a, b) in velocity.iter().zip(&reference) {
            assert!((a - b).abs() < 1e-7, "{name}: {a} {b}");
        }
    }
}

#[test]
fn operators_without_entries_are_for_the_papers_iteration() {
    let problem = problem(forms().remove(3).1);
    let jacobi = Solver::ProxJacobi { step: ProxStep::Adaptive, max_iterations: 1_000_000 };
    assert_eq!(solve(jacobi, &problem).0.status, Status::Converged);
    let others = [
        Solver::Exact { max_sweeps: 10 },
        Solver::SemismoothNewton { max_iterations: 10 },
        Solver::ProximalPoint { max_iterations: 10 },
        Solver::InteriorPoint { max_iterations: 10 },
        Solver::Admm { max_iterations: 10 },
        Solver::ProxGaussSeidel { step: ProxStep::Adaptive, max_iterations: 10 },
    ];
    for solver in others {
        assert_eq!(solve(solver, &problem).0.status, Status::NotApplicable, "{solver:?}");
    }
}

#[test]
fn bad_operators_are_named() {
    let named = |result: Result<(), ArgumentError>, argument: &str| {
        assert_eq!(result.unwrap_err().argument, argument);
    };
    let pattern =
        |sizes: &[usize], lists: &[Vec<usize>]| BlockMatrix::from_pattern(sizes, lists).map(|_| ());
    named(pattern(&[3, 3], &[vec![0]]), "delassus");
    named(pattern(&[3, 3], &[vec![0], vec![2]]), "delassus");
    named(pattern(&[3, 3], &[vec![1, 0], vec![1]]), "delassus");
    named(pattern(&[5], &[vec![0]]), "delassus");
    let (mass, directions) = bodies();
    let factored = |mass: &DMatrix<f64>, directions: &DMatrix<f64>| {
        let (mass, directions) =
            (Csr::from_dense(mass).unwrap(), Csr::from_dense(directions).unwrap());
        Factored::new(mass, directions, &[3; CONTACTS]).map(|_| ())
    };
    named(factored(&-&mass, &directions), "mass");
    named(factored(&mass, &directions.rows(0, 6).into_owned()), "directions");
    let large = 600;
    let chain = DMatrix::from_fn(large, large, |i, j| match i.abs_diff(j) {
        0 => 2.0,
        1 => -0.5,
        _ => 0.0,
    });
    let along = DMatrix::from_fn(3 * CONTACTS, large, |i, j| f64::from(u8::from(i == j)));
    named(factored(&chain, &along), "mass");
    let products = Arc::new(Products(DMatrix::identity(4, 4)));
    named(MatrixFree::new(products, &[3]).map(|_| ()), "delassus");
    let unsorted = Csr::new(1, 2, vec![0, 2], vec![1, 0], vec![1.0, 1.0]);
    named(unsorted.map(|_| ()), "matrix");
    let outside = Csr::new(1, 2, vec![0, 1], vec![2], vec![1.0]);
    // The caller has its own word for it, and what is wrong stays as it is said.
    let [error, renamed] = [outside.clone(), outside.map_err(|error| error.named("mass"))]
        .map(|outside| outside.unwrap_err());
    assert_eq!((error.argument, renamed.argument), ("matrix", "mass"));
    assert_eq!(error.message, renamed.message);
}

const SOLVERS: [Solver; 8] = [
    Solver::AUTO,
    Solver::Exact { max_sweeps: 1000 },
    Solver::SemismoothNewton { max_iterations: 100 },
    Solver::ProximalPoint { max_iterations: 100 },
    Solver::InteriorPoint { max_iterations: 100 },
    Solver::Admm { max_iterations: 2000 },
    Solver::ProxJacobi { step: ProxStep::Adaptive, max_iterations: 10_000 },
    Solver::ProxGaussSeidel { step: ProxStep::Adaptive, max_iterations: 10_000 },
];

/// Three contacts fewer than [`problem`], of one body each.
fn smaller() -> ContactProblem {
    let law: Law = FrictionLaw::<1>::isotropic(0.3).unwrap().into();
    let contacts = (0..3).map(|_| (law.clone(), NormalForce::Unilateral));
    let free = vec![-1.0, 0.2, -1.0, 0.1, 0.5, 0.0];
    let mut g = DMatrix::identity(6, 6);
    (g[(0, 2)], g[(2, 0)]) = (0.3, 0.3);
    ContactProblem::new(g, free, contacts).unwrap()
}

/// Buffers that are not there, or are those of another problem, are made; what is remembered of another problem
/// is forgotten.
#[test]
fn workspaces_need_no_preparation() {
    for solver in SOLVERS {
        for name in 0..3 {
            let (problem, other) = (problem(forms().remove(name).1), smaller());
            let (mut memory, mut workspace) = (Memory::default(), Workspace::default());
            for problem in [&problem, &other, &problem] {
                let stop = Stop::at(1e-7);
                let report = solver.solve(problem, stop, &mut memory, &mut workspace);
                assert_eq!(report.status, Status::Converged, "{solver:?}");
                assert_eq!(memory.percussion.len(), problem.rows());
                assert_eq!(workspace.velocity().len(), problem.rows());
            }
        }
    }
}

/// A limit is the reason only where it was reached; a proof is there if and only if there is no solution.
#[test]
fn statuses_say_what_happened() {
    for solver in SOLVERS {
        let normals = DMatrix::from_row_slice(2, 2, &[1.0, -1.0, -1.0, 1.0]);
        let mut g = DMatrix::identity(4, 4);
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            g[(2 * i, 2 * j)] = normals[(i, j)];
        }
        let law: Law = FrictionLaw::<1>::isotropic(0.3).unwrap().into();
        let contacts = [(law.clone(), NormalForce::Unilateral), (law, NormalForce::Unilateral)];
        let squeezed = ContactProblem::new(g, vec![-1.0, 0.5, -1.0, 0.5], contacts).unwrap();
        let (mut memory, mut workspace) = (Memory::default(), Workspace::default());
        let report = solver.solve(&squeezed, Stop::at(1e-8), &mut memory, &mut workspace);
        assert_ne!(report.status, Status::Converged, "{solver:?}");
        let proof = workspace.infeasibility().cloned();
        assert_eq!(proof.is_some(), report.status == Status::NoSolution, "{solver:?}");
        if let Some(proof) = proof {
            assert_eq!(proof.kind, InfeasibilityKind::Closing);
            assert!((proof.closing_velocity - 1.0).abs() < 1e-12);
            let expected = [0.5, 0.0, 0.5, 0.0];
            assert!(proof.direction.iter().zip(expected).all(|(d, e)| (d - e).abs() < 1e-12));
        }
        // The next solve forgets it.
        solver.solve(&smaller(), Stop::at(1e-7), &mut memory, &mut workspace);
        assert_eq!(workspace.infeasibility(), None);
    }
}

#[test]
fn certificates_of_numbers_that_are_none_say_so() {
    let problem = smaller();
    let mut percussion = vec![0.1; problem.rows()];
    percussion[0] = f64::NAN;
    let certificate = Certificate::new(&problem, &percussion).unwrap();
    assert!(certificate.penetration_velocity.is_nan());
    assert!(certificate.tension.is_nan());
    assert!(!(certificate.contact_residual <= 1.0));
}

#[test]
fn questions_about_no_contact_are_refused_by_name() {
    let dense = problem(forms().remove(0).1);
    let free = problem(forms().remove(3).1);
    let held = vec![0.0; dense.rows()];
    let named = |problem: &ContactProblem, contact, held: &[f64], argument: &str| {
        assert_eq!(solutions(problem, contact, held).unwrap_err().argument, argument);
    };
    assert!(solutions(&dense, 0, &held).is_ok());
    named(&dense, 99, &held, "contact");
    named(&dense, 0, &[], "percussion");
    named(&free, 0, &held, "delassus");
}

/// The residual of percussions that are no solution, written out once more: `max_i √(defect_i/scale_i)`.
#[test]
fn residuals_of_all_forms_are_those_of_the_formula() {
    let mut seed = 77;
    let mu = 0.4;
    for (name, delassus) in forms() {
        let dense = delassus.to_dense();
        let restitution: Vec<f64> = (0..3 * CONTACTS).map(|_| 0.3 * random(&mut seed)).collect();
        let problem = problem(delassus)
            .with_restitution(&[1.0; CONTACTS], &[1.0; CONTACTS], &restitution)
            .unwrap();
        for _ in 0..20 {
            let percussion: Vec<f64> = (0..3 * CONTACTS)
                .map(|row| random(&mut seed) * if row % 3 == 0 { 1.0 } else { 0.3 })
                .collect();
            let velocity = problem.velocities(&percussion).unwrap();
            let (mut worst, mut worst_contact, mut map) = (0.0, 0, 0.0);
            let trace = dense.trace();
            for i in 0..CONTACTS {
                let rows = 3 * i..3 * i + 3;
                let p = &percussion[rows.clone()];
                let xi: Vec<f64> = rows.clone().map(|r| velocity[r] + restitution[r]).collect();
                let rho = 3.0 / rows.clone().map(|r| dense[(r, r)]).sum::<f64>();
                let normal = p[0] - f64::max(0.0, p[0] - rho * xi[0]);
                // −P_T + ργ projected onto the disk of radius μP_N.
                let z = [-p[1] + rho * xi[1], -p[2] + rho * xi[2]];
                let shrink = f64::min(1.0, mu * p[0].max(0.0) / f64::hypot(z[0], z[1]));
                let own = f64::hypot(p[1], p[2]);
                // Outside of the reservoir α shortens the percussion, for associated laws not.
                let off = match p[0] > 0.0 {
                    true => f64::hypot(-p[1] - z[0] * shrink, -p[2] - z[1] * shrink),
                    false => own,
                };
                let brought = |r: usize| match name {
                    "matrix-free" => (velocity[r] - problem.free_velocity()[r]).abs(),
                    _ => (0..3 * CONTACTS).map(|j| (dense[(r, j)] * percussion[j]).abs()).sum(),
                };
                let load = |r: usize| -> f64 {
                    brought(r) + problem.free_velocity()[r].abs() + restitution[r].abs()
                };
                let loads: f64 = rows.clone().map(|r| load(r).powi(2)).sum();
                let scale = p.iter().map(|p| p * p).sum::<f64>().max(rho * rho * loads);
                let value = ((normal * normal + off * off) / scale).sqrt();
                if value > worst {
                    (worst, worst_contact) = (value, i);
                }
                map += cone_defect(mu, p, &xi, (3 * CONTACTS) as f64 / trace);
            }
            let found = natural_residual(&problem, &percussion, &velocity).unwrap();
            assert!((found.value - worst).abs() < 1e-12 * worst, "{name}: {found:?} {worst}");
            assert_eq!(found.worst_contact, worst_contact, "{name}");
            let rho = (3 * CONTACTS) as f64 / trace;
            let loads = problem.free_velocity().iter().zip(&restitution);
            let loads = loads.map(|(b, e)| (b + e).powi(2)).sum::<f64>() * rho * rho;
            let scale = percussion.iter().map(|p| p * p).sum::<f64>().max(loads);
            let found = natural_map(&problem, &percussion, &velocity).unwrap();
            assert!((found - (map / scale).sqrt()).abs() < 1e-12 * found, "{name}: {found} {map}");
        }
    }
}

/// `‖P − P_K(P − ρ(ξ_N + μ‖ξ_T‖, ξ_T))‖²`, the projection onto the cone by its two generators.
fn cone_defect(mu: f64, p: &[f64], xi: &[f64], rho: f64) -> f64 {
    let z = [
        p[0] - rho * (xi[0] + mu * f64::hypot(xi[1], xi[2])),
        p[1] - rho * xi[1],
        p[2] - rho * xi[2],
    ];
    let size = f64::hypot(z[1], z[2]);
    // In the half-plane of the axis and z: the nearest of the edge (1, μ), the apex and z itself.
    let along = f64::max(0.0, (z[0] + mu * size) / (1.0 + mu * mu));
    let inside = size <= mu * z[0];
    let (normal, tangent) = if inside { (z[0], size) } else { (along, mu * along) };
    let part = if size > 0.0 { tangent / size } else { 0.0 };
    (p[0] - normal).powi(2) + (p[1] - z[1] * part).powi(2) + (p[2] - z[2] * part).powi(2)
}

#[test]
fn eigenvalues_beyond_all_numbers_are_an_error() {
    let element = |size: f64| DMatrix::from_element(6, 6, size);
    let full = |size| Delassus::from(BlockMatrix::from_dense(&element(size), &[3, 3]).unwrap());
    assert_eq!(full(1e308).spectrum().unwrap_err().argument, "delassus");
    for size in [1e300, 1.0, 1e-300] {
        let (low, high) = full(size).spectrum().unwrap();
        assert!((high / size - 6.0).abs() < 1e-9, "{size}: {high}");
        assert!(low.abs() < 1e-9 * size, "{size}: {low}");
    }
}

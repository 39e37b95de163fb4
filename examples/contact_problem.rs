//! The one-step contact problem as data: all three solvers agree, and one contact may have several
//! solutions.
//!
//! Run: cargo run --release -p asperity --example contact_problem

use std::error::Error;

use asperity::contact::{ContactProblem, Memory, NormalForce};
use asperity::law::{FrictionLaw, Law};
use asperity::set::{Convex, Ellipse, Vector};
use asperity::solver::{ProxStep, Solver, Status, Stop, Workspace, solutions};
use nalgebra::DMatrix;

fn main() -> Result<(), Box<dyn Error>> {
    let ellipse: Convex<2> = Ellipse::new(Vector::<2>::new(0.6, 0.2))?.into();
    let reservoir = ellipse.rotated(30f64.to_radians())?;
    let direction: Convex<2> = Ellipse::new(Vector::<2>::new(3.0, 1.0))?.into();
    let extended = FrictionLaw::new(reservoir.into(), direction)?;
    // A load on the reservoir's boundary, moved on in the direction in which it slides there.
    let slip = Vector::<2>::new(0.5, 0.75f64.sqrt());
    let load = slip * 0.05 - extended.force(&slip, 1.0)?;
    let plane = Law::from(extended);
    let line = Law::from(FrictionLaw::<1>::isotropic(0.4)?);

    // Rows: normal, two tangential of the unilateral contact; one tangential of the other.
    let delassus = DMatrix::from_row_slice(
        4,
        4,
        &[1.0, 0.1, 0.0, 0.2, 0.1, 2.0, 0.3, 0.0, 0.0, 0.3, 2.0, 0.1, 0.2, 0.0, 0.1, 1.5],
    );
    let contacts = [(plane.clone(), NormalForce::Unilateral), (line, NormalForce::Prescribed(0.5))];
    let problem = ContactProblem::new(delassus, vec![-1.0, 1.5, -0.5, 0.8], contacts)?;
    let (step, max_iterations) = (ProxStep::Adaptive, 100_000);
    let solvers = [
        Solver::Exact { max_sweeps: 1000 },
        Solver::ProxJacobi { step, max_iterations },
        Solver::ProxGaussSeidel { step, max_iterations },
    ];
    let mut found: Vec<Vec<f64>> = Vec::new();
    for solver in solvers {
        let mut memory = Memory::new(problem.rows(), problem.contacts().len());
        let mut workspace = Workspace::default();
        let stop = Stop::at(1e-12);
        let report = solver.solve(&problem, stop, &mut memory, &mut workspace);
        println!("{solver:?}");
        println!("  {} iterations, residual {:.1e}", report.iterations, report.residual);
        println!("  percussions {:.9?}", memory.percussion);
        assert_eq!(report.status, Status::Converged);
        found.push(memory.percussion);
    }
    for other in &found[1..] {
        assert!(other.iter().zip(&found[0]).all(|(a, b)| (a - b).abs() < 1e-9));
    }

    // A load inside C that admits stick and two slip solutions, see docs/selection.md.
    let contact = [(plane, NormalForce::Prescribed(1.0))];
    let alone = ContactProblem::new(DMatrix::identity(2, 2), vec![load.x, load.y], contact)?;
    let all = solutions(&alone, 0, &[0.0, 0.0])?;
    for solution in &all {
        println!("{:?}: P = {:.6?}", solution.phase, solution.percussion);
    }
    assert_eq!(all.len(), 3);
    Ok(())
}

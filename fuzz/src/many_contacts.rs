//! Several contacts, any `G`, every solver, any start.

use asperity::contact::{ContactState, Memory, NormalForce, Phase};
use asperity::solver::{ProxStep, Solver, Status, Steps, Stop, Workspace};
use nalgebra::{DMatrix, DVector};

use crate::decode::{Range, Source};
use crate::laws;
use crate::truth::Scene;

const TOLERANCE: f64 = 1e-8;
const DEFECT: f64 = 1e-7;

/// A solve ends; what has converged solves the problem, what has a solution is not denied.
pub fn check(data: &[u8]) {
    let mut source = Source::new(data);
    let range = [Range::Narrow, Range::Narrow, Range::Wide][source.below(3)];
    let same = source.once_in(2);
    let mut contacts = Vec::new();
    for _ in 0..2 + source.below(4) {
        let law = match contacts.first() {
            Some((law, _)) if same => Clone::clone(law),
            _ => match laws::any(&mut source, range) {
                Some(law) => law,
                None => return,
            },
        };
        let normal = match source.below(4) {
            0 => NormalForce::Prescribed(source.size(Range::Narrow)),
            _ => NormalForce::Unilateral,
        };
        contacts.push((law, normal));
    }
    let length = |(law, normal): &(asperity::law::Law, NormalForce)| {
        law.dimension() + usize::from(*normal == NormalForce::Unilateral)
    };
    let rows = contacts.iter().map(length).sum();
    let delassus = delassus(&mut source, rows, range);
    let free_velocity = DVector::from_fn(rows, |_, _| source.number(Range::Narrow));
    let mut scene = Scene { delassus, free_velocity, contacts, known: None };
    if source.once_in(2) {
        scene.solve_backwards(&mut source);
    }
    let Some(problem) = scene.problem() else { return };
    let count = scene.contacts.len();
    let mut memory = Memory::new(rows, count);
    if source.once_in(3) {
        let size = source.size(range);
        memory.percussion.fill_with(|| size * source.signed());
        memory.states.fill_with(|| {
            let phase = [Phase::Unknown, Phase::Open, Phase::Stick, Phase::Slip][source.below(4)];
            ContactState::new(phase, [source.signed(), source.signed(), source.signed()])
        });
    }
    let ordinary = scene.contacts.iter().all(|(law, _)| laws::is_ordinary(law));
    let mut workspace = Workspace::default();
    for solver in solvers(&mut source) {
        let mut own = memory.clone();
        let report = solver.solve(&problem, Stop::at(TOLERANCE), &mut own, &mut workspace);
        let finite = own.percussion.iter().all(|p| p.is_finite());
        assert!(finite || !ordinary, "{solver:?} {report:?}: {:?} of {scene:?}", own.percussion);
        match report.status {
            Status::Converged => {
                let defect = scene.defect(&own.percussion);
                assert!(
                    !ordinary || defect <= DEFECT,
                    "{solver:?} called converged, defect {defect:e}: {:?} of {scene:?}",
                    own.percussion
                );
            }
            Status::NoSolution => {
                let denied = ordinary && scene.known.is_some();
                assert!(!denied, "{solver:?} denies a solution: {scene:?}");
            }
            Status::MaxIterations => {
                let limit = limit(&solver);
                assert!(
                    limit.is_none_or(|limit| report.iterations >= limit),
                    "{solver:?} says limit after {}: {scene:?}",
                    report.iterations
                );
            }
            _ => {}
        }
    }
}

/// The default, and another one.
fn solvers(source: &mut Source<'_>) -> [Solver; 2] {
    let step = match source.below(3) {
        0 => ProxStep::Constant(source.size(Range::Narrow)),
        _ => ProxStep::Adaptive,
    };
    let other = match source.below(8) {
        0 => Solver::Exact { max_sweeps: 200 },
        1 => Solver::ProxJacobi { step, max_iterations: 500 },
        2 => Solver::ProxGaussSeidel { step, max_iterations: 500 },
        3 => Solver::SemismoothNewton { max_iterations: 100 },
        4 => Solver::ProximalPoint { max_iterations: 60 },
        5 => Solver::InteriorPoint { max_iterations: 100 },
        6 => Solver::Admm { max_iterations: 500 },
        _ => {
            let steps = Steps::ALL.without("admm").and_then(|left| left.without("interior_point"));
            Solver::Auto { steps: steps.unwrap_or(Steps::ALL), threads: 1 }
        }
    };
    [Solver::AUTO, other]
}

fn limit(solver: &Solver) -> Option<usize> {
    match *solver {
        Solver::Exact { max_sweeps } => Some(max_sweeps),
        Solver::SemismoothNewton { max_iterations }
        | Solver::ProximalPoint { max_iterations }
        | Solver::InteriorPoint { max_iterations }
        | Solver::Admm { max_iterations }
        | Solver::ProxJacobi { max_iterations, .. }
        | Solver::ProxGaussSeidel { max_iterations, .. } => Some(max_iterations),
        _ => None,
    }
}

/// `WᵀM⁻¹W` of few or many degrees of freedom, masses of all sizes, or any matrix at all.
fn delassus(source: &mut Source<'_>, rows: usize, range: Range) -> DMatrix<f64> {
    if source.once_in(6) {
        let mut any = DMatrix::from_fn(rows, rows, |_, _| source.signed());
        any.fill_diagonal(1.0 + source.unit() * rows as f64);
        return any * source.size(range);
    }
    let dof = 1 + source.below(rows + 4);
    let sparse = source.below(3);
    let mut factor = DMatrix::from_fn(dof, rows, |_, _| {
        if sparse == 2 && source.once_in(2) { 0.0 } else { source.signed() }
    });
    for mut row in factor.row_iter_mut() {
        let mass = source.size(range);
        row /= mass.sqrt();
    }
    // A contact that is listed twice.
    if source.once_in(4) && rows > 1 {
        let column = factor.column(0).into_owned();
        factor.set_column(rows / 2, &column);
    }
    factor.transpose() * factor
}

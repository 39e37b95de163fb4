//! One law, one contact, a block of any rank, any start.

use asperity::contact::{ContactState, Memory, NormalForce, Phase};
use asperity::solver::{Solver, Status, Stop, Workspace, solutions};
use nalgebra::{DMatrix, DVector};

use crate::decode::{Range, Source};
use crate::laws;
use crate::truth::Scene;

const TOLERANCE: f64 = 1e-10;
/// Defect that what has converged may have: the measure counts loads differently by a factor of a few.
const DEFECT: f64 = 1e-9;
/// Condition up to which a solver must find a solution that is known.
const CONDITION: f64 = 1e10;

/// A solve ends; what has converged solves the problem, what has a solution is not denied.
pub fn check(data: &[u8]) {
    let mut source = Source::new(data);
    let range = [Range::Narrow, Range::Narrow, Range::Wide][source.below(3)];
    let Some(law) = laws::any(&mut source, range) else { return };
    let normal = match source.below(3) {
        0 => NormalForce::Prescribed(source.size(range)),
        _ => NormalForce::Unilateral,
    };
    let rows = law.dimension() + usize::from(normal == NormalForce::Unilateral);
    let mut scene = Scene {
        delassus: block(&mut source, rows, range),
        free_velocity: DVector::from_fn(rows, |_, _| source.number(range)),
        contacts: vec![(law, normal)],
        known: None,
    };
    if source.once_in(2) {
        scene.solve_backwards(&mut source);
    }
    let Some(problem) = scene.problem() else { return };
    let mut memory = Memory::new(rows, 1);
    let phase = [Phase::Unknown, Phase::Open, Phase::Stick, Phase::Slip][source.below(4)];
    memory.states[0] =
        ContactState::new(phase, [source.signed(), source.signed(), source.signed()]);
    memory.percussion.fill_with(|| source.signed());
    let mut workspace = Workspace::default();
    let solver = Solver::Exact { max_sweeps: 1 };
    let report = solver.solve(&problem, Stop::at(TOLERANCE), &mut memory, &mut workspace);
    let ordinary = laws::is_ordinary(&scene.contacts[0].0);
    if source.once_in(8) {
        for solution in solutions(&problem, 0, &vec![0.0; rows]).unwrap_or_default() {
            assert!(solution.percussion.iter().all(|p| !p.is_nan()), "{solution:?} of {scene:?}");
        }
    }
    match report.status {
        Status::Converged => {
            let defect = scene.defect(&memory.percussion);
            assert!(
                !ordinary || defect <= DEFECT,
                "called converged, defect {defect:e}: {:?} of {scene:?}",
                memory.percussion
            );
        }
        Status::NoSolution => {
            let certain = scene.known.is_some() || scene.is_solvable();
            assert!(!(ordinary && certain), "a solution is denied: {scene:?}");
        }
        other => {
            let must = ordinary
                && scene.known.is_some()
                && !scene.is_known_on_a_cusp()
                && scene.condition() < CONDITION;
            assert!(!must, "{other:?}, residual {:e}: {scene:?}", report.residual);
        }
    }
}

/// A block with a positive diagonal: identity, of a body, of any rank, unsymmetric, scaled.
fn block(source: &mut Source<'_>, rows: usize, range: Range) -> DMatrix<f64> {
    let rank = 1 + source.below(rows);
    let factor = DMatrix::from_fn(rank, rows, |_, _| source.signed());
    let mut block = factor.transpose() * factor;
    match source.below(4) {
        0 => block += DMatrix::identity(rows, rows),
        1 => {
            let small = 10f64.powf(-16.0 * source.unit());
            block += DMatrix::from_diagonal_element(rows, rows, small);
        }
        2 => block += DMatrix::from_fn(rows, rows, |_, _| 1e-2 * source.signed()),
        _ => {}
    }
    let size = source.size(range);
    let ratio = if source.once_in(3) { source.size(range) } else { 1.0 };
    block *= size;
    // The rows of one direction in other units.
    block.row_mut(0).scale_mut(ratio);
    block.column_mut(0).scale_mut(ratio);
    block
}

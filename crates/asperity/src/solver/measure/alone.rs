//! Residual and growth of contacts that no other influences, in one pass with their solution.

use super::growth;
use super::natural_residual::defect;
use crate::contact::ContactProblem;
use crate::law::Friction;

/// What is measured of one contact in its own rows.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OwnMeasure {
    /// Square of the relative defect.
    pub(crate) defect: f64,
    /// Whether its percussions may have grown, see `growth.rs`.
    pub(crate) may_grow: bool,
}

/// Measures a contact that no other influences, from the percussions in its own rows; their velocities `γ_E` are found
/// on the way.
#[inline(always)]
pub(crate) fn measure_alone(
    problem: &ContactProblem,
    contact: usize,
    percussion: &[f64],
    velocity: &mut [f64],
) -> OwnMeasure {
    match percussion.len() {
        1 => measure_rows::<1>(problem, contact, percussion, velocity),
        2 => measure_rows::<2>(problem, contact, percussion, velocity),
        3 => measure_rows::<3>(problem, contact, percussion, velocity),
        _ => measure_rows::<4>(problem, contact, percussion, velocity),
    }
}

/// The same with `N` rows.
#[inline(always)]
fn measure_rows<const N: usize>(
    problem: &ContactProblem,
    contact: usize,
    percussion: &[f64],
    velocity: &mut [f64],
) -> OwnMeasure {
    let (rows, rho) = (&problem.contacts()[contact], problem.rho(contact));
    let (percussion, velocity) = (&percussion[..N], &mut velocity[..N]);
    let free = &problem.free_velocity()[rows.offset..rows.offset + N];
    let restitution = &problem.restitution()[rows.offset..rows.offset + N];
    let own = &problem.delassus().blocks().diagonal(contact)[..N * N];
    // With one contact nothing is brought by others, see `scale`.
    let counted = if problem.contacts().len() == 1 { 0.0 } else { 1.0 };
    let (mut squares, mut loads, mut all) = (0.0, 0.0, 0.0);
    for a in 0..N {
        let (mut sum, mut size) = (0.0, 0.0);
        for b in 0..N {
            let term = own[N * a + b] * percussion[b];
            (sum, size) = (sum + term, size + term.abs());
        }
        velocity[a] = free[a] + sum;
        squares += percussion[a] * percussion[a];
        let load = counted * size + free[a].abs() + restitution[a].abs();
        all += load * load;
        let load = free[a] + restitution[a];
        loads += load * load;
    }
    let first = rows.normal_rows();
    let friction = Friction {
        normal: rows.normal.prescribed().unwrap_or(percussion[0]),
        tangent: &percussion[first..],
        velocity: &velocity[first..],
        restitution: &restitution[first..],
    };
    let xi = velocity[0] + restitution[0];
    let defect = defect(rows, (percussion[0], xi), friction, rho);
    let may_grow = first == 1
        && percussion[0] > 0.0
        && growth::may_grow((xi, free[0] + restitution[0]), squares, rho * rho * loads);
    if defect == 0.0 {
        return OwnMeasure { defect, may_grow };
    }
    OwnMeasure { defect: defect / f64::max(squares, rho * rho * all), may_grow }
}

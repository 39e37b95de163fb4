//! Residual and growth of one contact after another, in one pass with their solution.

use super::growth::Size;
use super::natural_residual::{defect, relative};
use crate::contact::{ContactProblem, ContactRows};
use crate::law::Friction;

/// What is measured of one contact in its own rows.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OwnMeasure {
    /// Square of the relative defect.
    pub(crate) defect: f64,
    /// How large its percussions are.
    pub(crate) size: Size,
}

/// Percussions and velocities `γ_E` of one contact, with `Σ_j |G_ij P_j|`.
struct Own<'a, const N: usize> {
    percussion: &'a [f64; N],
    velocity: &'a [f64; N],
    brought: [f64; N],
}

/// Calls a function of the number of rows of a contact.
macro_rules! by_rows {
    ($len:expr, $of:ident $arguments:tt) => {
        match $len {
            1 => $of::<1> $arguments,
            2 => $of::<2> $arguments,
            3 => $of::<3> $arguments,
            _ => $of::<4> $arguments,
        }
    };
}

/// Measures a contact that no other influences, from the percussions in its own rows; their velocities are found on the
/// way.
#[inline(always)]
pub(crate) fn measure_alone(
    problem: &ContactProblem,
    contact: usize,
    percussion: &[f64],
    velocity: &mut [f64],
) -> OwnMeasure {
    by_rows!(percussion.len(), alone(problem, contact, percussion, velocity))
}

/// Measures a contact that others may influence, from the percussions in all rows; its velocities are found on the way.
#[inline]
pub(crate) fn measure_coupled(
    problem: &ContactProblem,
    contact: usize,
    percussion: &[f64],
    velocity: &mut [f64],
) -> OwnMeasure {
    by_rows!(problem.contacts()[contact].len(), coupled(problem, contact, percussion, velocity))
}

#[inline(always)]
fn alone<const N: usize>(
    problem: &ContactProblem,
    contact: usize,
    percussion: &[f64],
    velocity: &mut [f64],
) -> OwnMeasure {
    let rows = &problem.contacts()[contact];
    let own = problem.delassus().blocks().only_block::<N>(contact);
    let (percussion, velocity) = (first::<N>(percussion), &mut velocity[..N]);
    let free = first::<N>(&problem.free_velocity()[rows.offset..]);
    // With one contact nothing is brought by others, see `scale` of the natural residual. Terms are added in the order of
    // `ContactProblem::velocity`, so that velocities do not tell, to the bit, which way they were found.
    let only = problem.contacts().len() == 1;
    let counted = if only { 0.0 } else { 1.0 };
    let (mut sums, mut brought) = (if only { *free } else { [0.0; N] }, [0.0; N]);
    for a in 0..N {
        for b in 0..N {
            let term = own[N * a + b] * percussion[b];
            sums[a] += term;
            brought[a] += counted * term.abs();
        }
    }
    if !only {
        sums = std::array::from_fn(|a| sums[a] + free[a]);
    }
    velocity.copy_from_slice(&sums);
    measure(problem, contact, rows, Own { percussion, velocity: &sums, brought })
}

#[inline(always)]
fn coupled<const N: usize>(
    problem: &ContactProblem,
    contact: usize,
    percussion: &[f64],
    velocity: &mut [f64],
) -> OwnMeasure {
    let rows = &problem.contacts()[contact];
    let (sums, brought) = problem.delassus().blocks().row_products::<N>(contact, percussion);
    let free = first::<N>(&problem.free_velocity()[rows.offset..]);
    let sums = std::array::from_fn(|a| free[a] + sums[a]);
    velocity[rows.rows()].copy_from_slice(&sums);
    let percussion = first::<N>(&percussion[rows.offset..]);
    measure(problem, contact, rows, Own { percussion, velocity: &sums, brought })
}

/// The measure of a contact with `N` rows.
#[inline(always)]
fn measure<const N: usize>(
    problem: &ContactProblem,
    contact: usize,
    rows: &ContactRows,
    own: Own<'_, N>,
) -> OwnMeasure {
    let Own { percussion, velocity, brought } = own;
    let rho = problem.rho(contact);
    let free = first::<N>(&problem.free_velocity()[rows.offset..]);
    let restitution = first::<N>(&problem.restitution()[rows.offset..]);
    let normal_rows = rows.normal_rows();
    let friction = Friction {
        normal: rows.normal.prescribed().unwrap_or(percussion[0]),
        tangent: &percussion[normal_rows..],
        velocity: &velocity[normal_rows..],
        restitution: &restitution[normal_rows..],
    };
    let xi = velocity[0] + restitution[0];
    let defect = defect(rows, (percussion[0], xi), friction, rho);
    let (mut squares, mut loads, mut all) = (0.0, 0.0, 0.0);
    for a in 0..N {
        squares += percussion[a] * percussion[a];
        let (load, sum) = (free[a] + restitution[a], free[a].abs() + restitution[a].abs());
        loads += load * load;
        all += (brought[a] + sum) * (brought[a] + sum);
    }
    let normal = (normal_rows == 1).then_some((xi, free[0] + restitution[0]));
    let size = Size::of(percussion, normal, (squares, loads), rho);
    OwnMeasure { defect: relative(defect, || f64::max(squares, rho * rho * all)), size }
}

/// The first numbers of a list that has them.
#[inline(always)]
fn first<const N: usize>(values: &[f64]) -> &[f64; N] {
    const { assert!(N <= 4) };
    values.first_chunk().unwrap_or(const { &[f64::NAN; N] })
}

//! Residual and growth of one contact after another, in one pass with their solution.

use nalgebra::{SMatrix, SVector};

use super::growth::Size;
use super::natural_residual::{normal_defect, relative};
use crate::contact::ContactProblem;
use crate::contact::NormalForce::{Prescribed, Unilateral};
use crate::law::{self, Friction, FrictionLaw, Law};

/// What is measured of one contact in its own rows.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OwnMeasure {
    /// Square of the relative defect.
    pub(crate) defect: f64,
    /// How large its percussions are.
    pub(crate) size: Size,
    /// `Σ_j |G_ij P_j|` in its first row; of a contact that no other influences it is not found.
    pub(crate) brought: Option<f64>,
}

/// One contact of a problem, with its law.
struct Own<'a, const P: usize> {
    problem: &'a ContactProblem,
    contact: usize,
    law: &'a FrictionLaw<P>,
}

/// Calls a function of the number of rows and of components of friction with a contact and its law.
macro_rules! by_rows {
    ($problem:expr, $contact:expr, $of:ident, $($argument:expr),*) => {{
        let (problem, contact) = ($problem, $contact);
        let rows = &problem.contacts()[contact];
        match (&rows.law, rows.normal) {
            (Law::One(law), Prescribed(_)) => $of::<1, 1>(Own { problem, contact, law }, $($argument),*),
            (Law::One(law), Unilateral) => $of::<2, 1>(Own { problem, contact, law }, $($argument),*),
            (Law::Two(law), Prescribed(_)) => $of::<2, 2>(Own { problem, contact, law }, $($argument),*),
            (Law::Two(law), Unilateral) => $of::<3, 2>(Own { problem, contact, law }, $($argument),*),
            (Law::Three(law), Prescribed(_)) => $of::<3, 3>(Own { problem, contact, law }, $($argument),*),
            (Law::Three(law), Unilateral) => $of::<4, 3>(Own { problem, contact, law }, $($argument),*),
        }
    }};
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
    by_rows!(problem, contact, alone, percussion, velocity)
}

/// The percussions in all rows of a problem, to measure contacts of an island, which no others influence.
#[derive(Clone, Copy)]
pub(crate) struct Percussions<'a> {
    values: &'a [f64],
    /// Whether those of the island are all zero: nothing has to be multiplied.
    vanish: bool,
}

impl<'a> Percussions<'a> {
    /// For all contacts of an island.
    #[inline(always)]
    pub(crate) fn of(problem: &ContactProblem, contacts: &[usize], values: &'a [f64]) -> Self {
        let mut rows = contacts.iter().flat_map(|&i| problem.contacts()[i].rows());
        Self { values, vanish: rows.all(|row| values[row] == 0.0) }
    }
}

/// Measures a contact of the island that the percussions were looked at for; its velocities are found on the way.
#[inline(always)]
pub(crate) fn measure_coupled(
    problem: &ContactProblem,
    contact: usize,
    percussions: Percussions<'_>,
    velocity: &mut [f64],
) -> OwnMeasure {
    by_rows!(problem, contact, coupled, percussions, velocity)
}

/// Velocities and size only.
#[inline(always)]
pub(crate) fn size_coupled(
    problem: &ContactProblem,
    contact: usize,
    percussions: Percussions<'_>,
    velocity: &mut [f64],
) -> Size {
    by_rows!(problem, contact, sized, percussions, velocity)
}

#[inline(always)]
fn alone<const N: usize, const P: usize>(
    own: Own<'_, P>,
    percussion: &[f64],
    velocity: &mut [f64],
) -> OwnMeasure {
    let Own { problem, contact, .. } = own;
    let block = problem.delassus().blocks().only_block::<N>(contact);
    let percussion = first::<N>(percussion);
    let free = first::<N>(&problem.free_velocity()[problem.contacts()[contact].offset..]);
    // With one contact nothing is brought by others, see `scale` of the natural residual. Terms are added in the order of
    // `ContactProblem::velocity`, so that velocities do not tell, to the bit, which way they were found.
    let only = problem.contacts().len() == 1;
    let (block, p) = (SMatrix::from_row_slice(block), SVector::from(*percussion));
    let sums = block * p + SVector::from(*free);
    let brought = if only { SVector::zeros() } else { block.abs() * p.abs() };
    velocity[..N].copy_from_slice(sums.as_slice());
    let velocity = &sums.into();
    let (size, squares) = size(&own, percussion, velocity);
    let scale = scale(&own, squares, &brought.into());
    let defect = relative(defect(&own, percussion, velocity), || scale);
    OwnMeasure { defect, size, brought: None }
}

#[inline(always)]
fn coupled<const N: usize, const P: usize>(
    own: Own<'_, P>,
    percussions: Percussions<'_>,
    velocity: &mut [f64],
) -> OwnMeasure {
    let (mut sums, mut brought) = ([0.0; 4], [0.0; 4]);
    if !percussions.vanish {
        let blocks = own.problem.delassus().blocks();
        blocks.add_row_and_magnitudes(own.contact, percussions.values, &mut sums, &mut brought);
    }
    let (own_percussion, velocity) = velocities::<N, P>(&own, percussions, &sums, velocity);
    let (size, squares) = size(&own, own_percussion, &velocity);
    let defect = defect(&own, own_percussion, &velocity);
    let defect = relative(defect, || scale(&own, squares, first::<N>(&brought)));
    OwnMeasure { defect, size, brought: Some(brought[0]) }
}

#[inline(always)]
fn sized<const N: usize, const P: usize>(
    own: Own<'_, P>,
    percussions: Percussions<'_>,
    velocity: &mut [f64],
) -> Size {
    let mut sums = [0.0; 4];
    if !percussions.vanish {
        let blocks = own.problem.delassus().blocks();
        blocks.add_row(own.contact, percussions.values, true, &mut sums);
    }
    let (percussion, velocity) = velocities::<N, P>(&own, percussions, &sums, velocity);
    size(&own, percussion, &velocity).0
}

/// The percussions of a contact that others may influence, and its velocities `γ_E`, of which the `sums` are brought about by
/// percussions and which are handed over, too.
#[inline(always)]
fn velocities<'a, const N: usize, const P: usize>(
    own: &Own<'_, P>,
    percussions: Percussions<'a>,
    sums: &[f64; 4],
    velocity: &mut [f64],
) -> (&'a [f64; N], [f64; N]) {
    let Own { problem, contact, .. } = *own;
    let rows = problem.contacts()[contact].rows();
    let free = first::<N>(&problem.free_velocity()[rows.start..]);
    let sums = std::array::from_fn(|a| free[a] + sums[a]);
    velocity[rows.clone()].copy_from_slice(&sums);
    (first::<N>(&percussions.values[rows.start..]), sums)
}

/// How large the percussions of a contact are, and the sum of their squares.
#[inline(always)]
fn size<const N: usize, const P: usize>(
    own: &Own<'_, P>,
    percussion: &[f64; N],
    velocity: &[f64; N],
) -> (Size, f64) {
    let Own { problem, contact, .. } = *own;
    let offset = problem.contacts()[contact].offset;
    let free = first::<N>(&problem.free_velocity()[offset..]);
    let restitution = first::<N>(&problem.restitution()[offset..]);
    let (mut squares, mut loads) = (0.0, 0.0);
    for a in 0..N {
        squares += percussion[a] * percussion[a];
        let load = free[a] + restitution[a];
        loads += load * load;
    }
    let normal = (N - P == 1).then_some((velocity[0] + restitution[0], free[0] + restitution[0]));
    (Size::of(percussion, normal, (squares, loads), problem.rho(contact)), squares)
}

/// Square of the defect of a contact with `N` rows, from its percussions and its velocities `γ_E`.
#[inline(always)]
fn defect<const N: usize, const P: usize>(
    own: &Own<'_, P>,
    percussion: &[f64; N],
    velocity: &[f64; N],
) -> f64 {
    let Own { problem, contact, law } = *own;
    let rows = &problem.contacts()[contact];
    let rho = problem.rho(contact);
    let restitution = first::<N>(&problem.restitution()[rows.offset..]);
    let normal_rows = N - P;
    let friction = Friction {
        normal: rows.normal.prescribed().unwrap_or(percussion[0]),
        tangent: &percussion[normal_rows..],
        velocity: &velocity[normal_rows..],
        restitution: &restitution[normal_rows..],
    };
    let friction = law::inclusion_defect(law, friction, rho);
    if normal_rows == 0 {
        return friction;
    }
    friction + normal_defect(percussion[0], velocity[0] + restitution[0], rho).powi(2)
}

/// Square of what that is compared with, from the square of the percussions and `Σ_j |G_ij P_j|`.
#[inline(always)]
fn scale<const N: usize, const P: usize>(
    own: &Own<'_, P>,
    squares: f64,
    brought: &[f64; N],
) -> f64 {
    let Own { problem, contact, .. } = *own;
    let (rows, rho) = (&problem.contacts()[contact], problem.rho(contact));
    let free = first::<N>(&problem.free_velocity()[rows.offset..]);
    let restitution = first::<N>(&problem.restitution()[rows.offset..]);
    let mut all = 0.0;
    for a in 0..N {
        // In the order of `scale` of the natural residual: measures do not tell, to the bit, which way they were found.
        let sum = brought[a] + free[a].abs() + restitution[a].abs();
        all += sum * sum;
    }
    f64::max(squares, rho * rho * all)
}

/// The first numbers of a list that has them.
#[inline(always)]
fn first<const N: usize>(values: &[f64]) -> &[f64; N] {
    const { assert!(N <= 4) };
    values.first_chunk().unwrap_or(const { &[f64::NAN; N] })
}

#[cfg(test)]
mod tests;

//! Residual of one contact after another, in one pass with their solution.

use super::approach::may_be_flawed;
use super::natural_residual::OwnRows;
use crate::contact::{ContactProblem, NormalForce};
use crate::vectors::unrolled;

/// What is measured of one contact in its own rows.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OwnMeasure {
    /// Square of the relative defect.
    pub(crate) defect: f64,
    /// Whether it may move although its residual is small; of a contact that others influence it is not asked.
    pub(crate) may_be_flawed: bool,
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
    let rows = &problem.contacts()[contact];
    let (block, mut brought) = (problem.delassus().blocks().diagonal(contact), [0.0; 4]);
    let free = &problem.free_velocity()[rows.rows()];
    unrolled!(n = percussion.len() => {
        for (a, row) in block.chunks_exact(n).take(n).enumerate() {
            let mut sum = 0.0;
            for b in 0..n {
                sum += row[b] * percussion[b];
                brought[a] += (row[b] * percussion[b]).abs();
            }
            velocity[a] = free[a] + sum;
        }
    });
    if problem.contacts().len() == 1 {
        // Nothing is brought by others.
        brought = [0.0; 4];
    }
    let (percussion, velocity) = (&percussion[..rows.len()], &velocity[..rows.len()]);
    let own = OwnRows { problem, contact, percussion, velocity };
    let may_be_flawed = rows.normal == NormalForce::Unilateral && {
        let xi = velocity[0] + problem.restitution()[rows.offset];
        may_be_flawed(percussion[0], xi, &problem.load(contact), block[0])
    };
    OwnMeasure { defect: own.relative(&brought), may_be_flawed }
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

    /// Square of the relative defect of a contact of the island; its velocities are found on the way.
    #[inline(always)]
    pub(crate) fn measure(
        self,
        problem: &ContactProblem,
        contact: usize,
        velocity: &mut [f64],
    ) -> f64 {
        let (mut sums, mut brought) = ([0.0; 4], [0.0; 4]);
        if !self.vanish {
            let blocks = problem.delassus().blocks();
            blocks.add_row_and_magnitudes(contact, self.values, &mut sums, &mut brought);
        }
        if problem.contacts().len() == 1 {
            // Nothing is brought by others.
            brought = [0.0; 4];
        }
        put(problem, contact, &sums, velocity);
        let rows = problem.contacts()[contact].rows();
        let (percussion, velocity) = (&self.values[rows.clone()], &velocity[rows]);
        OwnRows { problem, contact, percussion, velocity }.relative(&brought)
    }

    /// Velocities only.
    #[inline(always)]
    pub(crate) fn move_one(self, problem: &ContactProblem, contact: usize, velocity: &mut [f64]) {
        let mut sums = [0.0; 4];
        if !self.vanish {
            problem.delassus().blocks().add_row(contact, self.values, true, &mut sums);
        }
        put(problem, contact, &sums, velocity);
    }
}

/// Writes the velocities `γ_E` of a contact, of which percussions bring the `sums`.
#[inline(always)]
fn put(problem: &ContactProblem, contact: usize, sums: &[f64; 4], velocity: &mut [f64]) {
    let rows = problem.contacts()[contact].rows();
    let free = &problem.free_velocity()[rows.clone()];
    velocity[rows].iter_mut().zip(free).zip(sums).for_each(|((v, b), sum)| *v = b + sum);
}

#[cfg(test)]
mod tests;

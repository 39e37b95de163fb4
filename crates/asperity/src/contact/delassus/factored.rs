//! Delassus operators that know where they come from.

use std::collections::BTreeSet;

use nalgebra::DMatrix;

use super::blocks::rows_of;
use super::{BlockMatrix, Csr, Selection};
use crate::argument::{ArgumentError, length, refuse};
use crate::contact::components::Components;

/// Velocities of the largest connected part of `M` that is factored densely.
const LARGEST_PART: usize = 512;

/// `G = Wᵀ M⁻¹ W` with its factors: solvers may eliminate in contact space or in body space.
#[derive(Debug, Clone, PartialEq)]
pub struct Factored {
    mass: Csr,
    directions: Csr,
    blocks: BlockMatrix,
}

impl Factored {
    /// From the symmetric positive definite `M` and the rows `Wᵀ` of contacts with `sizes` rows.
    ///
    /// `M` may couple few degrees of freedom only: each connected part of it is factored densely.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] if the shapes do not fit each other, if a contact has not 1 to 4 rows, or if `M` is not
    /// symmetric positive definite or couples too many degrees of freedom.
    pub fn new(mass: Csr, directions: Csr, sizes: &[usize]) -> Result<Self, ArgumentError> {
        // Zeros that are kept connect nothing.
        let (mass, directions) = (mass.without_zeros(), directions.without_zeros());
        let blocks = assemble(&mass, &directions, sizes)?;
        Self::with_blocks(mass, directions, blocks)
    }

    /// With `G = Wᵀ M⁻¹ W` known already, `M` symmetric positive definite. Neither is checked, and what solvers say of other
    /// numbers need not be true.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] if the shapes do not fit each other.
    pub fn with_blocks(
        mass: Csr,
        directions: Csr,
        blocks: BlockMatrix,
    ) -> Result<Self, ArgumentError> {
        check_shapes(&mass, &directions, blocks.rows())?;
        Ok(Self { mass, directions, blocks })
    }

    /// `M`.
    pub fn mass(&self) -> &Csr {
        &self.mass
    }

    /// `Wᵀ`, one row per row of the contact problem.
    pub fn directions(&self) -> &Csr {
        &self.directions
    }

    /// `G`.
    pub fn blocks(&self) -> &BlockMatrix {
        &self.blocks
    }

    /// The operator of some contacts.
    pub(super) fn part(&self, members: &Selection) -> Self {
        let Selection { contacts, rows, dofs } = members;
        Self {
            mass: self.mass.part(dofs, dofs),
            directions: self.directions.part(rows, dofs),
            blocks: self.blocks.part(contacts),
        }
    }

    /// Copies the entries to an operator that was made as a part of this one, of contacts that meet no others.
    pub(super) fn copy_part(&self, members: &Selection, part: &mut Self) {
        self.mass.copy_part(&members.dofs, &mut part.mass);
        self.directions.copy_part(&members.rows, &mut part.directions);
        self.blocks.copy_part(&members.contacts, &mut part.blocks);
    }

    /// The velocities that act on some rows or that `M` couples with them, ascending.
    pub(super) fn dofs_of(&self, rows: &[usize]) -> Vec<usize> {
        let touched = rows.iter().flat_map(|&row| self.directions.row(row).0);
        let mut dofs: BTreeSet<usize> = touched.copied().collect();
        let mut next: Vec<usize> = dofs.iter().copied().collect();
        while let Some(dof) = next.pop() {
            next.extend(self.mass.row(dof).0.iter().filter(|&&other| dofs.insert(other)));
        }
        dofs.into_iter().collect()
    }

    /// All parts, to be refilled: `M`, `Wᵀ` and `G`.
    pub(crate) fn parts_mut(&mut self) -> (&mut [f64], &mut [f64], &mut BlockMatrix) {
        (self.mass.values_mut(), self.directions.values_mut(), &mut self.blocks)
    }
}

fn check_shapes(mass: &Csr, directions: &Csr, rows: usize) -> Result<(), ArgumentError> {
    length("directions", rows, directions.rows())?;
    length("mass", mass.rows(), mass.columns())?;
    length("mass", directions.columns(), mass.rows())
}

/// `G = Wᵀ M⁻¹ W`: the rows of `Wᵀ` that meet a connected part of `M` couple through it.
fn assemble(mass: &Csr, directions: &Csr, sizes: &[usize]) -> Result<BlockMatrix, ArgumentError> {
    check_shapes(mass, directions, rows_of(sizes)?)?;
    let part_of = parts(mass);
    let count = part_of.iter().max().map_or(0, |last| last + 1);
    let mut members = vec![Vec::new(); count];
    let mut position = vec![0; mass.rows()];
    for (dof, &part) in part_of.iter().enumerate() {
        position[dof] = members[part].len();
        members[part].push(dof);
    }
    let mut row = 0;
    let parts_of: Vec<Vec<usize>> = sizes
        .iter()
        .map(|&size| {
            row += size;
            let dofs = (row - size..row).flat_map(|row| directions.row(row).0);
            distinct(dofs.map(|&dof| part_of[dof]).collect())
        })
        .collect();
    let mut contacts = vec![Vec::new(); count];
    for (i, parts) in parts_of.iter().enumerate() {
        parts.iter().for_each(|&part| contacts[part].push(i));
    }
    let all =
        |parts: &Vec<usize>| parts.iter().flat_map(|&part| &contacts[part]).copied().collect();
    let neighbours: Vec<Vec<usize>> = parts_of.iter().map(|parts| distinct(all(parts))).collect();
    let mut blocks = BlockMatrix::with_pattern(sizes, &neighbours);
    for (dofs, contacts) in members.iter().zip(&contacts) {
        let part = ConnectedPart { dofs, position: &position, contacts };
        add_part(mass, directions, part, &mut blocks)?;
    }
    Ok(blocks)
}

/// The numbers in ascending order, each once, in no more memory than that.
fn distinct(mut numbers: Vec<usize>) -> Vec<usize> {
    numbers.sort_unstable();
    numbers.dedup();
    numbers.shrink_to_fit();
    numbers
}

/// Velocities that `M` couples, and the contacts that act on them.
struct ConnectedPart<'a> {
    dofs: &'a [usize],
    /// Place of every velocity in its own part.
    position: &'a [usize],
    contacts: &'a [usize],
}

/// What the contacts at one connected part of `M` bring: `W_pᵀ M_p⁻¹ W_p`.
fn add_part(
    mass: &Csr,
    directions: &Csr,
    part: ConnectedPart<'_>,
    blocks: &mut BlockMatrix,
) -> Result<(), ArgumentError> {
    let ConnectedPart { dofs, position, contacts } = part;
    let n = dofs.len();
    if n > LARGEST_PART {
        let message = "must couple few velocities: a connected part of it is too large";
        return refuse("mass", message);
    }
    let mut own_mass = DMatrix::zeros(n, n);
    for (a, &dof) in dofs.iter().enumerate() {
        let (columns, values) = mass.row(dof);
        for (&column, value) in columns.iter().zip(values) {
            own_mass[(a, position[column])] = *value;
        }
    }
    let symmetric = (&own_mass - own_mass.transpose()).amax() <= 1e-10 * own_mass.amax();
    let factor = own_mass.cholesky().filter(|_| symmetric);
    let Some(factor) = factor else {
        return refuse("mass", "must be symmetric positive definite");
    };
    let rows = contacts.iter().flat_map(|&i| blocks.offsets()[i]..blocks.offsets()[i + 1]);
    let mut own = DMatrix::zeros(n, rows.clone().count());
    for (mut own, row) in own.column_iter_mut().zip(rows) {
        let (columns, values) = directions.row(row);
        for (&dof, value) in columns.iter().zip(values) {
            if dofs.get(position[dof]) == Some(&dof) {
                own[position[dof]] = *value;
            }
        }
    }
    let responses = factor.solve(&own);
    let (own, responses) = (own.as_slice(), responses.as_slice());
    let mut first = 0;
    for &i in contacts {
        let mut other = 0;
        let mut k = 0;
        for &j in contacts {
            while blocks.neighbours(i)[k] != j {
                k += 1;
            }
            let (rows, width) = (blocks.size(i), blocks.size(j));
            let (_, block) = blocks.block_mut(i, k);
            for a in 0..rows {
                for b in 0..width {
                    // Rows of a body are so short that a call per product would take most of the time.
                    let (along, response) =
                        (&own[n * (first + a)..], &responses[n * (other + b)..]);
                    let mut product = 0.0;
                    for d in 0..n {
                        product += along[d] * response[d];
                    }
                    block[a * width + b] += product;
                }
            }
            other += width;
        }
        first += blocks.size(i);
    }
    Ok(())
}

/// The connected part of `M` that every degree of freedom belongs to, numbered from zero.
fn parts(mass: &Csr) -> Vec<usize> {
    let mut parts = Components::default();
    parts.separate(mass.rows());
    for i in 0..mass.rows() {
        mass.row(i).0.iter().for_each(|&j| parts.join(i, j));
    }
    parts.numbers()
}

//! Delassus operators from arrays.

use asperity::contact::{BlockMatrix, Csr, Delassus, Factored};
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;

use crate::convert::{Numbers, Points, matrix, numbers};
use crate::errors::Failure;

/// Row starts, columns and values.
pub type Triple<'py> = (PyReadonlyArray1<'py, i64>, PyReadonlyArray1<'py, i64>, Numbers<'py>);

/// What Python hands over.
#[derive(FromPyObject)]
pub enum Operator<'py> {
    /// Every entry.
    Dense(Points<'py>),
    /// `G`, sparse.
    Sparse(Triple<'py>),
    /// `M`, `Wᵀ` and `G` if it is known.
    Factored((Triple<'py>, Triple<'py>, Option<Triple<'py>>)),
}

impl Operator<'_> {
    /// The operator for contacts with `sizes` rows.
    pub fn into_delassus(self, sizes: &[usize]) -> Result<Delassus, Failure> {
        let rows = sizes.iter().sum();
        Ok(match self {
            Self::Dense(entries) => {
                BlockMatrix::from_dense(&matrix(&entries, "delassus")?, sizes)?.into()
            }
            Self::Sparse(triple) => {
                let csr = sparse("delassus", (rows, rows), &triple)?;
                BlockMatrix::from_csr(&csr, sizes)?.into()
            }
            Self::Factored((mass, directions, delassus)) => {
                let n = mass.0.len()?.saturating_sub(1);
                let directions = sparse("directions", (rows, n), &directions)?;
                let mass = sparse("mass", (n, n), &mass)?;
                match delassus {
                    None => Factored::new(mass, directions, sizes)?.into(),
                    Some(triple) => {
                        let csr = sparse("delassus", (rows, rows), &triple)?;
                        let blocks = BlockMatrix::from_csr(&csr, sizes)?;
                        Factored::with_blocks(mass, directions, blocks)?.into()
                    }
                }
            }
        })
    }
}

/// The matrix of this shape.
pub fn sparse(
    argument: &'static str,
    (rows, columns): (usize, usize),
    (starts, indices, values): &Triple<'_>,
) -> Result<Csr, Failure> {
    let index = |array: &PyReadonlyArray1<'_, i64>| -> Vec<usize> {
        // Negative numbers become too large ones, which are refused.
        array.as_array().iter().map(|&k| k as usize).collect()
    };
    let values = numbers(values, argument)?.to_vec();
    let matrix = Csr::new(rows, columns, index(starts), index(indices), values);
    Ok(matrix.map_err(|error| error.named(argument))?)
}

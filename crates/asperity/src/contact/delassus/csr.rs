//! Sparse matrices, compressed by rows.

use crate::argument::{ArgumentError, finite, length, refuse};
use nalgebra::DMatrix;

/// The argument in errors, unless the caller gives it its own name.
const MATRIX: &str = "matrix";

/// A sparse matrix, compressed by rows, columns ascending within a row.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Csr {
    rows: usize,
    columns: usize,
    starts: Vec<usize>,
    indices: Vec<usize>,
    values: Vec<f64>,
}

impl Csr {
    /// The matrix with so many rows and columns whose row `i` has its entries at `starts[i]..starts[i + 1]`.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] of a `matrix`, which [`ArgumentError::named`] gives another name, if the lengths do not fit the
    /// shape or each other, if starts or columns do not ascend within it, or if an entry is not finite.
    pub fn new(
        rows: usize,
        columns: usize,
        starts: Vec<usize>,
        indices: Vec<usize>,
        values: Vec<f64>,
    ) -> Result<Self, ArgumentError> {
        length(MATRIX, rows.saturating_add(1), starts.len())?;
        length(MATRIX, indices.len(), values.len())?;
        if starts[0] != 0 || starts[rows] != indices.len() || starts.windows(2).any(|w| w[0] > w[1])
        {
            let message = "must have row starts that ascend from 0 to the number of entries";
            return refuse(MATRIX, message);
        }
        if indices.iter().any(|&j| j >= columns) {
            return refuse(MATRIX, "must have column indices within its shape");
        }
        let ascending = |w: &[usize]| indices[w[0]..w[1]].windows(2).all(|pair| pair[0] < pair[1]);
        if !starts.windows(2).all(ascending) {
            return refuse(MATRIX, "must have ascending columns without duplicates in every row");
        }
        finite(MATRIX, &values)?;
        Ok(Self { rows, columns, starts, indices, values })
    }

    /// The entries of a matrix that are not zero.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] of a `matrix` if an entry is not finite.
    pub fn from_dense(matrix: &DMatrix<f64>) -> Result<Self, ArgumentError> {
        let (mut starts, mut indices, mut values) = (vec![0], Vec::new(), Vec::new());
        for row in matrix.row_iter() {
            for (j, value) in row.iter().enumerate().filter(|(_, value)| **value != 0.0) {
                indices.push(j);
                values.push(*value);
            }
            starts.push(indices.len());
        }
        Self::new(matrix.nrows(), matrix.ncols(), starts, indices, values)
    }

    /// The same matrix without entries that are zero.
    pub(super) fn without_zeros(self) -> Self {
        if self.values.iter().all(|value| *value != 0.0) {
            return self;
        }
        self.select(0..self.rows, self.columns, |j, value| (value != 0.0).then_some(j))
    }

    /// Some rows of the matrix, without the columns that are not among `columns`, ascending.
    pub(super) fn part(&self, rows: &[usize], columns: &[usize]) -> Self {
        let place = |j: usize, _| columns.binary_search(&j).ok();
        self.select(rows.iter().copied(), columns.len(), place)
    }

    /// The entries of some rows that have a place among new columns.
    fn select(
        &self,
        rows: impl ExactSizeIterator<Item = usize>,
        columns: usize,
        place: impl Fn(usize, f64) -> Option<usize>,
    ) -> Self {
        let mut part = Self { rows: rows.len(), columns, starts: vec![0], ..Self::default() };
        for i in rows {
            let (indices, values) = self.row(i);
            for (&j, &value) in indices.iter().zip(values) {
                if let Some(place) = place(j, value) {
                    part.indices.push(place);
                    part.values.push(value);
                }
            }
            part.starts.push(part.indices.len());
        }
        part
    }

    /// Copies the entries of rows that have no others to a matrix that was made as their part.
    pub(super) fn copy_part(&self, rows: &[usize], part: &mut Self) {
        let mut at = 0;
        for &i in rows {
            let (_, values) = self.row(i);
            part.values[at..at + values.len()].copy_from_slice(values);
            at += values.len();
        }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Columns and values of a row.
    ///
    /// # Panics
    ///
    /// If there is no such row.
    pub fn row(&self, i: usize) -> (&[usize], &[f64]) {
        let own = self.starts[i]..self.starts[i + 1];
        (&self.indices[own.clone()], &self.values[own])
    }

    /// Start of every row among the entries, and the number of entries.
    pub fn starts(&self) -> &[usize] {
        &self.starts
    }

    /// Columns of all entries.
    pub fn indices(&self) -> &[usize] {
        &self.indices
    }

    /// All entries.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// All entries, to be changed.
    pub(crate) fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }
}

//! Delassus operators `G`: how percussions change velocities.

mod blocks;
mod csr;
mod factored;
mod spectrum;

use std::fmt::Debug;
use std::sync::Arc;

use crate::argument::{ArgumentError, length, refuse};
use nalgebra::DMatrix;

pub use blocks::BlockMatrix;
pub use csr::Csr;
pub use factored::Factored;

/// What an operator must be able to do; the prox iterations need no more.
pub trait DelassusOperator: Debug + Send + Sync {
    /// Number of rows.
    fn rows(&self) -> usize;

    /// `velocity ← G P`, both with one number per row.
    fn apply(&self, percussion: &[f64], velocity: &mut [f64]);
}

/// An operator that is known by its products.
#[derive(Debug, Clone)]
pub struct MatrixFree {
    operator: Arc<dyn DelassusOperator>,
    /// The diagonal blocks, from products with unit vectors.
    diagonal: BlockMatrix,
    /// Estimate of its norm.
    norm: f64,
}

impl MatrixFree {
    /// The operator for contacts with `sizes` rows.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] if a contact has not 1 to 4 rows, if the operator has not the rows of all contacts, or if its
    /// products are not finite.
    pub fn new(
        operator: Arc<dyn DelassusOperator>,
        sizes: &[usize],
    ) -> Result<Self, ArgumentError> {
        let rows = operator.rows();
        length("delassus", blocks::rows_of(sizes)?, rows)?;
        let diagonal = probe(operator.as_ref(), sizes, rows, |i| vec![i]);
        let mut out = Self { operator, diagonal, norm: 0.0 };
        let (low, high) = Delassus::MatrixFree(out.clone()).spectrum()?;
        out.norm = high.max(-low);
        Ok(out)
    }

    /// Estimate of the norm.
    pub(crate) fn norm(&self) -> f64 {
        self.norm
    }
}

impl From<MatrixFree> for Delassus {
    fn from(operator: MatrixFree) -> Self {
        Self::MatrixFree(operator)
    }
}

/// Some contacts, with their rows and with the velocities that act on them where these are known.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Selection {
    pub(super) contacts: Vec<usize>,
    pub(super) rows: Vec<usize>,
    pub(super) dofs: Vec<usize>,
}

/// A Delassus operator `G`, not necessarily symmetric.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum Delassus {
    /// The blocks of contacts that influence each other.
    Blocks(BlockMatrix),
    /// `Wᵀ M⁻¹ W` with its factors.
    Factored(Factored),
    /// Products only.
    MatrixFree(MatrixFree),
}

impl Delassus {
    /// The same operator with all its blocks, as most solvers need it.
    pub fn assembled(&self) -> Self {
        match self {
            Self::MatrixFree(MatrixFree { operator, diagonal, .. }) => {
                let sizes: Vec<usize> =
                    diagonal.offsets().windows(2).map(|w| w[1] - w[0]).collect();
                let all: Vec<usize> = (0..sizes.len()).collect();
                Self::Blocks(probe(operator.as_ref(), &sizes, operator.rows(), |_| all.clone()))
            }
            _ => self.clone(),
        }
    }

    /// Some contacts, ascending.
    pub(super) fn select(&self, contacts: &[usize]) -> Selection {
        let offsets = self.blocks().offsets();
        let rows: Vec<usize> = contacts.iter().flat_map(|&i| offsets[i]..offsets[i + 1]).collect();
        let dofs = match self {
            Self::Factored(factored) => factored.dofs_of(&rows),
            Self::Blocks(_) | Self::MatrixFree(_) => Vec::new(),
        };
        Selection { contacts: contacts.to_vec(), rows, dofs }
    }

    /// The operator of some contacts; of a matrix-free one its diagonal blocks.
    pub(super) fn part(&self, members: &Selection) -> Self {
        match self {
            Self::Factored(factored) => Self::Factored(factored.part(members)),
            Self::Blocks(_) | Self::MatrixFree(_) => {
                Self::Blocks(self.blocks().part(&members.contacts))
            }
        }
    }

    /// Copies the entries to an operator that was made as a part of this one, of contacts that meet no others.
    pub(super) fn copy_part(&self, members: &Selection, part: &mut Self) {
        match (self, part) {
            (Self::Factored(factored), Self::Factored(part)) => factored.copy_part(members, part),
            (_, Self::Blocks(part)) => self.blocks().copy_part(&members.contacts, part),
            _ => {}
        }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.blocks().rows()
    }

    /// The blocks that are kept: of a matrix-free operator those on the diagonal.
    #[inline]
    pub fn blocks(&self) -> &BlockMatrix {
        match self {
            Self::Blocks(blocks) => blocks,
            Self::MatrixFree(free) => &free.diagonal,
            Self::Factored(factored) => factored.blocks(),
        }
    }

    /// Whether only products are known.
    pub fn is_matrix_free(&self) -> bool {
        matches!(self, Self::MatrixFree(_))
    }

    /// `velocity ← G P`.
    #[inline]
    pub(crate) fn apply(&self, percussion: &[f64], velocity: &mut [f64]) {
        match self {
            Self::MatrixFree(free) => free.operator.apply(percussion, velocity),
            assembled => assembled.blocks().apply(percussion, velocity),
        }
    }

    /// Every entry, from products with unit vectors unless they are kept.
    pub fn to_dense(&self) -> DMatrix<f64> {
        let rows = self.rows();
        let mut dense = DMatrix::zeros(rows, rows);
        let mut unit = vec![0.0; rows];
        for j in 0..rows {
            unit[j] = 1.0;
            self.apply(&unit, dense.column_mut(j).as_mut_slice());
            unit[j] = 0.0;
        }
        dense
    }

    /// Entry in the diagonal block of contact `i`.
    #[inline]
    pub(crate) fn own(&self, i: usize, a: usize, b: usize) -> f64 {
        let blocks = self.blocks();
        blocks.diagonal(i)[a * blocks.size(i) + b]
    }
}

/// What a contact problem takes for its operator: a [`Delassus`], whatever becomes one, or a dense matrix.
pub trait IntoDelassus {
    /// The operator of contacts with `sizes` rows.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] if it has not the rows of these contacts.
    fn into_delassus(self, sizes: &[usize]) -> Result<Delassus, ArgumentError>;
}

impl IntoDelassus for DMatrix<f64> {
    fn into_delassus(self, sizes: &[usize]) -> Result<Delassus, ArgumentError> {
        BlockMatrix::from_dense(&self, sizes).map(Delassus::Blocks)
    }
}

impl<T: Into<Delassus>> IntoDelassus for T {
    fn into_delassus(self, sizes: &[usize]) -> Result<Delassus, ArgumentError> {
        let delassus = self.into();
        length("delassus", sizes.iter().sum(), delassus.rows())?;
        let blocks = delassus.blocks();
        if blocks.contacts() != sizes.len() || (0..sizes.len()).any(|i| blocks.size(i) != sizes[i])
        {
            let message = "must have one block row per contact, with the contact's rows";
            return refuse("delassus", message);
        }
        Ok(delassus)
    }
}

/// The blocks `columns(i)` of every contact, by products with unit vectors.
fn probe(
    operator: &dyn DelassusOperator,
    sizes: &[usize],
    rows: usize,
    columns: impl Fn(usize) -> Vec<usize>,
) -> BlockMatrix {
    let neighbours: Vec<Vec<usize>> = (0..sizes.len()).map(columns).collect();
    let mut blocks = BlockMatrix::with_pattern(sizes, &neighbours);
    let offsets = blocks.offsets().to_vec();
    let (mut unit, mut response) = (vec![0.0; rows], vec![0.0; rows]);
    for j in 0..sizes.len() {
        for b in 0..sizes[j].min(rows.saturating_sub(offsets[j])) {
            unit[offsets[j] + b] = 1.0;
            operator.apply(&unit, &mut response);
            unit[offsets[j] + b] = 0.0;
            for i in 0..sizes.len() {
                let Some(k) = blocks.neighbours(i).iter().position(|&c| c == j) else { continue };
                let (_, block) = blocks.block_mut(i, k);
                for a in 0..sizes[i] {
                    block[a * sizes[j] + b] = response[offsets[i] + a];
                }
            }
        }
    }
    blocks
}

impl PartialEq for Delassus {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Blocks(a), Self::Blocks(b)) => a == b,
            (Self::Factored(a), Self::Factored(b)) => a == b,
            (Self::MatrixFree(a), Self::MatrixFree(b)) => Arc::ptr_eq(&a.operator, &b.operator),
            _ => false,
        }
    }
}

impl From<BlockMatrix> for Delassus {
    fn from(blocks: BlockMatrix) -> Self {
        Self::Blocks(blocks)
    }
}

impl From<Factored> for Delassus {
    fn from(factored: Factored) -> Self {
        Self::Factored(factored)
    }
}

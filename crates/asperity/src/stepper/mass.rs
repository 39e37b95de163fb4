//! Factor of the mass matrix.

use nalgebra::{Cholesky, DMatrix, DVectorViewMut, Dyn};

/// The mass matrix ready to be solved with.
#[derive(Debug, Clone)]
pub(crate) enum MassFactor {
    /// Reciprocals of a diagonal.
    Diagonal(Vec<f64>),
    /// Cholesky factor.
    Dense(Cholesky<f64, Dyn>),
}

impl MassFactor {
    /// `None` unless the matrix is positive definite.
    pub(crate) fn new(mass: &DMatrix<f64>) -> Option<Self> {
        let n = mass.nrows();
        let diagonal = (0..n).all(|j| (0..n).all(|i| i == j || mass[(i, j)] == 0.0));
        if !diagonal {
            let symmetric = (mass - mass.transpose()).amax() <= 1e-12 * mass.amax();
            return mass.clone().cholesky().filter(|_| symmetric).map(Self::Dense);
        }
        let positive = mass.diagonal().iter().all(|&m| m > 0.0 && m.is_finite());
        positive.then(|| Self::Diagonal(mass.diagonal().iter().map(|m| 1.0 / m).collect()))
    }

    /// `values ← M⁻¹ values`.
    #[inline]
    pub(crate) fn solve(&self, values: &mut [f64]) {
        match self {
            Self::Diagonal(inverse) => {
                for (value, m) in values.iter_mut().zip(inverse) {
                    *value *= m;
                }
            }
            Self::Dense(cholesky) => {
                let len = values.len();
                cholesky.solve_mut(&mut DVectorViewMut::from_slice(values, len));
            }
        }
    }
}

//! Singular values of a small matrix that may have any rank.

use crate::law::{ContactMatrix, ContactVector};

/// `G = U Σ Vᵀ` by one-sided rotations, which keep the digits of small singular values
/// (\[DemmelVeselic1992\]).
pub(crate) struct Factors {
    /// `U Σ`.
    left: ContactMatrix,
    /// `V`.
    pub(crate) right: ContactMatrix,
    /// Singular values, the largest first.
    pub(crate) values: ContactVector,
}

impl Factors {
    /// The factors of the first `n` rows and columns; the others must vanish.
    pub(crate) fn new(matrix: &ContactMatrix, n: usize) -> Self {
        let (mut left, mut right) = (*matrix, ContactMatrix::identity());
        // Three or four sweeps are the rule.
        for _ in 0..40 {
            let mut rotated = false;
            for p in 0..n {
                for q in p + 1..n {
                    let (a, b) = (left.column(p).norm_squared(), left.column(q).norm_squared());
                    let across = left.column(p).dot(&left.column(q));
                    if !(across.abs() > f64::EPSILON * (a * b).sqrt()) {
                        continue;
                    }
                    rotated = true;
                    let zeta = (b - a) / (2.0 * across);
                    let tangent = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
                    let cosine = 1.0 / tangent.hypot(1.0);
                    for matrix in [&mut left, &mut right] {
                        let (first, second) =
                            (matrix.column(p).into_owned(), matrix.column(q).into_owned());
                        matrix.set_column(p, &((first - second * tangent) * cosine));
                        matrix.set_column(q, &((second + first * tangent) * cosine));
                    }
                }
            }
            if !rotated {
                break;
            }
        }
        for i in 0..n {
            let norm = |k: &usize| left.column(*k).norm();
            let largest = (i..n).max_by(|a, b| norm(a).total_cmp(&norm(b))).unwrap_or(i);
            left.swap_columns(i, largest);
            right.swap_columns(i, largest);
        }
        let values = ContactVector::from_fn(|i, _| if i < n { left.column(i).norm() } else { 0.0 });
        Self { left, right, values }
    }

    /// The shortest least-squares solution with the `rank` largest singular values, refined.
    pub(crate) fn solve(
        &self,
        matrix: &ContactMatrix,
        load: &ContactVector,
        rank: usize,
    ) -> ContactVector {
        let mut x = ContactVector::zeros();
        for _ in 0..3 {
            let rest = load - matrix * x;
            for k in 0..rank {
                if self.values[k] > 0.0 {
                    let part = self.left.column(k).dot(&rest) / self.values[k].powi(2);
                    x += self.right.column(k) * part;
                }
            }
        }
        x
    }
}

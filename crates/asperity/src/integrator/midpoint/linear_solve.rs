//! Linear systems that are known by products only.

use crate::linear::DenseLu;
use crate::vectors::{add, dot};

/// Systems up to this size are solved by elimination: the iteration takes some tens of products, each a pass over all of `G`.
const SMALL: usize = 24;
/// Iterations after which the best is taken: an inexact correction costs a further solve of the contact problem, no accuracy.
const MOST: usize = 50;
/// Part of the right-hand side that may be left over.
const LEFT_OVER: f64 = 1e-8;

/// A solver with its buffers: elimination of small systems, else stabilised bi-conjugate gradients (\[VanDerVorst1992\]).
#[derive(Debug, Default)]
pub(super) struct LinearSolver {
    small: DenseLu,
    residual: Vec<f64>,
    shadow: Vec<f64>,
    search: Vec<f64>,
    image: Vec<f64>,
    second: Vec<f64>,
}

impl LinearSolver {
    pub(super) fn resize(&mut self, n: usize) {
        let Self { residual, shadow, search, image, second, .. } = self;
        for list in [residual, shadow, search, image, second] {
            list.clear();
            list.resize(n, 0.0);
        }
    }

    /// `A x = b`; `product(x, y)` is `y ← A x`.
    pub(super) fn solve(
        &mut self,
        product: &mut impl FnMut(&[f64], &mut [f64]),
        b: &[f64],
        x: &mut [f64],
    ) {
        if b.len() > SMALL {
            return self.iterate(product, b, x);
        }
        let (n, matrix) = (b.len(), self.small.begin(b.len()));
        self.search.fill(0.0);
        for j in 0..n {
            self.search[j] = 1.0;
            product(&self.search, &mut self.image);
            self.search[j] = 0.0;
            for (i, entry) in self.image.iter().enumerate() {
                matrix[i * n + j] = *entry;
            }
        }
        x.copy_from_slice(b);
        if !(self.small.factor(0.0) && self.small.solve(x)) {
            // No correction: the next one begins elsewhere.
            x.fill(0.0);
        }
    }

    fn iterate(&mut self, product: &mut impl FnMut(&[f64], &mut [f64]), b: &[f64], x: &mut [f64]) {
        let Self { residual: r, shadow, search: p, image: v, second: t, .. } = self;
        x.fill(0.0);
        r.copy_from_slice(b);
        shadow.copy_from_slice(b);
        p.copy_from_slice(b);
        let goal = LEFT_OVER * LEFT_OVER * dot(b, b);
        let mut rho = dot(shadow, r);
        for _ in 0..MOST {
            if !(dot(r, r) > goal) || rho == 0.0 {
                break;
            }
            product(p, v);
            let alpha = rho / dot(shadow, v);
            if !alpha.is_finite() {
                break;
            }
            add(x, alpha, p);
            add(r, -alpha, v);
            if !(dot(r, r) > goal) {
                break;
            }
            product(r, t);
            let omega = dot(t, r) / dot(t, t);
            if !omega.is_finite() {
                break;
            }
            add(x, omega, r);
            add(r, -omega, t);
            let next = dot(shadow, r);
            let beta = next / rho * (alpha / omega);
            if !beta.is_finite() {
                break;
            }
            for ((p, r), v) in p.iter_mut().zip(&*r).zip(&*v) {
                *p = r + beta * (*p - omega * v);
            }
            rho = next;
        }
    }
}

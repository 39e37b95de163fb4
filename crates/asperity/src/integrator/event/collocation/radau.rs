//! Radau IIA with five stages, of order nine: its nodes and weights (\[HairerWanner1996\] IV.5).

use std::sync::OnceLock;

use nalgebra::SMatrix;

/// Number of stages.
pub(crate) const STAGES: usize = 5;

type Square = SMatrix<f64, STAGES, STAGES>;

/// The coefficients of the method.
#[derive(Debug)]
pub(crate) struct Tableau {
    /// Nodes, the last one is 1.
    pub(crate) c: [f64; STAGES],
    pub(crate) a: Square,
    pub(crate) a_squared: Square,
    /// The real eigenvalue of `A`.
    pub(crate) gamma: f64,
    /// The Lagrange polynomials of the nodes at the start.
    pub(crate) at_start: [f64; STAGES],
}

impl Tableau {
    /// The coefficients, computed once.
    pub(crate) fn radau() -> &'static Self {
        static RADAU: OnceLock<Tableau> = OnceLock::new();
        RADAU.get_or_init(Self::new)
    }

    fn new() -> Self {
        let c = nodes();
        // `A V = C` with the powers of the nodes and their integrals, refined once.
        let powers = Square::from_fn(|j, k| c[j].powi(k as i32));
        let integrals = Square::from_fn(|i, k| c[i].powi(k as i32 + 1) / (k as f64 + 1.0));
        let inverse = powers.try_inverse().unwrap_or_else(Square::zeros);
        let mut a = integrals * inverse;
        a += (integrals - a * powers) * inverse;
        let gamma = bisect(0.0, 1.0, |x| (a - Square::identity() * x).determinant());
        Self { c, a, a_squared: a * a, gamma, at_start: lagrange(&c, 0.0) }
    }
}

/// Zeros of `P₅ − P₄` on `[0, 1]`, Legendre's polynomials: the nodes of Radau's quadrature.
fn nodes() -> [f64; STAGES] {
    let difference = |x: f64| {
        let (mut last, mut next) = (1.0, x);
        for k in 1..STAGES {
            let k = k as f64;
            (last, next) = (next, ((2.0 * k + 1.0) * x * next - k * last) / (k + 1.0));
        }
        next - last
    };
    const CELLS: usize = 64;
    let at = |k: usize| -1.0 + 2.0 * k as f64 / CELLS as f64;
    let mut c = [1.0; STAGES];
    let changes =
        (0..CELLS - 1).filter(|&k| (difference(at(k)) > 0.0) != (difference(at(k + 1)) > 0.0));
    for (node, k) in c.iter_mut().zip(changes) {
        *node = 0.5 * (1.0 + bisect(at(k), at(k + 1), difference));
    }
    c
}

fn bisect(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    let rising = f(high) > 0.0;
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if (f(middle) > 0.0) == rising { high = middle } else { low = middle }
    }
    0.5 * (low + high)
}

/// The Lagrange polynomials of the nodes at `x`.
pub(crate) fn lagrange(c: &[f64; STAGES], x: f64) -> [f64; STAGES] {
    std::array::from_fn(|j| lagrange_at(c, j, x))
}

/// The polynomial that is one at the `j`-th node and zero at the others.
pub(crate) fn lagrange_at(nodes: &[f64], j: usize, x: f64) -> f64 {
    let others = (0..nodes.len()).filter(|&k| k != j);
    others.map(|k| (x - nodes[k]) / (nodes[j] - nodes[k])).product()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_and_weights_have_the_order_nine() {
        let table = Tableau::radau();
        assert_eq!(table.c[STAGES - 1], 1.0);
        for k in 0..9 {
            let sum: f64 = (0..STAGES).map(|j| table.a[(STAGES - 1, j)] * table.c[j].powi(k)).sum();
            assert!((sum - 1.0 / (f64::from(k) + 1.0)).abs() < 1e-14, "{k}: {sum}");
        }
        let sum: f64 = (0..STAGES).map(|j| table.a[(STAGES - 1, j)] * table.c[j].powi(9)).sum();
        assert!((sum - 0.1).abs() > 1e-6);
    }
}

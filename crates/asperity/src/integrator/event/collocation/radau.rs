//! Radau IIA with five stages, of order nine: its nodes and weights (\[HairerWanner1996\] IV.5).

use std::sync::OnceLock;

use nalgebra::SMatrix;

/// Number of stages.
pub(crate) const STAGES: usize = 5;

/// Zeros of `P₅ − P₄` on `[0, 1]`, Legendre's polynomials: the nodes of Radau's quadrature.
const NODES: [f64; STAGES] = [
    0.057_104_196_114_517_68,
    0.276_843_013_638_123_8,
    0.583_590_432_368_916_8,
    0.860_240_135_656_219_5,
    1.0,
];
/// The real eigenvalue of `A`.
const GAMMA: f64 = 1.0 / 6.286_704_751_729_277;

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
        let c = NODES;
        // `A V = C` with the powers of the nodes and their integrals, refined once.
        let powers = Square::from_fn(|j, k| c[j].powi(k as i32));
        let integrals = Square::from_fn(|i, k| c[i].powi(k as i32 + 1) / (k as f64 + 1.0));
        let inverse = powers.try_inverse().unwrap_or_else(Square::zeros);
        let mut a = integrals * inverse;
        a += (integrals - a * powers) * inverse;
        Self { c, a, a_squared: a * a, gamma: GAMMA, at_start: lagrange(&c, 0.0) }
    }
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
mod tests;

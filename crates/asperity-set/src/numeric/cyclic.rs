//! Cyclic tridiagonal linear systems.

/// A system whose row `k` holds the unknowns `k − 1`, `k` and `k + 1`, counted around a ring.
#[derive(Debug)]
pub struct Cyclic {
    lower: Vec<f64>,
    diagonal: Vec<f64>,
    upper: Vec<f64>,
    /// The right-hand sides.
    pub right: Vec<f64>,
}

impl Cyclic {
    /// Zeros in `n` rows, at least two.
    pub fn zeros(n: usize) -> Self {
        Self {
            lower: vec![0.0; n],
            diagonal: vec![0.0; n],
            upper: vec![0.0; n],
            right: vec![0.0; n],
        }
    }

    /// Adds to the entry in row `k` and a column next to it or on the diagonal.
    pub fn add(&mut self, k: usize, column: usize, value: f64) {
        let n = self.right.len();
        if column == k {
            self.diagonal[k] += value;
        } else if column == (k + 1) % n {
            self.upper[k] += value;
        } else {
            self.lower[k] += value;
        }
    }

    /// Gaussian elimination along the chain; the last unknown closes the ring.
    #[must_use]
    pub fn solve(&self) -> Vec<f64> {
        let last = self.right.len() - 1;
        // x_k = p_k + q_k x_last for k < last, from both right-hand sides at once.
        let mut forward = vec![(0.0, 0.0, 0.0); last];
        for k in 0..last {
            let (mut right, mut corner, mut pivot) =
                (self.right[k], if k == 0 { -self.lower[0] } else { 0.0 }, self.diagonal[k]);
            if k > 0 {
                let (ratio, p, q) = forward[k - 1];
                pivot -= self.lower[k] * ratio;
                right -= self.lower[k] * p;
                corner -= self.lower[k] * q;
            }
            let upper = if k + 1 == last { 0.0 } else { self.upper[k] };
            if k + 1 == last {
                corner -= self.upper[k];
            }
            forward[k] = (upper / pivot, right / pivot, corner / pivot);
        }
        let mut x = vec![(0.0, 0.0); last];
        for k in (0..last).rev() {
            let (ratio, p, q) = forward[k];
            let next = if k + 1 == last { (0.0, 0.0) } else { x[k + 1] };
            x[k] = (p - ratio * next.0, q - ratio * next.1);
        }
        let (first, before) = (x[0], x[last - 1]);
        let closing = (self.right[last] - self.upper[last] * first.0 - self.lower[last] * before.0)
            / (self.diagonal[last] + self.upper[last] * first.1 + self.lower[last] * before.1);
        let mut solution: Vec<f64> = x.iter().map(|(p, q)| p + q * closing).collect();
        solution.push(closing);
        solution
    }
}

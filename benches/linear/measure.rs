//! Seconds of factorisations, and what they leave over.

use std::hint::black_box;
use std::time::{Duration, Instant};

use crate::contact::BlockMatrix;

/// A factorisation of one matrix, made again and again.
pub trait Factorisation {
    /// Factors the matrix; false if that failed.
    fn factor(&mut self) -> bool;
    /// `x ← A⁻¹ x`.
    fn solve(&mut self, x: &mut [f64]);
}

/// The least seconds of each part, and the backward error of a solution; infinite where the factorisation has failed.
#[derive(Debug, Clone, Copy)]
pub struct Cost {
    pub analysis: f64,
    pub factor: f64,
    pub solve: f64,
    pub error: f64,
}

impl Cost {
    const NOTHING: Self =
        Self { analysis: f64::INFINITY, factor: f64::INFINITY, solve: f64::INFINITY, error: 0.0 };
}

/// Seconds of one call.
fn seconds<T>(call: impl FnOnce() -> T) -> (f64, T) {
    let start = Instant::now();
    let result = black_box(call());
    (start.elapsed().as_secs_f64(), result)
}

/// The least seconds of calls that are repeated for this long.
fn least(lowest: &mut f64, budget: Duration, mut call: impl FnMut()) {
    let start = Instant::now();
    loop {
        let (time, ()) = seconds(&mut call);
        *lowest = lowest.min(time);
        if start.elapsed() > budget {
            return;
        }
    }
}

/// Measures several ways to factor a matrix in turn, so that whatever else the machine does meets all of them.
pub fn compare<'a, const N: usize>(
    matrix: &BlockMatrix,
    ways: [&dyn Fn() -> Box<dyn Factorisation + 'a>; N],
) -> [Cost; N] {
    const ROUNDS: u32 = 4;
    let budget = Duration::from_millis(60) / ROUNDS;
    let right: Vec<f64> = (0..matrix.rows()).map(|i| (1.7 * i as f64).sin()).collect();
    let mut costs = [Cost::NOTHING; N];
    for _ in 0..ROUNDS {
        for (cost, way) in costs.iter_mut().zip(ways) {
            if cost.error.is_infinite() {
                continue;
            }
            least(&mut cost.analysis, budget, || drop(way()));
            let mut factorisation = way();
            let mut regular = factorisation.factor();
            least(&mut cost.factor, budget, || regular &= factorisation.factor());
            let mut x = right.clone();
            factorisation.solve(&mut x);
            cost.error = backward_error(matrix, &x, &right);
            least(&mut cost.solve, budget, || {
                x.copy_from_slice(&right);
                factorisation.solve(&mut x);
            });
            if !regular {
                // What has failed has taken no time that counts.
                (cost.factor, cost.solve) = (f64::INFINITY, f64::INFINITY);
                cost.error = f64::INFINITY;
            }
        }
    }
    costs
}

/// `max_i |A x − b|_i / (|A| |x| + |b|)_i`.
fn backward_error(matrix: &BlockMatrix, x: &[f64], b: &[f64]) -> f64 {
    let (mut left, mut sizes) = (b.to_vec(), b.iter().map(|b| b.abs()).collect::<Vec<_>>());
    let offsets = matrix.offsets();
    for i in 0..matrix.contacts() {
        for (j, block) in matrix.row(i) {
            let x = &x[offsets[j]..offsets[j + 1]];
            for (a, row) in block.chunks_exact(x.len()).enumerate() {
                for (value, x) in row.iter().zip(x) {
                    left[offsets[i] + a] -= value * x;
                    sizes[offsets[i] + a] += (value * x).abs();
                }
            }
        }
    }
    let relative =
        left.iter().zip(&sizes).map(|(left, size)| left.abs() / size.max(f64::MIN_POSITIVE));
    relative.fold(0.0, |worst, error| if error <= worst { worst } else { error })
}

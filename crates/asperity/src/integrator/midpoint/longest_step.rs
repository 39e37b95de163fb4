//! Steps that are too long for a linear system.
//!
//! Forces act explicitly. Where contacts hold what they can, with velocities `v = Δt u` from one midpoint to the next and
//! `M = 1` in the coordinates that are left, the scheme and the motion are
//!
//! ```text
//! v′ = v − Δt B v − Δt² K x,   x′ = x + v′;        Δt ẋ = v,   Δt v̇ = −Δt B v − Δt² K x.
//! ```
//!
//! A step is too long where the scheme amplifies more motions than the exact flow does. If `K` is symmetric and `B` is symmetric
//! and positive semidefinite, it amplifies those with `Δt² k + 2Δt b > 4`: `(λ − 1)² + Δt b (λ − 1) + Δt² k λ = 0` then has a
//! root below −1, and no other root leaves the unit circle.

use nalgebra::{Complex, ComplexField, DMatrix, SymmetricEigen};

use crate::argument::{ArgumentError, refuse};
use crate::system::LinearSystem;
use crate::system::linear::Matrices;

/// Difference from a symmetric matrix that is rounding, as a part of its largest entry, as for masses.
const ASYMMETRY: f64 = 1e-12;
/// Square of the sine of the angle up to which directions of contacts are parallel.
const PARALLEL: f64 = 1e-12;
/// Growth per radian of a motion which the step resolves that counts as the error of a method of first order: gyroscopic
/// forces, which act explicitly, too, would allow no step.
const SLOW: f64 = 1e-3;
/// Rounding of a double eigenvalue over `√ε` of the largest one, and of a fourfold one, as under follower forces, over `⁴√ε`.
const ROUNDING: f64 = 4.0;
/// Iterations per eigenvalue: the QR algorithm takes two or three of them.
const SWEEPS: usize = 50;
/// Relative error of the longest step.
const ACCURACY: f64 = 1e-4;

/// Refuses steps of a length in which the scheme amplifies motions of a linear system that the exact flow does not.
pub(super) fn check(system: &LinearSystem, dt: f64) -> Result<(), ArgumentError> {
    let Some(matrices) = system.internal_forces() else { return Ok(()) };
    if are_weak(&matrices, dt) {
        return Ok(());
    }
    let find = || {
        let motion = FreeMotion::new(matrices)?;
        (!motion.allows(dt)).then(|| motion.longest_step(dt))
    };
    let Some(longest) = system.longest_step(dt, find) else { return Ok(()) };
    let message = format!(
        "must be at most {longest:?} s, got {dt:?}: stiffness and damping act explicitly, and longer steps amplify motions \
         that are stable"
    );
    refuse("dt", message)
}

/// Whether norms alone prove that a step is short enough, as for most: eigenvalues would take longer than a short run.
fn are_weak(matrices: &Matrices<'_>, dt: f64) -> bool {
    let Matrices { mass, stiffness, damping, .. } = matrices;
    let n = mass.nrows();
    let weight: Vec<f64> = (0..n).map(|i| mass[(i, i)].sqrt().recip()).collect();
    let entry = |matrix: &DMatrix<f64>, i: usize, j: usize| matrix[(i, j)] * weight[i] * weight[j];
    let largest_sum = |of: &dyn Fn(usize, usize) -> f64| {
        (0..n).map(|i| (0..n).map(|j| of(i, j).abs()).sum()).fold(0.0_f64, f64::max)
    };
    let size = |matrix: &DMatrix<f64>| {
        let by_row = largest_sum(&|i, j| entry(matrix, i, j));
        let by_column = largest_sum(&|i, j| entry(matrix, j, i));
        (by_row * by_column).sqrt()
    };
    // No eigenvalue of M is less in units of its diagonal.
    let least = 2.0 - largest_sum(&|i, j| entry(mass, i, j));
    let bounded = dt * dt * size(stiffness) + 2.0 * dt * size(damping) <= 4.0 * least;
    // Without B all that grows in the scheme grows while Δt² |k| ≤ 4.
    let dissipates = |i: usize| {
        let others = (0..n).filter(|&j| j != i).map(|j| damping[(i, j)].abs()).sum::<f64>();
        damping[(i, i)] >= others
    };
    let plain = || asymmetry(stiffness) == 0.0 && asymmetry(damping) == 0.0;
    bounded && (damping.amax() == 0.0 || (plain() && (0..n).all(dissipates)))
}

fn asymmetry(matrix: &DMatrix<f64>) -> f64 {
    (matrix - matrix.transpose()).amax()
}

/// What contacts do not hold, in coordinates in which `M = 1`.
struct FreeMotion {
    /// `K`, `B`.
    stiffness: DMatrix<f64>,
    damping: DMatrix<f64>,
    /// Whether both are symmetric, and damping takes energy.
    dissipative: bool,
}

impl FreeMotion {
    /// Nothing if contacts may hold all of it.
    fn new(matrices: Matrices<'_>) -> Option<Self> {
        let Matrices { mass, stiffness, damping, held } = matrices;
        let lower = mass.clone().cholesky()?.unpack();
        let scaled = |matrix: &DMatrix<f64>| lower.solve_lower_triangular(matrix);
        let mut held = scaled(&held)?;
        for mut column in held.column_iter_mut() {
            column.try_normalize_mut(0.0);
        }
        let directions = SymmetricEigen::new(&held * held.transpose());
        let free: Vec<usize> =
            (0..mass.nrows()).filter(|&i| directions.eigenvalues[i] <= PARALLEL).collect();
        if free.is_empty() {
            return None;
        }
        let basis = directions.eigenvectors.select_columns(&free);
        let reduced = |matrix: &DMatrix<f64>| {
            let half = scaled(matrix)?.transpose();
            Some(basis.transpose() * scaled(&half)?.transpose() * &basis)
        };
        let (stiffness, damping) = (reduced(&stiffness)?, reduced(&damping)?);
        let symmetric = |matrix: &DMatrix<f64>| asymmetry(matrix) <= ASYMMETRY * matrix.amax();
        let least = || damping.symmetric_eigenvalues().min();
        let dissipative =
            symmetric(&stiffness) && symmetric(&damping) && least() >= -ASYMMETRY * damping.amax();
        Some(Self { stiffness, damping, dissipative })
    }

    /// Whether the scheme amplifies no more motions in steps of a length than the exact flow does; yes where numbers overflow.
    fn allows(&self, dt: f64) -> bool {
        let (stiffness, damping) = (&self.stiffness * (dt * dt), &self.damping * dt);
        if self.dissipative {
            let both = stiffness + damping * 2.0;
            let size = both.amax();
            // In units of its size nothing that is computed of it is beyond all numbers.
            return size <= 4.0 / both.nrows() as f64
                || size < f64::INFINITY
                    && (both / size).symmetric_eigenvalues().max() <= 4.0 / size;
        }
        let n = stiffness.nrows();
        let (zero, one) = (DMatrix::zeros(n, n), DMatrix::identity(n, n));
        let kept = &one - &damping;
        let Some(factors) = eigenvalues([[&(&one - &stiffness), &kept], [&-&stiffness, &kept]])
        else {
            return true;
        };
        let Some(rates) = eigenvalues([[&zero, &one], [&-&stiffness, &-&damping]]) else {
            return true;
        };
        let fastest = rates.iter().map(|rate| rate.modulus()).fold(1.0, f64::max);
        let rounding = ROUNDING * f64::EPSILON.sqrt() * fastest;
        let grows = |rate: &&Complex<f64>| rate.re > rounding;
        let multiple = ROUNDING * f64::EPSILON.sqrt().sqrt();
        let grows_in_steps = |factor: &&Complex<f64>| {
            let change = (*factor - 1.0).modulus();
            if change < multiple {
                return false;
            }
            let resolved = if factor.re > 0.0 { SLOW * change } else { 0.0 };
            factor.modulus().ln() > 2.0 * rounding + resolved
        };
        let (growing, in_steps) =
            (rates.iter().filter(grows), factors.iter().filter(grows_in_steps));
        // Motions that turn by more than a quarter in a step are also counted by themselves: slow motions that the scheme does
        // not amplify enough must not make up for them.
        let rapid = growing.clone().filter(|rate| rate.modulus() >= 1.0).count();
        let rapid_in_steps = in_steps.clone().filter(|factor| factor.re < 0.0).count();
        in_steps.count() <= growing.count() && rapid_in_steps <= rapid
    }

    /// The longest step that is allowed, where this one is not.
    fn longest_step(&self, dt: f64) -> f64 {
        let (mut allowed, mut refused) = (0.5 * dt, dt);
        while !self.allows(allowed) {
            (allowed, refused) = (0.5 * allowed, allowed);
        }
        while refused - allowed > ACCURACY * allowed {
            let middle = 0.5 * (allowed + refused);
            if self.allows(middle) {
                allowed = middle;
            } else {
                refused = middle;
            }
        }
        // With four digits, as a user would type it.
        let digits = 3 - allowed.log10().floor() as i32;
        let shown = format!("{}e{}", (allowed * 10f64.powi(digits)).floor(), -digits);
        shown.parse().unwrap_or(allowed)
    }
}

/// Eigenvalues of a matrix of four parts, unless it is beyond all numbers.
fn eigenvalues(parts: [[&DMatrix<f64>; 2]; 2]) -> Option<Vec<Complex<f64>>> {
    let n = parts[0][0].nrows();
    let whole = DMatrix::from_fn(2 * n, 2 * n, |i, j| parts[i / n][j / n][(i % n, j % n)]);
    if !whole.iter().all(|entry| entry.is_finite()) {
        return None;
    }
    let schur = whole.try_schur(f64::EPSILON, SWEEPS * 2 * n)?;
    Some(schur.complex_eigenvalues().iter().copied().collect())
}

//! Sweeps with Anderson's acceleration.
//!
//! A sweep is a map `x ↦ g(x)` of percussions with the solution as its fixed point. The next one starts from the
//! combination `Σ θ_j g(x_j)`, `Σ θ_j = 1`, of the last images whose defects `f_j = g(x_j) − x_j`, combined in the same
//! way, are the smallest (\[WalkerNi2011\]): where contacts keep their states the map is linear, and this is a Krylov
//! method that needs the root of the number of sweeps. Where a state changes it may lead astray: as soon as a defect is
//! larger than the one before, what is remembered is forgotten, and a plain sweep follows from the last image.
//!
//! Defects of plain sweeps grow, too, where percussions are near a fixed point of the map that is unstable with the present
//! states, or would be one were it not for the next change of a state. Sweeps leave it at a rate of 1.0002 per sweep in
//! columns of spheres with 1240 contacts, and an acceleration goes back to it. So where one reset follows soon upon
//! another, the last defect is followed beyond its image, each time twice as far.

use nalgebra::{SMatrix, SVector};

use super::progress::Progress;
use super::sweeps::TRIAL_SWEEPS;
use crate::solver::report::Method;
use crate::vectors::dot;

/// Differences that are remembered: with 3 and 10 the piles and columns of `auto.rs` take 0.98 and 1.11 times as long.
const DEPTH: usize = 5;
/// Part of the trace by which the normal equations are regularised; a hundredth and a hundred times of it change that by 1 %.
const REGULARIZED: f64 = 1e-10;
/// Resets that follow each other within so many sweeps tell that defects of plain sweeps grow; how many times the last defect
/// is followed then at most. With 2 and 6 of the one they take 1.02 and 0.96 times as long, with 10 and 1000 of the other 1.03
/// and 1.00 times, and 1.17 times where it is not followed: 1240 contacts 8915 sweeps in place of 2700.
const SOON: usize = 3;
const FARTHEST: f64 = 100.0;

/// Contacts from which on they are swept in the order of colours, which several threads may do. On one thread columns of ten
/// spheres with 1240, 1930, 3230 and 5710 contacts take 0.8, 0.7, 2.4 and 0.26 times as long as in the order of contacts:
/// numbers of sweeps are chaotic.
const COLOURED: usize = 1000;

/// Buffers.
#[derive(Debug, Clone, Default)]
pub(crate) struct Accelerated {
    /// Where the sweep began.
    from: Vec<f64>,
    image: Vec<f64>,
    defect: Vec<f64>,
    /// Differences of images and of defects that follow each other, in a ring.
    images: [Vec<f64>; DEPTH],
    defects: [Vec<f64>; DEPTH],
    /// Products of these differences of defects with each other.
    products: SMatrix<f64, DEPTH, DEPTH>,
}

impl Accelerated {
    /// At most so many sweeps from the best percussions.
    pub(crate) fn iterate(&mut self, progress: &mut Progress<'_>, most: usize) {
        let rows = progress.task.problem.rows();
        let Self { from, image, defect, images, defects, products } = self;
        for list in [&mut *image, &mut *defect]
            .into_iter()
            .chain(images.iter_mut())
            .chain(defects.iter_mut())
        {
            list.clear();
            list.resize(rows, 0.0);
        }
        // Whoever shares the pool with other calls would wait for them in every sweep.
        let threads = progress.task.threads;
        let claim = threads.claim();
        // The order must not depend on the number of threads.
        let coloured = progress.task.problem.contacts().len() >= COLOURED;
        progress.start_from_best(from);
        progress.iterate.percussion.copy_from_slice(from);
        let (mut remembered, mut next, mut last) = (0, 0, f64::INFINITY);
        let (mut sweeps, mut reset_at, mut farther) = (0, None, 0.0);
        while sweeps < most && !progress.task.stop.early() {
            if coloured {
                progress.sweep_by_colours(claim.is_some());
            } else {
                progress.sweep();
            }
            sweeps += 1;
            let swept = &*progress.iterate.percussion;
            let size = swept.iter().zip(&*from).map(|(g, x)| (g - x) * (g - x)).sum::<f64>().sqrt();
            // The comparison also turns away what is not a number.
            if !(size <= last) {
                // From the last image again or beyond it, as if nothing had been before.
                let soon = reset_at.is_some_and(|before| sweeps - before <= SOON);
                farther = if soon { FARTHEST.min(2.0 * farther + 1.0) } else { 0.0 };
                (remembered, next, last, reset_at) = (0, 0, f64::INFINITY, Some(sweeps));
                for ((from, image), defect) in from.iter_mut().zip(&*image).zip(&*defect) {
                    *from = image + farther * defect;
                }
                progress.iterate.percussion.copy_from_slice(from);
                continue;
            }
            let (change, turn) = (&mut images[next], &mut defects[next]);
            for row in 0..rows {
                let now = swept[row] - from[row];
                change[row] = swept[row] - image[row];
                turn[row] = now - defect[row];
                (image[row], defect[row]) = (swept[row], now);
            }
            if last.is_finite() {
                for (other, turn) in defects.iter().enumerate().take(DEPTH.min(remembered + 1)) {
                    let product = dot(turn, &defects[next]);
                    (products[(next, other)], products[(other, next)]) = (product, product);
                }
                next = (next + 1) % DEPTH;
                remembered = (remembered + 1).min(DEPTH);
            }
            last = size;
            if sweeps.is_multiple_of(TRIAL_SWEEPS) {
                progress.grade(image);
                if progress.is_over() || progress.is_hopeless() {
                    break;
                }
            }
            let share = weights(&defects[..remembered], products, defect);
            from.copy_from_slice(image);
            for (images, share) in images.iter().zip(share.iter()) {
                for (from, image) in from.iter_mut().zip(images) {
                    *from -= share * image;
                }
            }
            progress.iterate.percussion.copy_from_slice(from);
        }
        progress.grade(image);
        progress.record(Method::GaussSeidel, sweeps, 0);
    }
}

/// Shares of the differences with which the defect is the smallest.
fn weights(
    defects: &[Vec<f64>],
    products: &SMatrix<f64, DEPTH, DEPTH>,
    defect: &[f64],
) -> SVector<f64, DEPTH> {
    let mut normal = SMatrix::<f64, DEPTH, DEPTH>::identity();
    let mut right = SVector::<f64, DEPTH>::zeros();
    let known = defects.len();
    normal.view_mut((0, 0), (known, known)).copy_from(&products.view((0, 0), (known, known)));
    let trace: f64 = (0..known).map(|i| normal[(i, i)]).sum();
    for (i, own) in defects.iter().enumerate() {
        right[i] = dot(own, defect);
        normal[(i, i)] += REGULARIZED * trace;
    }
    // Without an answer the plain image is the next start.
    normal.cholesky().map(|factored| factored.solve(&right)).unwrap_or_default()
}

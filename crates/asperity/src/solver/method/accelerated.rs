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

use super::cones::Cones;
use super::progress::Progress;
use super::sweeps::{BodySweeps, TRIAL_SWEEPS};
use crate::solver::report::Method;

// What follows, down to `FARTHEST`, was measured with sweeps over the blocks of `G`.

/// Differences that are remembered: with 3 and 10 the piles and columns of `auto.rs` take 0.98 and 1.11 times as long.
const DEPTH: usize = 5;
/// Part of the trace by which the normal equations are regularised; a hundredth and a hundred times of it change that by 1 %.
const REGULARIZED: f64 = 1e-10;
/// Resets that follow each other within so many sweeps tell that defects of plain sweeps grow; how many times the last defect
/// is followed then at most. With 2 and 6 of the one they take 1.02 and 0.96 times as long, with 10 and 1000 of the other 1.03
/// and 1.00 times, and 1.17 times where it is not followed: 1240 contacts 8915 sweeps in place of 2700.
const SOON: usize = 3;
const FARTHEST: f64 = 100.0;

/// Contacts from which on blocks of `G` are swept in the order of colours, which several threads may do. On one thread columns
/// of ten spheres with 1240, 1930, 3230 and 5710 contacts take 0.8, 0.7, 2.4 and 0.26 times as long as in the order of
/// contacts: numbers of sweeps are chaotic.
const COLOURED: usize = 1000;

/// The sweep that is accelerated.
enum Sweep<'a> {
    /// Over the blocks of `G`, from and to the percussions of the iterate; with several threads, if they are free.
    Blocks { free: bool },
    /// Over the velocities of bodies, in the coordinates of cones.
    Bodies(&'a mut BodySweeps, &'a Cones),
}

impl Sweep<'_> {
    /// Where it starts from, and its image after it.
    fn point<'a>(&'a mut self, progress: &'a mut Progress<'_>) -> &'a mut [f64] {
        match self {
            Sweep::Blocks { .. } => progress.iterate.percussion,
            Sweep::Bodies(bodies, _) => bodies.coordinates(),
        }
    }

    fn start(&mut self, progress: &mut Progress<'_>, percussion: &[f64]) {
        match self {
            Sweep::Blocks { .. } => progress.iterate.percussion.copy_from_slice(percussion),
            Sweep::Bodies(bodies, cones) => bodies.start(progress.task.problem, cones, percussion),
        }
    }

    fn run(&mut self, progress: &mut Progress<'_>) {
        match self {
            Sweep::Blocks { free } => {
                // The order must not depend on the number of threads.
                if progress.task.problem.contacts().len() >= COLOURED {
                    progress.sweep_by_colours(*free);
                } else {
                    progress.sweep();
                }
            }
            Sweep::Bodies(bodies, _) => bodies.sweep(),
        }
    }

    /// Measures the image; `percussion` is a buffer.
    fn grade(&mut self, progress: &mut Progress<'_>, image: &[f64], percussion: &mut [f64]) {
        if let Sweep::Bodies(bodies, cones) = self {
            bodies.coordinates().copy_from_slice(image);
            bodies.percussion(progress.task.problem, cones, percussion);
            progress.grade(percussion);
        } else {
            progress.grade(image);
        }
    }
}

/// Buffers.
#[derive(Debug, Clone, Default)]
pub(crate) struct Accelerated {
    percussion: Vec<f64>,
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
    /// From the best percussions, over the velocities of bodies if there are any, which have read the problem. At most so many
    /// sweeps, and so many since the natural map was halved.
    pub(crate) fn iterate(
        &mut self,
        progress: &mut Progress<'_>,
        bodies: Option<&mut BodySweeps>,
        cones: &Cones,
        most: usize,
        patience: usize,
    ) {
        let Self { percussion, from, image, defect, images, defects, products } = self;
        let threads = progress.task.threads;
        let claim;
        let mut sweep = if let Some(bodies) = bodies {
            Sweep::Bodies(bodies, cones)
        } else {
            // Whoever shares the pool with other calls would wait for them in every sweep.
            claim = threads.claim();
            Sweep::Blocks { free: claim.is_some() }
        };
        let (mut halved, mut halved_at) = (f64::INFINITY, 0);
        progress.start_from_best(percussion);
        sweep.start(progress, percussion);
        from.clear();
        from.extend_from_slice(sweep.point(progress));
        let rows = from.len();
        for list in [&mut *image, &mut *defect]
            .into_iter()
            .chain(images.iter_mut())
            .chain(defects.iter_mut())
        {
            list.clear();
            list.resize(rows, 0.0);
        }
        image.copy_from_slice(from);
        let (mut remembered, mut next, mut last) = (0, 0, f64::INFINITY);
        let (mut sweeps, mut look_at, mut reset_at, mut farther) = (0, TRIAL_SWEEPS, None, 0.0);
        while sweeps < most && !progress.task.stop.early() {
            sweep.run(progress);
            sweeps += 1;
            let swept = sweep.point(progress);
            let size = distance(swept, from);
            // The comparison also turns away what is not a number.
            if !(size <= last) {
                // From the last image again or beyond it, as if nothing had been before.
                let soon = reset_at.is_some_and(|before| sweeps - before <= SOON);
                farther = if soon { FARTHEST.min(2.0 * farther + 1.0) } else { 0.0 };
                (remembered, next, last, reset_at) = (0, 0, f64::INFINITY, Some(sweeps));
                for ((from, image), defect) in from.iter_mut().zip(&*image).zip(&*defect) {
                    *from = image + farther * defect;
                }
                swept.copy_from_slice(from);
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
            if sweeps >= look_at {
                look_at = sweeps + TRIAL_SWEEPS;
                sweep.grade(progress, image, percussion);
                if progress.best_grade() < 0.5 * halved {
                    (halved, halved_at) = (progress.best_grade(), sweeps);
                }
                let in_vain = sweeps - halved_at > patience;
                if in_vain || progress.is_over() || progress.is_hopeless() {
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
            sweep.point(progress).copy_from_slice(from);
        }
        sweep.grade(progress, image, percussion);
        if let Sweep::Bodies(..) = sweep {
            // Sweeps that follow begin here.
            progress.iterate.percussion.copy_from_slice(percussion);
        }
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

/// `aᵀb`.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    in_lanes(a, b, |x, y| x * y)
}

/// `‖a − b‖`.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    in_lanes(a, b, |x, y| (x - y) * (x - y)).sqrt()
}

/// Sum of terms in several partial sums: each in order, the sums of a sweep over bodies would take a third of its time.
fn in_lanes(a: &[f64], b: &[f64], term: impl Fn(f64, f64) -> f64) -> f64 {
    const LANES: usize = 8;
    let mut sums = [0.0; LANES];
    let (left, right) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest = left.remainder().iter().zip(right.remainder());
    let rest: f64 = rest.map(|(x, y)| term(*x, *y)).sum();
    for (x, y) in left.zip(right) {
        for (lane, sum) in sums.iter_mut().enumerate() {
            *sum += term(x[lane], y[lane]);
        }
    }
    sums.iter().sum::<f64>() + rest
}

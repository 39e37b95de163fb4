//! Sweeps with Anderson's acceleration.
//!
//! A sweep is a map `x ↦ g(x)` of percussions with the solution as its fixed point. The next one starts from the
//! combination `Σ θ_j g(x_j)`, `Σ θ_j = 1`, of the last images whose defects `f_j = g(x_j) − x_j`, combined in the same
//! way, are the smallest (\[WalkerNi2011\]): where contacts keep their states the map is linear, and this is a Krylov
//! method that needs the root of the number of sweeps. Where a state changes it may lead astray: as soon as a defect is
//! larger than the one before, the differences are forgotten, and a plain sweep follows from the last image.
//!
//! Defects say little of the natural map. Where that is more than twice its lowest value at the end of a block of sweeps, the
//! best percussions are taken back and plain sweeps follow, twice as many each time: as many sweeps without acceleration would
//! not have led much further.
//!
//! Defects of plain sweeps grow where percussions are near a fixed point that is unstable with the present states: sweeps leave
//! it slowly, and an acceleration goes back to it. There nothing is taken back, and where one defect that has grown follows soon
//! upon another, the last defect is followed beyond its image, each time twice as far.

use nalgebra::{SMatrix, SVector};

use crate::solver::gauss_seidel::TRIAL_SWEEPS;
use crate::solver::incumbent::Incumbent;
use crate::solver::report::Method;
use crate::vectors::sum_in_lanes;

/// Differences that are remembered.
const DEPTH: usize = 5;
/// Part of the trace by which the normal equations are regularised, far above their rounding.
const REGULARIZED: f64 = 1e-10;
/// How many times the lowest natural map is taken back.
const ASTRAY: f64 = 2.0;
/// Natural map below which percussions are near a fixed point.
const FIXED: f64 = 1e-4;
/// Defects that grow within so many sweeps follow each other soon; how far the last one is followed then at most.
const SOON: usize = 3;
const FARTHEST: f64 = 100.0;

/// Buffers.
#[derive(Debug, Clone, Default)]
pub(crate) struct Anderson {
    /// Where the sweep began.
    from: Vec<f64>,
    image: Vec<f64>,
    defect: Vec<f64>,
    /// `‖f‖` of the last sweep.
    last: f64,
    /// Differences of images and of defects that follow each other, in a ring.
    images: [Vec<f64>; DEPTH],
    defects: [Vec<f64>; DEPTH],
    /// Products of these differences of defects with each other.
    products: SMatrix<f64, DEPTH, DEPTH>,
    remembered: usize,
    next: usize,
}

impl Anderson {
    /// From the best percussions, at most so many sweeps since the natural map was halved; plain ones if not `accelerated`.
    pub(crate) fn iterate(
        &mut self,
        incumbent: &mut Incumbent<'_>,
        patience: usize,
        accelerated: bool,
    ) {
        let mut lowest = self.start(incumbent);
        let (mut halved, mut halved_at) = (lowest, 0);
        // Plain sweeps that are left, and those that follow the next time.
        let (mut plain, mut next_plain) = (if accelerated { 0 } else { usize::MAX }, TRIAL_SWEEPS);
        // Sweeps when a defect grew last, and how far that is followed.
        let (mut sweeps, mut grew_at, mut farther) = (0, None, 0.0);
        while !incumbent.task.stop.early() {
            incumbent.sweep();
            sweeps += 1;
            let accelerates = plain == 0;
            plain = plain.saturating_sub(1);
            let advanced = self.take_in(incumbent.iterate.percussion);
            if sweeps % TRIAL_SWEEPS == 0 {
                let grade = incumbent.grade(&self.image);
                if incumbent.best_grade() < 0.5 * halved {
                    (halved, halved_at) = (incumbent.best_grade(), sweeps);
                }
                if incumbent.is_over() || incumbent.is_hopeless() || sweeps - halved_at >= patience
                {
                    break;
                }
                if accelerates && lowest > FIXED && !(grade <= ASTRAY * lowest) {
                    self.start(incumbent);
                    (plain, next_plain) = (next_plain, 2 * next_plain);
                    continue;
                }
                lowest = lowest.min(grade);
            }
            if advanced && accelerates {
                self.extrapolate();
            } else {
                let soon = grew_at.is_some_and(|before: usize| sweeps - before <= SOON);
                farther = match (advanced, soon) {
                    (false, true) if lowest <= FIXED => FARTHEST.min(2.0 * farther + 1.0),
                    _ => 0.0,
                };
                grew_at = if advanced { grew_at } else { Some(sweeps) };
                let beyond = self.image.iter().zip(&self.defect);
                let start = self.from.iter_mut().zip(beyond);
                start.for_each(|(from, (image, defect))| *from = image + farther * defect);
            }
            incumbent.iterate.percussion.copy_from_slice(&self.from);
        }
        incumbent.grade(&self.image);
        let method = if accelerated { Method::AcceleratedGaussSeidel } else { Method::GaussSeidel };
        incumbent.record(method, sweeps, 0);
    }

    /// Starts from the best percussions; their natural map.
    fn start(&mut self, incumbent: &mut Incumbent<'_>) -> f64 {
        let grade = incumbent.start_from_best(&mut self.from);
        incumbent.iterate.percussion.copy_from_slice(&self.from);
        self.image.clone_from(&self.from);
        let rows = self.from.len();
        for list in self.images.iter_mut().chain(&mut self.defects).chain([&mut self.defect]) {
            list.clear();
            list.resize(rows, 0.0);
        }
        self.forget();
        grade
    }

    /// Forgets the differences.
    fn forget(&mut self) {
        (self.remembered, self.next, self.last) = (0, 0, f64::INFINITY);
    }

    /// Takes in the image of the last sweep; whether its defect is smaller than that of the one before, else the last image stays
    /// and the differences are forgotten.
    fn take_in(&mut self, swept: &[f64]) -> bool {
        let size = distance(swept, &self.from);
        // The comparison also turns away what is not a number.
        if !(size <= self.last) {
            self.forget();
            return false;
        }
        let Self { from, image, defect, images, defects, products, next, .. } = self;
        let (change, turn) = (&mut images[*next], &mut defects[*next]);
        for row in 0..swept.len() {
            let now = swept[row] - from[row];
            change[row] = swept[row] - image[row];
            turn[row] = now - defect[row];
            (image[row], defect[row]) = (swept[row], now);
        }
        if self.last.is_finite() {
            let turn = &defects[*next];
            for (other, own) in defects.iter().enumerate().take(DEPTH.min(self.remembered + 1)) {
                let product = dot(turn, own);
                (products[(*next, other)], products[(other, *next)]) = (product, product);
            }
            *next = (*next + 1) % DEPTH;
            self.remembered = (self.remembered + 1).min(DEPTH);
        }
        self.last = size;
        true
    }

    /// Combines the last images; the next sweep starts from there.
    fn extrapolate(&mut self) {
        let share = weights(&self.defects[..self.remembered], &self.products, &self.defect);
        self.from.copy_from_slice(&self.image);
        for (images, share) in self.images.iter().take(self.remembered).zip(share.iter()) {
            for (from, image) in self.from.iter_mut().zip(images) {
                *from -= share * image;
            }
        }
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
    sum_in_lanes(a, b, |x, y| x * y)
}

/// `‖a − b‖`.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    sum_in_lanes(a, b, |x, y| (x - y) * (x - y)).sqrt()
}

//! Alternating direction method of multipliers for laws with Lorentz cones (`cones.rs`).
//!
//! In `x = T P` and `ξ̂ = K ξ`: `x ← (Ĝ + βS)⁻¹(βS(y − w) − b̂ − s)`, `y ← proj_S(x + w)`, `w ← w + x − y` with De
//! Saxcé's shift `s_N = ‖ξ̂_T‖` (\[DeSaxceFeng1998\]) of the last iterate; prescribed normal percussions have no normal row, and `y` is
//! projected onto a ball. One factorisation serves until the penalty `β` changes: the method of choice where a factorisation is too
//! expensive to be repeated.
//!
//! Variants take turns ([`Variant`]). Plain iterations whose penalty keeps primal and dual residuals of one size end most problems.
//! Iterations that are extrapolated by Nesterov's rule with restarts (\[GoldsteinODonoghueSetzerBaraniuk2014\]), at the
//! penalty that the problem's own units give, end piles of spheres, where balance leads the penalty to where iterations
//! circle at 1e-4. The shift makes the problem one that is not monotone: either variant may circle, and which of them does
//! depends on where it begins.

use super::cones::{Cones, between_rows, own_rows, write_rows};
use crate::contact::ContactProblem;
use crate::law::{ContactMatrix, ContactVector};
use crate::solver::gauss_seidel::Task;
use crate::solver::incumbent::Incumbent;
use crate::solver::newton_matrix::NewtonMatrix;
use crate::solver::report::Method;

type V = ContactVector;

/// Iterations between two looks at the residuals.
const CHECK: usize = 10;
/// Iterations within which the lowest natural map must halve; slow tails need more, and `ADMM` ends with a variant that is not
/// judged.
const STALLED: usize = 200;
/// Part of the last change that a further step must stay below, else momentum is given up: the value of those who found
/// the rule.
const RESTART: f64 = 0.999;

/// Where iterations begin, and how they are scaled.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Variant {
    /// From no percussions instead of the best ones.
    afresh: bool,
    /// Extrapolated by Nesterov's rule.
    accelerated: bool,
    /// `S = diag(size^(−power), 1, 1, 1)` with the size of the reservoir of a contact: with 0 normal percussions count in the
    /// coordinates of the Lorentz cone, with 2 in newton seconds.
    power: f64,
    /// Ratio of the residuals beyond which the penalty changes, which takes a factorisation.
    unbalanced: f64,
}

/// The variant of most problems.
const BALANCED: Variant =
    Variant { afresh: false, accelerated: false, power: 0.0, unbalanced: 10.0 };
/// The variant of piles of spheres. From percussions that sweeps or the interior point method have left it circles, hence
/// afresh; with a power of 0 or a penalty that changes sooner it circles, too.
const AFRESH: Variant = Variant { afresh: true, accelerated: true, power: 1.0, unbalanced: 100.0 };
const ACCELERATED: Variant = Variant { afresh: false, ..AFRESH };

/// Variants of `ADMM`, in turn; the last one goes on to the limit of iterations.
pub(crate) const ALONE: &[Variant] = &[BALANCED, AFRESH, BALANCED];
/// Variants beside other methods: where the first does not end, the second improves their best percussions.
pub(crate) const BESIDE: &[Variant] = &[AFRESH, ACCELERATED];

/// Buffers.
#[derive(Debug, Clone, Default)]
pub(crate) struct Admm {
    points: Vec<Point>,
    a: Vec<ContactMatrix>,
    b: Vec<ContactMatrix>,
    step: Vec<f64>,
    percussion: Vec<f64>,
    velocity: Vec<f64>,
    penalty: f64,
    factorizations: usize,
    /// Nesterov's sequence, and the squared change of the last step.
    momentum: f64,
    change: f64,
}

/// State of one contact.
#[derive(Debug, Clone, Copy, Default)]
struct Point {
    /// Projected percussions and multipliers, in the coordinates of the cones: of this iterate, of the one before, and from
    /// where the next one starts.
    y: V,
    w: V,
    y_before: V,
    w_before: V,
    y_ahead: V,
    w_ahead: V,
    /// `S_NN`.
    weight: f64,
    /// `P̂_N` where it is prescribed; all vectors are zero there.
    given: Option<f64>,
}

/// Of one iteration: residuals relative to their sizes, and the squared change of its iterate.
struct Residuals {
    primal: f64,
    dual: f64,
    change: f64,
}

/// Why iterations on one variant ended.
enum End {
    /// The natural map fell no more.
    Stalled,
    /// There is nothing left to do, or nothing more can be done.
    Over,
}

impl Admm {
    /// Iterates on one variant after the other until the problem is solved or the last variant leads no further; `endless`: until the
    /// limit of iterations. Whether that limit ended it.
    pub(crate) fn iterate(
        &mut self,
        incumbent: &mut Incumbent<'_>,
        cones: &Cones,
        matrix: &mut NewtonMatrix,
        max_iterations: usize,
        (variants, endless): (&[Variant], bool),
    ) -> bool {
        let mut iterations = 0;
        self.factorizations = 0;
        for (turn, variant) in variants.iter().enumerate() {
            let patience = if endless && turn + 1 == variants.len() { usize::MAX } else { STALLED };
            let limits = (max_iterations, patience);
            let end = self.go(incumbent, cones, matrix, variant, &mut iterations, limits);
            if matches!(end, End::Over) {
                break;
            }
        }
        incumbent.record(Method::Admm, iterations, self.factorizations);
        iterations == max_iterations
    }

    /// Iterates on one variant, at most so many iterations in all, and so many without progress.
    fn go(
        &mut self,
        incumbent: &mut Incumbent<'_>,
        cones: &Cones,
        matrix: &mut NewtonMatrix,
        variant: &Variant,
        iterations: &mut usize,
        (max_iterations, patience): (usize, usize),
    ) -> End {
        let problem = incumbent.task.problem;
        incumbent.start_from_best(&mut self.percussion);
        if variant.afresh {
            self.percussion.fill(0.0);
        }
        self.start(problem, cones, variant);
        if !self.factor(&incumbent.task, cones, matrix) {
            return End::Over;
        }
        let (mut own, mut lowest, mut lowest_at) = (0, f64::INFINITY, 0);
        while *iterations < max_iterations && !incumbent.is_over() {
            (own, *iterations) = (own + 1, *iterations + 1);
            let residuals = self.update(problem, cones, matrix);
            self.look_ahead(variant, residuals.change);
            if own % CHECK != 0 && *iterations != max_iterations {
                continue;
            }
            self.restore(problem, cones);
            let grade = incumbent.grade(&self.percussion);
            if incumbent.is_hopeless() {
                return End::Over;
            }
            if grade < 0.5 * lowest {
                (lowest, lowest_at) = (grade, own);
            } else if own - lowest_at >= patience {
                return End::Stalled;
            }
            let ratio = residuals.primal / residuals.dual;
            let balanced = (1.0 / variant.unbalanced..=variant.unbalanced).contains(&ratio);
            // Ever more seldom: a change takes a factorisation.
            let due = (own / CHECK).is_power_of_two();
            if due && !balanced && !self.change_penalty(&incumbent.task, cones, matrix, ratio) {
                break;
            }
        }
        End::Over
    }

    fn start(&mut self, problem: &ContactProblem, cones: &Cones, variant: &Variant) {
        let unit = problem.global_rho();
        (self.penalty, self.momentum, self.change) = (1.0 / unit, 1.0, f64::INFINITY);
        self.velocity.resize(problem.rows(), 0.0);
        problem.velocity(&self.percussion, &mut self.velocity);
        self.step.resize(problem.rows(), 0.0);
        self.a.resize(problem.contacts().len(), ContactMatrix::zeros());
        self.b.resize(problem.contacts().len(), ContactMatrix::zeros());
        self.points.clear();
        for (i, rows) in problem.contacts().iter().enumerate() {
            let own = |values: &[f64]| own_rows(values, rows);
            let xi = own(&self.velocity) + own(problem.restitution());
            let weight = cones.t[i][(0, 0)].powf(-variant.power);
            let (mut v, given) = (cones.k[i] * xi, cones.given[i]);
            if given.is_none() {
                v[0] = (v[0].max(0.0) + v.rows(1, 3).norm()) / weight;
            }
            let (y, w) = (cones.t[i] * own(&self.percussion), -v * unit);
            let (y_before, w_before, y_ahead, w_ahead) = (y, w, y, w);
            self.points.push(Point { y, w, y_before, w_before, y_ahead, w_ahead, weight, given });
        }
    }

    fn factor(&mut self, task: &Task<'_>, cones: &Cones, matrix: &mut NewtonMatrix) -> bool {
        let Task { problem, stop, .. } = *task;
        self.factorizations += 1;
        for (i, rows) in problem.contacts().iter().enumerate() {
            let mut a = cones.t[i] * self.penalty;
            a.row_mut(0).scale_mut(self.points[i].weight);
            self.a[i] = between_rows(a, rows);
            self.b[i] = between_rows(cones.k[i], rows);
        }
        matrix.factor(problem, &self.a, &self.b, &|| stop.early())
    }

    /// The penalty for residuals of this ratio; false if there is no factorisation with it.
    fn change_penalty(
        &mut self,
        task: &Task<'_>,
        cones: &Cones,
        matrix: &mut NewtonMatrix,
        ratio: f64,
    ) -> bool {
        let factor = ratio.sqrt().clamp(0.1, 10.0);
        self.penalty *= factor;
        self.points.iter_mut().for_each(|point| point.w /= factor);
        (self.momentum, self.change) = (1.0, f64::INFINITY);
        self.extrapolate(0.0);
        self.factor(task, cones, matrix)
    }

    /// One iteration.
    fn update(
        &mut self,
        problem: &ContactProblem,
        cones: &Cones,
        matrix: &mut NewtonMatrix,
    ) -> Residuals {
        let penalty = self.penalty;
        for (i, rows) in problem.contacts().iter().enumerate() {
            let own = |values: &[f64]| own_rows(values, rows);
            let b = own(problem.free_velocity()) + own(problem.restitution());
            let Point { y_ahead, w_ahead, weight, .. } = self.points[i];
            let mut right = (y_ahead - w_ahead) * penalty;
            right[0] = weight * right[0] - penalty * w_ahead.rows(1, 3).norm();
            right -= cones.k[i] * b;
            write_rows(&right, rows, &mut self.step);
        }
        matrix.solve(problem, &mut self.step);
        let (mut primal, mut dual, mut size, mut change) = (0.0, 0.0, 0.0, 0.0);
        for (i, rows) in problem.contacts().iter().enumerate() {
            let x = cones.t[i] * own_rows(&self.step, rows);
            let point = &mut self.points[i];
            (point.y_before, point.w_before) = (point.y, point.w);
            let y = match point.given {
                Some(radius) => (x + point.w_ahead).cap_magnitude(radius),
                None => project(&(x + point.w_ahead), point.weight),
            };
            let (moved, gap) = (y - point.y_ahead, x - y);
            primal += gap.norm_squared();
            dual += moved.norm_squared();
            size += y.norm_squared();
            let square = |v: &V| point.weight * v[0] * v[0] + v.rows(1, 3).norm_squared();
            change += square(&moved) + square(&gap);
            (point.y, point.w) = (y, point.w_ahead + gap);
        }
        let loads = problem.load_norm().powi(2);
        let relative = |square: f64, of: f64| (square / of.max(f64::MIN_POSITIVE)).sqrt();
        Residuals {
            primal: relative(primal, size),
            dual: relative(dual * penalty * penalty, loads).max(f64::MIN_POSITIVE),
            change,
        }
    }

    /// From where the next iteration starts.
    fn look_ahead(&mut self, variant: &Variant, change: f64) {
        if variant.accelerated && change < RESTART * self.change {
            let next = 0.5 * (1.0 + (1.0 + 4.0 * self.momentum * self.momentum).sqrt());
            self.extrapolate((self.momentum - 1.0) / next);
            (self.momentum, self.change) = (next, change);
        } else {
            self.extrapolate(0.0);
            (self.momentum, self.change) = (1.0, self.change / RESTART);
        }
    }

    /// Goes beyond the last iterate by a part of the way from the one before.
    fn extrapolate(&mut self, part: f64) {
        for point in &mut self.points {
            point.y_ahead = point.y + (point.y - point.y_before) * part;
            point.w_ahead = point.w + (point.w - point.w_before) * part;
        }
    }

    /// The projected percussions in the coordinates of the problem.
    fn restore(&mut self, problem: &ContactProblem, cones: &Cones) {
        for (i, rows) in problem.contacts().iter().enumerate() {
            write_rows(&(cones.t_inverse[i] * self.points[i].y), rows, &mut self.percussion);
        }
    }
}

/// Projection onto the Lorentz cone by the norm in which the square of the normal part counts `weight` times.
fn project(v: &V, weight: f64) -> V {
    let t = v.rows(1, 3).norm();
    if t <= v[0] {
        return *v;
    }
    if t <= -weight * v[0] {
        return V::zeros();
    }
    let normal = (weight * v[0] + t) / (weight + 1.0);
    let mut out = v * (normal / t);
    out[0] = normal;
    out
}

//! Primal-dual interior point method for laws with Lorentz cones (`cones.rs`).
//!
//! Percussions `x = T P` and `z = Γ(K ξ)`, `Γ(v) = (v_N + ‖v_T‖, v_T)` (\[DeSaxceFeng1998\]), both in the
//! cone with `x ∘ z = μ e`, `μ → 0`: scaling of \[NesterovTodd1998\], predictor and corrector of
//! \[Mehrotra1992\], Newton on `Γ` with its full derivative. Where `P_N` is prescribed `x_N` never moves and `z_N` is whatever
//! complementarity asks for, ‖v_T‖ in the end: it is eliminated from each step. Variables are scaled: `P` by `ρ` times
//! the loads' mean size, `ξ` by that size.

use super::cones::{Cones, between_rows, own_rows, write_rows};
use crate::contact::ContactProblem;
use crate::law::{ContactMatrix, ContactVector};
use crate::solver::gauss_seidel::Task;
use crate::solver::incumbent::Incumbent;
use crate::solver::newton_matrix::NewtonMatrix;
use crate::solver::report::Method;

type V = ContactVector;

/// Start `x = z = START e`: near the boundary steps are short, far from it there are more of them.
const START: f64 = 10.0;
/// Part of the way to the boundary of the cone: longer steps reduce more and come nearer to where the next one is short.
const DAMPING: f64 = 0.995;
/// Part of the way below which a step is short: the next one is centred more, and, of bodies at rest, the step is refined, as
/// percussions of large vaults leave hardly a digit of its direction.
const SHORT: f64 = 0.1;

/// How far the method goes, and from where.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Course {
    pub(crate) max_iterations: usize,
    /// Natural map from which on the method ends after some iterations that bring no better percussions.
    pub(crate) goal: f64,
    /// Size of the percussions of a contact, if something is known of it, or zero: those of a vault of 10⁴ contacts are ten
    /// thousand times the loads, which takes 31 iterations from `START`, and 6 from this.
    pub(crate) expected: f64,
}

/// State and scaling of one contact.
#[derive(Debug, Clone, Copy, Default)]
struct Point {
    x: V,
    z: V,
    dx: V,
    dz: V,
    /// `Γ(Kξ) − z`.
    defect: V,
    /// `W z = W⁻¹ x` with the scaling `W`, its inverse and square.
    lambda: V,
    w: ContactMatrix,
    w_inverse: ContactMatrix,
    theta: ContactMatrix,
    /// First column of the square before `dz_N` of a prescribed `x_N` was eliminated.
    lead: V,
    /// `Γ'`.
    slope: ContactMatrix,
    /// Scale of the contact's equations.
    weight: f64,
    /// Whether `x_N` is prescribed, and `dx_N + (Θ dz)_N` that a step then brings about by `dz_N`.
    is_given: bool,
    goal: f64,
}

/// Buffers.
#[derive(Debug, Clone, Default)]
pub(crate) struct Interior {
    points: Vec<Point>,
    a: Vec<ContactMatrix>,
    b: Vec<ContactMatrix>,
    percussion: Vec<f64>,
    /// The same in the units of the problem.
    trial: Vec<f64>,
    velocity: Vec<f64>,
    step: Vec<f64>,
    /// What the step is to bring about, then what it leaves of that.
    left: Vec<f64>,
}

/// Sizes of percussions and velocities.
#[derive(Debug, Clone, Copy)]
struct Units {
    rho: f64,
    velocity: f64,
}

impl Units {
    fn of(problem: &ContactProblem) -> Self {
        let size = problem.load_norm() / (problem.contacts().len() as f64).sqrt();
        Self { rho: problem.global_rho(), velocity: if size > 0.0 { size } else { 1.0 } }
    }
}

impl Interior {
    /// Iterates until the problem is solved, digits end below the goal or the iterations are made; whether these ended it.
    pub(crate) fn iterate(
        &mut self,
        incumbent: &mut Incumbent<'_>,
        cones: &Cones,
        matrix: &mut NewtonMatrix,
        course: Course,
    ) -> bool {
        let problem = incumbent.task.problem;
        let units = Units::of(problem);
        let Course { max_iterations, goal, expected } = course;
        self.start(problem, cones, units, expected);
        let (mut iterations, mut lowest, mut lowest_at) = (0, f64::INFINITY, 0);
        while iterations < max_iterations && !incumbent.task.stop.early() {
            self.evaluate(problem, cones, units);
            self.restore(units);
            let grade = incumbent.grade(&self.trial);
            if grade < lowest {
                (lowest, lowest_at) = (grade, iterations);
            }
            let ends = lowest <= goal && iterations > lowest_at + 2;
            if incumbent.is_solved() || ends || !grade.is_finite() {
                break;
            }
            iterations += 1;
            if !self.advance(&incumbent.task, cones, matrix, units, expected > 0.0) {
                break;
            }
        }
        incumbent.record(Method::InteriorPoint, iterations, iterations);
        iterations == max_iterations
    }

    /// Percussions in the units of the problem.
    fn restore(&mut self, units: Units) {
        for (trial, p) in self.trial.iter_mut().zip(&self.percussion) {
            *trial = units.rho * units.velocity * p;
        }
    }

    fn start(&mut self, problem: &ContactProblem, cones: &Cones, units: Units, expected: f64) {
        let (rows, contacts) = (problem.rows(), problem.contacts().len());
        self.percussion.resize(rows, 0.0);
        self.trial.resize(rows, 0.0);
        self.velocity.resize(rows, 0.0);
        self.step.resize(rows, 0.0);
        self.a.resize(contacts, ContactMatrix::zeros());
        self.b.resize(contacts, ContactMatrix::zeros());
        let along = |size: f64| V::new(size, 0.0, 0.0, 0.0);
        let unit = units.rho * units.velocity;
        self.points.clear();
        self.points.extend(cones.given.iter().map(|given| match given {
            // Without a percussion it stays at rest in the origin.
            Some(0.0) => Point { is_given: true, ..Point::default() },
            Some(given) => {
                let x = given / unit;
                let (x, z) = (along(x), along(START * START / x));
                Point { x, z, is_given: true, ..Point::default() }
            }
            None => {
                let (x, z) = (along((expected / unit).max(START)), along(START));
                Point { x, z, ..Point::default() }
            }
        }));
    }

    /// `P = T⁻¹ x`, `ξ`, `Γ(Kξ)` and its defect.
    fn evaluate(&mut self, problem: &ContactProblem, cones: &Cones, units: Units) {
        for (i, rows) in problem.contacts().iter().enumerate() {
            write_rows(&(cones.t_inverse[i] * self.points[i].x), rows, &mut self.percussion);
        }
        problem.delassus().apply(&self.percussion, &mut self.velocity);
        for (row, xi) in self.velocity.iter_mut().enumerate() {
            let load = problem.free_velocity()[row] + problem.restitution()[row];
            *xi = units.rho * *xi + load / units.velocity;
        }
        for (i, rows) in problem.contacts().iter().enumerate() {
            let v = cones.k[i] * own_rows(&self.velocity, rows);
            let point = &mut self.points[i];
            let speed = tangent(&v).norm();
            point.slope = ContactMatrix::identity();
            if speed > 0.0 && !point.is_given {
                (1..4).for_each(|j| point.slope[(0, j)] = v[j] / speed);
            }
            point.defect = V::new(v[0] + speed, v[1], v[2], v[3]) - point.z;
            if point.is_given {
                point.defect[0] = 0.0;
            }
        }
    }

    /// One step, refined if it is short and `refined` asks for it; false if it failed.
    fn advance(
        &mut self,
        task: &Task<'_>,
        cones: &Cones,
        matrix: &mut NewtonMatrix,
        units: Units,
        refined: bool,
    ) -> bool {
        let Task { problem, stop, .. } = *task;
        let gap: f64 = self.points.iter().map(|p| p.x.dot(&p.z)).sum();
        let mean = gap / self.points.len() as f64;
        for (i, point) in self.points.iter_mut().enumerate() {
            point.rescale();
            let rows = &problem.contacts()[i];
            self.a[i] = between_rows(cones.t[i] * point.weight, rows);
            let b = point.theta * point.slope * cones.k[i] * (point.weight * units.rho);
            self.b[i] = between_rows(b, rows);
        }
        if !matrix.factor(problem, &self.a, &self.b, &|| stop.early()) {
            return false;
        }
        let mut solve = |interior: &mut Self, sigma_mean: f64, corrected: bool| {
            interior.right_hand_side(problem, sigma_mean, corrected);
            if refined {
                interior.left.clone_from(&interior.step);
            }
            matrix.solve(problem, &mut interior.step);
            interior.directions(problem, cones, units);
            let longest = interior.longest();
            if !(refined && longest < SHORT) {
                return longest;
            }
            interior.refine(problem, matrix);
            interior.directions(problem, cones, units);
            interior.longest()
        };
        let predicted = solve(self, 0.0, false).min(1.0);
        let ahead = |p: &Point| (p.x + p.dx * predicted).dot(&(p.z + p.dz * predicted));
        let affine: f64 = self.points.iter().map(ahead).sum();
        let mut sigma = (affine / gap).max(0.0).powi(3).clamp(1e-6, 1.0);
        if predicted < SHORT {
            sigma = sigma.max(0.5);
        }
        let mut length = (DAMPING * solve(self, sigma * mean, true)).min(1.0);
        if length < SHORT {
            length = (DAMPING * solve(self, sigma.max(0.8) * mean, false)).min(1.0);
        }
        for point in &mut self.points {
            point.x += point.dx * length;
            point.z += point.dz * length;
        }
        length > 0.0
    }

    fn right_hand_side(&mut self, problem: &ContactProblem, centre: f64, corrected: bool) {
        for (rows, point) in problem.contacts().iter().zip(&mut self.points) {
            if point.rests() {
                write_rows(&V::zeros(), rows, &mut self.step);
                continue;
            }
            let mut d = -product(&point.lambda, &point.lambda);
            d[0] += centre;
            if corrected {
                d -= product(&(point.w_inverse * point.dx), &(point.w * point.dz));
            }
            let mut h = point.w * quotient(&point.lambda, &d);
            if point.is_given {
                point.goal = h[0];
                h -= point.lead * (h[0] / point.lead[0]);
            }
            h -= point.theta * point.defect;
            write_rows(&(h * point.weight), rows, &mut self.step);
        }
    }

    /// Adds what the step has left over, with the same factors; the velocities are those that it brings.
    fn refine(&mut self, problem: &ContactProblem, matrix: &mut NewtonMatrix) {
        for (i, rows) in problem.contacts().iter().enumerate() {
            for (r, row) in rows.rows().enumerate() {
                for (c, column) in rows.rows().enumerate() {
                    self.left[row] -= self.a[i][(r, c)] * self.step[column]
                        + self.b[i][(r, c)] * self.velocity[column];
                }
            }
        }
        matrix.solve(problem, &mut self.left);
        self.step.iter_mut().zip(&self.left).for_each(|(step, more)| *step += more);
    }

    /// `dx = T dP`, `dz = Γ' K dξ + Γ(Kξ) − z`.
    fn directions(&mut self, problem: &ContactProblem, cones: &Cones, units: Units) {
        problem.delassus().apply(&self.step, &mut self.velocity);
        for (i, rows) in problem.contacts().iter().enumerate() {
            let point = &mut self.points[i];
            if point.rests() {
                continue;
            }
            point.dx = cones.t[i] * own_rows(&self.step, rows);
            let change = own_rows(&self.velocity, rows) * units.rho;
            point.dz = point.slope * (cones.k[i] * change) + point.defect;
            if point.is_given {
                let others = tangent(&point.lead).dot(&tangent(&point.dz));
                point.dz[0] = (point.goal - others) / point.lead[0];
            }
        }
    }

    /// Longest step for all `x` and `z` to stay in their cones.
    fn longest(&self) -> f64 {
        let of = |p: &Point| f64::min(to_boundary(&p.x, &p.dx), to_boundary(&p.z, &p.dz));
        self.points.iter().map(of).fold(f64::INFINITY, f64::min)
    }
}

impl Point {
    /// Whether nothing moves it from the origin: its percussions are prescribed to vanish.
    fn rests(&self) -> bool {
        self.is_given && self.x[0] == 0.0
    }

    /// Nesterov–Todd scaling `W x̂ = z`-wise: `W λ = x`, `W⁻¹ λ = z`.
    fn rescale(&mut self) {
        if self.rests() {
            self.weight = 1.0;
            return;
        }
        let size = |v: &V| (inner(v).max(1e-300)).sqrt();
        let (size_x, size_z) = (size(&self.x), size(&self.z));
        let (x, z) = (self.x / size_x, self.z / size_z);
        let gamma = (0.5 * (1.0 + x.dot(&z))).sqrt();
        let w = (x + reflect(&z)) / (2.0 * gamma);
        let eta = (size_x / size_z).sqrt();
        let bar = V::new(0.0, w[1], w[2], w[3]);
        let mut m = ContactMatrix::identity() + bar * bar.transpose() / (1.0 + w[0]);
        let mut inverse = m;
        (m[(0, 0)], inverse[(0, 0)]) = (w[0], w[0]);
        for j in 1..4 {
            (m[(0, j)], m[(j, 0)]) = (w[j], w[j]);
            (inverse[(0, j)], inverse[(j, 0)]) = (-w[j], -w[j]);
        }
        self.w = m * eta;
        self.w_inverse = inverse / eta;
        self.lambda = self.w * self.z;
        let j = ContactMatrix::from_diagonal(&V::new(-1.0, 1.0, 1.0, 1.0));
        self.theta = (w * w.transpose() * 2.0 + j) * (eta * eta);
        self.weight = 1.0 / (1.0 + eta * eta * 2.0 * w.norm_squared());
        if self.is_given {
            self.lead = self.theta.column(0).into();
            self.theta -= self.lead * self.lead.transpose() / self.lead[0];
        }
    }
}

fn tangent(v: &V) -> nalgebra::Vector3<f64> {
    nalgebra::Vector3::new(v[1], v[2], v[3])
}

/// `v_N² − ‖v_T‖²` without cancellation.
fn inner(v: &V) -> f64 {
    let t = tangent(v).norm();
    (v[0] - t) * (v[0] + t)
}

fn reflect(v: &V) -> V {
    V::new(v[0], -v[1], -v[2], -v[3])
}

/// Jordan product `a ∘ b`.
fn product(a: &V, b: &V) -> V {
    let mut out = b * a[0] + a * b[0];
    out[0] = a.dot(b);
    out
}

/// `s` with `l ∘ s = d`.
fn quotient(l: &V, d: &V) -> V {
    let dot = tangent(l).dot(&tangent(d));
    let s0 = (l[0] * d[0] - dot) / inner(l);
    let mut s = (d - l * s0) / l[0];
    s[0] = s0;
    s
}

/// Largest `a` with `p + a d` in the cone.
fn to_boundary(p: &V, d: &V) -> f64 {
    let a = d[0] * d[0] - tangent(d).norm_squared();
    let b = p[0] * d[0] - tangent(p).dot(&tangent(d));
    let c = inner(p).max(0.0);
    let root = (b * b - a * c).max(0.0).sqrt();
    let mut longest = f64::INFINITY;
    if a < 0.0 {
        longest = if b < 0.0 { c / (root - b) } else { (-b - root) / a };
    } else if b < 0.0 && b * b >= a * c {
        longest = c / (root - b);
    }
    if d[0] < 0.0 { longest.min(-p[0] / d[0]) } else { longest }
}

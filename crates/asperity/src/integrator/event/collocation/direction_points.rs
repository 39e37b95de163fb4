//! Newton's method with points of the direction sets as unknowns of their own.
//!
//! The sliding force is `λ = −λ_N z/k_C(z)` at the point `z` of *D* whose normal is γ. Where the boundary of *D* is
//! nearly flat, such as on the axes of superellipses with exponents above 2, `z` turns by a root of the angle of γ:
//! the force has an infinite slope there, slips along an axis are reached within a finite time, and Newton's method
//! for accelerations alone does not converge. With `z` and γ as unknowns the law is
//!
//! `z = prox_D(z + rγ)`, `r = ‖z‖/‖γ‖`,
//!
//! whose derivatives are bounded whatever the curvature: `prox_D` is a contraction.

use crate::contact::Phase;
use crate::integrator::event::collocation::lu;
use crate::integrator::event::collocation::step::{ITERATIONS, STAGES, Scale, Step, Tableau};
use crate::integrator::event::dynamics::contact_variables::{FieldError, ROWS, State};
use crate::integrator::event::dynamics::sliding_force;
use crate::integrator::event::dynamics::{Field, add};

/// Newton's method passes flat points by steps that do not shrink at first.
const MORE_ITERATIONS: usize = 3 * ITERATIONS;
/// Largest change of a point in one iteration, relative to its size.
const LONGEST: f64 = 0.5;
/// What is added to `1 − ∂prox_D` to see whether deviations grow: the contraction makes it positive, rounding where
/// the boundary is flat may not.
const FLAT: f64 = 1e-8;

/// The points of a step and what belongs to them.
#[derive(Debug, Clone, Default)]
pub(crate) struct Points {
    /// Whether the stages have been found with points as unknowns.
    pub(crate) used: bool,
    /// The contacts, in their order.
    contacts: Vec<usize>,
    /// The first unknown of each contact, and their number last.
    first: Vec<usize>,
    /// Points, stage after stage.
    z: Vec<f64>,
    /// Derivatives at the stages: accelerations by points, defects by points, by velocities and by coordinates.
    by_point: Vec<f64>,
    own: Vec<f64>,
    by_u: Vec<f64>,
    by_q: Vec<f64>,
    matrix: Vec<f64>,
    right: Vec<f64>,
}

impl Points {
    fn count(&self) -> usize {
        self.first.last().copied().unwrap_or(0)
    }

    /// All stages begin at the points that belong to these sliding forces.
    fn begin(&mut self, field: &Field<'_>, sliding: &[[f64; 3]]) {
        (self.used, self.first) = (false, vec![0]);
        self.contacts.clear();
        let mut start = Vec::new();
        for (i, touch) in field.touches.iter().enumerate() {
            if touch.mode == Phase::Slip && !sliding_force::is_smooth(field.law(i)) {
                self.contacts.push(i);
                start
                    .extend_from_slice(&sliding_force::point(field.law(i), &sliding[i])[..touch.p]);
                self.first.push(start.len());
            }
        }
        self.z = start.repeat(STAGES);
        let (n, m) = (field.n, self.count());
        self.by_point.resize(STAGES * n * m, 0.0);
        self.own.resize(STAGES * m * m, 0.0);
        self.by_u.resize(STAGES * m * n, 0.0);
        self.by_q.resize(STAGES * m * n, 0.0);
    }

    fn of(&self, stage: usize, k: usize) -> [f64; 3] {
        let at = stage * self.count();
        let own = &self.z[at + self.first[k]..at + self.first[k + 1]];
        std::array::from_fn(|r| own.get(r).copied().unwrap_or(0.0))
    }

    /// Lets the field take the forces of a stage from its points, until it is told not to.
    pub(crate) fn hold(&self, field: &mut Field<'_>, stage: usize) {
        field.held.clear();
        if self.used {
            self.give(field, stage);
        }
    }

    fn give(&self, field: &mut Field<'_>, stage: usize) {
        field.held.clear();
        let points = self.contacts.iter().enumerate().map(|(k, &i)| (i, self.of(stage, k)));
        field.held.extend(points);
    }
}

impl Step {
    /// Newton's method for accelerations, or for accelerations and points: the first that converges from the guess
    /// in `a`. `sliding` are the forces per unit normal force at the start, `points_first` says what the step
    /// before needed.
    pub(crate) fn solve_by_any(
        &mut self,
        field: &mut Field<'_>,
        start: &State,
        h: f64,
        goal: (f64, Scale),
        (sliding, points_first): (&[[f64; 3]], bool),
    ) -> Result<bool, FieldError> {
        let guess = self.a.clone();
        for with_points in [points_first, !points_first] {
            self.a.copy_from_slice(&guess);
            let found = if with_points {
                self.solve_with_points(field, start, h, goal, sliding)?
            } else {
                self.solve(field, start, h, goal)?
            };
            if found {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Newton's method for accelerations and points, as [`Step::solve`]; `sliding` are the forces per unit normal
    /// force at the start.
    pub(crate) fn solve_with_points(
        &mut self,
        field: &mut Field<'_>,
        start: &State,
        h: f64,
        (tolerance, scale): (f64, Scale),
        sliding: &[[f64; 3]],
    ) -> Result<bool, FieldError> {
        self.h = h;
        self.points.begin(field, sliding);
        if self.points.count() == 0 {
            return Ok(false);
        }
        let found = self.iterate_with_points(field, start, (tolerance, scale));
        field.held.clear();
        self.points.used = matches!(found, Ok(true));
        found
    }

    fn iterate_with_points(
        &mut self,
        field: &mut Field<'_>,
        start: &State,
        (tolerance, scale): (f64, Scale),
    ) -> Result<bool, FieldError> {
        let (n, m) = (field.n, self.points.count());
        let mut last = f64::INFINITY;
        for iteration in 0..MORE_ITERATIONS {
            self.stages(start);
            if !self.linearise_with_points(field, start)? {
                return Ok(false);
            }
            self.assemble_with_points(n, m);
            if !lu::solve(&mut self.points.matrix, &mut self.points.right) {
                return Ok(false);
            }
            let (mut largest, mut turn) = (0.0_f64, 0.0_f64);
            for (i, step) in self.points.right.chunks_exact(n + m).enumerate() {
                for (a, da) in self.a[i * n..(i + 1) * n].iter_mut().zip(&step[..n]) {
                    *a += da;
                    largest = largest.max(da.abs());
                }
                for ends in self.points.first.windows(2) {
                    let z = &mut self.points.z[i * m + ends[0]..i * m + ends[1]];
                    let dz = &step[n + ends[0]..n + ends[1]];
                    let size = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
                    let change = size(dz) / size(z);
                    add(z, (LONGEST / change).min(1.0), dz);
                    turn = turn.max(change);
                }
            }
            let norm = largest * self.h * (1.0 / scale.u).max(self.h / scale.q);
            if !(norm.is_finite() && turn.is_finite()) {
                return Ok(false);
            }
            let rate = if iteration == 0 { 1.0 } else { norm / last };
            let left = if rate < 1.0 { rate / (1.0 - rate) * norm } else { f64::INFINITY };
            let near = left < tolerance || norm < 1e-3 * tolerance || norm == 0.0;
            if near && turn < LONGEST {
                self.stages(start);
                return Ok(true);
            }
            last = norm;
        }
        Ok(false)
    }

    /// Residuals and derivatives at the stages; false where a slip vanishes.
    fn linearise_with_points(
        &mut self,
        field: &mut Field<'_>,
        start: &State,
    ) -> Result<bool, FieldError> {
        let (n, m) = (field.n, self.points.count());
        let mut right = std::mem::take(&mut self.points.right);
        right.resize(STAGES * (n + m), 0.0);
        let mut moves = true;
        for (i, c) in Tableau::radau().c.iter().enumerate() {
            let own = i * n..(i + 1) * n;
            self.points.give(field, i);
            let time = start.t + c * self.h;
            field.evaluate(time, &self.q[own.clone()], &self.u[own.clone()], false)?;
            let residual = &mut right[i * (n + m)..(i + 1) * (n + m)];
            for ((r, f), a) in residual.iter_mut().zip(&field.acceleration).zip(&self.a[own]) {
                *r = f - a;
            }
            let block = i * n * n..(i + 1) * n * n;
            field.jacobian(&mut self.ku[block.clone()], &mut self.kq[block]);
            moves &= self.points.linearise(field, i, &mut residual[n..]);
        }
        self.points.right = right;
        Ok(moves)
    }

    fn assemble_with_points(&mut self, n: usize, m: usize) {
        let (h, table, size) = (self.h, Tableau::radau(), n + m);
        let width = STAGES * size;
        let Points { matrix, by_point, own, by_u, by_q, .. } = &mut self.points;
        matrix.clear();
        matrix.resize(width * width, 0.0);
        for i in 0..STAGES {
            for j in 0..STAGES {
                let (first, second) = (h * table.a[(i, j)], h * h * table.a_squared[(i, j)]);
                for r in 0..size {
                    let row = &mut matrix[(i * size + r) * width + j * size..][..size];
                    let (a, z) = row.split_at_mut(n);
                    let (ku, kq) = if r < n {
                        let from = (i * n + r) * n;
                        (&self.ku[from..from + n], &self.kq[from..from + n])
                    } else {
                        let from = (i * m + r - n) * n;
                        (&by_u[from..from + n], &by_q[from..from + n])
                    };
                    add(a, -first, ku);
                    add(a, -second, kq);
                    if i == j && r < n {
                        a[r] += 1.0;
                        add(z, -1.0, &by_point[(i * n + r) * m..][..m]);
                    } else if i == j {
                        add(z, 1.0, &own[(i * m + r - n) * m..][..m]);
                    }
                }
            }
        }
    }

    /// `values ← (I − γhJ)⁻¹ values` with the Jacobian at the first stage, which the points make; false if it is
    /// singular.
    pub(crate) fn filter_with_points(&mut self, step: f64, values: &mut [f64]) -> bool {
        let (n, m) = (values.len(), self.points.count());
        let size = n + m;
        let Points { matrix, right, by_point, own, by_u, by_q, .. } = &mut self.points;
        matrix.clear();
        matrix.resize(size * size, 0.0);
        right.clear();
        right.extend_from_slice(values);
        right.resize(size, 0.0);
        for (r, row) in matrix.chunks_exact_mut(size).enumerate() {
            let (u, z) = row.split_at_mut(n);
            if r < n {
                add(u, -step, &self.ku[r * n..(r + 1) * n]);
                add(u, -step * step, &self.kq[r * n..(r + 1) * n]);
                u[r] += 1.0;
                add(z, -step, &by_point[r * m..(r + 1) * m]);
            } else {
                let from = (r - n) * n;
                add(u, -1.0, &by_u[from..from + n]);
                add(u, -step, &by_q[from..from + n]);
                add(z, 1.0, &own[(r - n) * m..(r - n + 1) * m]);
            }
        }
        let solved = lu::solve(matrix, right);
        values.copy_from_slice(&right[..n]);
        solved
    }
}

impl Step {
    /// The derivatives of the accelerations by the velocities at a stage, with points as they follow from slips;
    /// none where they do not.
    pub(crate) fn by_velocity(&self, stage: usize) -> Option<Vec<f64>> {
        let (n, m) = (self.n, self.points.count());
        let Points { by_point, own, by_u, .. } = &self.points;
        let block = stage * n * n..(stage + 1) * n * n;
        let mut total = self.ku[block].to_vec();
        for column in 0..n {
            let mut matrix = own[stage * m * m..(stage + 1) * m * m].to_vec();
            (0..m).for_each(|r| matrix[r * m + r] += FLAT);
            let mut turn: Vec<f64> = (0..m).map(|r| by_u[(stage * m + r) * n + column]).collect();
            if !lu::solve(&mut matrix, &mut turn) {
                return None;
            }
            for r in 0..n {
                let by_point = &by_point[(stage * n + r) * m..][..m];
                total[r * n + column] +=
                    by_point.iter().zip(&turn).map(|(a, z)| a * z).sum::<f64>();
            }
        }
        Some(total)
    }
}

impl Points {
    /// The defects of the points of a stage, at which the field has been evaluated, and their derivatives; false
    /// where a slip vanishes.
    fn linearise(&mut self, field: &mut Field<'_>, stage: usize, defects: &mut [f64]) -> bool {
        let (n, m) = (field.n, self.count());
        let (rows, square) = (stage * m * n, stage * m * m);
        self.own[square..square + m * m].fill(0.0);
        let mut column = vec![0.0; n];
        for k in 0..self.contacts.len() {
            let (i, z) = (self.contacts[k], self.of(stage, k));
            let (touch, first) = (field.touches[i], self.first[k]);
            let Some(at) = sliding_force::at_point(field.law(i), &z, &touch.slip) else {
                return false;
            };
            for r in 0..touch.p {
                defects[first + r] = at.defect[r];
                let target = rows + (first + r) * n;
                self.by_u[target..target + n].fill(0.0);
                self.by_q[target..target + n].fill(0.0);
                for s in 0..touch.p {
                    let row = (ROWS * i + 1 + s) * n;
                    let slope = at.slope[r][s];
                    let weight = at.r * slope;
                    add(&mut self.by_u[target..target + n], weight, &field.rows[row..row + n]);
                    if !field.constant {
                        let gradient = &field.slip_gradient[row..row + n];
                        add(&mut self.by_q[target..target + n], weight, gradient);
                    }
                    let unit = f64::from(u8::from(r == s));
                    self.own[square + (first + r) * m + first + s] = unit - slope;
                }
            }
            // What the accelerations answer to the force along each row.
            for c in 0..touch.p {
                for r in 0..n {
                    self.by_point[(stage * n + r) * m + first + c] = 0.0;
                }
            }
            for s in 0..touch.p {
                let row = (ROWS * i + 1 + s) * n;
                column.copy_from_slice(&field.response[row..row + n]);
                field.constrain(&mut column);
                for c in 0..touch.p {
                    let factor = touch.normal_force * at.by_point[s][c];
                    for (r, value) in column.iter().enumerate() {
                        self.by_point[(stage * n + r) * m + first + c] += factor * value;
                    }
                }
            }
        }
        true
    }
}

//! Newton's method for the stages of a step.

use crate::integrator::event::collocation::radau::{STAGES, Tableau};
use crate::integrator::event::collocation::step::Step;
use crate::integrator::event::dynamics::{Dynamics, SlidingForces};
use crate::integrator::event::resolution::ROUNDING;
use crate::integrator::event::state::{EvaluationError, Scale, State};
use crate::vectors::add;

/// Most iterations: a step that needs more converges faster at a shorter length.
const ITERATIONS: usize = 12;
/// Most iterations with points of *D* as unknowns, which pass flat places by steps that do not shrink at first.
const ITERATIONS_WITH_POINTS: usize = 3 * ITERATIONS;
/// Largest change of a point of *D* in one iteration, relative to its size.
const LONGEST: f64 = 0.5;

/// Part of the slowest slip that an error of a velocity may be: its direction is an angle of this size then.
const TURN: f64 = 1e-6;

/// The goal of Newton's method: the largest error that may be left, relative to the scale.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NewtonGoal {
    tolerance: f64,
    scale: Scale,
    /// Rounding of velocities, relative to the scale.
    rounding: f64,
}

impl NewtonGoal {
    /// A goal where the slowest slip has this size in velocities: where a slip comes to its end together with its
    /// acceleration, the accelerations follow from its direction, which small errors of velocities turn.
    pub(crate) fn new(tolerance: f64, scale: Scale, slip: f64) -> Self {
        let wanted = TURN * slip;
        if wanted >= tolerance * scale.u {
            return Self { tolerance, scale, rounding: 0.0 };
        }
        let rounding = ROUNDING * scale.u;
        let u = wanted.max(rounding) / tolerance;
        Self { tolerance, scale: Scale { u, ..scale }, rounding: rounding / u }
    }
}

/// What is known of the sliding forces before a step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SlidingStart<'s> {
    /// The forces for unit normal force at the start of the step.
    pub(crate) forces: &'s [[f64; 3]],
    /// Whether the step before was found with points of *D* as unknowns.
    pub(crate) with_points: bool,
}

impl Step {
    /// Finds the stages of a step of length `h` from the guess in `a`; whether Newton's method has converged. The
    /// dynamics hold the smooth part of the Jacobian.
    ///
    /// The unknowns are the accelerations, or accelerations and points of *D*
    /// ([`DirectionPoints`](super::direction_points::DirectionPoints)): what succeeded in the step before is tried
    /// first, then the other one.
    pub(crate) fn solve(
        &mut self,
        dynamics: &mut Dynamics<'_>,
        start: &State,
        h: f64,
        goal: NewtonGoal,
        sliding: SlidingStart<'_>,
    ) -> Result<bool, EvaluationError> {
        self.h = h;
        self.guess.clone_from(&self.a);
        for with_points in [sliding.with_points, !sliding.with_points] {
            self.a.copy_from_slice(&self.guess);
            self.points.begin(dynamics, if with_points { sliding.forces } else { &[] });
            if with_points && self.points.count() == 0 {
                continue;
            }
            let found = self.iterate(dynamics, start, goal);
            dynamics.direction_points.clear();
            self.points.used = with_points && matches!(found, Ok(true));
            if found? {
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn iterate(
        &mut self,
        dynamics: &mut Dynamics<'_>,
        start: &State,
        NewtonGoal { tolerance, scale, rounding }: NewtonGoal,
    ) -> Result<bool, EvaluationError> {
        let (n, m) = (self.n, self.points.count());
        let mut last = f64::INFINITY;
        for iteration in 0..if m == 0 { ITERATIONS } else { ITERATIONS_WITH_POINTS } {
            self.stages(start);
            if !self.linearise(dynamics, start)? {
                return Ok(false);
            }
            self.assemble();
            if !(self.matrix.factor(0.0) && self.matrix.solve(&mut self.residual)) {
                return Ok(false);
            }
            let (mut largest, mut turn) = (0.0_f64, 0.0_f64);
            for (i, change) in self.residual.chunks_exact(n + m).enumerate() {
                for (a, da) in self.a[i * n..(i + 1) * n].iter_mut().zip(change) {
                    *a += da;
                    largest = largest.max(da.abs());
                }
                turn = turn.max(self.points.turn(i, &change[n..], LONGEST));
            }
            // The larger of the changes as velocities and as coordinates.
            let norm = largest * self.h * (1.0 / scale.u).max(self.h / scale.q);
            if !(norm.is_finite() && turn.is_finite()) {
                return Ok(false);
            }
            let rate = if iteration == 0 { 1.0 } else { norm / last };
            let left = if rate < 1.0 { rate / (1.0 - rate) * norm } else { f64::INFINITY };
            let near = left < tolerance || norm < (1e-3 * tolerance).max(rounding) || norm == 0.0;
            if near && turn < LONGEST {
                self.stages(start);
                return Ok(true);
            }
            if m == 0 && iteration > 2 && rate > 2.0 {
                return Ok(false);
            }
            last = norm;
        }
        Ok(false)
    }

    /// Residuals and derivatives at the stages; false where a slip of a point vanishes, or an iterate has left the chart.
    fn linearise(
        &mut self,
        dynamics: &mut Dynamics<'_>,
        start: &State,
    ) -> Result<bool, EvaluationError> {
        let (n, m) = (self.n, self.points.count());
        self.residual.resize(STAGES * (n + m), 0.0);
        let mut slips = true;
        for (i, c) in Tableau::radau().c.iter().enumerate() {
            let (own, block) = (i * n..(i + 1) * n, i * n * n..(i + 1) * n * n);
            self.points.assign(dynamics, i);
            let (t, q, u) = (start.t + c * self.h, &self.q[own.clone()], &self.u[own.clone()]);
            if !dynamics.chart.reaches(q) {
                return Ok(false);
            }
            dynamics.evaluate(t, q, u, SlidingForces::Updated)?;
            let (defect, of_points) = self.residual[i * (n + m)..(i + 1) * (n + m)].split_at_mut(n);
            for ((r, f), a) in defect.iter_mut().zip(&dynamics.acceleration).zip(&self.a[own]) {
                *r = f - a;
            }
            dynamics.jacobian(&mut self.by_u[block.clone()], &mut self.by_q[block]);
            slips &= self.points.linearise(dynamics, i, of_points);
        }
        Ok(slips)
    }

    /// The matrix of Newton's method, stage after stage accelerations first, then points.
    fn assemble(&mut self) {
        let (n, m, h, table) = (self.n, self.points.count(), self.h, Tableau::radau());
        let size = n + m;
        let width = STAGES * size;
        let matrix = self.matrix.begin(width);
        for i in 0..STAGES {
            for j in 0..STAGES {
                let (first, second) = (h * table.a[(i, j)], h * h * table.a_squared[(i, j)]);
                for r in 0..n {
                    let row = &mut matrix[(i * size + r) * width + j * size..][..size];
                    let (a, z) = row.split_at_mut(n);
                    let from = (i * n + r) * n;
                    add(a, -first, &self.by_u[from..from + n]);
                    add(a, -second, &self.by_q[from..from + n]);
                    if i == j {
                        a[r] += 1.0;
                        add(z, -1.0, self.points.acceleration_by_points(i, r));
                    }
                }
                for r in 0..m {
                    let row = &mut matrix[(i * size + n + r) * width + j * size..][..size];
                    let (a, z) = row.split_at_mut(n);
                    add(a, -first, self.points.defect_by_u(i, r));
                    add(a, -second, self.points.defect_by_q(i, r));
                    if i == j {
                        add(z, 1.0, self.points.defect_by_points(i, r));
                    }
                }
            }
        }
    }
}

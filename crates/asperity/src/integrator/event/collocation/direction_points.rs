//! Points of the direction sets as unknowns of their own.
//!
//! The sliding force is `λ = −λ_N z/k_C(z)` at the point `z` of *D* whose normal is γ. Where the boundary of *D* is
//! nearly flat, such as on the axes of superellipses with exponents above 2, `z` turns by a root of the angle of γ: the
//! force has an infinite slope there, slips along an axis are reached within a finite time, and Newton's method for
//! accelerations alone does not converge. With `z` and γ as unknowns the law is
//!
//! `z = prox_D(z + rγ)`, `r = ‖z‖/‖γ‖`,
//!
//! whose derivatives are bounded whatever the curvature is, because `prox_D` is a contraction.

use crate::contact::Phase;
use crate::integrator::event::collocation::radau::STAGES;
use crate::integrator::event::dynamics::{Dynamics, ROWS};
use crate::vectors::{add, norm};

/// The points of a step and what belongs to them.
#[derive(Debug, Clone, Default)]
pub(crate) struct DirectionPoints {
    /// Whether the stages have been found with points as unknowns.
    pub(crate) used: bool,
    /// The contacts that have points, in their order.
    contacts: Vec<usize>,
    /// The first unknown of each contact, and their number last.
    first: Vec<usize>,
    /// Points, stage after stage.
    z: Vec<f64>,
    n: usize,
    /// Derivatives at the stages: accelerations by points, defects by points, by velocities and by coordinates.
    by_point: Vec<f64>,
    own: Vec<f64>,
    by_u: Vec<f64>,
    by_q: Vec<f64>,
    column: Vec<f64>,
}

impl DirectionPoints {
    /// Number of unknowns at a stage.
    pub(crate) fn count(&self) -> usize {
        self.first.last().copied().unwrap_or(0)
    }

    /// All stages begin at the points that belong to these sliding forces; there are no points without forces.
    pub(crate) fn begin(&mut self, dynamics: &Dynamics<'_>, sliding: &[[f64; 3]]) {
        self.used = false;
        self.n = dynamics.n;
        self.contacts.clear();
        self.first.clear();
        self.first.push(0);
        self.z.clear();
        for (i, (contact, force)) in dynamics.contacts.iter().zip(sliding).enumerate() {
            if contact.mode == Phase::Slip && !dynamics.law(i).is_smooth() {
                self.contacts.push(i);
                let point = dynamics.law(i).direction_point(force);
                self.z.extend_from_slice(&point[..contact.p]);
                self.first.push(self.z.len());
            }
        }
        let (n, m) = (self.n, self.count());
        for _ in 1..STAGES {
            self.z.extend_from_within(..m);
        }
        self.by_point.resize(STAGES * n * m, 0.0);
        self.own.resize(STAGES * m * m, 0.0);
        self.by_u.resize(STAGES * m * n, 0.0);
        self.by_q.resize(STAGES * m * n, 0.0);
    }

    /// The point of the `k`-th of the contacts.
    fn point(&self, stage: usize, k: usize) -> [f64; 3] {
        let at = stage * self.count();
        let own = &self.z[at + self.first[k]..at + self.first[k + 1]];
        std::array::from_fn(|r| own.get(r).copied().unwrap_or(0.0))
    }

    /// Lets the dynamics take the forces of a stage from its points, if it was found with points.
    pub(crate) fn apply(&self, dynamics: &mut Dynamics<'_>, stage: usize) {
        dynamics.direction_points.clear();
        if self.used {
            self.assign(dynamics, stage);
        }
    }

    /// Lets the dynamics take the forces of a stage from its points.
    pub(crate) fn assign(&self, dynamics: &mut Dynamics<'_>, stage: usize) {
        dynamics.direction_points.clear();
        let points = self.contacts.iter().enumerate().map(|(k, &i)| (i, self.point(stage, k)));
        dynamics.direction_points.extend(points);
    }

    /// Changes the points of a stage, each at most by the part `longest` of its size; the largest relative change asked for.
    pub(crate) fn turn(&mut self, stage: usize, changes: &[f64], longest: f64) -> f64 {
        let (m, mut turn) = (self.count(), 0.0_f64);
        for ends in self.first.windows(2) {
            let z = &mut self.z[stage * m + ends[0]..stage * m + ends[1]];
            let change = &changes[ends[0]..ends[1]];
            let relative = norm(change) / norm(z);
            add(z, (longest / relative).min(1.0), change);
            turn = turn.max(relative);
        }
        turn
    }

    /// What the `r`-th acceleration answers to the points of a stage.
    pub(crate) fn acceleration_by_points(&self, stage: usize, r: usize) -> &[f64] {
        &self.by_point[(stage * self.n + r) * self.count()..][..self.count()]
    }

    /// Derivatives of the `r`-th defect of a stage by its points.
    pub(crate) fn defect_by_points(&self, stage: usize, r: usize) -> &[f64] {
        &self.own[(stage * self.count() + r) * self.count()..][..self.count()]
    }

    /// Derivatives of the `r`-th defect of a stage by the velocities.
    pub(crate) fn defect_by_u(&self, stage: usize, r: usize) -> &[f64] {
        &self.by_u[(stage * self.count() + r) * self.n..][..self.n]
    }

    /// Derivatives of the `r`-th defect of a stage by the coordinates.
    pub(crate) fn defect_by_q(&self, stage: usize, r: usize) -> &[f64] {
        &self.by_q[(stage * self.count() + r) * self.n..][..self.n]
    }

    /// The defects of the points of an evaluated stage and their derivatives; false where a slip vanishes.
    pub(crate) fn linearise(
        &mut self,
        dynamics: &mut Dynamics<'_>,
        stage: usize,
        defects: &mut [f64],
    ) -> bool {
        let (n, m) = (self.n, self.count());
        let (rows, square) = (stage * m * n, stage * m * m);
        self.own[square..square + m * m].fill(0.0);
        for k in 0..self.contacts.len() {
            let (i, z) = (self.contacts[k], self.point(stage, k));
            let (contact, first) = (dynamics.contacts[i], self.first[k]);
            let Some(at) = dynamics.law(i).at_point(&z, &contact.slip) else {
                return false;
            };
            for r in 0..contact.p {
                defects[first + r] = at.defect[r];
                let target = rows + (first + r) * n;
                self.by_u[target..target + n].fill(0.0);
                self.by_q[target..target + n].fill(0.0);
                for s in 0..contact.p {
                    let row = ROWS * i + 1 + s;
                    let slope = at.slope[r][s];
                    let weight = at.r * slope;
                    add(&mut self.by_u[target..target + n], weight, dynamics.row(row));
                    if !dynamics.constant {
                        let gradient = &dynamics.smooth.slip_by_q[row * n..(row + 1) * n];
                        add(&mut self.by_q[target..target + n], weight, gradient);
                    }
                    let unit = f64::from(u8::from(r == s));
                    self.own[square + (first + r) * m + first + s] = unit - slope;
                }
            }
            // What the accelerations answer to the force along each row.
            for c in 0..contact.p {
                for r in 0..n {
                    self.by_point[(stage * n + r) * m + first + c] = 0.0;
                }
            }
            for s in 0..contact.p {
                dynamics.response(ROWS * i + 1 + s).clone_into(&mut self.column);
                dynamics.constrain(&mut self.column, None);
                for c in 0..contact.p {
                    let factor = contact.normal_force * at.by_point[s][c];
                    for (r, value) in self.column.iter().enumerate() {
                        self.by_point[(stage * n + r) * m + first + c] += factor * value;
                    }
                }
            }
        }
        true
    }
}

//! Forces that the constraints of sticking and of closed slipping contacts need.

use crate::contact::Phase;
use crate::integrator::event::dynamics::Dynamics;
use crate::integrator::event::dynamics::buffers::Constraints;
use crate::integrator::event::dynamics::contact_variables::{ContactVariables, ROWS};
use crate::integrator::event::dynamics::forces::sharing::Rate;
use crate::integrator::event::resolution::{PARTS, ROUNDING};
use crate::vectors::{add, dot, largest};

impl Dynamics<'_> {
    /// Adds what the constraint forces do to the accelerations, and keeps the forces at the contacts.
    pub(crate) fn add_constraint_forces(&mut self) {
        let n = self.n;
        let mut system = std::mem::take(&mut self.constraints);
        system.rows.clear();
        system.columns.clear();
        for i in 0..self.contacts.len() {
            let contact = self.contacts[i];
            match (contact.mode, contact.prescribed) {
                (Phase::Stick, _) => {
                    let rows = self.rows_of(i);
                    system.columns.extend_from_slice(&self.response[rows.start * n..rows.end * n]);
                    system.rows.extend(rows);
                }
                (Phase::Slip, None) => {
                    let normal = ROWS * i;
                    let first = system.columns.len();
                    system.rows.push(normal);
                    system.columns.extend_from_slice(self.response(normal));
                    let column = &mut system.columns[first..];
                    let frictionless = dot(self.row(normal), column);
                    for r in 0..contact.p {
                        add(column, contact.sliding[r], self.response(normal + 1 + r));
                    }
                    self.contacts[i].resistance = dot(self.row(normal), column) / frictionless;
                }
                _ => {}
            }
        }
        self.sharing.clear();
        if self.undecided_share {
            self.share_normal_forces();
        }
        if !system.rows.is_empty() {
            self.solve_constraints(&mut system);
        }
        self.constraints = system;
        self.assign_constraint_forces();
    }

    /// Finds which of the closed unilateral contacts share normal forces.
    fn share_normal_forces(&mut self) {
        let mut sharing = std::mem::take(&mut self.sharing);
        let pressing = |i: &usize| {
            let contact = &self.contacts[*i];
            let may_close =
                self.undecided_share && contact.undecided && contact.prescribed.is_none();
            contact.is_closed_unilateral() || may_close
        };
        let all = self.contacts.len();
        let mobility = |i, j| self.normal_mobility(i, j);
        let rate = |i: usize| Rate {
            value: self.rate(ROWS * i, &self.acceleration),
            scale: self.normal_rate_scale(i),
        };
        sharing.find((0..all).filter(pressing), all, mobility, rate);
        self.sharing = sharing;
    }

    /// The size of what the normal acceleration of a contact is the sum of. That of the drift is at least the one of which
    /// [`PARTS`] is the rounding of its differences: where a spinning body lifts off, its terms cancel.
    pub(crate) fn normal_rate_scale(&self, i: usize) -> f64 {
        let size: f64 = self.row(ROWS * i).iter().map(|w| w.abs()).sum();
        let drift = if self.constant {
            0.0
        } else {
            ROUNDING / PARTS * self.contacts[i].size / self.stencil.width
        };
        self.load * size + self.drift[ROWS * i].abs().max(drift)
    }

    fn factor_constraints(&self, Constraints { rows, columns, matrix, .. }: &mut Constraints) {
        matrix.factor(rows.len(), |k, l| {
            let column = &columns[l * self.n..(l + 1) * self.n];
            self.mobility(rows[k], rows[l], column) + self.sharing.entry(rows[k], rows[l])
        });
    }

    fn solve_constraints(&mut self, system: &mut Constraints) {
        let n = self.n;
        self.factor_constraints(system);
        // Where all stick, accelerations do not depend on shares.
        let depends = |contact: &ContactVariables| contact.mode == Phase::Slip || contact.unloaded;
        if system.matrix.singular && self.sharing.is_empty() && self.contacts.iter().any(depends) {
            self.share_normal_forces();
            if !self.sharing.is_empty() {
                self.factor_constraints(system);
            }
        }
        let Constraints { rows, columns, matrix, forces, defects } = system;
        let count = rows.len();
        forces.clear();
        forces.resize(count, 0.0);
        // Residuals grow with the condition of the matrix, and would act as accelerations where forces balance: one more
        // solution reduces them to rounding.
        for _ in 0..2 {
            defects.clear();
            let defect = |&row: &usize| {
                -self.rate(row, &self.acceleration) - self.sharing.product(row, rows, forces)
            };
            defects.extend(rows.iter().map(defect));
            matrix.solve(defects);
            for ((column, x), force) in columns.chunks_exact(n).zip(&*defects).zip(&mut *forces) {
                add(&mut self.acceleration, *x, column);
                self.load = self.load.max(x.abs() * largest(column));
                *force += x;
            }
        }
    }

    fn assign_constraint_forces(&mut self) {
        for (&row, &x) in self.constraints.rows.iter().zip(&self.constraints.forces) {
            let contact = &mut self.contacts[row / ROWS];
            match (row % ROWS, contact.mode) {
                (0, Phase::Slip) => {
                    contact.normal_force = x;
                    contact.force = contact.sliding.map(|f| f * x);
                }
                (0, _) => contact.normal_force = x,
                (r, _) => contact.force[r - 1] = x,
            }
        }
    }

    /// Adds to an acceleration what the constraint forces answer to it, so that it satisfies the constraints. The change of
    /// the forces is left in [`constraint_forces`](Self::constraint_forces). `unit_force` is the row of the unit force that
    /// gives the acceleration, whose part in shared normal forces the constraints see; none of other accelerations.
    pub(crate) fn constrain(&mut self, acceleration: &mut [f64], unit_force: Option<usize>) {
        let Constraints { rows, columns, matrix, forces, .. } = &mut self.constraints;
        let (all, spans, sharing) = (&self.rows, &self.spans, &self.sharing);
        let along = |row: usize, vector: &[f64]| {
            let span = spans[row / ROWS].clone();
            let first = row * self.n;
            dot(&all[first + span.start..first + span.end], &vector[span])
        };
        forces.clear();
        if rows.is_empty() {
            return;
        }
        let shared = |row: usize| unit_force.map_or(0.0, |other| sharing.entry(row, other));
        forces.extend(rows.iter().map(|&k| -along(k, acceleration) - shared(k)));
        matrix.solve(forces);
        for (column, x) in columns.chunks_exact(self.n).zip(&*forces) {
            add(acceleration, *x, column);
        }
    }

    /// Whether the contacts can share the constraint forces in many ways, of which one was taken.
    pub(crate) fn is_indeterminate(&self) -> bool {
        !self.constraints.rows.is_empty()
            && (self.constraints.matrix.singular || !self.sharing.is_empty())
    }

    /// The contacts' rows that have constraint forces.
    pub(crate) fn constrained_rows(&self) -> &[usize] {
        &self.constraints.rows
    }

    /// The constraint forces along these rows.
    pub(crate) fn constraint_forces(&self) -> &[f64] {
        &self.constraints.forces[..self.constraints.rows.len()]
    }
}

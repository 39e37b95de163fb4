//! The Jacobian of the accelerations: that of the sliding forces by the laws, the rest by differences.

use crate::contact::Phase;
use crate::integrator::event::dynamics::buffers::SmoothJacobian;
use crate::integrator::event::dynamics::contact_variables::ROWS;
use crate::integrator::event::dynamics::{Dynamics, SlidingForces};
use crate::integrator::event::resolution::ROUNDING;
use crate::integrator::event::state::{EvaluationError, Scale, State};
use crate::law::Components;
use crate::vectors::add;

/// Rounding of a Jacobian times the length of a step: larger values slow Newton's method, smaller ones widen differences.
const NOISE: f64 = 1e-3;

impl Dynamics<'_> {
    /// The smooth part of the Jacobian at `state` for steps up to about the length `h`, by forward differences.
    ///
    /// Parts of the system that do not act on each other are shifted together, as far as they are known: after an event
    /// they are found anew.
    ///
    /// Where forces balance, what rounding leaves of their change must not look like a Jacobian: its product with
    /// `h`, or `h²`, has to be small beside one. Therefore the `load` of the forces gives the least widths.
    pub(crate) fn linearise(
        &mut self,
        state: &State,
        h: f64,
        scale: Scale,
    ) -> Result<(), EvaluationError> {
        let n = self.n;
        let State { t, q, u } = state;
        let (mut shifted_q, mut shifted_u) = std::mem::take(&mut self.smooth.shifted);
        shifted_q.clone_from(q);
        shifted_u.clone_from(u);
        let (q, u) = (&mut shifted_q, &mut shifted_u);
        self.evaluate(*t, q, u, SlidingForces::Kept)?;
        let least = ROUNDING / NOISE * self.load * h;
        self.smooth.acceleration.copy_from_slice(&self.acceleration);
        self.smooth.slips.clear();
        self.smooth.slips.extend(self.contacts.iter().map(|contact| contact.slip));
        self.smooth.by_u.fill(0.0);
        self.smooth.by_q.fill(0.0);
        self.smooth.slip_by_q.fill(0.0);
        let together = std::mem::take(&mut self.smooth.together);
        let alone: Vec<Vec<usize>> = (0..n).map(|j| vec![j]).collect();
        let root = f64::EPSILON.sqrt();
        for columns in together.as_ref().map_or(&alone, |parts| &parts.columns) {
            let width = |x: f64| (root * x.abs().max(1e-3 * scale.u)).max(least);
            let widths = shift(u, columns, width);
            self.evaluate(*t, q, u, SlidingForces::Kept)?;
            u.copy_from_slice(&state.u);
            for (&j, width) in columns.iter().zip(&widths) {
                let SmoothJacobian { by_u, acceleration, .. } = &mut self.smooth;
                for (k, (there, here)) in self.acceleration.iter().zip(acceleration).enumerate() {
                    if together.as_ref().is_none_or(|parts| parts.of[k] == parts.of[j]) {
                        by_u[k * n + j] = (there - *here) / width;
                    }
                }
            }
        }
        for columns in together.as_ref().map_or(&alone, |parts| &parts.columns) {
            let width = |x: f64| (root * x.abs().max(1e-3 * scale.q)).max(least * h);
            let widths = shift(q, columns, width);
            self.evaluate(*t, q, u, SlidingForces::Kept)?;
            q.copy_from_slice(&state.q);
            for (&j, width) in columns.iter().zip(&widths) {
                let own = |k: usize| together.as_ref().is_none_or(|p| p.of[k] == p.of[j]);
                let SmoothJacobian { by_q, slip_by_q, acceleration, slips, .. } = &mut self.smooth;
                for (k, (there, here)) in self.acceleration.iter().zip(acceleration).enumerate() {
                    if own(k) {
                        by_q[k * n + j] = (there - *here) / width;
                    }
                }
                for (i, (contact, here)) in self.contacts.iter().zip(slips).enumerate() {
                    if contact.mode == Phase::Open || !own(self.spans[i].start) {
                        continue;
                    }
                    let slips = contact.slip[..contact.p].iter().zip(here);
                    for (r, (there, here)) in slips.enumerate() {
                        slip_by_q[(ROWS * i + 1 + r) * n + j] = (there - *here) / width;
                    }
                }
            }
        }
        self.smooth.together = together.or_else(|| Some(self.independent_parts()));
        self.smooth.shifted = (shifted_q, shifted_u);
        Ok(())
    }

    /// The Jacobian of the accelerations by velocities and by coordinates where they were evaluated last: the smooth
    /// part, which is kept from [`linearise`](Self::linearise), and that of the sliding directions.
    pub(crate) fn jacobian(&mut self, by_u: &mut [f64], by_q: &mut [f64]) {
        let n = self.n;
        by_u.copy_from_slice(&self.smooth.by_u);
        by_q.copy_from_slice(&self.smooth.by_q);
        let mut column = std::mem::take(&mut self.scratch);
        for i in 0..self.contacts.len() {
            let contact = self.contacts[i];
            if contact.mode != Phase::Slip {
                continue;
            }
            let point = self.direction_points.iter().find(|(k, _)| *k == i).map(|(_, z)| *z);
            let slope = match point {
                None => finite(self.law(i).jacobian(&contact.slip, 1.0)),
                Some(z) => {
                    self.law(i).at_point(&z, &contact.slip).map_or([[0.0; 3]; 3], |at| at.by_slip)
                }
            };
            for (r, slope) in slope[..contact.p].iter().enumerate() {
                column.copy_from_slice(self.response(ROWS * i + 1 + r));
                self.constrain(&mut column, None);
                for (s, slope) in slope[..contact.p].iter().enumerate() {
                    let factor = contact.normal_force * slope;
                    let row = ROWS * i + 1 + s;
                    add_dyad(by_u, factor, &column, self.row(row));
                    if !self.constant {
                        let along = &self.smooth.slip_by_q[row * n..(row + 1) * n];
                        add_dyad(by_q, factor, &column, along);
                    }
                }
            }
        }
        self.scratch = column;
    }
}

/// Shifts some of the values by the widths that these ask for; by how much.
fn shift(values: &mut [f64], columns: &[usize], width: impl Fn(f64) -> f64) -> Vec<f64> {
    let shifted = columns.iter().map(|&j| {
        let kept = values[j];
        values[j] += width(kept);
        values[j] - kept
    });
    shifted.collect()
}

/// Slopes as far as they exist.
fn finite(slope: Option<[Components; 3]>) -> [Components; 3] {
    let finite = |entry: f64| if entry.is_finite() { entry } else { 0.0 };
    slope.unwrap_or_default().map(|row| row.map(finite))
}

/// `matrix += factor column rowᵀ`.
fn add_dyad(matrix: &mut [f64], factor: f64, column: &[f64], row: &[f64]) {
    for (target, c) in matrix.chunks_exact_mut(row.len()).zip(column) {
        if *c != 0.0 {
            add(target, factor * c, row);
        }
    }
}

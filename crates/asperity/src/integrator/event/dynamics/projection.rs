//! Projection of states onto the constraints of closed and of sticking contacts.

use crate::contact::Phase;
use crate::integrator::event::dynamics::Dynamics;
use crate::integrator::event::dynamics::buffers::Projection;
use crate::integrator::event::dynamics::contact_variables::ROWS;
use crate::integrator::event::dynamics::forces::constraint_matrix::ConstraintMatrix;
use crate::integrator::event::state::{EvaluationError, State};
use crate::vectors::add;

impl Dynamics<'_> {
    /// Takes gaps, approach and slip, which rounding and differences bring in, out of contacts that have none.
    pub(crate) fn project(&mut self, state: &mut State) -> Result<(), EvaluationError> {
        self.kinematics(state.t, &state.q, &state.u)?;
        let mut projection = std::mem::take(&mut self.projection);
        let Projection { rows, matrix, percussions, shifts } = &mut projection;
        rows.clear();
        for (i, contact) in self.contacts.iter().enumerate() {
            match (contact.mode, contact.prescribed) {
                (Phase::Stick, _) => rows.extend(self.rows_of(i)),
                (Phase::Slip, None) => rows.push(ROWS * i),
                _ => {}
            }
        }
        if !rows.is_empty() {
            self.factor_mobility(rows, matrix);
            percussions.clear();
            percussions.extend(rows.iter().map(|&row| -self.velocity(row, &state.u)));
            matrix.solve(percussions);
            let gap = |&row: &usize| {
                if row % ROWS == 0 { -self.contacts[row / ROWS].gap } else { 0.0 }
            };
            shifts.clear();
            shifts.extend(rows.iter().map(gap));
            matrix.solve(shifts);
            for ((&row, percussion), shift) in rows.iter().zip(&*percussions).zip(&*shifts) {
                add(&mut state.u, *percussion, self.response(row));
                add(&mut state.q, *shift, self.response(row));
            }
        }
        self.projection = projection;
        Ok(())
    }

    /// Factors `WᵀM⁻¹W` of some rows.
    pub(crate) fn factor_mobility(&self, rows: &[usize], matrix: &mut ConstraintMatrix) {
        let entry = |i: usize, j: usize| self.mobility(rows[i], rows[j], self.response(rows[j]));
        matrix.factor(rows.len(), entry);
    }
}

//! Projection of states onto the constraints of closed and of sticking contacts.

use crate::contact::Phase;
use crate::integrator::event::dynamics::Dynamics;
use crate::integrator::event::dynamics::contact_variables::ROWS;
use crate::integrator::event::dynamics::inverse::Inverse;
use crate::integrator::event::state::{EvaluationError, State};
use crate::integrator::event::vectors::{add, dot};

impl Dynamics<'_> {
    /// Takes gaps, approach and slip, which rounding and differences bring in, out of contacts that have none.
    pub(crate) fn project(&mut self, state: &mut State) -> Result<(), EvaluationError> {
        self.kinematics(state.t, &state.q, &state.u)?;
        let mut rows: Vec<usize> = Vec::new();
        for (i, contact) in self.contacts.iter().enumerate() {
            match (contact.mode, contact.prescribed) {
                (Phase::Stick, _) => rows.extend(self.rows_of(i)),
                (Phase::Slip, None) => rows.push(ROWS * i),
                _ => {}
            }
        }
        if rows.is_empty() {
            return Ok(());
        }
        let mut inverse = self.mobility_inverse(&rows);
        let velocity = |&row: &usize| -self.velocity(row, &state.u);
        let gap = |&row: &usize| if row % ROWS == 0 { -self.contacts[row / ROWS].gap } else { 0.0 };
        let mut percussions: Vec<f64> = rows.iter().map(velocity).collect();
        let mut shifts: Vec<f64> = rows.iter().map(gap).collect();
        inverse.apply(&mut percussions);
        inverse.apply(&mut shifts);
        for ((&row, percussion), shift) in rows.iter().zip(&percussions).zip(&shifts) {
            add(&mut state.u, *percussion, self.response(row));
            add(&mut state.q, *shift, self.response(row));
        }
        Ok(())
    }

    /// The inverse of `WᵀM⁻¹W` for some rows.
    pub(crate) fn mobility_inverse(&self, rows: &[usize]) -> Inverse {
        let mut inverse = Inverse::default();
        inverse.of(rows.len(), |i, j| dot(self.row(rows[i]), self.response(rows[j])));
        inverse
    }
}

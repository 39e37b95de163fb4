//! What forces along the rows of contacts move.

use crate::integrator::event::dynamics::contact_variables::{FieldError, ROWS};
use crate::integrator::event::dynamics::{Field, dot};
use crate::system::SystemError;

impl Field<'_> {
    /// Refuses directions of a contact that move nothing.
    pub(crate) fn check_rows(&self, contact: usize) -> Result<(), FieldError> {
        let mobility =
            |row: usize| dot(self.row(row), &self.response[row * self.n..(row + 1) * self.n]);
        // The comparison also turns away NaN.
        if self.rows_of(contact).any(|row| !(mobility(row) > 0.0)) {
            return Err(SystemError::direction(contact).into());
        }
        Ok(())
    }

    /// `values ← M⁻¹ values` with the mass matrix of the last state.
    pub(crate) fn apply_inverse_mass(&self, values: &mut [f64]) {
        if let Some(factor) = &self.factor {
            factor.solve(values);
        }
    }

    /// `w_NᵀM⁻¹(w_N + W f)` over `w_NᵀM⁻¹w_N` of a slipping unilateral contact.
    pub(crate) fn resistance(&self, contact: usize) -> f64 {
        let touch = &self.touches[contact];
        let normal = self.row(ROWS * contact);
        let response = |r: usize| &self.response[(ROWS * contact + r) * self.n..][..self.n];
        let friction = (0..touch.p).map(|r| touch.sliding[r] * dot(normal, response(1 + r)));
        match touch.prescribed {
            Some(_) => 1.0,
            None => 1.0 + friction.sum::<f64>() / dot(normal, response(0)),
        }
    }
}

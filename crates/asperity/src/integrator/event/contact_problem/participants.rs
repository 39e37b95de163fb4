//! Contacts and rows that take part in a contact problem.

use crate::integrator::event::dynamics::contact_variables::ROWS;
use crate::integrator::event::dynamics::{Field, dot};

/// Mobility of a row over that without other contacts that counts as none.
const HELD: f64 = 1e-12;

/// Rows that take part in a contact problem, with `M⁻¹` of them.
pub(crate) struct Part {
    pub(crate) contacts: Vec<usize>,
    pub(crate) rows: Vec<usize>,
    pub(crate) responses: Vec<f64>,
}

impl Part {
    /// Contacts that the slipping ones hold in all their directions already. The mobility that is left of them
    /// is rounding, and must not ask for a force.
    pub(crate) fn held(&self, field: &Field<'_>) -> Vec<usize> {
        let n = field.n;
        let moves = |k: usize| {
            let row = self.rows[k];
            let left = dot(field.row(row), &self.responses[k * n..(k + 1) * n]);
            left.abs() > HELD * dot(field.row(row), &field.response[row * n..(row + 1) * n])
        };
        let mobile: Vec<usize> =
            (0..self.rows.len()).filter(|&k| moves(k)).map(|k| self.rows[k] / ROWS).collect();
        self.contacts.iter().copied().filter(|i| !mobile.contains(i)).collect()
    }
}

/// Rows of these contacts, answered by the slipping contacts that stay closed: responses, and the normal
/// forces there.
pub(crate) fn constrained(field: &mut Field<'_>, contacts: Vec<usize>) -> (Part, Vec<f64>) {
    let rows: Vec<usize> = contacts.iter().flat_map(|&i| field.rows_of(i)).collect();
    let n = field.n;
    let (mut responses, mut answers) = (Vec::with_capacity(rows.len() * n), Vec::new());
    for &row in &rows {
        let mut response = field.response[row * n..(row + 1) * n].to_vec();
        field.constrain(&mut response);
        responses.extend_from_slice(&response);
        answers.extend_from_slice(&field.solution[..field.unknown().len()]);
    }
    (Part { contacts, rows, responses }, answers)
}

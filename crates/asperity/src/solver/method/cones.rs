//! The coordinates in which the friction cones of all contacts are Lorentz cones, see `law/contact_equation/lorentz.rs`.

use crate::contact::{ContactProblem, ContactRows};
use crate::law::{ContactMatrix, ContactVector};

/// `P̂ = T P`, `ξ̂ = K ξ` for all contacts. Where the normal percussion is prescribed it is no unknown: `P̂_T` lies in the section of
/// the cone at `P̂_N`, a ball.
#[derive(Debug, Clone, Default)]
pub(crate) struct Cones {
    pub(crate) t: Vec<ContactMatrix>,
    pub(crate) k: Vec<ContactMatrix>,
    pub(crate) t_inverse: Vec<ContactMatrix>,
    /// `P̂_N` where it is prescribed.
    pub(crate) given: Vec<Option<f64>>,
}

impl Cones {
    /// Reads the laws; false if some contact has no such coordinates.
    pub(crate) fn read(&mut self, problem: &ContactProblem) -> bool {
        self.t.clear();
        self.k.clear();
        self.t_inverse.clear();
        self.given.clear();
        for contact in problem.contacts() {
            let Some(cone) = contact.law.lorentz_cone() else { return false };
            let Some(inverse) = cone.t.try_inverse() else { return false };
            self.given
                .push(contact.normal.prescribed().map(|percussion| cone.t[(0, 0)] * percussion));
            self.t.push(cone.t);
            self.k.push(cone.k);
            self.t_inverse.push(inverse);
        }
        true
    }
}

/// Rows of a contact as a vector whose first entry belongs to the normal, zero where there is no such row; the rest zero.
pub(crate) fn own_rows(values: &[f64], contact: &ContactRows) -> ContactVector {
    let mut own = ContactVector::zeros();
    own.as_mut_slice()[1 - contact.normal_rows()..][..contact.len()]
        .copy_from_slice(&values[contact.rows()]);
    own
}

/// Writes such a vector back into the rows.
pub(crate) fn write_rows(own: &ContactVector, contact: &ContactRows, values: &mut [f64]) {
    let from = &own.as_slice()[1 - contact.normal_rows()..][..contact.len()];
    values[contact.rows()].copy_from_slice(from);
}

/// The matrix between such vectors as one between the rows.
pub(crate) fn between_rows(matrix: ContactMatrix, contact: &ContactRows) -> ContactMatrix {
    if contact.normal_rows() == 1 {
        return matrix;
    }
    let mut shifted = ContactMatrix::zeros();
    shifted.fixed_view_mut::<3, 3>(0, 0).copy_from(&matrix.fixed_view::<3, 3>(1, 1));
    shifted
}

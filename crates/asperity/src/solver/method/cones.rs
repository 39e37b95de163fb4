//! The coordinates in which the friction cones of all contacts are Lorentz cones, see `law/contact_equation/lorentz.rs`.

use crate::contact::{ContactProblem, NormalForce};
use crate::law::{ContactMatrix, ContactVector};

/// `P̂ = T P`, `ξ̂ = K ξ` for all contacts.
#[derive(Debug, Clone, Default)]
pub(crate) struct Cones {
    pub(crate) t: Vec<ContactMatrix>,
    pub(crate) k: Vec<ContactMatrix>,
    pub(crate) t_inverse: Vec<ContactMatrix>,
}

impl Cones {
    /// Reads the laws; false if some contact has no such coordinates.
    pub(crate) fn read(&mut self, problem: &ContactProblem) -> bool {
        self.t.clear();
        self.k.clear();
        self.t_inverse.clear();
        for contact in problem.contacts() {
            if contact.normal != NormalForce::Unilateral {
                return false;
            }
            let Some(cone) = contact.law.lorentz_cone() else { return false };
            let Some(inverse) = cone.t.try_inverse() else { return false };
            self.t.push(cone.t);
            self.k.push(cone.k);
            self.t_inverse.push(inverse);
        }
        true
    }
}

/// Rows of a contact as a vector, the rest zero.
pub(crate) fn own_rows(values: &[f64], offset: usize, len: usize) -> ContactVector {
    ContactVector::from_fn(|i, _| if i < len { values[offset + i] } else { 0.0 })
}

//! The natural residual, which no solver owns.

use crate::argument::ArgumentError;
use crate::contact::{ContactProblem, ContactRows, NormalForce};
use crate::law::Friction;

/// Natural residual of a problem.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Residual {
    /// The largest relative defect of a contact, independent of units.
    pub value: f64,
    /// Contact with the largest defect.
    pub worst_contact: usize,
}

/// Largest residual that rounding explains: percussions of an ill-conditioned block that are handed on have at most
/// this one.
pub(crate) const ROUNDED: f64 = 1e-6;

/// Percussions, and the velocities `γ_E` that belong to them: what is measured.
#[derive(Clone, Copy)]
pub(crate) struct Measured<'a> {
    pub(crate) problem: &'a ContactProblem,
    pub(crate) percussion: &'a [f64],
    pub(crate) velocity: &'a [f64],
}

impl<'a> Measured<'a> {
    /// Percussions and velocities that nobody has looked at.
    pub(crate) fn checked(
        problem: &'a ContactProblem,
        percussion: &'a [f64],
        velocity: &'a [f64],
    ) -> Result<Self, ArgumentError> {
        problem.check_rows("percussion", percussion)?;
        problem.check_rows("velocity", velocity)?;
        Ok(Self { problem, percussion, velocity })
    }

    /// `ξ = γ_E + e γ_B` of a row.
    #[inline]
    pub(crate) fn xi(&self, row: usize) -> f64 {
        self.velocity[row] + self.problem.restitution()[row]
    }

    /// The friction of a contact.
    #[inline(always)]
    pub(crate) fn friction(&self, contact: &ContactRows) -> Friction<'a> {
        let rows = contact.tangential_rows();
        Friction {
            normal: contact.normal_percussion(self.percussion),
            tangent: &self.percussion[rows.clone()],
            velocity: &self.velocity[rows.clone()],
            restitution: &self.problem.restitution()[rows],
        }
    }

    /// `ξ_T` of a contact, unused components zero.
    pub(crate) fn slip(&self, contact: &ContactRows) -> [f64; 3] {
        let mut slip = [0.0; 3];
        slip.iter_mut().zip(contact.tangential_rows()).for_each(|(xi, row)| *xi = self.xi(row));
        slip
    }

    /// Square of the defect of both inclusions of a contact with the prox parameter `rho`.
    #[inline]
    pub(crate) fn defect(&self, contact: &ContactRows, rho: f64) -> f64 {
        contact.law.inclusion_defect(self.friction(contact), rho) + self.normal_defect(contact, rho)
    }

    /// Square of that of the normal inclusion.
    #[inline]
    fn normal_defect(&self, contact: &ContactRows, rho: f64) -> f64 {
        let row = contact.offset;
        let normal = match contact.normal {
            NormalForce::Prescribed(_) => 0.0,
            NormalForce::Unilateral => normal_defect(self.percussion[row], self.xi(row), rho),
        };
        normal * normal
    }
}

/// Defect of `0 ≤ P_N ⊥ ξ_N ≥ 0`.
#[inline(always)]
pub(super) fn normal_defect(percussion: f64, xi: f64, rho: f64) -> f64 {
    percussion - f64::max(0.0, percussion - rho * xi)
}

/// How far percussions and velocities are from obeying the contact laws, contact by contact.
///
/// With `ρ = rows/tr G` of the contact's own block the defect of the normal row is `P_N − max(0, P_N − ρξ_N)` (\[WL19\] (12)).
/// That of friction is the distance from the pair of `P_T` and `ρξ_T` to one near by that obeys the law with the same
/// `P_N`, of percussion and velocity the larger part: with `z = −αP_T` and `z′ = prox_{P_N D}(z + αρξ_T)` (\[WL19\] (69)) it is
/// `max(‖P_T + z′/α(z′)‖, ‖z − z′‖/α)`, or the distance to rest, `‖P_T‖ max(0, 1 − 1/k_C(−P_T/P_N)) + ρ‖ξ_T‖`,
/// where that is less. For `D = C` it is `‖z − z′‖`, the natural map of friction.
///
/// It vanishes exactly at solutions. A friction percussion is no farther beyond its reservoir than that, nor, in slip, farther
/// within; and what the velocity is off the normal of *D* is no larger either, however thin *D* is beside *C*. The
/// defect of a contact is taken relative to its own percussion and loads, so that a light contact
/// cannot hide the defect of a heavy one. Percussions and loads of a contact below `1e-150`, of which there are no squares,
/// count as none.
///
/// # Errors
///
/// [`ArgumentError`] if there is not one percussion and one velocity `γ_E` per row.
pub fn natural_residual(
    problem: &ContactProblem,
    percussion: &[f64],
    velocity: &[f64],
) -> Result<Residual, ArgumentError> {
    Ok(residual(&Measured::checked(problem, percussion, velocity)?))
}

/// See [`natural_residual`].
pub(crate) fn residual(measured: &Measured<'_>) -> Residual {
    residual_of(measured, 0..measured.problem.contacts().len())
}

/// The same of some contacts only.
pub(crate) fn residual_of(
    measured: &Measured<'_>,
    contacts: impl IntoIterator<Item = usize>,
) -> Residual {
    let mut worst = Worst::NONE;
    for i in contacts {
        let Measured { problem, .. } = *measured;
        let contact = &problem.contacts()[i];
        let friction = contact.law.inclusion_defect(measured.friction(contact), problem.rho(i));
        worst.add(measured, i, friction);
    }
    worst.residual()
}

/// The largest relative defect of some contacts.
#[derive(Debug, Clone, Copy)]
pub(super) struct Worst {
    /// Its square, negative without contacts.
    defect: f64,
    contact: usize,
}

impl Worst {
    /// Of no contacts.
    pub(super) const NONE: Self = Self { defect: -1.0, contact: 0 };

    /// Takes in a contact, of which the square of the defect of friction is known.
    #[inline]
    pub(super) fn add(&mut self, measured: &Measured<'_>, i: usize, friction: f64) {
        let Measured { problem, percussion, velocity } = *measured;
        let contact = &problem.contacts()[i];
        let defect = friction + measured.normal_defect(contact, problem.rho(i));
        let own = percussion[contact.rows()].iter().map(|p| p * p).sum::<f64>();
        if is_surely_less(defect, own, self.defect) {
            return;
        }
        let defect = relative(defect, || scale(problem, i, percussion, velocity));
        if is_worse(defect, self.defect) {
            *self = Self { defect, contact: i };
        }
    }

    pub(super) fn residual(self) -> Residual {
        let value = if self.defect < 0.0 { 0.0 } else { self.defect.sqrt() };
        Residual { value, worst_contact: self.contact }
    }
}

/// So much less is less, however squares, sums and ratios are rounded.
pub(super) const SURELY: f64 = 0.99;

/// Whether a defect relative to its scale is certainly less than that of another contact, `worst`, negative without one; `own` is
/// the square of the contact's percussion, which its scale is no less than. The velocities that others bring take longer than
/// all the rest: they need not be asked for then.
#[inline(always)]
fn is_surely_less(defect: f64, own: f64, worst: f64) -> bool {
    worst >= 0.0 && own < f64::INFINITY && defect <= SURELY * worst * own
}

/// Whether a defect is larger than another one; not-a-number is larger than all others.
#[inline(always)]
pub(crate) fn is_worse(defect: f64, than: f64) -> bool {
    !(defect <= than || than.is_nan())
}

/// A defect relative to its scale, both squared. Percussions whose squares are no numbers are no solution of anything:
/// beside an infinite scale every defect would vanish.
#[inline(always)]
pub(super) fn relative(defect: f64, scale: impl FnOnce() -> f64) -> f64 {
    if defect == 0.0 {
        return 0.0;
    }
    let scale = scale();
    if scale < f64::INFINITY { defect / scale } else { f64::INFINITY }
}

/// Square of what the defect of a contact is compared with: its percussion, its free velocity and the
/// velocities that the other contacts bring, the latter times ρ.
#[inline]
fn scale(problem: &ContactProblem, i: usize, percussion: &[f64], velocity: &[f64]) -> f64 {
    let (contact, rho) = (&problem.contacts()[i], problem.rho(i));
    let loads = loads(problem, i, percussion, velocity);
    let (mut own, mut brought) = (0.0, 0.0);
    for (row, load) in contact.rows().zip(loads) {
        own += percussion[row] * percussion[row];
        let load = load + problem.free_velocity()[row].abs() + problem.restitution()[row].abs();
        brought += load * load;
    }
    f64::max(own, rho * rho * brought)
}

/// `Σ_j |G_ij P_j|` over the rows of contact `i`; with products only, `|Σ_j G_ij P_j|`.
#[inline]
fn loads(problem: &ContactProblem, i: usize, percussion: &[f64], velocity: &[f64]) -> [f64; 4] {
    let mut loads = [0.0; 4];
    if problem.contacts().len() == 1 {
        return loads;
    }
    if !problem.delassus().is_matrix_free() {
        problem.delassus().blocks().add_magnitudes(i, percussion, &mut loads);
        return loads;
    }
    for (load, row) in loads.iter_mut().zip(problem.contacts()[i].rows()) {
        *load = (velocity[row] - problem.free_velocity()[row]).abs();
    }
    loads
}

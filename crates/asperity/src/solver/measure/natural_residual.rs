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
        let rows = contact.rows();
        let [percussion, velocity] = [self.percussion, self.velocity].map(|v| &v[rows.clone()]);
        squared_defect(contact, percussion, velocity, &self.problem.restitution()[rows], rho)
    }
}

/// Square of the defect of both inclusions of a contact, from its own rows.
#[inline(always)]
fn squared_defect(
    contact: &ContactRows,
    percussion: &[f64],
    velocity: &[f64],
    restitution: &[f64],
    rho: f64,
) -> f64 {
    let first = contact.normal_rows();
    let friction = Friction {
        normal: contact.normal.prescribed().unwrap_or(percussion[0]),
        tangent: &percussion[first..],
        velocity: &velocity[first..],
        restitution: &restitution[first..],
    };
    let friction = contact.law.inclusion_defect(friction, rho);
    match contact.normal {
        NormalForce::Prescribed(_) => friction,
        NormalForce::Unilateral => {
            friction + normal_defect(percussion[0], velocity[0] + restitution[0], rho).powi(2)
        }
    }
}

/// Defect of `0 ≤ P_N ⊥ ξ_N ≥ 0`.
#[inline(always)]
fn normal_defect(percussion: f64, xi: f64, rho: f64) -> f64 {
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
        worst.add(measured, i);
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

    /// Takes in a contact.
    #[inline]
    pub(super) fn add(&mut self, measured: &Measured<'_>, i: usize) {
        let Measured { problem, percussion, velocity } = *measured;
        let rows = problem.contacts()[i].rows();
        let (own, own_velocity) = (&percussion[rows.clone()], &velocity[rows]);
        let own = OwnRows { problem, contact: i, percussion: own, velocity: own_velocity };
        let (defect, squares) = (own.defect(), own.squares());
        if is_surely_less(defect, squares, self.defect) {
            return;
        }
        let brought = || loads(problem, i, percussion, velocity);
        let defect = relative(defect, || own.scale(squares, &brought()));
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

/// A contact with the percussions and velocities `γ_E` of its own rows.
#[derive(Clone, Copy)]
pub(super) struct OwnRows<'a> {
    pub(super) problem: &'a ContactProblem,
    pub(super) contact: usize,
    pub(super) percussion: &'a [f64],
    pub(super) velocity: &'a [f64],
}

impl OwnRows<'_> {
    /// Square of the defect relative to its scale, where others bring so much.
    #[inline(always)]
    pub(super) fn relative(&self, brought: &[f64; 4]) -> f64 {
        relative(self.defect(), || self.scale(self.squares(), brought))
    }

    /// Square of the defect of both inclusions.
    #[inline(always)]
    fn defect(&self) -> f64 {
        let Self { problem, contact, percussion, velocity } = *self;
        let (rows, rho) = (&problem.contacts()[contact], problem.rho(contact));
        squared_defect(rows, percussion, velocity, &problem.restitution()[rows.rows()], rho)
    }

    /// Square of the percussions.
    #[inline(always)]
    fn squares(&self) -> f64 {
        self.percussion.iter().map(|p| p * p).sum()
    }

    /// Square of what the defect is compared with: the percussion, of which this is the square, and, times ρ, the free velocity
    /// and the velocities that the other contacts bring.
    #[inline(always)]
    fn scale(&self, squares: f64, brought: &[f64; 4]) -> f64 {
        let Self { problem, contact, .. } = *self;
        let (rows, rho) = (problem.contacts()[contact].rows(), problem.rho(contact));
        let own = problem.free_velocity()[rows.clone()].iter().zip(&problem.restitution()[rows]);
        let all = own.zip(brought).map(|((b, e), brought)| {
            let sum = brought + b.abs() + e.abs();
            sum * sum
        });
        f64::max(squares, rho * rho * all.sum::<f64>())
    }
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

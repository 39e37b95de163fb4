//! What laws answer, whatever their dimension: vectors are slices with one component per direction of friction.
//!
//! This is the one place where the dimension of a law is erased.

use std::sync::Arc;

use asperity_set::{Ball, Convex, ConvexSet, Matrix, Star, StarSet, Vector, strict_convexity};

use super::Bounds;
use super::contact_equation::inclusion;
use super::contact_equation::lorentz::{self, LorentzCone};
use super::contact_equation::natural_map::{self, ContactPoint, Derivatives};
use super::extended::FrictionLaw;
use super::rate::Stribeck;

/// A shared friction law of any dimension.
#[derive(Debug, Clone)]
pub enum Law {
    /// Of a contact without friction, which has a normal row alone.
    Zero(Arc<FrictionLaw<0>>),
    /// On a line.
    One(Arc<FrictionLaw<1>>),
    /// In the contact plane.
    Two(Arc<FrictionLaw<2>>),
    /// In the contact plane with drilling.
    Three(Arc<FrictionLaw<3>>),
}

/// The answer of the law inside, whatever its dimension.
macro_rules! answer {
    ($of:expr, $law:ident => $answer:expr) => {
        match $of {
            Law::Zero($law) => $answer,
            Law::One($law) => $answer,
            Law::Two($law) => $answer,
            Law::Three($law) => $answer,
        }
    };
}

/// Components of a vector in the directions of friction, unused ones zero.
pub(crate) type Components = [f64; 3];

/// The friction of a contact: percussion and velocity in its tangential rows, and its normal percussion.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Friction<'a> {
    /// Normal percussion.
    pub(crate) normal: f64,
    /// Tangential percussion.
    pub(crate) tangent: &'a [f64],
    /// Tangential velocity `ξ_T`: the sum of what the problem calls `γ_E` and `e γ_B`.
    pub(crate) velocity: &'a [f64],
    pub(crate) restitution: &'a [f64],
}

impl Friction<'_> {
    /// `ξ_T`.
    #[inline(always)]
    fn slip<const P: usize>(&self) -> Vector<P> {
        vector::<P>(self.velocity) + vector::<P>(self.restitution)
    }

    /// `−P_T/P_N`.
    #[inline(always)]
    fn reduced<const P: usize>(&self) -> Vector<P> {
        -(vector::<P>(self.tangent) * (1.0 / self.normal))
    }
}

/// What is wrong with the friction of a contact.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Violation {
    /// The part of the percussion beyond its reservoir, `‖P_T‖ (1 − 1/k_C(−P_T/P_N))` above zero.
    pub(crate) excess: f64,
    /// See [`Law::inclusion_defect`].
    pub(crate) squared_defect: f64,
    /// See [`Law::is_projected`]; false without a normal percussion.
    pub(crate) slips: bool,
}

/// The prox parameter of an iteration.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ProxParameter {
    pub(crate) r: f64,
    /// Whether `r` is multiplied by `α`.
    pub(crate) by_alpha: bool,
}

/// λ for unit normal force from the point `z` of *D* in place of the sliding direction, with its derivatives.
#[derive(Debug, Clone, Copy)]
pub(crate) struct AtPoint {
    /// `−f z/k_C(z)` with the factor `f` of the speed.
    pub(crate) sliding: Components,
    /// `∂λ/∂z`.
    pub(crate) by_point: [Components; 3],
    /// `∂λ/∂γ` by the factor of the speed.
    pub(crate) by_slip: [Components; 3],
    /// `prox_D(z + rγ) − z`, which vanishes where γ is normal to *D* at `z`.
    pub(crate) defect: Components,
    /// The derivative of `prox_D`.
    pub(crate) slope: [Components; 3],
    /// `r = ‖z‖/‖γ‖`: where the boundary is flat the slope is one, where it has a corner it vanishes.
    pub(crate) r: f64,
}

impl Law {
    /// That of a contact without friction.
    pub fn frictionless() -> Self {
        FrictionLaw::<0>::associated(Ball::UNIT.into()).into()
    }

    /// Whether both are the same object, so that nobody has to compare their sets.
    #[cfg(feature = "serde")]
    pub(crate) fn is_the_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Zero(_), Self::Zero(_)) => true,
            (Self::One(a), Self::One(b)) => Arc::ptr_eq(a, b),
            (Self::Two(a), Self::Two(b)) => Arc::ptr_eq(a, b),
            (Self::Three(a), Self::Three(b)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }

    /// Number of components of the friction force.
    #[inline]
    pub fn dimension(&self) -> usize {
        match self {
            Self::Zero(_) => 0,
            Self::One(_) => 1,
            Self::Two(_) => 2,
            Self::Three(_) => 3,
        }
    }

    /// The factor of the sliding speed, if there is one.
    pub fn rate(&self) -> Option<&Stribeck> {
        answer!(self, law => law.rate())
    }

    /// Whether the direction set is the reservoir, at all speeds.
    pub(crate) fn is_associated(&self) -> bool {
        answer!(self, law => law.is_associated() && law.rate().is_none())
    }

    /// The associated law with this reservoir where that is convex, and this law is another one. Whether contacts can stick
    /// depends on reservoirs alone; with associated laws and given normal forces, accelerations and so the answer are unique.
    pub(crate) fn associated(&self) -> Option<Self> {
        fn of<const P: usize>(law: &FrictionLaw<P>) -> Option<FrictionLaw<P>> {
            let other = !law.is_associated() || law.rate().is_some();
            let reservoir = law.reservoir().as_convex().filter(|_| other)?;
            Some(FrictionLaw::associated(reservoir.clone()))
        }
        answer!(self, law => of(law).map(Self::from))
    }

    /// `min r_D/r_C`, see [`FrictionLaw::alpha_min`].
    pub fn alpha_min(&self) -> f64 {
        answer!(self, law => law.alpha_min())
    }

    /// The coefficient, if the law is isotropic Coulomb friction.
    pub fn isotropic_coefficient(&self) -> Option<f64> {
        answer!(self, law => law.isotropic_coefficient())
    }

    /// `k_C(x)`, zero at the origin.
    pub(crate) fn gauge(&self, x: &[f64]) -> f64 {
        answer!(self, law => law.reservoir().gauge(&vector(x)))
    }

    /// λ while sliding with `slip` and unit normal force; none at rest.
    pub(crate) fn sliding(&self, slip: &[f64]) -> Option<Components> {
        answer!(self, law => law.force(&vector(slip), 1.0).ok().map(|force| padded(&force)))
    }

    /// `∂λ/∂γ` row by row, see [`FrictionLaw::jacobian`]; none at rest.
    pub(crate) fn jacobian(&self, slip: &[f64], normal_force: f64) -> Option<[Components; 3]> {
        answer!(self, law => law.jacobian(&vector(slip), normal_force).ok().map(|m| square(&m)))
    }

    /// The sliding direction that goes with a force λ on the boundary of the reservoir: the normal of *D*.
    pub(crate) fn normal(&self, force: &[f64]) -> Components {
        answer!(self, law => {
            let normal = law.direction().normal(&-vector(force));
            padded(&normal.try_normalize(0.0).unwrap_or_else(Vector::zeros))
        })
    }

    /// The point `z` of the boundary of *D* that goes with a sliding force λ.
    pub(crate) fn direction_point(&self, sliding: &[f64]) -> Components {
        answer!(self, law => {
            let x = -vector(sliding);
            let gauge = law.direction().gauge(&x);
            padded(&if gauge > 0.0 { x / gauge } else { x })
        })
    }

    /// What the law says with `z` and γ as unknowns of their own; none at rest.
    pub(crate) fn at_point(&self, z: &[f64], slip: &[f64]) -> Option<AtPoint> {
        answer!(self, law => at_point(law, vector(z), vector(slip)))
    }

    /// Whether the force is a smooth function of the sliding direction, with slopes of one size in all directions.
    pub(crate) fn is_smooth(&self) -> bool {
        fn smooth<const P: usize>(law: &FrictionLaw<P>) -> bool {
            P == 1 || matches!(law.direction(), Convex::Ball(_) | Convex::Ellipsoid(_))
        }
        answer!(self, law => smooth(law))
    }

    /// Whether *D* is strictly convex, so that the force is a continuous function of the sliding direction.
    pub(crate) fn has_strictly_convex_direction(&self) -> bool {
        fn strictly<const P: usize>(law: &FrictionLaw<P>) -> bool {
            P == 1
                || law.isotropic_coefficient().is_some()
                || strict_convexity(&Star::Convex(law.direction().clone())).holds
        }
        answer!(self, law => strictly(law))
    }

    /// Bounds of laws whose boundary is walked along.
    pub(crate) fn bounds(&self) -> Option<Bounds> {
        match self {
            Self::One(law) => Some(Bounds::on_a_line(law.largest_radius())),
            Self::Two(law) => Some(law.bounds()),
            Self::Zero(_) | Self::Three(_) => None,
        }
    }

    /// Coordinates in which the friction cone is a Lorentz cone, if the law has some.
    pub(crate) fn lorentz_cone(&self) -> Option<LorentzCone> {
        answer!(self, law => lorentz::cone(law))
    }

    /// Square of the defect of friction, a percussion: how far percussion and velocity times `ρ` are from a pair that obeys
    /// the law (`contact_equation/inclusion.rs`); without a normal percussion the square of the friction.
    #[inline]
    pub(crate) fn inclusion_defect(&self, friction: Friction<'_>, rho: f64) -> f64 {
        answer!(self, law => inclusion_defect(law, friction, rho))
    }

    /// All that a certificate asks of the law of a contact.
    #[inline]
    pub(crate) fn violation(&self, friction: Friction<'_>, rho: f64) -> Violation {
        answer!(self, law => violation(law, friction, rho))
    }

    /// Whether the natural map projects, as in slip: `α(x)(x + ρξ_T/P_N)` is outside of *D*, `x = −P_T/P_N`.
    pub(crate) fn is_projected(&self, friction: Friction<'_>, rho: f64) -> bool {
        answer!(self, law => is_projected(law, friction, rho))
    }

    /// One iteration (\[WL19\] (69), (70)) of the friction percussion.
    pub(crate) fn prox_iteration(
        &self,
        friction: Friction<'_>,
        r: ProxParameter,
        next: &mut [f64],
    ) {
        answer!(self, law => next.copy_from_slice(prox_iteration(law, friction, r).as_slice()));
    }

    /// The natural map of a contact with this law.
    pub(crate) fn natural_map(&self, at: ContactPoint<'_>, out: &mut [f64]) {
        answer!(self, law => natural_map::map(law, at, out, None));
    }

    /// The natural map `F` of a contact with this law, and its derivatives.
    pub(crate) fn natural_map_jet(
        &self,
        at: ContactPoint<'_>,
        out: &mut [f64],
        derivatives: Derivatives<'_>,
    ) {
        answer!(self, law => natural_map::map(law, at, out, Some(derivatives)));
    }
}

impl PartialEq for Law {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Zero(_), Self::Zero(_)) => true,
            (Self::One(a), Self::One(b)) => a == b,
            (Self::Two(a), Self::Two(b)) => a == b,
            (Self::Three(a), Self::Three(b)) => a == b,
            _ => false,
        }
    }
}

impl From<FrictionLaw<0>> for Law {
    fn from(law: FrictionLaw<0>) -> Self {
        Self::Zero(Arc::new(law))
    }
}

impl From<FrictionLaw<1>> for Law {
    fn from(law: FrictionLaw<1>) -> Self {
        Self::One(Arc::new(law))
    }
}

impl From<FrictionLaw<2>> for Law {
    fn from(law: FrictionLaw<2>) -> Self {
        Self::Two(Arc::new(law))
    }
}

impl From<FrictionLaw<3>> for Law {
    fn from(law: FrictionLaw<3>) -> Self {
        Self::Three(Arc::new(law))
    }
}

/// See [`Law::inclusion_defect`].
#[inline]
pub(crate) fn inclusion_defect<const P: usize>(
    law: &FrictionLaw<P>,
    friction: Friction<'_>,
    rho: f64,
) -> f64 {
    let normal = friction.normal;
    if normal <= 0.0 {
        return vector::<P>(friction.tangent).norm_squared();
    }
    let sigma = friction.slip::<P>() * (rho * (1.0 / normal));
    inclusion::squared_defect(law, &friction.reduced(), &sigma) * normal * normal
}

#[inline(always)]
fn violation<const P: usize>(law: &FrictionLaw<P>, friction: Friction<'_>, rho: f64) -> Violation {
    let tangent = vector::<P>(friction.tangent);
    let pushing = friction.normal.max(0.0);
    let still = tangent.iter().all(|p| *p == 0.0);
    // `P_N k_C(x/P_N) = k_C(x)`, also for an open contact.
    let gauge = if still { 0.0 } else { law.reservoir().gauge(&-tangent) };
    let excess = if gauge <= pushing { 0.0 } else { tangent.norm() * (1.0 - pushing / gauge) };
    let squared_defect = inclusion_defect(law, friction, rho);
    let slips = friction.normal > 0.0 && is_projected(law, friction, rho);
    Violation { excess, squared_defect, slips }
}

#[inline(always)]
fn is_projected<const P: usize>(law: &FrictionLaw<P>, friction: Friction<'_>, rho: f64) -> bool {
    let moved = friction.slip::<P>() * (rho / friction.normal);
    let step = law.prox_step(&friction.reduced(), |alpha| moved * alpha);
    law.direction().gauge(&step.target) > 1.0 + 1e-12
}

fn prox_iteration<const P: usize>(
    law: &FrictionLaw<P>,
    friction: Friction<'_>,
    parameter: ProxParameter,
) -> Vector<P> {
    if friction.normal <= 0.0 {
        return Vector::zeros();
    }
    let x = friction.reduced::<P>();
    // A falling normal percussion leaves −P far outside; α is taken on the boundary then.
    let gauge = law.reservoir().gauge(&x);
    let x = if gauge > 1.0 { x / gauge } else { x };
    let step = law.prox_step(&x, |alpha| {
        let r = if parameter.by_alpha { parameter.r * alpha } else { parameter.r };
        friction.slip::<P>() * (r / friction.normal)
    });
    step.end(law) * (-friction.normal / step.alpha)
}

fn at_point<const P: usize>(
    law: &FrictionLaw<P>,
    z: Vector<P>,
    slip: Vector<P>,
) -> Option<AtPoint> {
    let (speed, r) = (slip.norm(), z.norm() / slip.norm());
    if !(r.is_finite() && r > 0.0) {
        return None;
    }
    let (gauge, gradient) = law.reservoir().gauge_jet(&z);
    let (factor, falls) =
        law.rate().map_or((1.0, 0.0), |rate| (rate.factor(speed), rate.slope(speed)));
    let plain = z / -gauge;
    let by_point = (Matrix::<P>::identity() - z * gradient.transpose() / gauge) * (-factor / gauge);
    let (near, slope) = law.direction().project_jet(&(z + slip * r), &z);
    Some(AtPoint {
        sliding: padded(&(plain * factor)),
        by_point: square(&by_point),
        by_slip: square(&(plain * (slip / speed).transpose() * falls)),
        defect: padded(&(near - z)),
        slope: square(&slope),
        r,
    })
}

/// The components of a slice.
#[inline(always)]
fn vector<const P: usize>(components: &[f64]) -> Vector<P> {
    Vector::from_column_slice(&components[..P])
}

fn padded<const P: usize>(v: &Vector<P>) -> Components {
    std::array::from_fn(|i| if i < P { v[i] } else { 0.0 })
}

fn square<const P: usize>(matrix: &Matrix<P>) -> [Components; 3] {
    std::array::from_fn(|i| {
        std::array::from_fn(|j| if i < P && j < P { matrix[(i, j)] } else { 0.0 })
    })
}

#[cfg(test)]
mod tests;

//! The extended normal cone inclusion, which holds every Coulomb-type law.

use std::sync::OnceLock;

use asperity_set::{
    Ball, Convex, ConvexSet, Form, Matrix, SetError, Star, StarSet, Vector, directions,
    largest_ratio, largest_scale_inside, ratio_in_closed_form,
};

use super::{AmbiguousLoads, Bounds, LawError, Stribeck, WalkTable};

/// The law `γ ∈ N_D(−αλ)`, `α(x) = 1/(k_D(x) − k_C(x) + 1)` at `x = −λ` (\[WL19\] (55), (56)), for
/// unit normal force.
///
/// The scale of *D* is irrelevant to the law but decides the convergence of prox iterations: *D* is
/// kept at the largest scale with `D ⊆ C`.
///
/// ```
/// use asperity::law::FrictionLaw;
/// use asperity::set::{Convex, Ellipse, Star, Superellipse, Vector};
///
/// let reservoir: Star<2> = Superellipse::new(Vector::<2>::new(0.54, 0.46), 2.9)?.into();
/// let direction: Convex<2> = Ellipse::new(Vector::<2>::new(3.0, 2.0))?.into();
/// let law = FrictionLaw::new(reservoir, direction)?;
/// let slip = Vector::<2>::new(1.0, 1.0);
/// let force = law.force(&slip, 9.3)?;
/// // Sliding dissipates, and the force tells the direction of the slip.
/// assert!(law.dissipation(&slip, 9.3) > 0.0);
/// assert!((law.slip_direction(&force, 9.3, 1e-9)? - slip.normalize()).norm() < 1e-12);
/// # Ok::<(), asperity::law::LawError>(())
/// ```
#[derive(Debug)]
pub struct FrictionLaw<const P: usize> {
    reservoir: Star<P>,
    direction: Convex<P>,
    direction_scale: f64,
    associated: bool,
    rate: Option<Stribeck>,
    /// Coefficient of isotropic friction.
    isotropic: Option<f64>,
    searched: Searched,
}

/// What takes a search over the boundaries, made when it is first needed: most runs need none of it.
#[derive(Debug, Default)]
struct Searched {
    alpha_min: OnceLock<f64>,
    bounds: OnceLock<Bounds>,
    table: OnceLock<Box<WalkTable>>,
    ambiguous: OnceLock<Box<AmbiguousLoads>>,
}

/// The boundary of a direction set as a table; of isotropic laws, that of the unit disk.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Walk<'a> {
    pub table: &'a WalkTable,
    pub direction: &'a Convex<2>,
}

impl<const P: usize> PartialEq for FrictionLaw<P> {
    fn eq(&self, other: &Self) -> bool {
        self.reservoir == other.reservoir
            && self.direction == other.direction
            && self.rate == other.rate
    }
}

impl<const P: usize> FrictionLaw<P> {
    /// The law with reservoir `C` and direction set `D`; `D` is rescaled to the largest set inside `C`.
    ///
    /// # Errors
    ///
    /// [`LawError::Set`] if a set of a user is flat, unbounded or undefined in some direction, or if the scale of `D`
    /// is none that a set may have.
    pub fn new(reservoir: Star<P>, direction: Convex<P>) -> Result<Self, LawError> {
        check_size("reservoir", &reservoir)?;
        check_size("direction", &direction)?;
        if reservoir.as_convex() == Some(&direction) {
            return Ok(Self::associated(direction));
        }
        let mut scale = largest_scale_inside(&direction, &reservoir);
        if !(scale.is_finite() && scale > 0.0) {
            return Err(SetError::Degenerate { argument: "reservoir", gauge: 1.0 / scale }.into());
        }
        // Already normalised up to rounding: leave every bit as it is.
        if (scale - 1.0).abs() < 1e-12 {
            scale = 1.0;
        }
        let direction = if scale == 1.0 { direction } else { direction.scaled(scale)? };
        if let Some(same) = reservoir.as_convex().filter(|c| are_equal(&direction, *c)) {
            // D = aC up to rounding is the associated law.
            return Ok(Self { direction_scale: scale, ..Self::associated(same.clone()) });
        }
        Ok(Self {
            reservoir,
            direction,
            direction_scale: scale,
            associated: false,
            rate: None,
            isotropic: None,
            searched: Searched::default(),
        })
    }

    /// The associated law `D = C` (\[WL19\] Def. 12): maximal dissipation, maximal monotone.
    pub fn associated(reservoir: Convex<P>) -> Self {
        let isotropic = match &reservoir {
            Convex::Ball(ball) => Some(ball.size()),
            _ => None,
        };
        Self {
            isotropic,
            reservoir: Star::Convex(reservoir.clone()),
            direction: reservoir,
            direction_scale: 1.0,
            associated: true,
            rate: None,
            searched: Searched::default(),
        }
    }

    /// The collinear law (\[WL19\] Def. 15): `D` is a ball, the force opposes the sliding velocity.
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new).
    pub fn collinear(reservoir: Star<P>) -> Result<Self, LawError> {
        Self::new(reservoir, Ball::new(1.0)?.into())
    }

    /// Isotropic Coulomb friction (\[WL19\] (33)).
    ///
    /// # Errors
    ///
    /// [`LawError::Set`] if `mu` is not finite and positive.
    pub fn isotropic(mu: f64) -> Result<Self, LawError> {
        Ok(Self::associated(Ball::new(mu)?.into()))
    }

    /// The same law that holds this set as *D*, which is its own up to rounding: for callers that keep a value of *D*
    /// which they have scaled themselves by [`direction_scale`](Self::direction_scale).
    ///
    /// # Errors
    ///
    /// [`LawError::Set`] if the set is another one.
    pub fn with_direction(&self, direction: Convex<P>) -> Result<Self, LawError> {
        const SAME: f64 = 1e-9;
        let near = |d: &Vector<P>| {
            let own = self.direction.gauge(d);
            (direction.gauge(d) - own).abs() <= SAME * own
        };
        if !directions(12).iter().all(near) {
            let message = "must be the direction set of the law".into();
            return Err(SetError::Shape { argument: "direction", message }.into());
        }
        Ok(Self {
            reservoir: self.reservoir.clone(),
            direction,
            direction_scale: 1.0,
            associated: self.associated,
            rate: self.rate,
            isotropic: self.isotropic,
            searched: Searched::default(),
        })
    }

    /// The law whose force in slip is multiplied by a factor of the sliding speed; in stick all of `C`
    /// stays admissible.
    pub fn with_rate(self, rate: Stribeck) -> Self {
        Self { rate: Some(rate), ..self }
    }

    /// The factor of the sliding speed, if there is one.
    pub fn rate(&self) -> Option<&Stribeck> {
        self.rate.as_ref()
    }

    /// Whether the direction set is the reservoir.
    #[inline]
    pub fn is_associated(&self) -> bool {
        self.associated
    }

    /// The coefficient, if the law is isotropic Coulomb friction.
    pub fn isotropic_coefficient(&self) -> Option<f64> {
        self.isotropic
    }

    /// Force reservoir `C` per unit normal force.
    pub fn reservoir(&self) -> &Star<P> {
        &self.reservoir
    }

    /// Direction set `D`, the largest inside `C`.
    pub fn direction(&self) -> &Convex<P> {
        &self.direction
    }

    /// The factor by which the direction set was scaled.
    pub fn direction_scale(&self) -> f64 {
        self.direction_scale
    }

    /// `min r_D/r_C` over all directions: prox iterations are slow where it is small.
    pub fn alpha_min(&self) -> f64 {
        if self.associated {
            return 1.0;
        }
        let search = || 1.0 / largest_ratio(&self.direction, &self.reservoir).0;
        *self.searched.alpha_min.get_or_init(search)
    }

    /// `α(x) = 1/(k_D(x) − k_C(x) + 1)` (\[WL19\] (56)).
    pub fn alpha(&self, x: &Vector<P>) -> f64 {
        self.alpha_at(x)
    }

    /// The same within the loops of solvers and measures.
    #[inline(always)]
    pub(crate) fn alpha_at(&self, x: &Vector<P>) -> f64 {
        1.0 / (self.direction.gauge(x) - self.reservoir.gauge(x) + 1.0)
    }

    /// Friction force λ while sliding with `slip` γ: `−λ = λ_N z/k_C(z)`, `z = ∇Ψ*_D(γ)`
    /// (\[WL19\] (84)), times the factor of the speed.
    ///
    /// # Errors
    ///
    /// [`LawError::AtRest`] for `γ = 0`, [`LawError::Set`] if an argument is not finite.
    pub fn force(&self, slip: &Vector<P>, normal_force: f64) -> Result<Vector<P>, LawError> {
        // Only the direction counts; scaled, tiny slips do not underflow.
        let size = size_of_slip(slip, normal_force)?;
        let z = self.direction.support_point(&(slip / size));
        let factor = self.rate.map_or(1.0, |rate| rate.factor(slip.norm()));
        Ok(z * (-normal_force * factor / self.reservoir.gauge(&z)))
    }

    /// Unit sliding direction that goes with the friction force λ, or zero where it sticks.
    ///
    /// Forces within `tolerance` of the reservoir's boundary count as sliding.
    ///
    /// # Errors
    ///
    /// [`LawError::OutsideReservoir`] if the contact cannot transmit the force, [`LawError::SpeedUnknown`] for a law
    /// with a factor of the speed, [`LawError::Set`] if a force is not finite or the normal force not positive.
    pub fn slip_direction(
        &self,
        force: &Vector<P>,
        normal_force: f64,
        tolerance: f64,
    ) -> Result<Vector<P>, LawError> {
        if !(normal_force.is_finite() && normal_force > 0.0) {
            let (argument, allowed) = ("normal_force", "finite and positive");
            return Err(SetError::Parameter { argument, allowed, value: normal_force }.into());
        }
        if self.rate.is_some() {
            return Err(LawError::SpeedUnknown);
        }
        if let Some(&value) = force.iter().find(|v| !v.is_finite()) {
            let (argument, allowed) = ("force", "finite");
            return Err(SetError::Parameter { argument, allowed, value }.into());
        }
        let x = -force / normal_force;
        let gauge = self.reservoir.gauge(&x);
        if gauge < 1.0 - tolerance {
            return Ok(Vector::zeros());
        }
        // The comparison also turns away NaN.
        if !(gauge <= 1.0 + tolerance) {
            return Err(LawError::OutsideReservoir { gauge });
        }
        Ok(self.direction.normal(&x).normalize())
    }

    /// `∂λ/∂γ` while sliding: `−λ_N/k_C(z) (I − z∇k_C(z)ᵀ/k_C(z)) ∇²Ψ*_D(γ)` (\[WL19\] (87), (88)), and
    /// with a factor `f` of the speed `f` times that and `f′/f λ γᵀ/‖γ‖`. Infinite where *D* is flat.
    ///
    /// # Errors
    ///
    /// As [`force`](Self::force), and [`LawError::Set`] if the slip is so small that the answer is beyond the range of
    /// numbers.
    pub fn jacobian(&self, slip: &Vector<P>, normal_force: f64) -> Result<Matrix<P>, LawError> {
        let size = size_of_slip(slip, normal_force)?;
        let (z, hessian) = self.direction.support_jet(&(slip / size));
        let (gauge, gradient) = self.reservoir.gauge_jet(&z);
        let across = Matrix::identity() - z * gradient.transpose() / gauge;
        // In this order tiny slips lose no digits.
        let factor = -normal_force / gauge / size;
        let plain = if hessian.iter().all(|v| v.is_finite()) {
            let plain = across * hessian * factor;
            if !plain.iter().all(|v| v.is_finite()) {
                return Err(SetError::Range { argument: "slip", excess: "small" }.into());
            }
            plain
        } else {
            jump(&across, &(slip / size), factor)
        };
        Ok(self.rate.map_or(plain, |rate| {
            let speed = slip.norm();
            let falling = z * (-normal_force / gauge) * (slip / speed).transpose();
            plain * rate.factor(speed) + falling * rate.slope(speed)
        }))
    }

    /// Dissipation rate `−λᵀγ = λ_N Ψ*_D(γ)/k_C(z)` (\[WL19\] Prop. 5), zero at rest; not a number where an argument is
    /// none.
    pub fn dissipation(&self, slip: &Vector<P>, normal_force: f64) -> f64 {
        match self.force(slip, normal_force) {
            Ok(force) => -force.dot(slip),
            Err(LawError::AtRest) => 0.0,
            Err(_) => f64::NAN,
        }
    }
}

impl FrictionLaw<1> {
    /// Largest radius of `C`.
    pub(crate) fn largest_radius(&self) -> f64 {
        let radius = |end: f64| 1.0 / self.reservoir.gauge(&Vector::<1>::new(end));
        f64::max(radius(-1.0), radius(1.0))
    }
}

impl FrictionLaw<2> {
    /// The law turned counter-clockwise by `angle` in rad.
    ///
    /// # Errors
    ///
    /// [`LawError::Set`] if the angle is not finite.
    pub fn rotated(&self, angle: f64) -> Result<Self, LawError> {
        let turned = Self::new(self.reservoir.rotated(angle)?, self.direction.rotated(angle)?)?;
        Ok(Self { rate: self.rate, ..turned })
    }

    /// Bounds over the boundaries of both sets.
    #[inline]
    pub(crate) fn bounds(&self) -> Bounds {
        match self.isotropic {
            Some(mu) => Bounds::isotropic(mu),
            None => *self.searched.bounds.get_or_init(|| self.searched_bounds()),
        }
    }

    #[cold]
    fn searched_bounds(&self) -> Bounds {
        Bounds::of_smooth_sets(&self.reservoir, &self.direction)
            .unwrap_or_else(|| self.table().bounds(&self.direction))
    }

    /// The table of the exact one-contact solver.
    pub(crate) fn table(&self) -> &WalkTable {
        let make = || Box::new(WalkTable::new(&self.reservoir, &self.direction));
        self.searched.table.get_or_init(make)
    }

    /// Whether a load `y = c₀/a` with gauge `k_C(y)` may have several solutions with `A = aI`.
    #[inline]
    pub(crate) fn may_be_ambiguous(&self, load: &Vector<2>, gauge: f64) -> bool {
        self.ambiguous_loads().may_hold(load, gauge)
    }

    /// The loads that may have several solutions with `A = aI`.
    #[inline]
    pub(crate) fn ambiguous_loads(&self) -> &AmbiguousLoads {
        let (reservoir, direction) = (&self.reservoir, &self.direction);
        let make = || Box::new(AmbiguousLoads::new(&self.table().nodes, reservoir, direction));
        self.searched.ambiguous.get_or_init(make)
    }

    /// What the exact one-contact solver walks along; isotropic laws share one walk.
    pub(crate) fn walk(&self) -> Walk<'_> {
        if self.isotropic.is_none() {
            return Walk { table: self.table(), direction: &self.direction };
        }
        static UNIT: OnceLock<(Convex<2>, WalkTable)> = OnceLock::new();
        let (direction, table) = UNIT.get_or_init(|| {
            let disk = Convex::Ball(Ball::UNIT);
            let table = WalkTable::new(&Star::Convex(disk.clone()), &disk);
            (disk, table)
        });
        Walk { table, direction }
    }
}

/// The largest component of a slip velocity, of which the law has an answer.
#[inline]
fn size_of_slip<const P: usize>(slip: &Vector<P>, normal_force: f64) -> Result<f64, LawError> {
    let refuse = |argument, value| {
        let allowed = "finite";
        Err(SetError::Parameter { argument, allowed, value }.into())
    };
    let (mut size, mut sum) = (0.0, 0.0);
    for component in slip.iter().map(|v| v.abs()) {
        size = f64::max(size, component);
        sum += component;
    }
    if size == 0.0 && sum == 0.0 {
        return Err(LawError::AtRest);
    }
    // The sum of numbers that are finite may be infinite, but is a number.
    if sum.is_nan() || size.is_infinite() {
        return refuse("slip", if sum.is_nan() { sum } else { size });
    }
    if !normal_force.is_finite() {
        return refuse("normal_force", normal_force);
    }
    Ok(size)
}

/// `across ∇²h factor` where the curvature of a planar *D* vanishes and `∇²h = ∞ t tᵀ`; not a number in other dimensions.
fn jump<const P: usize>(across: &Matrix<P>, slip: &Vector<P>, factor: f64) -> Matrix<P> {
    if P != 2 {
        return Matrix::repeat(f64::NAN);
    }
    let n = slip.normalize();
    let tangent = Vector::<P>::from_fn(|i, _| if i == 0 { -n[1] } else { n[0] });
    let dyad = across * tangent * tangent.transpose() * factor;
    dyad.map(|entry| if entry.abs() <= 1e-14 * factor.abs() { 0.0 } else { entry * f64::INFINITY })
}

/// Directions along which sizes are compared.
fn probes<const P: usize>() -> Vec<Vector<P>> {
    directions(if P == 3 { 500 } else { 1440 })
}

/// Refuses a set that a user's gauge makes flat, unbounded or undefined in some direction; closed forms never are.
fn check_size<const P: usize>(
    argument: &'static str,
    set: &dyn StarSet<P>,
) -> Result<(), SetError> {
    if has_closed_form(set) {
        return Ok(());
    }
    match probes().iter().map(|d| set.gauge(d)).find(|&k| !(k.is_finite() && k > 0.0)) {
        Some(gauge) => Err(SetError::Degenerate { argument, gauge }),
        None => Ok(()),
    }
}

fn has_closed_form<const P: usize>(set: &dyn StarSet<P>) -> bool {
    match set.form() {
        Form::Ellipsoid { .. } | Form::Powers { .. } => true,
        Form::Image { of, .. } => has_closed_form(of),
        _ => false,
    }
}

/// Whether two sets are the same up to rounding, the one inside the other.
fn are_equal<const P: usize>(inner: &Convex<P>, outer: &Convex<P>) -> bool {
    const ROUNDING: f64 = 1e-13;
    if let Some((ratio, _)) = ratio_in_closed_form(inner, outer) {
        return ratio - 1.0 <= ROUNDING;
    }
    let close = |x: f64, y: f64| (x - y).abs() <= ROUNDING * x.abs();
    let same = |d: &Vector<P>| {
        close(inner.gauge(d), outer.gauge(d)) && close(inner.support(d), outer.support(d))
    };
    // Most are told apart in the first direction.
    let first = Vector::repeat(1.0);
    same(&first) && probes::<P>().iter().all(same)
}

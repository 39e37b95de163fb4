//! What the laws say for unit normal force, whatever their dimension; unused components are zero.

use asperity_set::{Convex, ConvexSet, Matrix, Star, StarSet, Vector};

use crate::law::{FrictionLaw, Law};

type Components = [f64; 3];

/// λ while sliding with `slip` and unit normal force; none at rest.
pub(crate) fn sliding(law: &Law, slip: &Components) -> Option<Components> {
    match law {
        Law::One(law) => sliding_in(law, slip),
        Law::Two(law) => sliding_in(law, slip),
        Law::Three(law) => sliding_in(law, slip),
    }
}

fn sliding_in<const P: usize>(law: &FrictionLaw<P>, slip: &Components) -> Option<Components> {
    law.force(&cut(slip), 1.0).ok().map(|force| padded(&force))
}

/// ∂λ/∂γ for unit normal force, row by row; zero where it does not exist.
pub(crate) fn jacobian(law: &Law, slip: &Components) -> [Components; 3] {
    match law {
        Law::One(law) => jacobian_in(law, slip),
        Law::Two(law) => jacobian_in(law, slip),
        Law::Three(law) => jacobian_in(law, slip),
    }
}

fn jacobian_in<const P: usize>(law: &FrictionLaw<P>, slip: &Components) -> [Components; 3] {
    let mut out = [[0.0; 3]; 3];
    let matrix = law.jacobian(&cut(slip), 1.0).unwrap_or_else(|_| Matrix::<P>::zeros());
    for i in 0..P {
        for j in 0..P {
            let entry = matrix[(i, j)];
            out[i][j] = if entry.is_finite() { entry } else { 0.0 };
        }
    }
    out
}

/// `k_C(−λ)`.
pub(crate) fn gauge(law: &Law, force: &Components) -> f64 {
    fn of<const P: usize>(reservoir: &Star<P>, force: &Components) -> f64 {
        reservoir.gauge(&-cut::<P>(force))
    }
    match law {
        Law::One(law) => of(law.reservoir(), force),
        Law::Two(law) => of(law.reservoir(), force),
        Law::Three(law) => of(law.reservoir(), force),
    }
}

/// The sliding direction that goes with a force on the boundary of the reservoir: the normal of *D*.
pub(crate) fn direction(law: &Law, force: &Components) -> Components {
    fn of<const P: usize>(direction: &Convex<P>, force: &Components) -> Components {
        let normal = direction.gauge_jet(&-cut::<P>(force)).1;
        padded(&normal.try_normalize(0.0).unwrap_or_else(Vector::zeros))
    }
    match law {
        Law::One(law) => of(law.direction(), force),
        Law::Two(law) => of(law.direction(), force),
        Law::Three(law) => of(law.direction(), force),
    }
}

/// Whether the force is a smooth function of the sliding direction, with slopes of one size in all directions.
pub(crate) fn is_smooth(law: &Law) -> bool {
    fn of<const P: usize>(direction: &Convex<P>) -> bool {
        matches!(direction, Convex::Ball(_) | Convex::Ellipsoid(_))
    }
    match law {
        Law::One(_) => true,
        Law::Two(law) => of(law.direction()),
        Law::Three(law) => of(law.direction()),
    }
}

/// The point `z` of the boundary of *D* that goes with a sliding force λ.
pub(crate) fn point(law: &Law, sliding: &Components) -> Components {
    fn of<const P: usize>(direction: &Convex<P>, sliding: &Components) -> Components {
        let x = -cut::<P>(sliding);
        let gauge = direction.gauge(&x);
        padded(&if gauge > 0.0 { x / gauge } else { x })
    }
    match law {
        Law::One(law) => of(law.direction(), sliding),
        Law::Two(law) => of(law.direction(), sliding),
        Law::Three(law) => of(law.direction(), sliding),
    }
}

/// λ for unit normal force from the point `z` of *D* in place of the sliding direction, with its derivatives.
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

/// What the law says with `z` and γ as unknowns of their own; none at rest.
pub(crate) fn at_point(law: &Law, z: &Components, slip: &Components) -> Option<AtPoint> {
    match law {
        Law::One(law) => at_point_in(law, z, slip),
        Law::Two(law) => at_point_in(law, z, slip),
        Law::Three(law) => at_point_in(law, z, slip),
    }
}

fn at_point_in<const P: usize>(
    law: &FrictionLaw<P>,
    z: &Components,
    slip: &Components,
) -> Option<AtPoint> {
    let (z, slip) = (cut::<P>(z), cut::<P>(slip));
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

fn square<const P: usize>(matrix: &Matrix<P>) -> [Components; 3] {
    std::array::from_fn(|i| {
        std::array::from_fn(|j| if i < P && j < P { matrix[(i, j)] } else { 0.0 })
    })
}

fn cut<const P: usize>(v: &Components) -> Vector<P> {
    Vector::from_fn(|i, _| v[i])
}

fn padded<const P: usize>(v: &Vector<P>) -> Components {
    std::array::from_fn(|i| if i < P { v[i] } else { 0.0 })
}

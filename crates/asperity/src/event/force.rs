//! What the laws say for unit normal force, whatever their dimension; unused components are zero.

pub(super) use crate::law::AtPoint;
use crate::law::{Components, Law};

/// λ while sliding with `slip` and unit normal force; none at rest.
pub(super) fn sliding(law: &Law, slip: &Components) -> Option<Components> {
    law.sliding(slip)
}

/// ∂λ/∂γ for unit normal force, row by row; zero where it does not exist.
pub(super) fn jacobian(law: &Law, slip: &Components) -> [Components; 3] {
    let finite = |entry: f64| if entry.is_finite() { entry } else { 0.0 };
    law.jacobian(slip, 1.0).unwrap_or_default().map(|row| row.map(finite))
}

/// `k_C(−λ)`.
pub(super) fn gauge(law: &Law, force: &Components) -> f64 {
    law.gauge(&force.map(|f| -f))
}

/// The sliding direction that goes with a force on the boundary of the reservoir: the normal of *D*.
pub(super) fn direction(law: &Law, force: &Components) -> Components {
    law.normal(force)
}

/// Whether the force is a smooth function of the sliding direction, with slopes of one size in all directions.
pub(super) fn is_smooth(law: &Law) -> bool {
    law.is_smooth()
}

/// The point `z` of the boundary of *D* that goes with a sliding force λ.
pub(super) fn point(law: &Law, sliding: &Components) -> Components {
    law.direction_point(sliding)
}

/// What the law says with `z` and γ as unknowns of their own; none at rest.
pub(super) fn at_point(law: &Law, z: &Components, slip: &Components) -> Option<AtPoint> {
    law.at_point(z, slip)
}

/// The length of a vector.
pub(super) fn norm(v: &Components) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

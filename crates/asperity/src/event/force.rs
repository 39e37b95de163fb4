//! What the laws say for unit normal force, whatever their dimension; unused components are zero.

use asperity_set::{Convex, Matrix, Star, StarSet, Vector};

use crate::law::{FrictionLaw, Law};

type Components = [f64; 3];

/// λ while sliding with `slip` and unit normal force; none at rest.
pub(super) fn sliding(law: &Law, slip: &Components) -> Option<Components> {
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
pub(super) fn jacobian(law: &Law, slip: &Components) -> [Components; 3] {
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
pub(super) fn gauge(law: &Law, force: &Components) -> f64 {
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
pub(super) fn direction(law: &Law, force: &Components) -> Components {
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

/// The length of a vector.
pub(super) fn norm(v: &Components) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn cut<const P: usize>(v: &Components) -> Vector<P> {
    Vector::from_fn(|i, _| v[i])
}

fn padded<const P: usize>(v: &Vector<P>) -> Components {
    std::array::from_fn(|i| if i < P { v[i] } else { 0.0 })
}

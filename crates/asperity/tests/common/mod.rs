//! Random contact problems and the laws they are tested with.
#![allow(dead_code)] // Every test binary uses its own part.

pub mod random;

use std::f64::consts::PI;

use asperity::contact::{ContactProblem, NormalForce};
use asperity::law::{FrictionLaw, Law, flow_sets};
use asperity::set::{
    Ball, CappedRectangle, Convex, Cuboid, Ellipse, PolarCurve, Polygon, Star, Superellipse,
    SupportCurve, Vector, WedgeAsperity,
};
use nalgebra::DMatrix;
pub use random::Random;

pub type V = Vector<2>;

fn ellipse(a: f64, b: f64, degrees: f64) -> Convex<2> {
    let ellipse = Convex::from(Ellipse::new(V::new(a, b)).unwrap());
    ellipse.rotated(degrees.to_radians()).unwrap()
}

fn rectangle(a: f64, b: f64, degrees: f64) -> Convex<2> {
    let rectangle = Convex::from(Cuboid::symmetric(V::new(a, b)).unwrap());
    rectangle.rotated(degrees.to_radians()).unwrap()
}

fn superellipse(a: f64, b: f64, s: f64, degrees: f64) -> Star<2> {
    let set = Star::from(Superellipse::new(V::new(a, b), s).unwrap());
    set.rotated(degrees.to_radians()).unwrap()
}

fn convex(set: Star<2>) -> Convex<2> {
    set.as_convex().unwrap().clone()
}

/// Laws of every kind: associated, collinear, extended; smooth, with flats, with corners, with cusps.
pub fn laws() -> Vec<(&'static str, FrictionLaw<2>)> {
    let extended = |c: Star<2>, d: Convex<2>| FrictionLaw::new(c, d).unwrap();
    let smooth = |s, degrees| superellipse(0.5, 0.3, s, degrees);
    vec![
        ("isotropic", FrictionLaw::isotropic(0.4).unwrap()),
        ("ellipse 3:1", FrictionLaw::associated(ellipse(0.6, 0.2, 0.0))),
        ("ellipses 3:1 at 30°", extended(ellipse(0.6, 0.2, 30.0).into(), ellipse(3.0, 1.0, 0.0))),
        (
            "Table 1",
            extended(
                superellipse(0.5366, 0.4570, 2.94, 0.0),
                convex(superellipse(1.84, 1.19, 2.51, 0.0)),
            ),
        ),
        ("superellipse 1.2", FrictionLaw::associated(convex(smooth(1.2, 0.0)))),
        ("superellipse 20", FrictionLaw::associated(convex(smooth(20.0, 0.0)))),
        ("C 1.2 at 20°, D 20", extended(smooth(1.2, 20.0), convex(smooth(20.0, 0.0)))),
        ("C 20 at 30°, D 1.2", extended(smooth(20.0, 30.0), convex(smooth(1.2, 0.0)))),
        ("rectangle", FrictionLaw::associated(rectangle(0.5, 0.3, 0.0))),
        ("rectangles at 30°", extended(rectangle(0.5, 0.3, 30.0).into(), rectangle(0.5, 0.3, 0.0))),
        (
            "C rectangle at 30°, D ellipse",
            extended(rectangle(0.5, 0.3, 30.0).into(), ellipse(3.0, 1.0, 0.0)),
        ),
        ("rhombus", FrictionLaw::associated(convex(smooth(1.0, 10.0)))),
        ("collinear, C star-shaped", FrictionLaw::collinear(smooth(0.7, 15.0)).unwrap()),
        (
            "C disk, D rectangle",
            extended(Convex::from(Ball::new(0.4).unwrap()).into(), rectangle(0.5, 0.3, 25.0)),
        ),
        (
            "C ellipse, D rectangle",
            extended(ellipse(1.0, 0.4, 28.6).into(), rectangle(1.0, 0.4, 0.0)),
        ),
        (
            "C rectangle, D superellipse 100",
            extended(rectangle(1.0, 0.2, 40.0).into(), convex(superellipse(1.0, 0.4, 100.0, 0.0))),
        ),
        ("thin ellipses", extended(ellipse(1.0, 0.01, 28.6).into(), ellipse(1.0, 0.01, 0.0))),
        ("C 0.5, D ellipse", extended(superellipse(1.0, 0.5, 0.5, 23.0), ellipse(1.0, 0.2, 0.0))),
        ("thin D", extended(ellipse(1.0, 0.3, 28.6).into(), ellipse(1.0, 1e-3, 0.0))),
        (
            "asperity 36°",
            extended(
                WedgeAsperity::new(1.2, 0.2 * PI).unwrap().into(),
                ellipse(1.0, (0.2 * PI).cos(), 0.0),
            ),
        ),
        ("bobsleigh", FrictionLaw::associated(CappedRectangle::new(0.3, 0.1, 0.1).unwrap().into())),
        (
            "C polygon, D sum",
            extended(
                Polygon::new(
                    &[(0.5, 0.0), (0.2, 0.2), (0.1, 0.5), (-0.4, 0.1), (-0.1, -0.3)]
                        .map(|(x, y)| V::new(x, y)),
                )
                .unwrap()
                .into(),
                convex(
                    Star::minkowski_sum(
                        &[ellipse(1.0, 0.3, 20.0), rectangle(0.4, 0.2, 0.0)].map(Star::Convex),
                    )
                    .unwrap(),
                ),
            ),
        ),
        ("measured", measured()),
        // Its sides are so long that rays in many directions meet no other part of it.
        (
            "C ellipse, D runner",
            extended(
                ellipse(0.6, 0.3, 20.0).into(),
                CappedRectangle::new(2.6, 0.1, 0.9).unwrap().into(),
            ),
        ),
    ]
}

/// Table 1 at 36 directions.
fn measured() -> FrictionLaw<2> {
    let direction = convex(superellipse(1.84, 1.19, 2.51, 0.0));
    let exact = FrictionLaw::new(superellipse(0.5366, 0.4570, 2.94, 0.0), direction).unwrap();
    let phi: Vec<f64> = (0..36).map(|k| PI * f64::from(k) / 18.0).collect();
    let force: Vec<V> =
        phi.iter().map(|a| -exact.force(&V::new(a.cos(), a.sin()), 1.0).unwrap()).collect();
    let sets = flow_sets(&phi, &force, 0.1, 0.1).unwrap();
    let reservoir = PolarCurve::new(&sets.theta, &sets.radius).unwrap();
    let direction = SupportCurve::new(&sets.phi, &sets.support).unwrap();
    FrictionLaw::new(reservoir.into(), direction.into()).unwrap()
}

/// How the Delassus block of a random one-contact problem is made.
#[derive(Debug, Clone, Copy)]
pub enum Family {
    /// Prescribed normal percussion, `G = I`.
    Plain,
    /// A rigid body touched at a random lever arm.
    RigidBody,
    /// A random Gram matrix, slightly unsymmetric.
    Gram,
}

pub const FAMILIES: [Family; 3] = [Family::Plain, Family::RigidBody, Family::Gram];

/// A random problem of one contact.
pub fn one_contact(law: Law, family: Family, random: &mut Random) -> ContactProblem {
    match family {
        Family::Plain => {
            let free = vec![random.within(-1.5, 1.5), random.within(-1.5, 1.5)];
            let contacts = [(law, NormalForce::Prescribed(1.0))];
            ContactProblem::new(DMatrix::identity(2, 2), free, contacts).unwrap()
        }
        _ => {
            let delassus = match family {
                Family::RigidBody => rigid_body(random),
                _ => gram(3, 5, random) + DMatrix::from_fn(3, 3, |_, _| 1e-3 * random.normal()),
            };
            let pressed = if random.unit() < 0.8 { -1.0 } else { 1.0 };
            let free =
                vec![pressed * random.unit(), random.within(-1.0, 1.0), random.within(-1.0, 1.0)];
            ContactProblem::new(delassus, free, [(law, NormalForce::Unilateral)]).unwrap()
        }
    }
}

/// `1/m I + [r]ᵀ Θ⁻¹ [r]` with the cross-product matrix of a random lever arm.
fn rigid_body(random: &mut Random) -> DMatrix<f64> {
    let r = [0.7 * random.normal(), 0.7 * random.normal(), 0.7 * random.normal()];
    let lever =
        DMatrix::from_row_slice(3, 3, &[0.0, -r[2], r[1], r[2], 0.0, -r[0], -r[1], r[0], 0.0]);
    DMatrix::identity(3, 3) + lever.transpose() * lever
}

/// `AᵀA/m` with a random `m × n` matrix.
pub fn gram(n: usize, m: usize, random: &mut Random) -> DMatrix<f64> {
    let a = DMatrix::from_fn(m, n, |_, _| random.normal());
    a.transpose() * a / m as f64
}

//! Star-shaped and convex sets in one, two and three dimensions.
//!
//! Friction laws are made of two sets (the force reservoir *C* and the direction set *D*); this crate
//! knows their geometry and nothing of mechanics. A star-shaped set is its **gauge**
//! `k(x) = inf{s > 0 : x ∈ sC}`; a convex one has a **support function** `h(y) = sup{xᵀy : x ∈ C}`
//! besides. [`StarSet`] and [`ConvexSet`] ask for one method each and provide the rest.
//!
//! ```
//! use asperity_set::{Convex, ConvexSet, Ellipse, StarSet, Vector};
//!
//! let ellipse = Ellipse::new(Vector::<2>::new(3.0, 1.0))?;
//! assert_eq!(ellipse.gauge(&Vector::<2>::new(6.0, 0.0)), 2.0);
//! let rotated = Convex::from(ellipse).rotated(std::f64::consts::FRAC_PI_2)?;
//! assert!((rotated.support(&Vector::<2>::new(0.0, 1.0)) - 3.0).abs() < 1e-15);
//! # Ok::<(), asperity_set::SetError>(())
//! ```
//!
//! The definitions are those of Walker & Leine (2019), §2.1, cited as \[WL19\].
//!
//! With the feature `serde`, [`Star`] and [`Convex`] are data: `{ type = "Ellipse", a = 0.54, b = 0.48 }`.
#![deny(missing_docs, clippy::missing_errors_doc)]

mod any;
mod ball;
mod boundary;
mod capped;
mod checked;
mod combine;
mod cone;
mod contensou;
mod convex;
mod cuboid;
mod curve;
mod cyclic;
#[cfg(feature = "serde")]
pub mod data;
mod ellipsoid;
mod error;
mod from;
mod image;
mod inside;
mod planar;
mod plane;
mod polar;
mod polar_curve;
mod polygon;
mod project;
mod root;
mod star;
mod superellipsoid;
mod support_curve;
mod verdict;
mod wedge;

pub use any::{Convex, CustomConvex, CustomStar, Star};
pub use ball::{Ball, Disk};
pub use boundary::{Arc, BoundaryPoint, Side};
pub use capped::CappedRectangle;
pub use checked::Checked;
pub use combine::{Intersection, MinkowskiSum, Union};
pub use cone::{Cone, tangent_cone};
pub use contensou::{CoulombContensou, Pressure};
pub use convex::ConvexSet;
pub use cuboid::{Cuboid, Interval};
pub use ellipsoid::{Ellipse, Ellipsoid};
pub use error::SetError;
pub use image::Image;
pub use inside::{directions, largest_ratio, largest_ratio_unless, largest_scale_inside};
pub use planar::Planar;
pub use plane::Embedded;
pub use polar_curve::PolarCurve;
pub use polygon::{OutlineFault, Polygon};
pub use star::StarSet;
pub use superellipsoid::{Superellipse, Superellipsoid};
pub use support_curve::SupportCurve;
pub use verdict::{
    Cancelled, Verdict, convexity, convexity_unless, star_shape, strict_convexity,
    strict_convexity_unless, symmetry, symmetry_unless,
};
pub use wedge::WedgeAsperity;

/// A point of R^P.
pub type Vector<const P: usize> = nalgebra::SVector<f64, P>;
/// A linear map of R^P.
pub type Matrix<const P: usize> = nalgebra::SMatrix<f64, P, P>;

/// The vector `value · eᵢ`.
fn along<const P: usize>(i: usize, value: f64) -> Vector<P> {
    let mut vector = Vector::zeros();
    vector[i] = value;
    vector
}

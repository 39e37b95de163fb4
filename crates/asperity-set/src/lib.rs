//! Star-shaped and convex sets in one, two and three dimensions.
//!
//! Friction laws are made of two sets (the force reservoir *C* and the direction set *D*); this crate
//! knows their geometry and nothing of mechanics. A star-shaped set is its **gauge**
//! `k(x) = inf{s > 0 : x ∈ sC}`; a convex one has a **support function** `h(y) = sup{xᵀy : x ∈ C}`
//! besides. [`StarSet`] asks for its gauge, [`ConvexSet`] for nothing more; both provide the rest.
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
mod combine;
mod cone;
mod convex;
#[cfg(feature = "serde")]
pub mod data;
mod error;
mod from;
mod numeric;
mod project;
mod questions;
mod shapes;
mod star;

pub use any::{Convex, CustomConvex, CustomStar, Star};
pub use combine::{Image, Intersection, MinkowskiSum, Union};
pub use cone::Cone;
pub use convex::ConvexSet;
pub use error::SetError;
// For the splines of `asperity`, not part of the geometry.
#[doc(hidden)]
pub use numeric::Cyclic;
pub use numeric::{Arc, BoundaryPoint, Side, directions};
pub use questions::{
    Cancelled, Checked, TurningDirections, Verdict, convexity, convexity_unless, largest_ratio,
    largest_ratio_unless, largest_scale_inside, ratio_in_closed_form, star_shape, strict_convexity,
    strict_convexity_unless, symmetry, symmetry_unless, tangent_cone,
};
pub use shapes::{
    Ball, CappedRectangle, CoulombContensou, Cuboid, Disk, Ellipse, Ellipsoid, Embedded, Interval,
    OutlineFault, Planar, PolarCurve, Polygon, Pressure, Superellipse, Superellipsoid,
    SupportCurve, WedgeAsperity,
};
pub use star::{Form, StarSet};

/// A point of R^P.
pub type Vector<const P: usize> = nalgebra::SVector<f64, P>;
/// A linear map of R^P.
pub type Matrix<const P: usize> = nalgebra::SMatrix<f64, P, P>;

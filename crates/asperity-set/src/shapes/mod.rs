//! The sets with a description of their own, one file each.

mod ball;
mod capped_rectangle;
mod coulomb_contensou;
mod cuboid;
mod ellipsoid;
mod embedded;
mod planar;
mod polar_curve;
mod polygon;
mod superellipsoid;
mod support_curve;
mod wedge_asperity;

pub use ball::{Ball, Disk};
pub use capped_rectangle::CappedRectangle;
pub use coulomb_contensou::{CoulombContensou, Pressure};
pub use cuboid::{Cuboid, Interval};
pub use ellipsoid::{Ellipse, Ellipsoid};
pub use embedded::Embedded;
pub use planar::Planar;
pub use polar_curve::PolarCurve;
pub use polygon::{OutlineFault, Polygon};
pub(crate) use polygon::{distinct, fault};
pub use superellipsoid::{Superellipse, Superellipsoid};
pub use support_curve::SupportCurve;
pub use wedge_asperity::WedgeAsperity;

//! Sets made of sets: linear images, intersections, unions, Minkowski sums.

mod edges;
mod image;
mod intersection;
mod seams;
mod sum;
mod union;

use crate::SetError;

pub use image::Image;
pub use intersection::Intersection;
pub use sum::MinkowskiSum;
pub use union::Union;

/// Gauges and places this close count as equal.
const SAME: f64 = 1e-9;

fn some<S>(sets: &[S]) -> Result<(), SetError> {
    if sets.is_empty() {
        let message = String::from("must hold at least one set");
        return Err(SetError::Shape { argument: "sets", message });
    }
    Ok(())
}

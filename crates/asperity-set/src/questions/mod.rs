//! Questions about sets: tangent cones, one set inside another, verdicts with witnesses, arguments of any size.

mod checked;
mod closed_form;
mod inclusion;
mod peaks;
mod tangent_cone;
mod turning_directions;
mod verdict;

pub use checked::Checked;
pub use closed_form::ratio_in_closed_form;
pub use inclusion::{largest_ratio, largest_ratio_unless, largest_scale_inside};
pub use tangent_cone::tangent_cone;
pub use turning_directions::TurningDirections;
pub use verdict::{
    Verdict, convexity, convexity_unless, star_shape, strict_convexity, strict_convexity_unless,
    symmetry, symmetry_unless,
};

/// Whether a long question is to be given up; asked often, so it should be quick to answer.
pub type Cancelled<'a> = &'a dyn Fn() -> bool;

//! In which of its directions the bodies of a contact can move.

use nalgebra::Vector2;

use super::{ROUNDED, refuse_item};
use crate::argument::ArgumentError;
use crate::law::{FrictionLaw, Law};
use asperity_set::{Convex, Interval, Vector};

/// The rows of an item that percussions move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Freedom {
    /// All of them.
    All,
    /// The normal one, and this direction of the plane of contact: in planar models nothing moves across it.
    Line([f64; 2]),
    /// The same where the bodies slide across it at a speed that nothing changes.
    Across([f64; 2]),
    /// The normal one.
    Normal,
    /// None: what the item transmits is undetermined, and nothing depends on it.
    None,
}

/// The freedom of a contact whose law has `dimension` directions, from the entries `(before, after)` of its own block, of `G` and
/// with the joints that hold it, and from its free velocities with the joints.
pub(super) fn of_contact(
    item: usize,
    dimension: usize,
    own: impl Fn(usize, usize) -> (f64, f64),
    velocity: impl Fn(usize) -> f64,
) -> Result<Freedom, ArgumentError> {
    let largest = (0..dimension.min(2) + 1).map(|a| own(a, a).0).fold(0.0, f64::max);
    let is_dead = |a: usize, scale: f64| {
        let (before, after) = own(a, a);
        after <= ROUNDED * f64::max(before, scale)
    };
    if is_dead(0, largest) {
        return Ok(Freedom::None);
    }
    match dimension {
        0 => Ok(Freedom::All),
        1 if is_dead(1, largest) => Ok(Freedom::Normal),
        1 => Ok(Freedom::All),
        2 => {
            let [a, c, d] = [own(1, 1).1, own(1, 2).1, own(2, 2).1];
            let (mean, half) = (0.5 * (a + d), 0.5 * (a - d));
            let spread = half.hypot(c);
            if mean + spread <= ROUNDED * largest {
                Ok(Freedom::Normal)
            } else if mean - spread > ROUNDED * largest {
                Ok(Freedom::All)
            } else {
                // The eigenvector of the larger eigenvalue, from the row that cancels less.
                let along = if half >= 0.0 { [half + spread, c] } else { [c, spread - half] };
                let direction = Vector2::from(along).normalize();
                let forward = direction.x > 0.0 || direction.x == 0.0 && direction.y > 0.0;
                let direction = if forward { direction } else { -direction };
                let free = [0, 1, 2].map(velocity);
                let across = direction.x * free[2] - direction.y * free[1];
                let fastest = free.into_iter().fold(0.0, |most: f64, v| most.max(v.abs()));
                let still = across.abs() <= ROUNDED * fastest;
                Ok((if still { Freedom::Line } else { Freedom::Across })(direction.into()))
            }
        }
        // A turn about the normal has units of its own.
        _ if (1..3).any(|a| is_dead(a, largest)) || is_dead(3, 0.0) => refuse_item(
            item,
            "must move in all rows of a law with drilling; take one of dimension 2",
        ),
        _ => Ok(Freedom::All),
    }
}

/// The law in one direction: what it transmits while sliding forwards and backwards.
pub(super) fn along(law: &Law, direction: [f64; 2]) -> Option<Law> {
    let Law::Two(law) = law else { return None };
    let direction = Vector::<2>::from(direction);
    let against =
        |law: &FrictionLaw<2>, slip: Vector<2>| Some(-law.force(&slip, 1.0).ok()?.dot(&slip));
    let (forwards, backwards) = (against(law, direction)?, against(law, -direction)?);
    let limits = Interval::new([-backwards].into(), [forwards].into()).ok()?;
    Some(FrictionLaw::associated(Convex::from(limits)).into())
}

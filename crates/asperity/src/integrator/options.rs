//! What options of integrators are checked for.

use crate::argument::{ArgumentError, positive, refuse};
use crate::system::{Rotation, System};

/// Steps of this length to this accuracy, of a system that is put together as it should be.
pub(crate) fn check_steps(
    system: &dyn System,
    tolerance: f64,
    dt: f64,
) -> Result<(), ArgumentError> {
    positive("dt", dt)?;
    positive("tolerance", tolerance)?;
    check_structure(system)
}

/// Refuses what a system of a user says of its blocks and rotations, if places follow from it that there are not.
pub(crate) fn check_structure(system: &dyn System) -> Result<(), ArgumentError> {
    let (blocks, n, coordinates) = (system.blocks().count(), system.dof(), system.coordinates());
    if n != system.blocks().velocities() {
        let velocities = system.blocks().velocities();
        let message = format!("must have {velocities} velocities in its blocks, has {n}");
        return refuse("system", message);
    }
    if (0..blocks).any(|block| system.blocks().range(block).is_empty()) {
        return refuse("system", "must have a velocity at least in every block");
    }
    if system.constraints() > 0 && blocks > 1 {
        return refuse(
            "constraints",
            format!("must be of one block of velocities, not of {blocks}"),
        );
    }
    for contact in 0..system.contacts().len() {
        let touched = system.touched(contact);
        let ascends = touched.windows(2).all(|pair| pair[0] < pair[1]);
        if touched.is_empty() || !ascends || touched.iter().any(|&block| block >= blocks) {
            let message = format!(
                "must touch some of its {blocks} blocks, in ascending order, with contact {contact}, touches {touched:?}"
            );
            return refuse("system", message);
        }
    }
    check_rotations(system.rotations(), coordinates, n)
}

/// Refuses rotations unless between, before and after them there are as many coordinates as velocities.
fn check_rotations(
    rotations: &[Rotation],
    coordinates: usize,
    velocities: usize,
) -> Result<(), ArgumentError> {
    let (mut coordinate, mut velocity) = (0, 0);
    let end = Rotation { coordinate: coordinates, velocity: velocities };
    for next in rotations.iter().chain((!rotations.is_empty()).then_some(&end)) {
        let between = next.coordinate.checked_sub(coordinate);
        if between.is_none() || between != next.velocity.checked_sub(velocity) {
            let message = format!(
                "must have rotations of four coordinates and three velocities each, one after another, and elsewhere \
                 as many coordinates as velocities; has {coordinates} coordinates, {velocities} velocities and \
                 {rotations:?}"
            );
            return refuse("system", message);
        }
        (coordinate, velocity) =
            (next.coordinate.saturating_add(4), next.velocity.saturating_add(3));
    }
    Ok(())
}

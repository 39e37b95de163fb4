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
        return refuse(
            "system",
            format!("must have {velocities} velocities in its blocks, has {n}"),
        );
    }
    if (0..blocks).any(|block| system.blocks().range(block).is_empty()) {
        return refuse("system", "must have a velocity at least in every block");
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
    let outside = |r: &Rotation| r.coordinate + 4 > coordinates || r.velocity + 3 > n;
    match system.rotations().into_iter().find(outside) {
        Some(rotation) => refuse("system", format!("must have the coordinates of {rotation:?}")),
        None => Ok(()),
    }
}

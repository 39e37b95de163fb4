//! Which closed contacts are coupled through the inertia of the blocks that they touch, and the pattern of their
//! Delassus operator.

use crate::contact::{BlockMatrix, Csr, Delassus, Factored};
use crate::system::{ContactLaw, System, SystemError};

/// An operator of zeros for these contacts of a system: with its factors where several blocks have fewer velocities than
/// contact rows, so that solvers may eliminate among these; within one block everything is coupled anyway. The mass matrix
/// is that of the coordinates `q`.
pub(super) fn pattern(
    system: &dyn System,
    contacts: &[usize],
    q: &[f64],
) -> Result<Delassus, SystemError> {
    let laws = || contacts.iter().map(|&contact| &system.contacts()[contact]);
    let sizes: Vec<usize> = laws().map(ContactLaw::rows).collect();
    // The contacts of every block, by their place among those given.
    let mut at = vec![Vec::new(); system.blocks().count()];
    for (place, &contact) in contacts.iter().enumerate() {
        system.touched(contact).iter().for_each(|&block| at[block].push(place));
    }
    let neighbours = |&contact: &usize| {
        let touched = system.touched(contact).iter();
        let mut list: Vec<usize> = touched.flat_map(|&block| &at[block]).copied().collect();
        list.sort_unstable();
        list.dedup();
        list
    };
    let neighbours: Vec<_> = contacts.iter().map(neighbours).collect();
    let touched = (0..at.len()).filter(|&block| !at[block].is_empty());
    let velocities: usize = touched.map(|block| system.blocks().range(block).len()).sum();
    let blocks = BlockMatrix::with_pattern(&sizes, &neighbours);
    // Joints are not in the mass matrix. A factor of the speed scales columns of G only; a mass matrix that changes would
    // have to be filled in anew.
    let known = system.constancy().mass
        && !system.has_joints()
        && laws().all(|contact| contact.law().rate().is_none());
    if blocks.rows() <= velocities || system.blocks().count() == 1 || !known {
        return Ok(blocks.into());
    }
    let factored = directions(system, contacts, &sizes).zip(sparse_mass(system, q)?);
    let factored = factored.and_then(|(directions, mass)| {
        Factored::with_blocks(mass, directions, blocks.clone()).ok()
    });
    Ok(factored.map_or_else(|| blocks.into(), Delassus::from))
}

/// `Wᵀ` with a zero for every velocity of the blocks of a contact.
fn directions(system: &dyn System, contacts: &[usize], sizes: &[usize]) -> Option<Csr> {
    let blocks = system.blocks();
    let (mut starts, mut indices) = (vec![0], Vec::new());
    for (&contact, &size) in contacts.iter().zip(sizes) {
        for _ in 0..size {
            indices.extend(system.touched(contact).iter().flat_map(|&block| blocks.range(block)));
            starts.push(indices.len());
        }
    }
    let (values, rows) = (vec![0.0; indices.len()], starts.len() - 1);
    Csr::new(rows, blocks.velocities(), starts, indices, values).ok()
}

/// The mass matrix, block by block, without its zeros.
fn sparse_mass(system: &dyn System, q: &[f64]) -> Result<Option<Csr>, SystemError> {
    let blocks = system.blocks();
    let (mut starts, mut indices, mut values) = (vec![0], Vec::new(), Vec::new());
    let mut mass = Vec::new();
    for block in 0..blocks.count() {
        let range = blocks.range(block);
        let n = range.len();
        mass.resize(n * n, 0.0);
        system.mass(q, block, &mut mass)?;
        for i in 0..n {
            for j in (0..n).filter(|j| mass[n * j + i] != 0.0) {
                indices.push(range.start + j);
                values.push(mass[n * j + i]);
            }
            starts.push(indices.len());
        }
    }
    let n = blocks.velocities();
    Ok(Csr::new(n, n, starts, indices, values).ok())
}

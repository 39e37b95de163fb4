//! Which closed contacts of rigid bodies meet, and the pattern of their Delassus operator.

use crate::contact::{BlockMatrix, ContactRows, Csr, Delassus, Factored};
use crate::system::rigid::RigidBodies;

/// The closed contacts at every body, and those that every contact meets there.
pub(super) struct Meetings {
    /// First and second body of every contact.
    partners: Vec<(usize, Option<usize>)>,
    neighbours: Vec<Vec<usize>>,
    /// Number of bodies with contacts.
    touched: usize,
}

impl Meetings {
    pub(super) fn new(bodies: &RigidBodies, contacts: &[usize]) -> Self {
        let partners: Vec<_> = contacts.iter().map(|&contact| bodies.partners(contact)).collect();
        let mut at = vec![Vec::new(); bodies.bodies()];
        for (place, &(body, other)) in partners.iter().enumerate() {
            at[body].push(place);
            if let Some(other) = other {
                at[other].push(place);
            }
        }
        let neighbours = |&(body, other): &(usize, Option<usize>)| {
            let mut list = at[body].clone();
            if let Some(other) = other {
                list.extend_from_slice(&at[other]);
                list.sort_unstable();
                list.dedup();
            }
            list
        };
        let neighbours = partners.iter().map(neighbours).collect();
        let touched = at.iter().filter(|list| !list.is_empty()).count();
        Self { partners, neighbours, touched }
    }

    /// An operator of zeros: with its factors where bodies have fewer velocities than contact rows, so
    /// that solvers may eliminate there.
    pub(super) fn delassus(&self, bodies: &RigidBodies, contacts: &[ContactRows]) -> Delassus {
        let sizes: Vec<usize> = contacts.iter().map(ContactRows::len).collect();
        let blocks = BlockMatrix::with_pattern(&sizes, &self.neighbours);
        let hyperstatic = blocks.rows() > self.touched * bodies.velocities_per_body();
        // A factor of the speed scales columns of G only.
        let rated = contacts.iter().any(|contact| contact.law.rate().is_some());
        if !hyperstatic || rated {
            return blocks.into();
        }
        let factored = self.directions(bodies, &sizes).zip(bodies.sparse_mass());
        let factored = factored.and_then(|(directions, mass)| {
            Factored::with_blocks(mass, directions, blocks.clone()).ok()
        });
        factored.map_or_else(|| blocks.into(), Delassus::from)
    }

    /// `Wᵀ` with a zero for every velocity of the bodies of a contact.
    fn directions(&self, bodies: &RigidBodies, sizes: &[usize]) -> Option<Csr> {
        let n = bodies.velocities_per_body();
        let (mut starts, mut indices) = (vec![0], Vec::new());
        for (&(body, other), &size) in self.partners.iter().zip(sizes) {
            let (low, high) = match other {
                Some(other) => (body.min(other), Some(body.max(other))),
                None => (body, None),
            };
            for _ in 0..size {
                for body in std::iter::once(low).chain(high) {
                    indices.extend(n * body..n * (body + 1));
                }
                starts.push(indices.len());
            }
        }
        let values = vec![0.0; indices.len()];
        let rows = starts.len() - 1;
        Csr::new("directions", (rows, n * bodies.bodies()), starts, indices, values).ok()
    }
}

//! Parts of a system that do not act on each other, such as bodies that do not touch.

use crate::contact::{Components, Phase};
use crate::integrator::event::dynamics::Dynamics;
use crate::integrator::event::dynamics::buffers::IndependentParts;

impl Dynamics<'_> {
    /// The part of every contact: bodies that closed contacts connect are of one.
    pub(crate) fn parts_of_contacts(&self) -> Vec<usize> {
        let mut parts = Components::default();
        parts.separate(self.system.blocks().count());
        let touched = |i: usize| self.system.touched(i);
        let closed = (0..self.contacts.len()).filter(|&i| !self.contacts[i].is_free());
        for touched in closed.map(touched) {
            touched.iter().for_each(|&block| parts.join(touched[0], block));
        }
        let part = |i: usize| touched(i).first().map_or(usize::MAX, |&block| parts.first(block));
        (0..self.contacts.len()).map(part).collect()
    }

    /// The parts of a system that do not act on each other in the present modes, by the Jacobian that has just been computed.
    pub(crate) fn independent_parts(&self) -> IndependentParts {
        let (n, blocks) = (self.n, self.system.blocks());
        let mut block_of = vec![0; n];
        for block in 0..blocks.count() {
            block_of[blocks.range(block)].fill(block);
        }
        let mut parts = Components::default();
        parts.separate(blocks.count());
        for matrix in [&self.smooth.by_u, &self.smooth.by_q] {
            for (k, entry) in matrix.iter().enumerate() {
                if *entry != 0.0 {
                    parts.join(block_of[k / n], block_of[k % n]);
                }
            }
        }
        let closed = (0..self.contacts.len()).filter(|&i| self.contacts[i].mode != Phase::Open);
        for touched in closed.map(|i| self.system.touched(i)) {
            touched.iter().for_each(|&block| parts.join(touched[0], block));
        }
        let of: Vec<usize> = block_of.iter().map(|&block| parts.first(block)).collect();
        // The next velocity of every part.
        let mut columns: Vec<Vec<usize>> = Vec::new();
        let mut count = vec![0; blocks.count()];
        for (j, &part) in of.iter().enumerate() {
            if count[part] == columns.len() {
                columns.push(Vec::new());
            }
            columns[count[part]].push(j);
            count[part] += 1;
        }
        IndependentParts { of, columns }
    }
}

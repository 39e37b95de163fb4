//! The same linear systems, eliminated among the bodies.
//!
//! With `G = Wᵀ M⁻¹ W` and `D = A⁻¹B`, `(A + B G) d = g` is `d = A⁻¹g − D Wᵀ v` with
//! `(M + W D Wᵀ) v = W A⁻¹ g`: as many unknowns as velocities, fewer than contact rows where bodies touch in
//! many points.

use std::collections::HashMap;

use crate::contact::{BlockMatrix, Components, ContactProblem, Factored};
use crate::law::ContactMatrix;
use crate::linear::{Kind, Numeric, Symbolic};

/// Groups larger than this are not eliminated as dense blocks.
const LARGEST_GROUP: usize = 64;
/// Part of the largest entry by which rounding may take a matrix from being symmetric.
const SYMMETRIC: f64 = 1e-14;

/// Where a contact acts.
#[derive(Debug, Clone, Default)]
struct ContactDirections {
    /// First local velocity of every group of velocities, and the number of them.
    starts: Vec<usize>,
    /// Groups, and the blocks between them, row by row, in `BodySpace::matrix`.
    groups: Vec<usize>,
    blocks: Vec<usize>,
    /// Permuted velocities.
    velocities: Vec<usize>,
    /// `Wᵀ` of the contact, row-major, in local velocities.
    directions: Vec<f64>,
    /// Place in `directions` of the entries of the sparse rows.
    places: Vec<usize>,
    first_row: usize,
    rows: usize,
}

/// `M + W D Wᵀ` with its factors.
#[derive(Debug, Clone, Default)]
pub(super) struct BodySpace {
    contacts: Vec<ContactDirections>,
    matrix: BlockMatrix,
    /// Block and entry of every entry of `M`.
    mass_places: Vec<(usize, usize, usize)>,
    inverse: Vec<ContactMatrix>,
    d: Vec<ContactMatrix>,
    velocity: Vec<f64>,
    product: Vec<f64>,
    numeric: Numeric,
    pub(super) symbolic: Symbolic,
}

impl BodySpace {
    /// The pattern; `None` where the velocities do not fall into small groups.
    pub(super) fn new(problem: &ContactProblem, factored: &Factored) -> Option<Self> {
        let group_of = groups(problem, factored);
        let count = group_of.iter().max()? + 1;
        let mut sizes = vec![0; count];
        let mut within = Vec::with_capacity(group_of.len());
        for &group in &group_of {
            within.push(sizes[group]);
            sizes[group] += 1;
        }
        if sizes.iter().any(|&size| size > LARGEST_GROUP) {
            return None;
        }
        let mut neighbours: Vec<Vec<usize>> = (0..count).map(|group| vec![group]).collect();
        let mut touched: Vec<Vec<usize>> = Vec::with_capacity(problem.contacts().len());
        for contact in problem.contacts() {
            let mut list: Vec<usize> = (contact.rows())
                .flat_map(|row| factored.directions().row(row).0.iter().map(|&dof| group_of[dof]))
                .collect();
            list.sort_unstable();
            list.dedup();
            for &group in &list {
                neighbours[group].extend_from_slice(&list);
            }
            touched.push(list);
        }
        let mass = factored.mass();
        for dof in 0..mass.rows() {
            for &other in mass.row(dof).0 {
                neighbours[group_of[dof]].push(group_of[other]);
                neighbours[group_of[other]].push(group_of[dof]);
            }
        }
        for list in &mut neighbours {
            list.sort_unstable();
            list.dedup();
        }
        let mut space =
            Self { matrix: BlockMatrix::with_pattern(&sizes, &neighbours), ..Self::default() };
        let offsets = space.matrix.offsets().to_vec();
        let block = |i: usize, j: usize| neighbours[i].partition_point(|&other| other < j);
        for dof in 0..mass.rows() {
            for &other in mass.row(dof).0 {
                let (i, j) = (group_of[dof], group_of[other]);
                space.mass_places.push((i, block(i, j), within[dof] * sizes[j] + within[other]));
            }
        }
        for (rows, groups) in problem.contacts().iter().zip(touched) {
            let mut contact = ContactDirections { rows: rows.len(), ..Default::default() };
            contact.first_row = rows.offset;
            contact.starts.push(0);
            for &i in &groups {
                contact.velocities.extend(offsets[i]..offsets[i + 1]);
                contact.starts.push(contact.velocities.len());
                contact.blocks.extend(groups.iter().map(|&j| block(i, j)));
            }
            let len = contact.velocities.len();
            for a in 0..contact.rows {
                for &dof in factored.directions().row(rows.offset + a).0 {
                    let local = groups.partition_point(|&g| g < group_of[dof]);
                    contact.places.push(a * len + contact.starts[local] + within[dof]);
                }
            }
            contact.groups = groups;
            contact.directions = vec![0.0; contact.rows * len];
            space.contacts.push(contact);
        }
        space.symbolic = Symbolic::new(&space.matrix);
        Some(space)
    }

    /// Number of velocities, which are the unknowns.
    pub(super) fn velocities(&self) -> usize {
        self.matrix.rows()
    }

    /// Buffers for the factors.
    pub(super) fn reserve(&mut self) {
        self.numeric.reserve(&self.symbolic);
        self.inverse.resize(self.contacts.len(), ContactMatrix::zeros());
        self.d.resize(self.contacts.len(), ContactMatrix::zeros());
        self.velocity.resize(self.matrix.rows(), 0.0);
        let longest = self.contacts.iter().map(|contact| contact.velocities.len()).max();
        self.product.resize(4 * longest.unwrap_or(0), 0.0);
    }

    /// Factors `M + W A⁻¹B Wᵀ`; false if some `A` has no inverse, or if it is given up.
    pub(super) fn factor(
        &mut self,
        factored: &Factored,
        a: &[ContactMatrix],
        b: &[ContactMatrix],
        given_up: &dyn Fn() -> bool,
    ) -> bool {
        let mut symmetric = true;
        self.matrix.values_mut().fill(0.0);
        for (&(i, k, at), value) in self.mass_places.iter().zip(factored.mass().values()) {
            self.matrix.block_mut(i, k).1[at] += value;
        }
        for (i, contact) in self.contacts.iter_mut().enumerate() {
            // Unused rows and columns do not matter as long as they leave the inverse alone.
            let mut full = a[i];
            (contact.rows..4).for_each(|r| full[(r, r)] = 1.0);
            let Some(inverse) = full.try_inverse() else { return false };
            self.inverse[i] = inverse;
            self.d[i] = inverse * b[i];
            symmetric &= is_symmetric(&self.d[i], contact.rows);
            contact.load(factored);
            contact.add(&self.d[i], &mut self.product, &mut self.matrix);
        }
        let mut factor =
            |kind: Kind| self.numeric.factor(&self.symbolic, (&self.matrix, kind), given_up);
        // Where all `D` are symmetric, as those of what stands are, the matrix is; most are definite, too.
        if symmetric {
            if factor(Kind::Definite) {
                return true;
            }
            if given_up() {
                return false;
            }
        }
        factor(Kind::General)
    }

    /// `g ← (A + B G)⁻¹ g`.
    pub(super) fn solve(&mut self, problem: &ContactProblem, g: &mut [f64]) {
        self.velocity.fill(0.0);
        for (i, contact) in self.contacts.iter().enumerate() {
            let own = &mut g[contact.first_row..contact.first_row + contact.rows];
            let mut x = [0.0; 4];
            for (r, x) in x.iter_mut().enumerate().take(contact.rows) {
                *x = own.iter().enumerate().map(|(c, g)| self.inverse[i][(r, c)] * g).sum();
            }
            own.copy_from_slice(&x[..contact.rows]);
            let len = contact.velocities.len().max(1);
            for (x, row) in x.iter().zip(contact.directions.chunks_exact(len)) {
                for (&velocity, w) in contact.velocities.iter().zip(row) {
                    self.velocity[velocity] += w * x;
                }
            }
        }
        self.numeric.solve(&self.symbolic, &mut self.velocity);
        for (i, contact) in self.contacts.iter().enumerate().take(problem.contacts().len()) {
            let len = contact.velocities.len().max(1);
            let mut brought = [0.0; 4];
            for (sum, row) in brought.iter_mut().zip(contact.directions.chunks_exact(len)) {
                *sum = contact.velocities.iter().zip(row).map(|(&v, w)| self.velocity[v] * w).sum();
            }
            for r in 0..contact.rows {
                let change: f64 = (0..contact.rows).map(|c| self.d[i][(r, c)] * brought[c]).sum();
                g[contact.first_row + r] -= change;
            }
        }
    }
}

/// Whether the first `rows` rows and columns of a matrix are symmetric up to rounding.
fn is_symmetric(d: &ContactMatrix, rows: usize) -> bool {
    let used = d.view((0, 0), (rows, rows));
    let allowed = SYMMETRIC * used.amax();
    (0..rows).all(|r| (0..r).all(|c| (used[(r, c)] - used[(c, r)]).abs() <= allowed))
}

impl ContactDirections {
    /// Reads `Wᵀ` of the contact.
    fn load(&mut self, factored: &Factored) {
        let directions = factored.directions();
        let first = directions.starts()[self.first_row];
        for (&at, value) in self.places.iter().zip(&directions.values()[first..]) {
            self.directions[at] = *value;
        }
    }

    /// Adds `W D Wᵀ`.
    fn add(&self, d: &ContactMatrix, product: &mut [f64], matrix: &mut BlockMatrix) {
        let len = self.velocities.len();
        if len == 0 || d.amax() == 0.0 {
            return;
        }
        let product = &mut product[..self.rows * len];
        product.fill(0.0);
        for (r, out) in product.chunks_exact_mut(len).enumerate() {
            for (c, row) in self.directions.chunks_exact(len).enumerate() {
                for (value, w) in out.iter_mut().zip(row) {
                    *value += d[(r, c)] * w;
                }
            }
        }
        let mut k = 0;
        for (i, &group) in self.groups.iter().enumerate() {
            for j in 0..self.groups.len() {
                let (rows, columns) =
                    (self.starts[i]..self.starts[i + 1], self.starts[j]..self.starts[j + 1]);
                let (_, block) = matrix.block_mut(group, self.blocks[k]);
                k += 1;
                for (row, out) in rows.zip(block.chunks_exact_mut(columns.len())) {
                    for r in 0..self.rows {
                        let w = self.directions[r * len + row];
                        let brought = &product[r * len + columns.start..r * len + columns.end];
                        for (value, p) in out.iter_mut().zip(brought) {
                            *value += w * p;
                        }
                    }
                }
            }
        }
    }
}

/// Groups of velocities that the same contacts touch or that `M` couples: bodies, where there are bodies.
fn groups(problem: &ContactProblem, factored: &Factored) -> Vec<usize> {
    let mass = factored.mass();
    let n = mass.rows();
    let mut contacts: Vec<Vec<usize>> = vec![Vec::new(); n];
    for (i, contact) in problem.contacts().iter().enumerate() {
        for row in contact.rows() {
            for &dof in factored.directions().row(row).0 {
                if contacts[dof].last() != Some(&i) {
                    contacts[dof].push(i);
                }
            }
        }
    }
    let mut groups = Components::default();
    groups.separate(n);
    let mut same: HashMap<&[usize], usize> = HashMap::new();
    for (dof, list) in contacts.iter().enumerate().filter(|(_, list)| !list.is_empty()) {
        groups.join(*same.entry(list).or_insert(dof), dof);
    }
    for dof in 0..n {
        mass.row(dof).0.iter().for_each(|&other| groups.join(dof, other));
    }
    groups.numbers()
}

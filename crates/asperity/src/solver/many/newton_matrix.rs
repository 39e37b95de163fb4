//! The linear systems `(A + B G) d = g` of Newton's method, `A` and `B` block-diagonal.

use super::body_space::BodySpace;
use crate::contact::{BlockMatrix, ContactProblem, Delassus};
use crate::linear::{Numeric, Symbolic};
use crate::solver::natural_map::Small;

/// The matrix with its factors: analysed once per pattern, in the space where elimination is cheaper.
#[derive(Debug, Clone, Default)]
pub(super) struct NewtonMatrix {
    contact: ContactSpace,
    body: Option<BodySpace>,
    in_body_space: bool,
    /// What the analysis was made from.
    pattern: Vec<usize>,
    ready: bool,
}

impl NewtonMatrix {
    /// The problem may have a new pattern.
    pub(super) fn reset(&mut self) {
        self.ready = false;
    }

    /// Analyses the pattern, unless it is the last one.
    pub(super) fn prepare(&mut self, problem: &ContactProblem) {
        if self.ready || self.knows(problem) {
            self.ready = true;
            return;
        }
        self.ready = true;
        self.pattern.clear();
        self.pattern.extend(pattern(problem));
        self.contact.prepare(problem);
        self.body = None;
        if let Delassus::Factored(factored) = problem.delassus() {
            self.body = BodySpace::new(problem, factored);
        }
        let cost = |body: &BodySpace| body.symbolic.operations;
        self.in_body_space =
            self.body.as_ref().is_some_and(|b| cost(b) < self.contact.symbolic.operations);
        match (self.in_body_space, &mut self.body) {
            (true, Some(body)) => body.reserve(),
            _ => self.contact.numeric.reserve(&self.contact.symbolic),
        }
    }

    fn knows(&self, problem: &ContactProblem) -> bool {
        self.pattern.iter().copied().eq(pattern(problem))
    }

    /// Factors `A + B G`; false if that failed.
    pub(super) fn factor(&mut self, problem: &ContactProblem, a: &[Small], b: &[Small]) -> bool {
        match (self.in_body_space, &mut self.body, problem.delassus()) {
            (true, Some(body), Delassus::Factored(factored)) => body.factor(factored, a, b),
            _ => self.contact.factor(problem, a, b),
        }
    }

    /// `g ← (A + B G)⁻¹ g`.
    pub(super) fn solve(&mut self, problem: &ContactProblem, g: &mut [f64]) {
        match (self.in_body_space, &mut self.body, problem.delassus()) {
            (true, Some(body), Delassus::Factored(_)) => body.solve(problem, g),
            _ => self.contact.numeric.solve(&self.contact.symbolic, g),
        }
    }
}

/// Sizes and places of all entries that may be there.
fn pattern(problem: &ContactProblem) -> impl Iterator<Item = usize> + '_ {
    let sizes = problem.contacts().iter().map(|contact| contact.len());
    let blocks = problem.delassus().blocks().into_iter().flat_map(|blocks| {
        let (starts, columns) = blocks.pattern();
        starts.iter().chain(columns).copied()
    });
    let factors = match problem.delassus() {
        Delassus::Factored(factored) => Some([factored.mass(), factored.directions()]),
        _ => None,
    };
    let factors = factors.into_iter().flatten();
    let factors = factors.flat_map(|csr| csr.starts().iter().chain(csr.indices()).copied());
    sizes.chain(blocks).chain(factors)
}

/// Elimination among the rows of the contacts.
#[derive(Debug, Clone, Default)]
struct ContactSpace {
    /// `G` where the problem keeps it densely.
    sparse: Option<BlockMatrix>,
    matrix: BlockMatrix,
    /// Block of `matrix` for every block of `G`, counted within the block row.
    places: Vec<usize>,
    symbolic: Symbolic,
    numeric: Numeric,
}

impl ContactSpace {
    fn prepare(&mut self, problem: &ContactProblem) {
        self.sparse = match problem.delassus() {
            Delassus::Dense(_) => Some(problem.blocks()),
            _ => None,
        };
        let Some(g) = self.sparse.as_ref().or(problem.delassus().blocks()) else { return };
        let n = g.contacts();
        let mut neighbours: Vec<Vec<usize>> = (0..n).map(|i| g.neighbours(i).to_vec()).collect();
        for i in 0..n {
            for &j in g.neighbours(i) {
                if g.neighbours(j).binary_search(&i).is_err() {
                    neighbours[j].push(i);
                }
            }
        }
        for list in &mut neighbours {
            list.sort_unstable();
        }
        let sizes: Vec<usize> = (0..n).map(|i| g.size(i)).collect();
        self.matrix.reset(&sizes, neighbours.iter().map(|list| list.iter().copied()));
        self.places.clear();
        for (i, list) in neighbours.iter().enumerate() {
            let place = |j: &usize| list.partition_point(|other| other < j);
            self.places.extend(g.neighbours(i).iter().map(place));
        }
        self.symbolic = Symbolic::new(&self.matrix);
    }

    fn factor(&mut self, problem: &ContactProblem, a: &[Small], b: &[Small]) -> bool {
        if let (Delassus::Dense(_), Some(sparse)) = (problem.delassus(), &mut self.sparse) {
            problem.copy_into(sparse);
        }
        let Some(g) = self.sparse.as_ref().or(problem.delassus().blocks()) else { return false };
        self.matrix.values_mut().fill(0.0);
        let mut block = 0;
        for (i, (a, b)) in a.iter().zip(b).enumerate() {
            let size = g.size(i);
            for (j, entries) in g.row(i) {
                let (_, out) = self.matrix.block_mut(i, self.places[block]);
                block += 1;
                multiply(b, entries, size, out);
                if i == j {
                    for r in 0..size {
                        for c in 0..size {
                            out[r * size + c] += a[(r, c)];
                        }
                    }
                }
            }
        }
        self.numeric.factor(&self.symbolic, &self.matrix)
    }
}

/// `out ← B G_ij`, row-major.
#[inline]
fn multiply(b: &Small, g: &[f64], size: usize, out: &mut [f64]) {
    if let (Ok(g), Ok(out)) = (<&[f64; 9]>::try_from(g), <&mut [f64; 9]>::try_from(&mut *out)) {
        for r in 0..3 {
            for c in 0..3 {
                out[3 * r + c] = b[(r, 0)] * g[c] + b[(r, 1)] * g[3 + c] + b[(r, 2)] * g[6 + c];
            }
        }
        return;
    }
    let columns = g.len() / size;
    for (r, out) in out.chunks_exact_mut(columns).enumerate() {
        for (k, row) in g.chunks_exact(columns).enumerate() {
            for (value, g) in out.iter_mut().zip(row) {
                *value += b[(r, k)] * g;
            }
        }
    }
}

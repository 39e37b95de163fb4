//! The linear systems `(A + B G) d = g` of Newton's method, `A` and `B` block-diagonal, in the space where elimination
//! is cheaper: among the rows of the contacts or among the velocities of the bodies; few rows as a dense matrix.

mod body_space;
mod contact_space;
mod dense_space;

use crate::contact::{ContactProblem, Delassus};
use crate::law::ContactMatrix;
use crate::linear::{DenseLu, Symbolic};
use body_space::BodySpace;
use contact_space::ContactSpace;
use dense_space::DenseSpace;

/// Most rows of a matrix that is treated as a dense one: those of more contacts are half empty.
const SMALL: usize = 30;

/// The matrix with its factors: analysed once per pattern, in the space where elimination is cheaper.
#[derive(Debug, Clone, Default)]
pub(crate) struct NewtonMatrix {
    contact: ContactSpace,
    body: Option<BodySpace>,
    in_body_space: bool,
    dense: DenseSpace,
    /// What the analysis was made from.
    pattern: Vec<usize>,
    ready: bool,
}

impl NewtonMatrix {
    /// The problem may have a new pattern.
    pub(crate) fn reset(&mut self) {
        self.ready = false;
    }

    /// Analyses the pattern, unless it is the last one.
    pub(crate) fn prepare(&mut self, problem: &ContactProblem) {
        if is_small(problem) {
            return;
        }
        if self.ready || self.knows(problem) {
            self.ready = true;
            return;
        }
        self.ready = true;
        self.pattern.clear();
        self.pattern.extend(pattern(problem));
        (self.contact, self.body) = (ContactSpace::default(), None);
        if let Delassus::Factored(factored) = problem.delassus() {
            self.body = BodySpace::new(problem, factored);
        }
        // Fewer unknowns among bodies are cheaper; elsewhere both are analysed, and only the cheaper one is kept.
        let velocities = |body: &BodySpace| body.velocities() < problem.rows();
        self.in_body_space = self.body.as_ref().is_some_and(velocities);
        if !self.in_body_space {
            self.contact.prepare(problem);
            let operations = self.contact.symbolic.operations;
            let cheaper = |body: &BodySpace| body.symbolic.operations < operations;
            self.in_body_space = self.body.as_ref().is_some_and(cheaper);
        }
        match &mut self.body {
            Some(body) if self.in_body_space => {
                self.contact = ContactSpace::default();
                body.reserve();
            }
            _ => {
                self.body = None;
                self.contact.numeric.reserve(&self.contact.symbolic);
            }
        }
    }

    /// Floating-point operations of a factorisation with so many rows where these are known without an analysis of the
    /// pattern, whether one was made before or not: what is decided by them must not depend on it.
    pub(crate) fn known_operations(rows: usize) -> Option<f64> {
        (rows <= SMALL).then(|| DenseLu::operations(rows))
    }

    /// The same of the matrix that has been prepared.
    pub(crate) fn operations(&self, problem: &ContactProblem) -> f64 {
        Self::known_operations(problem.rows()).unwrap_or(self.symbolic().operations)
    }

    /// The analysis in the space where elimination is cheaper.
    fn symbolic(&self) -> &Symbolic {
        let body = self.body.as_ref().filter(|_| self.in_body_space);
        body.map_or(&self.contact.symbolic, |body| &body.symbolic)
    }

    fn knows(&self, problem: &ContactProblem) -> bool {
        self.pattern.iter().copied().eq(pattern(problem))
    }

    /// Factors `A + B G`; false if that failed, or if it was given up on the way.
    pub(crate) fn factor(
        &mut self,
        problem: &ContactProblem,
        a: &[ContactMatrix],
        b: &[ContactMatrix],
        given_up: &dyn Fn() -> bool,
    ) -> bool {
        if is_small(problem) {
            return self.dense.factor(problem, a, b);
        }
        match (self.in_body_space, &mut self.body, problem.delassus()) {
            (true, Some(body), Delassus::Factored(factored)) => {
                body.factor(factored, a, b, given_up)
            }
            _ => self.contact.factor(problem, a, b, given_up),
        }
    }

    /// `g ← (A + B G)⁻¹ g`.
    pub(crate) fn solve(&mut self, problem: &ContactProblem, g: &mut [f64]) {
        if is_small(problem) {
            return self.dense.solve(g);
        }
        match (self.in_body_space, &mut self.body, problem.delassus()) {
            (true, Some(body), Delassus::Factored(_)) => body.solve(problem, g),
            _ => self.contact.numeric.solve(&self.contact.symbolic, g),
        }
    }
}

/// Whether a matrix among the contacts is factored before its pattern could be analysed.
fn is_small(problem: &ContactProblem) -> bool {
    problem.rows() <= SMALL
}

/// Sizes and places of all entries that may be there.
fn pattern(problem: &ContactProblem) -> impl Iterator<Item = usize> + '_ {
    let sizes = problem.contacts().iter().map(|contact| contact.len());
    let (starts, columns) = problem.delassus().blocks().pattern();
    let blocks = starts.iter().chain(columns).copied();
    let factors = match problem.delassus() {
        Delassus::Factored(factored) => Some([factored.mass(), factored.directions()]),
        _ => None,
    };
    let factors = factors.into_iter().flatten();
    let factors = factors.flat_map(|csr| csr.starts().iter().chain(csr.indices()).copied());
    sizes.chain(blocks).chain(factors)
}

#[cfg(test)]
mod tests;

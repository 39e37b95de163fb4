//! The same contacts between bodies of other masses.
//!
//! Whether velocities of the bodies take contacts apart, and whether percussions move no body at all, does not depend on the
//! masses; how far percussions that nearly do so move them does. `G = Wᵀ M⁻¹ W` with masses that differ by many powers of ten hides both behind its rounding.

use crate::contact::{ContactProblem, Csr, Delassus, Factored};

/// The problem with diagonal masses such that units drop out: `M_kk = Σ_j W_kj²`.
///
/// `None` where the bodies are not known, or numbers are beyond those of a problem.
pub(crate) fn with_suitable_masses(problem: &ContactProblem) -> Option<ContactProblem> {
    let Delassus::Factored(factored) = problem.delassus() else { return None };
    let directions = factored.directions();
    let count = directions.columns();
    let mut masses = vec![0.0; count];
    for row in 0..directions.rows() {
        let (columns, values) = directions.row(row);
        columns.iter().zip(values).for_each(|(&k, w)| masses[k] += w * w);
    }
    // What no contact moves.
    masses.iter_mut().filter(|mass| **mass == 0.0).for_each(|mass| *mass = 1.0);
    let places = (0..count).collect();
    let mass = Csr::new(count, count, (0..=count).collect(), places, masses).ok()?;
    let sizes: Vec<usize> = problem.contacts().iter().map(|rows| rows.len()).collect();
    let operator = Factored::new(mass, directions.clone(), &sizes).ok()?;
    let loads = problem.free_velocity().iter().zip(problem.restitution()).map(|(b, e)| b + e);
    let contacts = problem.contacts().iter().map(|rows| (rows.law.clone(), rows.normal));
    ContactProblem::new(operator, loads.collect(), contacts).ok()
}

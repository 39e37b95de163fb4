//! Bodies at rest: all contacts closed, none slipping.
//!
//! Bodies that rest on each other have percussions that grow with what they carry, and sweeps bring them from one body to
//! the next: as many are needed as a stack is high, squared. Where all contacts stick the problem is linear,
//! `G P + b + e γ_B = 0`, and one factorisation of `G + εI` finds its solution of least norm, however many bodies lie upon
//! each other. It is the solution wherever these percussions are admissible, and a start for other methods where only
//! some of them are not.

use crate::law::ContactMatrix;
use crate::solver::gauss_seidel::Task;
use crate::solver::incumbent::Incumbent;
use crate::solver::newton_matrix::NewtonMatrix;
use crate::solver::report::Method;
use crate::vectors::norm;

/// `ε` relative to the mean of the diagonal of `G`: the softest motion of a stack of 25 000 boxes has 4e-9 of it.
const REGULARIZED: f64 = 1e-11;
/// Velocities relative to the loads, in tolerances, from which on percussions are measured although further steps would bring
/// them nearer: it saves large stacks and walls one step of four.
const CLOSE: f64 = 1e-2;
/// Most steps with one factorisation: large stacks take five.
const STEPS: usize = 12;
/// Velocities relative to the loads that are none: what is left where no percussions bring bodies to rest is larger.
const AT_REST: f64 = 1e-6;

/// Buffers.
#[derive(Debug, Clone, Default)]
pub(crate) struct LeastNorm {
    a: Vec<ContactMatrix>,
    b: Vec<ContactMatrix>,
    percussion: Vec<f64>,
    step: Vec<f64>,
}

impl LeastNorm {
    /// Looks for the percussions with which nothing moves, by proximal steps `(G + εI) d = −(G P + b + e γ_B)` from none,
    /// and returns the mean size of those of a contact, if they exist.
    pub(crate) fn attempt(
        &mut self,
        incumbent: &mut Incumbent<'_>,
        matrix: &mut NewtonMatrix,
    ) -> Option<f64> {
        let Task { problem, stop, .. } = incumbent.task;
        let (rows, contacts) = (problem.rows(), problem.contacts().len());
        self.percussion.clear();
        self.percussion.resize(rows, 0.0);
        self.step.resize(rows, 0.0);
        let epsilon = REGULARIZED / problem.global_rho();
        self.a.clear();
        self.a.resize(contacts, ContactMatrix::identity() * epsilon);
        self.b.clear();
        self.b.resize(contacts, ContactMatrix::identity());
        let (mut steps, mut last, mut is_measured) = (0, f64::INFINITY, false);
        let close = CLOSE * stop.tolerance * problem.load_norm();
        if matrix.factor(problem, &self.a, &self.b, &|| stop.early()) {
            loop {
                let velocity = incumbent.velocity(&self.percussion);
                let velocities = velocity.iter().zip(problem.restitution());
                for (step, (velocity, restitution)) in self.step.iter_mut().zip(velocities) {
                    *step = -(velocity + restitution);
                }
                let left = norm(&self.step);
                // Rounding ends it, or velocities that no percussions bring about; the comparison also finds NaN.
                let ends = steps == STEPS || !(left < 0.5 * last);
                // Percussions that do not pass the measure may be kept as the best ones: those at the end hardly differ.
                if ends || left <= close && !std::mem::replace(&mut is_measured, true) {
                    incumbent.grade_with_velocities(&self.percussion);
                    if ends || incumbent.is_solved() {
                        break;
                    }
                }
                last = left;
                matrix.solve(problem, &mut self.step);
                for (percussion, step) in self.percussion.iter_mut().zip(&self.step) {
                    *percussion += step;
                }
                steps += 1;
            }
        }
        incumbent.record(Method::LeastNorm, steps, 1);
        (incumbent.is_solved() || last <= AT_REST * problem.load_norm())
            .then(|| norm(&self.percussion) / (contacts as f64).sqrt())
    }
}

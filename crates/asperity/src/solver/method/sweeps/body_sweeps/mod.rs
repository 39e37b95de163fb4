//! Gauss–Seidel over the velocities of bodies, for packings whose factorisations are dear.
//!
//! A contact between two bodies needs three rows of `WᵀL⁻ᵀ`, `M = LLᵀ`, with twelve numbers each, a row of blocks of `G` with ten
//! neighbours has 99, and four contacts that share no body are visited side by side: in columns of spheres a sweep and
//! its acceleration take half of the time of one over the blocks of `G` (`OVER_BODIES` in `accelerated.rs`).
//!
//! Percussions and velocities are those of Lorentz cones (`cones.rs`), in which friction is isotropic with a coefficient of
//! one. A visit is a step of the projected Gauss–Seidel iteration, the normal percussion first:
//!
//! ```text
//! P̂_N ← max(0, P̂_N − ξ̂_N/Ĝ_NN),   P̂_T ← proj(P̂_T − ξ̂_T/g_T | ‖P̂_T‖ ≤ P̂_N)
//! ```
//!
//! with the largest eigenvalue `g_T` of `Ĝ_TT`. De Saxcé's shift does not appear: it moves the normal velocity of a contact
//! that slips, and the normal percussion has been found with the velocity itself.
//!
//! | file | concept |
//! |---|---|
//! | `bodies.rs` | which velocities belong to one body |
//! | `layout.rs` | bodies and contacts as arrays, contacts in groups that share no body |
//! | `sweep.rs` | a sweep over them |

mod bodies;
mod layout;
mod sweep;
#[cfg(test)]
mod tests;

use self::layout::{Layout, Percussions};
use self::sweep::{Sweep, Velocities};
use super::super::cones::Cones;
use crate::contact::ContactProblem;

/// Percussions and velocities of a problem of bodies.
#[derive(Debug, Clone, Default)]
pub(crate) struct BodySweeps {
    layout: Layout,
    /// Of every group, in the coordinates of the cones.
    percussions: Vec<Percussions>,
    /// `Lᵀu` of every body with `M = LLᵀ`, and of the ground, which stays zero.
    velocities: Vec<Velocities>,
}

impl BodySweeps {
    /// Reads a problem; false if it is not one of bodies that touch in pairs, or if friction has no symmetric cones in the
    /// plane, or elongated ones.
    pub(crate) fn read(&mut self, problem: &ContactProblem, cones: &Cones) -> bool {
        self.layout.read(problem, cones)
    }

    /// Takes percussions.
    pub(crate) fn start(&mut self, problem: &ContactProblem, cones: &Cones, percussion: &[f64]) {
        self.layout.pack(problem, cones, percussion, &mut self.percussions);
    }

    /// Their coordinates, which may be changed.
    pub(crate) fn coordinates(&mut self) -> &mut [f64] {
        self.percussions.as_flattened_mut().as_flattened_mut()
    }

    /// One sweep.
    pub(crate) fn sweep(&mut self) {
        let Self { layout, percussions, velocities } = self;
        velocities.clear();
        velocities.resize(layout.bodies() + 1, Velocities::default());
        Sweep { groups: layout.groups(), percussions, velocities }.run();
    }

    /// The percussions.
    pub(crate) fn percussion(&self, problem: &ContactProblem, cones: &Cones, into: &mut [f64]) {
        self.layout.unpack(problem, cones, &self.percussions, into);
    }
}

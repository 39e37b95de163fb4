//! Gauss–Seidel over the velocities of bodies, for packings whose factorisations are dear.
//!
//! A contact between two bodies needs three rows of `WᵀL⁻ᵀ`, `M = LLᵀ`, with twelve numbers each, a row of blocks of `G` with ten
//! neighbours has 99, and four contacts that share no body are visited side by side: in columns of spheres a sweep and
//! its acceleration take half of the time of one over the blocks of `G` ([`OVER_BODIES`]).
//!
//! Percussions and velocities are those of Lorentz cones (`cones.rs`), in which friction is isotropic with a coefficient of
//! one. A visit is a step of the projected Gauss–Seidel iteration, the normal percussion first:
//!
//! ```text
//! P̂_N ← max(0, P̂_N − ω ξ̂_N/Ĝ_NN),   P̂_T ← proj(P̂_T − ω ξ̂_T/g_T | ‖P̂_T‖ ≤ P̂_N)
//! ```
//!
//! with the largest eigenvalue `g_T` of `Ĝ_TT`, and `ω = 1` but in over-relaxed sweeps. De Saxcé's shift does not appear: it moves
//! the normal velocity of a contact that slips, and the normal percussion has been found with the velocity itself.
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

use std::ops::Range;

use self::layout::{Layout, Percussions};
use self::sweep::{Brought, Sweep, Velocities};
use super::super::cones::Cones;
use crate::contact::ContactProblem;

/// Sweeps over the velocities of bodies in the time of one over the blocks of `G`: columns of ten spheres with 1240, 3110 and
/// 10330 contacts take 43, 45 and 55 ns in place of 61, 85 and 105 ns per contact, the acceleration of the sweeps included.
pub(crate) const OVER_BODIES: usize = 2;
/// Over-relaxation `ω`. Of the problems of `benches/hard_problems.py --wide` the 27 that took longer than 0.3 s were solved with five
/// values, when over-relaxed sweeps came at once and before Newton's method with other parameters, each for 6 s at most. With 1,
/// 1.15, 1.3, 1.45 and 1.6 they took 59, 65, 47, 44 and 56 s, and 6, 6, 4, 4 and 5 of them were not solved. From 1.6 on sweeps
/// diverge in some columns.
const RELAXATION: f64 = 1.3;
/// Knuth's linear congruential generator of the random orders, and where each problem begins with it.
const FACTOR: u64 = 6_364_136_223_846_793_005;
const SUMMAND: u64 = 1_442_695_040_888_963_407;
const SEED: u64 = 1;

/// Percussions and velocities of a problem of bodies.
#[derive(Debug, Clone, Default)]
pub(crate) struct BodySweeps {
    layout: Layout,
    /// Of every group, in the coordinates of the cones.
    percussions: Vec<Percussions>,
    /// `Lᵀu` of every body with `M = LLᵀ`, and of the ground, which stays zero.
    velocities: Vec<Velocities>,
    /// Whether the velocities are those of the percussions.
    known: bool,
    /// The groups of every colour in the order of the next sweep, and what the next order is drawn from.
    order: Vec<Range<usize>>,
    random: u64,
}

impl BodySweeps {
    /// Reads a problem; false if it is not one of bodies that touch in pairs, or if friction has no symmetric cones in the
    /// plane, or elongated ones.
    pub(crate) fn read(&mut self, problem: &ContactProblem, cones: &Cones) -> bool {
        let is_one = self.layout.read(problem, cones);
        self.order.clear();
        self.order.extend_from_slice(self.layout.colours());
        self.random = SEED;
        is_one
    }

    /// Takes percussions.
    pub(crate) fn start(&mut self, problem: &ContactProblem, cones: &Cones, percussion: &[f64]) {
        self.layout.pack(problem, cones, percussion, &mut self.percussions);
        self.known = false;
    }

    /// Their coordinates, which may be changed.
    pub(crate) fn coordinates(&mut self) -> &mut [f64] {
        self.known = false;
        self.percussions.as_flattened_mut().as_flattened_mut()
    }

    /// The next sweep begins with velocities that the percussions bring, not with those that the last one has left.
    pub(crate) fn forget_velocities(&mut self) {
        self.known = false;
    }

    /// One sweep, colours in the order in which they were given.
    pub(crate) fn sweep(&mut self) {
        self.know_velocities();
        let Self { layout, percussions, velocities, .. } = self;
        let (groups, colours) = (layout.groups(), layout.colours());
        Sweep { groups, colours, relaxation: 1.0, percussions, velocities }.run();
    }

    /// An over-relaxed one, colours in another order every time.
    pub(crate) fn over_relaxed_sweep(&mut self) {
        self.know_velocities();
        let Self { layout, percussions, velocities, order, random, .. } = self;
        for i in (1..order.len()).rev() {
            // The upper bits are the most random.
            *random = random.wrapping_mul(FACTOR).wrapping_add(SUMMAND);
            order.swap(i, (*random >> 33) as usize % (i + 1));
        }
        let (groups, colours) = (layout.groups(), &order[..]);
        Sweep { groups, colours, relaxation: RELAXATION, percussions, velocities }.run();
    }

    /// Velocities that the percussions bring, unless they are known.
    fn know_velocities(&mut self) {
        let Self { layout, percussions, velocities, known, .. } = self;
        if !std::mem::replace(known, true) {
            velocities.clear();
            velocities.resize(layout.bodies() + 1, Velocities::default());
            Brought { groups: layout.groups(), percussions, velocities }.run();
        }
    }

    /// The percussions.
    pub(crate) fn percussion(&self, problem: &ContactProblem, cones: &Cones, into: &mut [f64]) {
        self.layout.unpack(problem, cones, &self.percussions, into);
    }
}

//! Over-relaxed sweeps over the velocities of bodies, colour by colour in a random order.
//!
//! In wide and high packings plain sweeps do not settle for a long time: states of contacts change all over, as in a
//! turbulent flow, until they happen to come to rest. Anderson's acceleration, which takes the map for linear, then makes
//! what it remembers for nothing or drives the changes on, while over-relaxed sweeps (`ω` in `sweeps/body_sweeps`) come to
//! rest sooner. In the same order every time they may go in circles.

use super::cones::Cones;
use super::progress::Progress;
use super::sweeps::BodySweeps;
use crate::solver::report::Method;

/// Sweeps between two looks at the natural map, each of which costs as much as some sweeps.
const CHECK: usize = 250;

/// Buffers.
#[derive(Debug, Clone, Default)]
pub(crate) struct Relaxed {
    percussion: Vec<f64>,
}

impl Relaxed {
    /// From the best percussions until their natural map is below a goal, at most so many sweeps. The problem is the one that
    /// `bodies` have read.
    pub(crate) fn iterate(
        &mut self,
        progress: &mut Progress<'_>,
        bodies: &mut BodySweeps,
        cones: &Cones,
        goal: f64,
        most: usize,
    ) {
        let problem = progress.task.problem;
        progress.start_from_best(&mut self.percussion);
        bodies.start(problem, cones, &self.percussion);
        for sweeps in 1..=most {
            bodies.relaxed_sweep();
            let ends = sweeps == most || progress.task.stop.early();
            if !ends && !sweeps.is_multiple_of(CHECK) {
                continue;
            }
            bodies.percussion(problem, cones, &mut self.percussion);
            let grade = progress.grade(&self.percussion);
            if ends || progress.is_over() || progress.is_hopeless() || grade < goal {
                progress.record(Method::GaussSeidel, sweeps, 0);
                return;
            }
        }
    }
}

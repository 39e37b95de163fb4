//! Over-relaxed sweeps over the velocities of bodies (projected successive over-relaxation, \[Cryer1971\]), colour by colour in a
//! random order.
//!
//! In wide and high packings plain sweeps do not settle for a long time: contacts go on changing their states all over the
//! packing until, by chance, all of them keep their states. Anderson's acceleration takes the map of a sweep for linear. There
//! it forgets what it remembers again and again, and brings nothing.

use super::cones::Cones;
use super::progress::Progress;
use super::sweeps::BodySweeps;
use crate::solver::report::Method;

/// Sweeps between two looks at the natural map, each of which costs as much as some sweeps.
const CHECK: usize = 250;

/// Buffers.
#[derive(Debug, Clone, Default)]
pub(crate) struct OverRelaxed {
    /// Those that the last sweeps have led to.
    percussion: Vec<f64>,
}

impl OverRelaxed {
    /// From the best percussions, where sweeps begin.
    pub(crate) fn begin(&mut self, progress: &Progress<'_>) {
        progress.start_from_best(&mut self.percussion);
    }

    /// From where the last sweeps have led until the natural map is below a goal, at most so many sweeps. The problem is the one
    /// that `bodies` have read.
    pub(crate) fn iterate(
        &mut self,
        progress: &mut Progress<'_>,
        bodies: &mut BodySweeps,
        cones: &Cones,
        goal: f64,
        most: usize,
    ) {
        let problem = progress.task.problem;
        bodies.start(problem, cones, &self.percussion);
        for sweeps in 1..=most {
            bodies.over_relaxed_sweep();
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
            // Rounding of the velocities must not add up.
            bodies.forget_velocities();
        }
    }
}

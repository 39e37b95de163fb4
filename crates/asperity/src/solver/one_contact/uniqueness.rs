//! Where a contact in the plane with a prescribed normal force certainly has one solution.

use asperity_set::{Matrix, Vector};

use super::block::{Block, Shape};
use crate::contact::ContactProblem;
use crate::law::FrictionLaw;

/// What is known of the number of solutions of a contact by the gauge of the load `G_TT⁻¹b_T/P_N` alone.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Uniqueness<'a> {
    law: &'a FrictionLaw<2>,
    /// Gauges between which there may be several solutions, the first one larger where there are none.
    pub(crate) doubtful: (f64, f64),
    /// Whether the direction of the load tells more.
    by_direction: bool,
}

impl<'a> Uniqueness<'a> {
    /// Of the only contact of a problem, whose reservoir `to_disk` maps to the unit disk; nothing where its block is not
    /// sound.
    pub(crate) fn new(
        problem: &ContactProblem,
        law: &'a FrictionLaw<2>,
        to_disk: &Matrix<2>,
    ) -> Option<Self> {
        let block = Block::new(problem, 0);
        // ‖b_T‖ is at least P_N times the gauge over this norm.
        let largest = (to_disk * block.schur_inverse).norm();
        let doubtful = match block.shape {
            Shape::Monotone => (f64::INFINITY, f64::NEG_INFINITY),
            _ => (f64::NEG_INFINITY, block.slip_certificate * largest),
        };
        let by_direction = block.shape == Shape::Scalar;
        block.sound.then_some(Self { law, doubtful, by_direction })
    }

    /// Whether a load whose gauge is one of those may have several solutions. What the law is searched for on this
    /// occasion leaves fewer of these gauges.
    pub(crate) fn may_have_several(&mut self, load: &Vector<2>, gauge: f64) -> bool {
        if !self.by_direction {
            return true;
        }
        let loads = self.law.ambiguous_loads();
        let ((low, high), (least, most)) = (self.doubtful, loads.gauges());
        self.doubtful = (low.max(least), high.min(most));
        loads.may_hold(load, gauge)
    }
}

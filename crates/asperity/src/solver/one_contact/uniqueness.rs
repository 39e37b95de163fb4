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
    /// Of the only contact of a problem, `shape` of whose reservoir maps it to the unit disk; nothing where its block is
    /// not sound.
    pub(crate) fn new(
        problem: &ContactProblem,
        law: &'a FrictionLaw<2>,
        to_disk: &Matrix<2>,
    ) -> Option<Self> {
        let block = Block::new(problem, 0);
        if !block.sound {
            return None;
        }
        // ‖b_T‖ is at least the gauge times P_N over this norm.
        let largest = (to_disk * block.schur_inverse).norm();
        let certain = block.certain_slip * largest;
        let (doubtful, by_direction) = match block.shape {
            Shape::Monotone => ((f64::INFINITY, f64::NEG_INFINITY), false),
            Shape::Scalar => {
                let (low, high) = law.table().ambiguous_gauges();
                ((low, high.min(certain)), true)
            }
            Shape::General => ((f64::NEG_INFINITY, certain), false),
        };
        Some(Self { law, doubtful, by_direction })
    }

    /// Whether a load with a gauge between those may have several solutions.
    pub(crate) fn may_fail(&self, load: &Vector<2>, gauge: f64) -> bool {
        !self.by_direction || self.law.table().may_be_ambiguous(load, gauge)
    }
}

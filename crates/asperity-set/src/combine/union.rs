//! Unions.

use super::seams::seams;
use super::some;
use crate::{SetError, Star, StarSet, Vector};

/// The union `C₁ ∪ C₂ ∪ …`, star-shaped, whose gauge is the smallest one.
#[derive(Debug, Clone, PartialEq)]
pub struct Union<const P: usize> {
    sets: Vec<Star<P>>,
    corners: Vec<Vector<P>>,
}

impl<const P: usize> Union<P> {
    /// The union of some sets.
    ///
    /// # Errors
    ///
    /// [`SetError`] if there are no sets.
    pub fn new(sets: Vec<Star<P>>) -> Result<Self, SetError> {
        some(&sets)?;
        let corners = seams(&sets, f64::min);
        Ok(Self { sets, corners })
    }

    /// The members.
    pub fn sets(&self) -> &[Star<P>] {
        &self.sets
    }
}

impl<const P: usize> StarSet<P> for Union<P> {
    fn gauge(&self, x: &Vector<P>) -> f64 {
        self.sets.iter().map(|set| set.gauge(x)).fold(f64::INFINITY, f64::min)
    }

    fn gauge_jet(&self, x: &Vector<P>) -> (f64, Vector<P>) {
        let jets = self.sets.iter().map(|set| set.gauge_jet(x));
        jets.reduce(|a, b| if b.0 < a.0 { b } else { a }).unwrap_or((0.0, Vector::zeros()))
    }

    fn corners(&self) -> Vec<Vector<P>> {
        self.corners.clone()
    }
}

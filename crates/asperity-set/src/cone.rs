//! Normal cones.

use crate::{StarSet, Vector};

/// A convex cone given by unit generators: `{Σ cᵢ gᵢ : cᵢ ≥ 0}`; no generators: the origin alone.
#[derive(Debug, Clone, PartialEq)]
pub struct NormalCone<const P: usize> {
    generators: Vec<Vector<P>>,
}

impl<const P: usize> NormalCone<P> {
    /// The cone with these generators, scaled to unit length; zero vectors are left out.
    pub fn new(generators: impl IntoIterator<Item = Vector<P>>) -> Self {
        Self { generators: generators.into_iter().filter_map(|g| g.try_normalize(0.0)).collect() }
    }

    /// Normal cone of a set with smooth boundary: a ray on the boundary, the origin inside.
    pub fn smooth<S>(set: &S, x: &Vector<P>, tolerance: f64) -> Option<Self>
    where
        S: StarSet<P> + ?Sized,
    {
        let (gauge, gradient) = set.gauge_jet(x);
        match gauge {
            k if k > 1.0 + tolerance => None,
            k if k < 1.0 - tolerance => Some(Self::new([])),
            _ => Some(Self::new([gradient])),
        }
    }

    /// Unit generators.
    pub fn generators(&self) -> &[Vector<P>] {
        &self.generators
    }

    /// The cone's image under `map`.
    pub(crate) fn mapped(&self, map: &crate::Matrix<P>) -> Self {
        Self::new(self.generators.iter().map(|g| map * g))
    }
}

//! The step that all prox iterations and measures of friction share.
//!
//! The inclusion `ξ_T ∈ N_D(z)`, `z = α(x) x`, `x = −P_T/P_N`, is the fixed point `z = prox_D(z + r ξ_T)` for any `r > 0`
//! (\[WL19\] (69), (70), per unit of `P_N`). Who iterates or measures with it chooses `r`, which may depend on `α`.

use asperity_set::{ConvexSet, Vector};

use crate::law::FrictionLaw;

/// A step for unit normal force, before its projection.
pub(crate) struct ProxStep<const P: usize> {
    /// `α(x)`.
    pub(crate) alpha: f64,
    /// `z = α(x) x`.
    pub(crate) start: Vector<P>,
    /// `z + r ξ_T`.
    pub(crate) target: Vector<P>,
}

impl<const P: usize> FrictionLaw<P> {
    /// The step from `x` by the `r ξ_T` that goes with `α(x)`.
    #[inline(always)]
    pub(crate) fn prox_step(
        &self,
        x: &Vector<P>,
        by: impl FnOnce(f64) -> Vector<P>,
    ) -> ProxStep<P> {
        // One to the bit where D is C.
        let alpha = if self.is_associated() { 1.0 } else { self.alpha_at(x) };
        let start = x * alpha;
        ProxStep { alpha, start, target: start + by(alpha) }
    }
}

impl<const P: usize> ProxStep<P> {
    /// `prox_D(z + r ξ_T)`.
    #[inline(always)]
    pub(crate) fn end(&self, law: &FrictionLaw<P>) -> Vector<P> {
        law.direction().project_from(&self.target, &self.start)
    }
}

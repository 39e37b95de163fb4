//! Star-shaped sets: gauge, gradient, radius, closed form.

use std::fmt::Debug;

use crate::{Matrix, Vector};

/// What of a set is known in closed form.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub enum Form<'a, const P: usize> {
    /// The image of the unit ball under a map with an inverse.
    Ellipsoid {
        /// Maps the unit ball to the set.
        from_ball: Matrix<P>,
        /// Maps the set to the unit ball.
        to_ball: Matrix<P>,
    },
    /// `{x : Σ|xᵢ/aᵢ|^s ≤ 1}`, where `aᵢ` may differ with the sign of `xᵢ`; a box without an exponent.
    Powers {
        /// Semi-axes on the sides of negative coordinates, all positive.
        lower: Vector<P>,
        /// Semi-axes on the sides of positive coordinates.
        upper: Vector<P>,
        /// `1/s`, zero for a box.
        reciprocal: f64,
    },
    /// The image of a set under a regular map.
    Image {
        /// The set that is mapped.
        of: &'a dyn StarSet<P>,
        /// The map.
        map: &'a Matrix<P>,
    },
    /// Nothing.
    Any,
}

/// A compact set with `x ∈ C ⇒ sx ∈ int C` for `0 ≤ s < 1` (\[WL19\] Def. 2).
///
/// Solvers call these methods with points whose squares are numbers; [`Checked`](crate::Checked) takes any point.
///
/// Only [`gauge`](Self::gauge) has to be given; closed forms override the rest.
pub trait StarSet<const P: usize>: Debug + Send + Sync {
    /// Gauge `k(x) = inf{s > 0 : x ∈ sC}` (\[WL19\] Def. 3): positively homogeneous, `C = {k ≤ 1}`.
    fn gauge(&self, x: &Vector<P>) -> f64;

    /// Gauge and its gradient in one evaluation; the gradient is meaningless at the origin.
    ///
    /// Where the boundary has a corner, the gradient is one element of the generalised gradient.
    /// The default takes central differences (relative error about 1e-10).
    fn gauge_jet(&self, x: &Vector<P>) -> (f64, Vector<P>) {
        let step = f64::EPSILON.cbrt() * x.amax();
        let gradient = Vector::from_fn(|i, _| {
            let (mut ahead, mut behind) = (*x, *x);
            ahead[i] += step;
            behind[i] -= step;
            (self.gauge(&ahead) - self.gauge(&behind)) / (ahead[i] - behind[i])
        });
        (self.gauge(x), gradient)
    }

    /// Gradient of the gauge, an outward normal of the boundary; `None` at the origin.
    fn gauge_gradient(&self, x: &Vector<P>) -> Option<Vector<P>> {
        (x.amax() > 0.0).then(|| self.gauge_jet(x).1)
    }

    /// An outward normal of the boundary on the ray of `x ≠ 0`, of any length.
    fn normal(&self, x: &Vector<P>) -> Vector<P> {
        self.gauge_jet(x).1
    }

    /// Distance from the origin to the boundary along `direction`, which need not have unit length.
    fn radius(&self, direction: &Vector<P>) -> f64 {
        direction.norm() / self.gauge(direction)
    }

    /// Whether `k(x) ≤ 1 + tolerance`.
    fn contains(&self, x: &Vector<P>, tolerance: f64) -> bool {
        self.gauge(x) <= 1.0 + tolerance
    }

    /// What is known of the set in closed form, from which comparisons with other sets follow without a search.
    fn form(&self) -> Form<'_, P> {
        Form::Any
    }

    /// Boundary points where the gradient of the gauge jumps or is infinite.
    fn corners(&self) -> Vec<Vector<P>> {
        Vec::new()
    }
}

//! Convex cones: those of normals and of tangents.

use crate::numeric::scaling::at_usual_size;
use crate::numeric::vectors::{along, aside, cast, cross, cross_3, quarter_turn, tangents};
use crate::{Matrix, StarSet, Vector};

/// A convex cone given by unit generators: `{Σ cᵢ gᵢ : cᵢ ≥ 0}`; no generators: the origin alone.
#[derive(Debug, Clone, PartialEq)]
pub struct Cone<const P: usize> {
    generators: Vec<Vector<P>>,
}

impl<const P: usize> Cone<P> {
    /// The cone with these generators, scaled to unit length; zero vectors are left out.
    pub fn new(generators: impl IntoIterator<Item = Vector<P>>) -> Self {
        let unit = |g: Vector<P>| (g / g.amax()).try_normalize(0.0);
        Self { generators: generators.into_iter().filter_map(unit).collect() }
    }

    /// The whole space.
    pub fn whole() -> Self {
        Self::new((0..P).flat_map(|i| [along(i, 1.0), along(i, -1.0)]))
    }

    /// Normal cone of a set with smooth boundary: a ray on the boundary, the origin inside.
    pub fn smooth<S>(set: &S, x: &Vector<P>, tolerance: f64) -> Option<Self>
    where
        S: StarSet<P> + ?Sized,
    {
        match set.gauge(x) {
            k if k > 1.0 + tolerance => None,
            k if k < 1.0 - tolerance => Some(Self::new([])),
            _ => Some(Self::new([set.gauge_jet(x).1])),
        }
    }

    /// Normal cone of a set with listed corners: at a planar corner between the gradients just beside it.
    pub(crate) fn beside_corner<S>(set: &S, x: &Vector<P>, tolerance: f64) -> Option<Self>
    where
        S: StarSet<P> + ?Sized,
    {
        let near = |c: &Vector<P>| (c - x).norm() <= tolerance.max(1e-12) * c.norm();
        match set.corners().into_iter().find(near) {
            Some(corner) if P == 2 => {
                Some(Self::new([1.0, -1.0].map(|side| set.gauge_jet(&aside(&corner, side)).1)))
            }
            _ => Self::smooth(set, x, tolerance),
        }
    }

    /// Unit generators.
    pub fn generators(&self) -> &[Vector<P>] {
        &self.generators
    }

    /// The point of the cone that is nearest to `y`.
    ///
    /// It lies in the span of at most `P` generators with coefficients that are not negative
    /// (Carathéodory), and every such combination lies in the cone: the nearest of them is the point.
    pub fn project(&self, y: &Vector<P>) -> Vector<P> {
        at_usual_size(y, |y| self.nearest(y))
    }

    fn nearest(&self, y: &Vector<P>) -> Vector<P> {
        let count = self.generators.len();
        let mut best = (y.norm_squared(), Vector::zeros());
        let mut consider = |chosen: &[usize]| {
            if let Some(x) = self.within_span(chosen, y) {
                let distance = (y - x).norm_squared();
                if distance < best.0 {
                    best = (distance, x);
                }
            }
        };
        for i in 0..count {
            consider(&[i]);
            for j in i + 1..count {
                consider(&[i, j]);
                for k in j + 1..count {
                    consider(&[i, j, k]);
                }
            }
        }
        best.1
    }

    /// Orthogonal projection onto the span of some generators, if all coefficients are positive.
    fn within_span(&self, chosen: &[usize], y: &Vector<P>) -> Option<Vector<P>> {
        if chosen.len() > P {
            return None;
        }
        let n = chosen.len();
        let basis = |i: usize| &self.generators[chosen[i]];
        if n == P {
            // P generators span the space: y itself, if Cramer's rule gives positive coefficients.
            let volume = |replaced: usize| {
                let column = |i: usize| if i == replaced { y } else { basis(i) };
                match P {
                    1 => column(0)[0],
                    2 => cross(&cast(column(0)), &cast(column(1))),
                    _ => column(0).dot(&cross_3(column(1), column(2))),
                }
            };
            let whole = volume(P);
            let positive = whole.abs() > 1e-14 && (0..P).all(|i| volume(i) * whole >= 0.0);
            return positive.then_some(*y);
        }
        let gram = Matrix::<3>::from_fn(|i, j| match (i < n, j < n) {
            (true, true) => basis(i).dot(basis(j)),
            _ => f64::from(i == j),
        });
        let right = Vector::<3>::from_fn(|i, _| if i < n { basis(i).dot(y) } else { 0.0 });
        if gram.determinant() < 1e-14 {
            return None;
        }
        let weights = gram.try_inverse()? * right;
        let positive = (0..n).all(|i| weights[i] >= 0.0);
        positive.then(|| (0..n).map(|i| basis(i) * weights[i]).sum())
    }

    /// Distance of `y` from the cone.
    pub fn distance(&self, y: &Vector<P>) -> f64 {
        (y - self.project(y)).norm()
    }

    /// The polar cone `{t : tᵀy ≤ 0 for all y in the cone}`.
    pub fn polar(&self) -> Self {
        let normals = &self.generators;
        let Some(first) = normals.first() else { return Self::whole() };
        let sum: Vector<P> = normals.iter().sum();
        // Extreme rays and lines, found among the vectors orthogonal to one or two generators.
        let mut candidates: Vec<Vector<P>> = vec![-sum];
        match P {
            1 => {}
            2 => candidates.extend(normals.iter().map(|n| cast(&quarter_turn(&cast(n))))),
            _ => {
                for (i, a) in normals.iter().enumerate() {
                    let others = normals[..i].iter().map(|b| cross_3(a, b));
                    candidates.extend(others.filter(|c| c.norm() > 1e-9).map(|c| c.normalize()));
                }
                let lines = candidates[1..].to_vec();
                candidates.extend(normals.iter().flat_map(|n| lines.iter().map(|c| cross_3(c, n))));
                if lines.is_empty() {
                    candidates.extend(tangents(first));
                }
            }
        }
        let both = candidates.into_iter().flat_map(|c| [c, -c]);
        let inside = |t: &Vector<P>| normals.iter().all(|n| n.dot(t) <= 1e-12 * t.norm());
        let mut rays: Vec<Vector<P>> = Vec::new();
        for ray in both.filter(|t| t.norm() > 1e-9 && inside(t)).map(|t| t.normalize()) {
            if rays.iter().all(|r| (r - ray).norm() > 1e-9) {
                rays.push(ray);
            }
        }
        Self { generators: rays }
    }

    /// The cone's image under `map`.
    pub(crate) fn mapped(&self, map: &Matrix<P>) -> Self {
        Self::new(self.generators.iter().map(|g| map * g))
    }

    /// The same cone under another constant dimension.
    pub(crate) fn cast<const Q: usize>(&self) -> Cone<Q> {
        Cone { generators: self.generators.iter().map(cast).collect() }
    }
}

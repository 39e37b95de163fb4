//! The rectangle with two half-ellipses.

use crate::{ConvexSet, Ellipse, Matrix, SetError, StarSet, Vector, error::size};

/// Rectangle `|x₁| ≤ a, |x₂| ≤ b` with a half-ellipse of semi-axes `cap` and `b` on either end (\[WL19\]
/// Fig. 7b: the runner of a bobsleigh): the sum of the segment from `−a e₁` to `a e₁` and an ellipse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CappedRectangle {
    a: f64,
    b: f64,
    cap: f64,
    ellipse: Ellipse,
}

impl CappedRectangle {
    /// Half-length `a` and half-width `b` of the rectangle, semi-axis `cap` of the half-ellipses along it.
    ///
    /// # Errors
    ///
    /// [`SetError::Parameter`] if a length is not between 1e-60 and 1e60.
    pub fn new(a: f64, b: f64, cap: f64) -> Result<Self, SetError> {
        let (a, b, cap) = (size("a", a)?, size("b", b)?, size("cap", cap)?);
        Ok(Self { a, b, cap, ellipse: Ellipse::new(Vector::<2>::new(cap, b))? })
    }

    /// Half-length `a` and half-width `b` of the rectangle, and the semi-axis of the half-ellipses along it.
    pub fn parameters(&self) -> [f64; 3] {
        [self.a, self.b, self.cap]
    }

    /// Two points of the upper flat side, whose middle is on the boundary.
    pub(crate) fn flat(&self) -> [Vector<2>; 2] {
        [Vector::<2>::new(-self.a, self.b), Vector::<2>::new(self.a, self.b)]
    }

    /// Centre of the half-ellipse on the side of `x₁`.
    fn centre(&self, along: f64) -> Vector<2> {
        Vector::<2>::new(self.a.copysign(along), 0.0)
    }

    /// `k` and `q = (u − ak)/(ck)` where `(u − ak)² + c²v² = c²k²`: on the caps, `u > av`, with `u = |x₁|` and
    /// `v = |x₂|/b`.
    ///
    /// With `R² = (u − av)(u + av) + c²v²` the quadratic equation has `k = (u² + c²v²)/(au + cR)`, and
    /// `q = (u − av)(u + av)/(uR + acv²)`: nothing cancels but `u − av`, for any sizes of `a` and `c`.
    #[inline]
    fn on_cap(&self, u: f64, v: f64) -> (f64, f64) {
        let (a, c) = (self.a, self.cap);
        let (beyond, flat) = ((u - a * v) * (u + a * v), c * v);
        let root = (beyond + flat * flat).sqrt();
        ((u * u + flat * flat) / (a * u + c * root), beyond / (u * root + a * flat * v))
    }
}

impl StarSet<2> for CappedRectangle {
    #[inline]
    fn gauge(&self, x: &Vector<2>) -> f64 {
        let (u, v) = (x.x.abs(), x.y.abs() / self.b);
        if u <= self.a * v { v } else { self.on_cap(u, v).0 }
    }

    /// On the caps `∇k = (q, cv/k)/(aq + c)` in the coordinates `|x₁|` and `v`, with `q = (|x₁| − ak)/(ck)`. The
    /// rounded boundary point `x/k` would not tell flat sides from caps that are short against their length.
    #[inline]
    fn gauge_jet(&self, x: &Vector<2>) -> (f64, Vector<2>) {
        let (u, v) = (x.x.abs(), x.y.abs() / self.b);
        if u <= self.a * v {
            return (v, Vector::<2>::new(0.0, (1.0 / self.b).copysign(x.y)));
        }
        let (gauge, along) = self.on_cap(u, v);
        let size = self.a * along + self.cap;
        let across = self.cap * v / gauge / self.b;
        (gauge, Vector::<2>::new((along / size).copysign(x.x), (across / size).copysign(x.y)))
    }
}

impl ConvexSet<2> for CappedRectangle {
    #[inline]
    fn support_point(&self, y: &Vector<2>) -> Vector<2> {
        let point = self.ellipse.support_point(y);
        if y.x == 0.0 { point } else { point + self.centre(y.x) }
    }

    fn support_jet(&self, y: &Vector<2>) -> (Vector<2>, Matrix<2>) {
        let (_, mut hessian) = self.ellipse.support_jet(y);
        if y.x == 0.0 {
            hessian[(0, 0)] = f64::INFINITY;
        }
        (self.support_point(y), hessian)
    }

    /// Beside the rectangle the nearest point lies straight across, beyond it on a cap.
    fn project(&self, z: &Vector<2>) -> Vector<2> {
        if z.x.abs() <= self.a {
            return Vector::<2>::new(z.x, z.y.clamp(-self.b, self.b));
        }
        let centre = self.centre(z.x);
        self.ellipse.project(&(z - centre)) + centre
    }

    fn project_jet(&self, z: &Vector<2>, start: &Vector<2>) -> (Vector<2>, Matrix<2>) {
        if z.x.abs() <= self.a {
            let x = self.project(z);
            return (x, Matrix::<2>::new(1.0, 0.0, 0.0, f64::from(x == *z)));
        }
        let centre = self.centre(z.x);
        let (x, jacobian) = self.ellipse.project_jet(&(z - centre), &(start - centre));
        // A point inside comes back as it is.
        (if x == z - centre { *z } else { x + centre }, jacobian)
    }

    fn flat_normals(&self) -> Vec<Vector<2>> {
        vec![Vector::<2>::y(), -Vector::<2>::y()]
    }
}

//! The ellipsoid, in the plane the ellipse.

use crate::{ConvexSet, Matrix, SetError, StarSet, Vector, error::positive};

/// `{x : ‖diag(1/a) Rᵀx‖ ≤ 1}` with semi-axes `a` along the columns of the rotation `R`.
///
/// Kept in factors: the matrix of the quadratic form would lose all digits at axis ratios of 1e8.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ellipsoid<const P: usize> {
    semi_axes: Vector<P>,
    axes: Matrix<P>,
}

/// The planar [`Ellipsoid`] (\[WL19\] (34)).
pub type Ellipse = Ellipsoid<2>;

impl<const P: usize> Ellipsoid<P> {
    /// Ellipsoid with semi-axes along the coordinate axes.
    pub fn new(semi_axes: Vector<P>) -> Result<Self, SetError> {
        for &a in semi_axes.iter() {
            positive("semi_axes", a)?;
        }
        Ok(Self { semi_axes, axes: Matrix::identity() })
    }

    /// The image of the unit ball under a regular `map`.
    ///
    /// One-sided Jacobi rotations make the columns orthogonal; they keep small axes accurate.
    pub(crate) fn from_map(map: &Matrix<P>) -> Result<Self, SetError> {
        let mut columns = *map;
        for _ in 0..60 {
            let mut rotated = false;
            for i in 0..P {
                for j in i + 1..P {
                    rotated |= orthogonalise(&mut columns, i, j);
                }
            }
            if !rotated {
                break;
            }
        }
        let semi_axes = Vector::from_fn(|i, _| columns.column(i).norm());
        let axes = Matrix::from_fn(|i, j| columns[(i, j)] / semi_axes[j]);
        Ok(Self { semi_axes: Self::new(semi_axes)?.semi_axes, axes })
    }

    /// Semi-axes.
    pub fn semi_axes(&self) -> &Vector<P> {
        &self.semi_axes
    }

    /// Unit vectors along the semi-axes, as columns.
    pub fn axes(&self) -> &Matrix<P> {
        &self.axes
    }

    pub(crate) fn scaled(&self, factor: f64) -> Result<Self, SetError> {
        Ok(Self { axes: self.axes, ..Self::new(self.semi_axes * factor)? })
    }

    /// The image under `map`, which is an ellipsoid again.
    pub(crate) fn mapped(&self, map: &Matrix<P>) -> Result<Self, SetError> {
        Self::from_map(&(map * self.axes * Matrix::from_diagonal(&self.semi_axes)))
    }

    pub(crate) fn rotated(&self, rotation: &Matrix<P>) -> Self {
        Self { semi_axes: self.semi_axes, axes: rotation * self.axes }
    }
}

/// Rotates columns `i` and `j` among themselves until they are orthogonal; whether that was needed.
fn orthogonalise<const P: usize>(columns: &mut Matrix<P>, i: usize, j: usize) -> bool {
    let (ci, cj) = (columns.column(i).clone_owned(), columns.column(j).clone_owned());
    let (ni, nj) = (ci.norm(), cj.norm());
    let overlap = ci.dot(&cj);
    if overlap.abs() <= 4.0 * f64::EPSILON * ni * nj {
        return false;
    }
    let zeta = (nj - ni) * (nj + ni) / (2.0 * overlap);
    let tangent = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
    let (cosine, sine) = (1.0 / tangent.hypot(1.0), tangent / tangent.hypot(1.0));
    columns.set_column(i, &(ci * cosine - cj * sine));
    columns.set_column(j, &(ci * sine + cj * cosine));
    true
}

impl Ellipse {
    /// Semi-axes `(a, b)` and angle in rad of `k² = (x₁/n₁)² + (x₂/n₂)² + ν x₁x₂`, `|ν| < 2/(n₁n₂)`
    /// (\[WL19\] (115)); `a` is the axis in the first or fourth quadrant that lies nearer to `e₁`.
    pub fn from_intercepts(n1: f64, n2: f64, nu: f64) -> Result<(f64, f64, f64), SetError> {
        let (p, q) = (1.0 / positive("n1", n1)?.powi(2), 1.0 / positive("n2", n2)?.powi(2));
        // det = (1/(n₁n₂) − ν/2)(1/(n₁n₂) + ν/2) keeps the small eigenvalue accurate near the limit.
        let determinant = (1.0 / (n1 * n2) - 0.5 * nu) * (1.0 / (n1 * n2) + 0.5 * nu);
        if !(nu.is_finite() && determinant > 0.0) {
            let allowed = "below 2/(n1*n2) in size";
            return Err(SetError::Parameter { argument: "nu", allowed, value: nu });
        }
        let large = 0.5 * (p + q) + (0.5 * (p - q)).hypot(0.5 * nu);
        let small = determinant / large;
        let (first, second) = if p >= q { (large, small) } else { (small, large) };
        let difference = if p >= q { p - q } else { q - p };
        let angle = 0.5 * (if p >= q { nu } else { -nu }).atan2(difference);
        Ok((first.sqrt().recip(), second.sqrt().recip(), angle))
    }
}

impl<const P: usize> StarSet<P> for Ellipsoid<P> {
    #[inline]
    fn gauge(&self, x: &Vector<P>) -> f64 {
        self.axes.tr_mul(x).component_div(&self.semi_axes).norm()
    }

    #[inline]
    fn gauge_jet(&self, x: &Vector<P>) -> (f64, Vector<P>) {
        let unit = self.axes.tr_mul(x).component_div(&self.semi_axes);
        let gauge = unit.norm();
        (gauge, self.axes * (unit / gauge).component_div(&self.semi_axes))
    }
}

impl<const P: usize> ConvexSet<P> for Ellipsoid<P> {
    #[inline]
    fn support_point(&self, y: &Vector<P>) -> Vector<P> {
        let stretched = self.axes.tr_mul(y).component_mul(&self.semi_axes);
        self.axes * (stretched / stretched.norm()).component_mul(&self.semi_axes)
    }

    fn support(&self, y: &Vector<P>) -> f64 {
        self.axes.tr_mul(y).component_mul(&self.semi_axes).norm()
    }

    #[inline]
    fn support_jet(&self, y: &Vector<P>) -> (Vector<P>, Matrix<P>) {
        let stretched = self.axes.tr_mul(y).component_mul(&self.semi_axes);
        let support = stretched.norm();
        let unit = stretched / support;
        let factor = self.axes * Matrix::from_diagonal(&self.semi_axes);
        let tangential = (Matrix::identity() - unit * unit.transpose()) / support;
        (factor * unit, factor * tangential * factor.transpose())
    }

    fn project(&self, z: &Vector<P>) -> Vector<P> {
        self.project_with(z, |_| 0.0)
    }

    /// On the boundary `z = x + t x/a²` in the axes: the start gives `t` to second order.
    fn project_from(&self, z: &Vector<P>, start: &Vector<P>) -> Vector<P> {
        self.project_with(z, |local| {
            let start = self.axes.tr_mul(start);
            let normal = start.component_div(&self.semi_axes).component_div(&self.semi_axes);
            normal.dot(&(local - start)) / normal.norm_squared()
        })
    }
}

impl<const P: usize> Ellipsoid<P> {
    /// `xᵢ = aᵢ²zᵢ/(t + aᵢ²)`, `t` the root of the secular equation `‖aᵢzᵢ/(t + aᵢ²)‖ = 1`.
    ///
    /// Newton's method on the reciprocal norm, which is nearly linear in `t`, from a lower bound or a
    /// better guess in the axes of the ellipsoid.
    #[inline]
    fn project_with(&self, z: &Vector<P>, guess: impl Fn(&Vector<P>) -> f64) -> Vector<P> {
        let local = self.axes.tr_mul(z);
        let unit = local.component_div(&self.semi_axes);
        if unit.norm_squared() <= 1.0 {
            return *z;
        }
        let squares = self.semi_axes.component_mul(&self.semi_axes);
        let stretched = local.component_mul(&self.semi_axes);
        let mut lowest = f64::max(0.0, stretched.norm() - squares.max());
        for i in 0..P {
            lowest = lowest.max(stretched[i].abs() - squares[i]);
        }
        // A guess that is no number falls back to the bound.
        let mut t = guess(&local).max(lowest);
        let mut on_sphere = stretched.component_div(&squares.map(|s| t + s));
        for _ in 0..100 {
            let norm2 = on_sphere.norm_squared();
            let slope = on_sphere.component_div(&squares.map(|s| t + s)).dot(&on_sphere);
            let step = norm2 * (norm2.sqrt() - 1.0) / slope;
            t = f64::max(t + step, lowest);
            on_sphere = stretched.component_div(&squares.map(|s| t + s));
            if step.abs() <= 4.0 * f64::EPSILON * (t + squares.min()) {
                break;
            }
        }
        self.axes * on_sphere.normalize().component_mul(&self.semi_axes)
    }
}

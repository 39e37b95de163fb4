//! The ellipsoid, in the plane the ellipse.

use crate::numeric::vectors::orthogonalise;
use crate::project::jet::on_level;
use crate::{ConvexSet, Form, Matrix, SetError, StarSet, Vector, error::size};

/// How far axes that are given may be from orthonormal ones: they come from rotations and factorisations.
const ORTHONORMAL: f64 = 1e-12;

/// `{x : ‖diag(1/a) Rᵀx‖ ≤ 1}` with semi-axes `a` along the columns of the rotation `R`.
///
/// Kept in factors: the matrix of the quadratic form would lose all digits at axis ratios of 1e8.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ellipsoid<const P: usize> {
    semi_axes: Vector<P>,
    axes: Matrix<P>,
    /// `R diag(a)`, which maps the unit ball to the set.
    from_ball: Matrix<P>,
    /// `diag(1/a) Rᵀ`, which maps the set to the unit ball.
    to_ball: Matrix<P>,
}

/// The planar [`Ellipsoid`] (\[WL19\] (34)).
pub type Ellipse = Ellipsoid<2>;

impl<const P: usize> Ellipsoid<P> {
    /// Ellipsoid with semi-axes along the coordinate axes.
    ///
    /// # Errors
    ///
    /// [`SetError::Parameter`] if a semi-axis is not between 1e-60 and 1e60.
    pub fn new(semi_axes: Vector<P>) -> Result<Self, SetError> {
        Self::along(semi_axes, Matrix::identity())
    }

    /// Ellipsoid with semi-axes along these unit vectors, the columns of a matrix.
    ///
    /// # Errors
    ///
    /// As [`Self::new`], and [`SetError::Shape`] if the columns are not orthonormal to 1e-12.
    pub fn turned(semi_axes: Vector<P>, axes: Matrix<P>) -> Result<Self, SetError> {
        let defect = (axes.transpose() * axes - Matrix::identity()).amax();
        if !(defect <= ORTHONORMAL) {
            let message = "must have orthonormal columns".into();
            return Err(SetError::Shape { argument: "axes", message });
        }
        Self::along(semi_axes, axes)
    }

    /// Ellipsoid with semi-axes along the columns of a rotation.
    pub(crate) fn along(semi_axes: Vector<P>, axes: Matrix<P>) -> Result<Self, SetError> {
        for &a in semi_axes.iter() {
            size("semi_axes", a)?;
        }
        let from_ball = Matrix::from_fn(|i, j| axes[(i, j)] * semi_axes[j]);
        let to_ball = Matrix::from_fn(|i, j| axes[(j, i)] / semi_axes[i]);
        Ok(Self { semi_axes, axes, from_ball, to_ball })
    }

    /// The image of the unit ball under a regular `map`.
    ///
    pub(crate) fn from_map(map: &Matrix<P>) -> Result<Self, SetError> {
        let mut columns = *map;
        orthogonalise(&mut columns);
        let semi_axes = Vector::from_fn(|i, _| columns.column(i).norm());
        Self::along(semi_axes, Matrix::from_fn(|i, j| columns[(i, j)] / semi_axes[j]))
    }

    /// Semi-axes.
    pub fn semi_axes(&self) -> &Vector<P> {
        &self.semi_axes
    }

    /// Unit vectors along the semi-axes, as columns.
    pub fn axes(&self) -> &Matrix<P> {
        &self.axes
    }

    /// The map of the set to the unit ball.
    pub fn to_ball(&self) -> &Matrix<P> {
        &self.to_ball
    }

    pub(crate) fn scaled(&self, factor: f64) -> Result<Self, SetError> {
        Self::along(self.semi_axes * factor, self.axes)
    }

    /// The image under `map`, which is an ellipsoid again.
    pub(crate) fn mapped(&self, map: &Matrix<P>) -> Result<Self, SetError> {
        Self::from_map(&(map * self.from_ball))
    }

    pub(crate) fn rotated(&self, rotation: &Matrix<P>) -> Result<Self, SetError> {
        Self::along(self.semi_axes, rotation * self.axes)
    }
}

impl Ellipse {
    /// Semi-axes `(a, b)` and angle in rad of `k² = (x₁/n₁)² + (x₂/n₂)² + ν x₁x₂`, `|ν| < 2/(n₁n₂)`
    /// (\[WL19\] (115)); `a` is the axis in the first or fourth quadrant that lies nearer to `e₁`.
    ///
    /// # Errors
    ///
    /// [`SetError::Parameter`] if an intercept is not between 1e-60 and 1e60, or `nu` out of its range.
    pub fn from_intercepts(n1: f64, n2: f64, nu: f64) -> Result<(f64, f64, f64), SetError> {
        let (p, q) = (1.0 / size("n1", n1)?.powi(2), 1.0 / size("n2", n2)?.powi(2));
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
        (self.to_ball * x).norm()
    }

    #[inline(always)]
    fn gauge_jet(&self, x: &Vector<P>) -> (f64, Vector<P>) {
        let unit = self.to_ball * x;
        let gauge = unit.norm();
        (gauge, self.to_ball.tr_mul(&unit) * (1.0 / gauge))
    }

    #[inline]
    fn normal(&self, x: &Vector<P>) -> Vector<P> {
        self.to_ball.tr_mul(&(self.to_ball * x))
    }

    fn form(&self) -> Form<'_, P> {
        Form::Ellipsoid { from_ball: self.from_ball, to_ball: self.to_ball }
    }
}

impl<const P: usize> ConvexSet<P> for Ellipsoid<P> {
    #[inline]
    fn support_point(&self, y: &Vector<P>) -> Vector<P> {
        let stretched = self.from_ball.tr_mul(y);
        self.from_ball * (stretched * (1.0 / stretched.norm()))
    }

    fn support(&self, y: &Vector<P>) -> f64 {
        self.from_ball.tr_mul(y).norm()
    }

    #[inline]
    fn support_jet(&self, y: &Vector<P>) -> (Vector<P>, Matrix<P>) {
        let stretched = self.from_ball.tr_mul(y);
        let reciprocal = 1.0 / stretched.norm();
        let unit = stretched * reciprocal;
        let point = self.from_ball * unit;
        let tangential = (Matrix::identity() - unit * unit.transpose()) * reciprocal;
        (point, self.from_ball * tangential * self.from_ball.transpose())
    }

    #[inline(always)]
    fn support_derivative(&self, y: &Vector<P>, dy: &Vector<P>) -> (Vector<P>, Vector<P>) {
        let stretched = self.from_ball.tr_mul(y);
        let reciprocal = 1.0 / stretched.norm();
        let (unit, change) = (stretched * reciprocal, self.from_ball.tr_mul(dy));
        let across = change - unit * unit.dot(&change);
        (self.from_ball * unit, self.from_ball * across * reciprocal)
    }

    /// From a lower bound of the root Newton's method never oversteps.
    fn project(&self, z: &Vector<P>) -> Vector<P> {
        if self.gauge(z) <= 1.0 {
            return *z;
        }
        let local = self.axes.tr_mul(z);
        let (stretched, squares) = (local.component_mul(&self.semi_axes), self.squares());
        let mut t = f64::max(0.0, stretched.norm() - squares.max());
        for i in 0..P {
            t = t.max(stretched[i].abs() - squares[i]);
        }
        for _ in 0..100 {
            let (on_sphere, step) = secular_step(&stretched, &squares, t);
            if step <= 4.0 * f64::EPSILON * (t + squares.min()) {
                return self.boundary_point(&on_sphere);
            }
            t += step;
        }
        self.boundary_point(&secular_step(&stretched, &squares, t).0)
    }

    /// On the boundary `z = x + t x/a²` in the axes, which gives `t` to second order.
    #[inline]
    fn project_from(&self, z: &Vector<P>, start: &Vector<P>) -> Vector<P> {
        if self.gauge(z) <= 1.0 {
            return *z;
        }
        let (local, start) = (self.axes.tr_mul(z), self.axes.tr_mul(start));
        let (stretched, squares) = (local.component_mul(&self.semi_axes), self.squares());
        let normal = start.component_div(&squares);
        let mut t = normal.dot(&(local - start)) / normal.norm_squared();
        for _ in 0..4 {
            // A start that is far off, or no number, is of no use.
            if !(t >= 0.0) {
                break;
            }
            let (on_sphere, step) = secular_step(&stretched, &squares, t);
            if step.abs() <= 4.0 * f64::EPSILON * (t + squares.min()) {
                return self.boundary_point(&on_sphere);
            }
            t += step;
        }
        self.project(z)
    }

    /// In the axes `x + t x/a² = z`.
    #[inline]
    fn project_jet(&self, z: &Vector<P>, start: &Vector<P>) -> (Vector<P>, Matrix<P>) {
        if self.gauge(z) <= 1.0 {
            return (*z, Matrix::identity());
        }
        let x = self.project_from(z, start);
        let (squares, local) = (self.squares(), self.axes.tr_mul(&x));
        let normal = local.component_div(&squares);
        let t = normal.dot(&(self.axes.tr_mul(z) - local)).max(0.0) / normal.norm_squared();
        let inner = on_level(&squares.map(|s| s / (s + t)), &normal);
        (x, self.axes * inner * self.axes.transpose())
    }
}

impl<const P: usize> Ellipsoid<P> {
    #[inline]
    fn squares(&self) -> Vector<P> {
        self.semi_axes.component_mul(&self.semi_axes)
    }

    /// The boundary point `R (a ∘ w/‖w‖)`.
    #[inline]
    fn boundary_point(&self, w: &Vector<P>) -> Vector<P> {
        self.from_ball * (w * (1.0 / w.norm()))
    }
}

/// The projection is `xᵢ = aᵢ²zᵢ/(t + aᵢ²)` with `t` the root of the secular equation `‖w‖ = 1`,
/// `wᵢ = aᵢzᵢ/(t + aᵢ²)`: `w` at `t`, and Newton's step for `1/‖w‖ = 1`, which is nearly linear in `t`.
#[inline]
fn secular_step<const P: usize>(
    stretched: &Vector<P>,
    squares: &Vector<P>,
    t: f64,
) -> (Vector<P>, f64) {
    let reciprocal = squares.map(|s| 1.0 / (t + s));
    let w = stretched.component_mul(&reciprocal);
    let norm2 = w.norm_squared();
    (w, norm2 * (norm2.sqrt() - 1.0) / w.component_mul(&reciprocal).dot(&w))
}

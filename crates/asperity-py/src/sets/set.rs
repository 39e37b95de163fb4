//! Sets.

use asperity::set::{
    Ball, CappedRectangle, Checked, Convex, CoulombContensou, Cuboid, Ellipse, Ellipsoid,
    PolarCurve, Polygon, Pressure, Star, Superellipsoid, SupportCurve, WedgeAsperity,
    convexity_unless, largest_ratio_unless, strict_convexity_unless, symmetry_unless,
};
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::prelude::*;

use super::any_star::{AnyStar, both, build, combined, each, map};
use super::batch::{Answer, answer, convex, each_point, flat, touching};
use crate::convert::{Numbers, Points, numbers, points, rows, square, vector};
use crate::errors::{Failure, dimension, parameter};
use crate::interrupt::asked;

/// A star-shaped set.
#[pyclass(frozen, module = "asperity._core")]
pub struct Set(pub AnyStar);

#[pymethods]
impl Set {
    #[staticmethod]
    fn ball(dimension: usize, radius: f64) -> Result<Self, Failure> {
        let ball = Ball::new(radius)?;
        Ok(Self(build!(dimension, "dimension", P => Star::Convex(Convex::<P>::from(ball)))))
    }

    #[staticmethod]
    fn cuboid(lower: Numbers<'_>, upper: Numbers<'_>) -> Result<Self, Failure> {
        Ok(Self(build!(numbers(&lower, "lower")?.len(), "lower", P => {
            let cuboid = Cuboid::<P>::new(vector(&lower, "lower")?, vector(&upper, "upper")?)?;
            Star::Convex(cuboid.into())
        })))
    }

    #[staticmethod]
    #[pyo3(signature = (semi_axes, axes = None))]
    fn ellipsoid(semi_axes: Numbers<'_>, axes: Option<Points<'_>>) -> Result<Self, Failure> {
        Ok(Self(build!(numbers(&semi_axes, "semi_axes")?.len(), "semi_axes", P => {
            let semi_axes = vector(&semi_axes, "semi_axes")?;
            let ellipsoid = match &axes {
                None => Ellipsoid::<P>::new(semi_axes),
                Some(axes) => Ellipsoid::turned(semi_axes, square(axes, "axes")?),
            };
            Star::Convex(ellipsoid?.into())
        })))
    }

    #[staticmethod]
    fn ellipse_from_intercepts(n1: f64, n2: f64, nu: f64) -> Result<(f64, f64, f64), Failure> {
        Ok(Ellipse::from_intercepts(n1, n2, nu)?)
    }

    #[staticmethod]
    fn superellipsoid(semi_axes: Numbers<'_>, exponent: f64) -> Result<Self, Failure> {
        Ok(Self(build!(numbers(&semi_axes, "semi_axes")?.len(), "semi_axes", P => {
            Superellipsoid::<P>::new(vector(&semi_axes, "semi_axes")?, exponent)?.into()
        })))
    }

    #[staticmethod]
    fn capped_rectangle(a: f64, b: f64, cap: f64) -> Result<Self, Failure> {
        Ok(Self::planar(Convex::from(CappedRectangle::new(a, b, cap)?).into()))
    }

    #[staticmethod]
    fn wedge_asperity(mu: f64, beta: f64) -> Result<Self, Failure> {
        Ok(Self::planar(WedgeAsperity::new(mu, beta)?.into()))
    }

    #[staticmethod]
    fn polygon(vertices: Points<'_>) -> Result<Self, Failure> {
        let vertices: Vec<_> = points(&vertices, "vertices")?.collect();
        Ok(Self::planar(Polygon::new(&vertices)?.into()))
    }

    #[staticmethod]
    fn polar_curve(angle: Numbers<'_>, radius: Numbers<'_>) -> Result<Self, Failure> {
        let curve = PolarCurve::new(numbers(&angle, "angle")?, numbers(&radius, "radius")?)?;
        Ok(Self::planar(curve.into()))
    }

    #[staticmethod]
    fn support_curve(angle: Numbers<'_>, support: Numbers<'_>) -> Result<Self, Failure> {
        let curve = SupportCurve::new(numbers(&angle, "angle")?, numbers(&support, "support")?)?;
        Ok(Self::planar(Convex::from(curve).into()))
    }

    #[staticmethod]
    fn coulomb_contensou(mu: f64, pressure: &str) -> Result<Self, Failure> {
        let pressure = match pressure {
            "hertz" => Pressure::Hertz,
            "uniform" => Pressure::Uniform,
            _ => return Err(parameter("pressure", "must be 'hertz' or 'uniform'").into()),
        };
        let set = Convex::from(CoulombContensou::new(mu, pressure)?);
        Ok(Self(AnyStar::Three(set.into())))
    }

    #[staticmethod]
    fn intersection(sets: Vec<PyRef<'_, Self>>) -> Result<Self, Failure> {
        Ok(Self(combined!(sets, Star::intersection)))
    }

    #[staticmethod]
    fn union(sets: Vec<PyRef<'_, Self>>) -> Result<Self, Failure> {
        Ok(Self(combined!(sets, Star::union)))
    }

    #[staticmethod]
    fn minkowski_sum(sets: Vec<PyRef<'_, Self>>) -> Result<Self, Failure> {
        Ok(Self(combined!(sets, Star::minkowski_sum)))
    }

    fn convexity<'py>(&self, py: Python<'py>) -> PyResult<Answer<'py>> {
        each!(&self.0, set => answer(py, &asked(py, |cancelled| convexity_unless(set, cancelled))?))
    }

    fn strict_convexity<'py>(&self, py: Python<'py>) -> PyResult<Answer<'py>> {
        each!(&self.0, set => answer(py, &asked(py, |cancelled| strict_convexity_unless(set, cancelled))?))
    }

    fn symmetry<'py>(&self, py: Python<'py>) -> PyResult<Answer<'py>> {
        each!(&self.0, set => answer(py, &asked(py, |cancelled| symmetry_unless(set, cancelled))?))
    }

    fn scale_inside<'py>(
        &self,
        py: Python<'py>,
        outer: &Self,
    ) -> Result<(f64, Bound<'py, PyArray1<f64>>), Failure> {
        let (ratio, at) = both!(
            &self.0,
            &outer.0,
            (a, b) => touching(asked(py, |cancelled| largest_ratio_unless(b, a, cancelled))?),
            return Err(dimension("outer", "must have the dimension of the set").into())
        );
        Ok((1.0 / ratio, PyArray1::from_vec(py, at)))
    }

    fn rotated(&self, angle: f64) -> Result<Self, Failure> {
        match &self.0 {
            AnyStar::Two(set) => Ok(Self(AnyStar::Two(set.rotated(angle)?))),
            _ => Err(dimension("set", "must be planar to be rotated by an angle").into()),
        }
    }

    fn scaled(&self, factor: f64) -> Result<Self, Failure> {
        Ok(Self(map!(&self.0, set => set.scaled(factor)?)))
    }

    fn mapped(&self, matrix: Points<'_>) -> Result<Self, Failure> {
        Ok(Self(map!(&self.0, set => set.mapped(&square(&matrix, "matrix")?)?)))
    }

    #[getter]
    fn dimension(&self) -> usize {
        self.0.dimension()
    }

    #[getter]
    fn is_convex(&self) -> bool {
        each!(&self.0, set => set.as_convex().is_some())
    }

    fn gauge<'py>(
        &self,
        py: Python<'py>,
        x: Points<'_>,
    ) -> Result<Bound<'py, PyArray1<f64>>, Failure> {
        let out = each!(&self.0, set => each_point(py, &x, "x", 1, |x, _, out| {
            Checked(set).gauge(x).map(|k| out.push(k))
        }))?;
        Ok(PyArray1::from_vec(py, out))
    }

    fn gauge_gradient<'py>(
        &self,
        py: Python<'py>,
        x: Points<'_>,
    ) -> Result<Bound<'py, PyArray2<f64>>, Failure> {
        let p = self.dimension();
        let out = each!(&self.0, set => each_point(py, &x, "x", p, |x, _, out| {
            Checked(set).gauge_gradient(x).map(|g| out.extend_from_slice(g.as_slice()))
        }))?;
        Ok(rows(py, out, p)?)
    }

    fn support<'py>(
        &self,
        py: Python<'py>,
        y: Points<'_>,
    ) -> Result<Bound<'py, PyArray1<f64>>, Failure> {
        let out = each!(&self.0, set => {
            let set = convex(set)?;
            each_point(py, &y, "y", 1, |y, _, out| Checked(set).support(y).map(|h| out.push(h)))
        })?;
        Ok(PyArray1::from_vec(py, out))
    }

    fn support_point<'py>(
        &self,
        py: Python<'py>,
        y: Points<'_>,
    ) -> Result<Bound<'py, PyArray2<f64>>, Failure> {
        let p = self.dimension();
        let out = each!(&self.0, set => {
            let set = convex(set)?;
            each_point(py, &y, "y", p, |y, _, out| {
                Checked(set).support_point(y).map(|x| out.extend_from_slice(x.as_slice()))
            })
        })?;
        Ok(rows(py, out, p)?)
    }

    fn support_hessian<'py>(
        &self,
        py: Python<'py>,
        y: Points<'_>,
    ) -> Result<Bound<'py, PyArray3<f64>>, Failure> {
        let p = self.dimension();
        let out = each!(&self.0, set => {
            let set = convex(set)?;
            each_point(py, &y, "y", p * p, |y, _, out| {
                Checked(set).support_hessian(y).map(|h| out.extend_from_slice(h.as_slice()))
            })
        })?;
        let n = out.len() / (p * p);
        Ok(PyArray1::from_vec(py, out).reshape([n, p, p])?)
    }

    fn project<'py>(
        &self,
        py: Python<'py>,
        z: Points<'_>,
    ) -> Result<Bound<'py, PyArray2<f64>>, Failure> {
        let p = self.dimension();
        let out = each!(&self.0, set => {
            let set = convex(set)?;
            each_point(py, &z, "z", p, |z, _, out| {
                Checked(set).project(z).map(|x| out.extend_from_slice(x.as_slice()))
            })
        })?;
        Ok(rows(py, out, p)?)
    }

    fn normal_cone<'py>(
        &self,
        py: Python<'py>,
        x: Numbers<'_>,
        tolerance: f64,
    ) -> Result<Option<Bound<'py, PyArray2<f64>>>, Failure> {
        let found: Option<Vec<f64>> = each!(&self.0, set => {
            let cone = Checked(convex(set)?).normal_cone(&vector(&x, "x")?, tolerance)?;
            cone.map(|cone| flat(cone.generators()))
        });
        Ok(found.map(|out| rows(py, out, self.dimension())).transpose()?)
    }

    fn tangent_cone<'py>(
        &self,
        py: Python<'py>,
        x: Numbers<'_>,
        tolerance: f64,
    ) -> Result<Option<Vec<Bound<'py, PyArray2<f64>>>>, Failure> {
        let found: Option<Vec<Vec<f64>>> = each!(&self.0, set => {
            let parts = Checked(set).tangent_cone(&vector(&x, "x")?, tolerance)?;
            parts.map(|parts| parts.iter().map(|part| flat(part.generators())).collect())
        });
        let Some(parts) = found else { return Ok(None) };
        let parts = parts.into_iter().map(|part| rows(py, part, self.dimension()));
        Ok(Some(parts.collect::<PyResult<_>>()?))
    }
}

impl Set {
    fn planar(set: Star<2>) -> Self {
        Self(AnyStar::Two(set))
    }
}

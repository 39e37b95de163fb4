//! Sets.

use asperity::set::{
    Ball, Convex, ConvexSet, Cuboid, Ellipse, Ellipsoid, Star, StarSet, Superellipsoid, Vector,
};
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::prelude::*;

use crate::convert::{Numbers, Points, numbers, points, rows, square, vector};
use crate::errors::{Failure, dimension, parameter};

/// A set of any dimension.
#[derive(Debug, Clone)]
pub enum AnyStar {
    One(Star<1>),
    Two(Star<2>),
    Three(Star<3>),
}

/// A star-shaped set.
#[pyclass(frozen, module = "asperity._core")]
pub struct Set(pub AnyStar);

/// Does the same with the set inside, whatever its dimension.
macro_rules! each {
    ($any:expr, $set:ident => $call:expr) => {
        match $any {
            AnyStar::One($set) => $call,
            AnyStar::Two($set) => $call,
            AnyStar::Three($set) => $call,
        }
    };
}

/// Builds the set of a dimension known at run time only.
macro_rules! build {
    ($dimension:expr, $argument:expr, $P:ident => $make:expr) => {
        match $dimension {
            1 => {
                const $P: usize = 1;
                AnyStar::One($make)
            }
            2 => {
                const $P: usize = 2;
                AnyStar::Two($make)
            }
            3 => {
                const $P: usize = 3;
                AnyStar::Three($make)
            }
            other => {
                let message = format!("must give a set of dimension 1, 2 or 3, gives {other}");
                return Err(dimension($argument, &message).into());
            }
        }
    };
}

/// The convex set inside, or the error that names the missing property.
fn convex<const P: usize>(set: &Star<P>) -> PyResult<&Convex<P>> {
    set.as_convex().ok_or_else(|| parameter("set", "must be convex for this, is star-shaped only"))
}

fn each_number<const P: usize>(
    x: &Points<'_>,
    argument: &str,
    f: impl Fn(&Vector<P>) -> f64,
) -> PyResult<Vec<f64>> {
    Ok(points::<P>(x, argument)?.map(|x| f(&x)).collect())
}

fn each_vector<const P: usize>(
    x: &Points<'_>,
    argument: &str,
    f: impl Fn(&Vector<P>) -> Vector<P>,
) -> PyResult<(Vec<f64>, usize)> {
    let mut out = Vec::with_capacity(x.as_array().len());
    for x in points::<P>(x, argument)? {
        out.extend_from_slice(f(&x).as_slice());
    }
    Ok((out, P))
}

fn nonzero<const P: usize>(y: &Points<'_>, argument: &str) -> PyResult<()> {
    if points::<P>(y, argument)?.any(|y| y.amax() == 0.0) {
        return Err(parameter(argument, "must not be zero"));
    }
    Ok(())
}

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
    fn ellipsoid(semi_axes: Numbers<'_>) -> Result<Self, Failure> {
        Ok(Self(build!(numbers(&semi_axes, "semi_axes")?.len(), "semi_axes", P => {
            Star::Convex(Ellipsoid::<P>::new(vector(&semi_axes, "semi_axes")?)?.into())
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

    fn rotated(&self, angle: f64) -> Result<Self, Failure> {
        match &self.0 {
            AnyStar::Two(set) => Ok(Self(AnyStar::Two(set.rotated(angle)?))),
            _ => Err(dimension("set", "must be planar to be rotated by an angle").into()),
        }
    }

    fn scaled(&self, factor: f64) -> Result<Self, Failure> {
        Ok(Self(match &self.0 {
            AnyStar::One(set) => AnyStar::One(set.scaled(factor)?),
            AnyStar::Two(set) => AnyStar::Two(set.scaled(factor)?),
            AnyStar::Three(set) => AnyStar::Three(set.scaled(factor)?),
        }))
    }

    fn mapped(&self, matrix: Points<'_>) -> Result<Self, Failure> {
        Ok(Self(match &self.0 {
            AnyStar::One(set) => AnyStar::One(set.mapped(&square(&matrix, "matrix")?)?),
            AnyStar::Two(set) => AnyStar::Two(set.mapped(&square(&matrix, "matrix")?)?),
            AnyStar::Three(set) => AnyStar::Three(set.mapped(&square(&matrix, "matrix")?)?),
        }))
    }

    #[getter]
    fn dimension(&self) -> usize {
        match &self.0 {
            AnyStar::One(_) => 1,
            AnyStar::Two(_) => 2,
            AnyStar::Three(_) => 3,
        }
    }

    #[getter]
    fn is_convex(&self) -> bool {
        each!(&self.0, set => set.as_convex().is_some())
    }

    fn gauge<'py>(&self, py: Python<'py>, x: Points<'_>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let out = each!(&self.0, set => each_number(&x, "x", |x| set.gauge(x)))?;
        Ok(PyArray1::from_vec(py, out))
    }

    fn gauge_gradient<'py>(
        &self,
        py: Python<'py>,
        x: Points<'_>,
    ) -> Result<Bound<'py, PyArray2<f64>>, Failure> {
        let (out, width) = each!(&self.0, set => {
            let mut origin = false;
            let out = points(&x, "x")?
                .flat_map(|x| {
                    let gradient = set.gauge_gradient(&x);
                    origin |= gradient.is_none();
                    gradient.unwrap_or_default().as_slice().to_vec()
                })
                .collect::<Vec<f64>>();
            if origin {
                return Err(asperity::set::SetError::Origin.into());
            }
            (out, self.dimension())
        });
        Ok(rows(py, out, width)?)
    }

    fn support<'py>(&self, py: Python<'py>, y: Points<'_>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let out = each!(&self.0, set => {
            let set = convex(set)?;
            each_number(&y, "y", |y| set.support(y))
        })?;
        Ok(PyArray1::from_vec(py, out))
    }

    fn support_point<'py>(
        &self,
        py: Python<'py>,
        y: Points<'_>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        fn farthest<const P: usize>(set: &Star<P>, y: &Points<'_>) -> PyResult<(Vec<f64>, usize)> {
            let set = convex(set)?;
            // Every point is farthest in no direction: the origin is as good as others.
            each_vector(y, "y", |y: &Vector<P>| {
                if y.amax() == 0.0 { Vector::zeros() } else { set.support_point(y) }
            })
        }
        let (out, width) = each!(&self.0, set => farthest(set, &y))?;
        rows(py, out, width)
    }

    fn support_hessian<'py>(
        &self,
        py: Python<'py>,
        y: Points<'_>,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        fn hessians<const P: usize>(set: &Star<P>, y: &Points<'_>) -> PyResult<Vec<f64>> {
            let set = convex(set)?;
            nonzero::<P>(y, "y")?;
            let mut out = Vec::new();
            for y in points::<P>(y, "y")? {
                out.extend_from_slice(set.support_hessian(&y).as_slice());
            }
            Ok(out)
        }
        let out = each!(&self.0, set => hessians(set, &y))?;
        let p = self.dimension();
        let n = out.len() / (p * p);
        PyArray1::from_vec(py, out).reshape([n, p, p])
    }

    fn project<'py>(&self, py: Python<'py>, z: Points<'_>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (out, width) = each!(&self.0, set => {
            let set = convex(set)?;
            each_vector(&z, "z", |z| set.project(z))
        })?;
        rows(py, out, width)
    }

    fn normal_cone<'py>(
        &self,
        py: Python<'py>,
        x: Numbers<'_>,
        tolerance: f64,
    ) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        fn generators<const P: usize>(
            set: &Star<P>,
            x: &Numbers<'_>,
            tolerance: f64,
        ) -> PyResult<Option<Vec<f64>>> {
            let cone = convex(set)?.normal_cone(&vector(x, "x")?, tolerance);
            Ok(cone.map(|c| c.generators().iter().flat_map(|g| g.as_slice().to_vec()).collect()))
        }
        let found = each!(&self.0, set => generators(set, &x, tolerance))?;
        found.map(|out| rows(py, out, self.dimension())).transpose()
    }
}

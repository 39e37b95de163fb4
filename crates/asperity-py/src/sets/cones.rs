//! Cones and outlines that belong to no set.

use asperity::set::{Cone, star_shape as outline_verdict};
use numpy::PyArray2;
use pyo3::prelude::*;

use super::batch::{Answer, answer, each_point, flat};
use crate::convert::{Points, points, rows};
use crate::errors::{Failure, dimension};

/// Nearest points of the convex cone with some generators.
#[pyfunction]
pub fn cone_projection<'py>(
    py: Python<'py>,
    generators: Points<'py>,
    y: Points<'py>,
) -> Result<Bound<'py, PyArray2<f64>>, Failure> {
    fn nearest<const P: usize>(
        py: Python<'_>,
        generators: &Points<'_>,
        y: &Points<'_>,
    ) -> Result<Vec<f64>, Failure> {
        let cone = Cone::<P>::new(points(generators, "generators")?);
        each_point(py, y, "y", P, |y, _, out| {
            out.extend_from_slice(cone.project(y).as_slice());
            Ok::<_, Failure>(())
        })
    }
    let width = generators.as_array().dim().1;
    let out = match width {
        1 => nearest::<1>(py, &generators, &y),
        2 => nearest::<2>(py, &generators, &y),
        3 => nearest::<3>(py, &generators, &y),
        other => Err(wrong_dimension(other).into()),
    }?;
    Ok(rows(py, out, width)?)
}

/// Whether a closed outline bounds a star-shaped set.
#[pyfunction]
pub fn star_shape<'py>(py: Python<'py>, vertices: Points<'py>) -> Result<Answer<'py>, Failure> {
    let outline: Vec<_> = points(&vertices, "vertices")?.collect();
    Ok(answer(py, &outline_verdict(&outline)?)?)
}

/// Generators of the polar cone of the convex cone with some generators.
#[pyfunction]
pub fn cone_polar<'py>(
    py: Python<'py>,
    generators: Points<'py>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    fn polar<const P: usize>(generators: &Points<'_>) -> PyResult<Vec<f64>> {
        let cone = Cone::<P>::new(points(generators, "generators")?).polar();
        Ok(flat(cone.generators()))
    }
    let width = generators.as_array().dim().1;
    let out = match width {
        1 => polar::<1>(&generators),
        2 => polar::<2>(&generators),
        3 => polar::<3>(&generators),
        other => Err(wrong_dimension(other)),
    }?;
    rows(py, out, width)
}

fn wrong_dimension(width: usize) -> PyErr {
    dimension("generators", &format!("must have points of dimension 1, 2 or 3, has {width}"))
}

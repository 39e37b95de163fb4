//! Cones and outlines that belong to no set.

use asperity::set::{Cone, star_shape as outline_verdict};
use numpy::PyArray2;
use pyo3::prelude::*;

use crate::batch::{Answer, answer, each_vector, flat};
use crate::convert::{Points, points, rows};
use crate::errors::{Failure, dimension};

/// Nearest points of the convex cone with some generators.
#[pyfunction]
pub fn cone_projection<'py>(
    py: Python<'py>,
    generators: Points<'py>,
    y: Points<'py>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    fn nearest<const P: usize>(
        generators: &Points<'_>,
        y: &Points<'_>,
    ) -> PyResult<(Vec<f64>, usize)> {
        let cone = Cone::<P>::new(points(generators, "generators")?);
        each_vector(y, "y", |y| cone.project(y))
    }
    let (out, width) = match generators.as_array().dim().1 {
        1 => nearest::<1>(&generators, &y),
        2 => nearest::<2>(&generators, &y),
        3 => nearest::<3>(&generators, &y),
        other => Err(wrong_dimension(other)),
    }?;
    rows(py, out, width)
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

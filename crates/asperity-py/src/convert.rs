//! Arrays in and out.

use asperity::set::{Matrix, Vector};
use nalgebra::DMatrix;
use numpy::{
    PyArray1, PyArray2, PyArrayDyn, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2,
    PyUntypedArrayMethods,
};
use pyo3::prelude::*;

use crate::errors::{dimension, parameter};

/// An array of points, `(n, p)`.
pub type Points<'py> = PyReadonlyArray2<'py, f64>;
/// An array of numbers, `(n,)`.
pub type Numbers<'py> = PyReadonlyArray1<'py, f64>;

/// The numbers of a contiguous array.
pub fn numbers<'a>(array: &'a Numbers<'_>, argument: &str) -> PyResult<&'a [f64]> {
    array.as_slice().map_err(|_| dimension(argument, "must be contiguous"))
}

/// The numbers as a vector of known dimension.
pub fn vector<const P: usize>(array: &Numbers<'_>, argument: &str) -> PyResult<Vector<P>> {
    let values = numbers(array, argument)?;
    if values.len() != P {
        let message = format!("must have {P} entries, has {}", values.len());
        return Err(dimension(argument, &message));
    }
    Ok(Vector::from_column_slice(values))
}

/// A matrix with the shape of the array.
pub fn matrix(array: &Points<'_>, argument: &str) -> PyResult<DMatrix<f64>> {
    let values = array.as_slice().map_err(|_| dimension(argument, "must be contiguous"))?;
    let shape = array.as_array().dim();
    Ok(DMatrix::from_row_slice(shape.0, shape.1, values))
}

/// A square matrix of known dimension.
pub fn square<const P: usize>(array: &Points<'_>, argument: &str) -> PyResult<Matrix<P>> {
    let dynamic = matrix(array, argument)?;
    if dynamic.shape() != (P, P) {
        let message = format!("must have shape ({P}, {P}), has {:?}", dynamic.shape());
        return Err(dimension(argument, &message));
    }
    Ok(Matrix::from_column_slice(dynamic.as_slice()))
}

/// The points of an array with `P` columns.
pub fn points<'a, const P: usize>(
    array: &'a Points<'_>,
    argument: &str,
) -> PyResult<impl ExactSizeIterator<Item = Vector<P>> + 'a> {
    Ok(chunks(coordinates::<P>(array, argument)?))
}

/// Coordinates as points.
pub fn chunks<const P: usize>(
    coordinates: &[f64],
) -> impl ExactSizeIterator<Item = Vector<P>> + '_ {
    let point = |x: &[f64]| Vector::from(std::array::from_fn::<f64, P, _>(|i| x[i]));
    coordinates.chunks_exact(P).map(point)
}

/// The coordinates of an array with `P` columns, point by point.
pub fn coordinates<'a, const P: usize>(
    array: &'a Points<'_>,
    argument: &str,
) -> PyResult<&'a [f64]> {
    let columns = array.as_array().dim().1;
    if columns != P {
        let message = format!("must have points of dimension {P}, has {columns}");
        return Err(dimension(argument, &message));
    }
    array.as_slice().map_err(|_| dimension(argument, "must be contiguous"))
}

/// An array of shape `(n, width)` from its numbers, row by row.
pub fn rows(py: Python<'_>, values: Vec<f64>, width: usize) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let len = values.len() / width;
    PyArray1::from_vec(py, values).reshape([len, width])
}

/// What a callback returned, as a float64 array in C order of the given shape, all finite.
pub fn returned<'py>(
    value: &Bound<'py, PyAny>,
    method: &str,
    shape: &[usize],
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let numpy = value.py().import("numpy")?;
    if value.is_none() {
        return Err(parameter(method, "must return numbers, returned None"));
    }
    // The conversion would leave the imaginary parts out.
    if numpy.call_method1("iscomplexobj", (value,))?.is_truthy()? {
        return Err(parameter(method, "must return real numbers, returned complex ones"));
    }
    let array = numpy.call_method1("ascontiguousarray", (value, "float64"));
    let array = array.map_err(|error| {
        parameter(method, &format!("must return numbers, returned {value:.60}: {error}"))
    })?;
    let array = array.cast_into::<PyArrayDyn<f64>>()?;
    // ascontiguousarray makes a number an array of one entry.
    let fits = array.shape() == shape || (shape.is_empty() && array.len() == 1);
    if !fits {
        let message = format!("must return shape {shape:?}, returned {:?}", array.shape());
        return Err(dimension(method, &message));
    }
    if !array.readonly().as_slice()?.iter().all(|v| v.is_finite()) {
        return Err(parameter(method, "must return finite numbers"));
    }
    Ok(array)
}

//! Questions to a set, answered for many points, and answers on their way to Python.

use asperity::set::{Convex, Star, Vector, Verdict};
use numpy::PyArray2;
use pyo3::prelude::*;

use crate::convert::{Points, points, rows};
use crate::errors::parameter;

/// The convex set inside, or the error that names the missing property.
pub fn convex<const P: usize>(set: &Star<P>) -> PyResult<&Convex<P>> {
    set.as_convex().ok_or_else(|| parameter("set", "must be convex for this, is star-shaped only"))
}

pub fn each_number<const P: usize>(
    x: &Points<'_>,
    argument: &str,
    f: impl Fn(&Vector<P>) -> f64,
) -> PyResult<Vec<f64>> {
    Ok(points::<P>(x, argument)?.map(|x| f(&x)).collect())
}

pub fn each_vector<const P: usize>(
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

pub fn nonzero<const P: usize>(y: &Points<'_>, argument: &str) -> PyResult<()> {
    if points::<P>(y, argument)?.any(|y| y.amax() == 0.0) {
        return Err(parameter(argument, "must not be zero"));
    }
    Ok(())
}

/// A verdict as `(holds, exact, tolerance, defect, witness)`.
pub type Answer<'py> = (bool, bool, f64, f64, Option<Bound<'py, PyArray2<f64>>>);

/// See [`Answer`].
pub fn answer<'py, const P: usize>(py: Python<'py>, verdict: &Verdict<P>) -> PyResult<Answer<'py>> {
    let points: Vec<f64> = verdict.witness.iter().flat_map(|x| x.as_slice().to_vec()).collect();
    let witness = if points.is_empty() { None } else { Some(rows(py, points, P)?) };
    Ok((verdict.holds, verdict.exact, verdict.tolerance, verdict.defect, witness))
}

/// Numbers of some vectors, one after another.
pub fn flat<const P: usize>(vectors: &[Vector<P>]) -> Vec<f64> {
    vectors.iter().flat_map(|v| v.as_slice().to_vec()).collect()
}

/// A ratio and the direction that has it, for Python.
pub fn touching<const P: usize>((ratio, at): (f64, Vector<P>)) -> (f64, Vec<f64>) {
    (ratio, at.as_slice().to_vec())
}

//! Friction laws.

use asperity::law::{Fall, FrictionLaw, Law as CoreLaw, LawError, Stribeck, flow_sets};
use asperity::set::{Convex, SetError, Star, Vector};
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::prelude::*;

use crate::convert::{Numbers, Points, numbers, points, rows};
use crate::errors::{Failure, dimension, parameter};
use crate::sets::any_star::{AnyStar, both};
use crate::sets::batch::{Answer, answer, each_point};
use crate::sets::set::Set;

/// A friction law.
#[pyclass(frozen, module = "asperity._core")]
pub struct Law(pub CoreLaw);

/// Does the same with the law inside, whatever its dimension.
macro_rules! each {
    ($any:expr, $law:ident => $call:expr) => {
        match $any {
            CoreLaw::Zero($law) => $call,
            CoreLaw::One($law) => $call,
            CoreLaw::Two($law) => $call,
            CoreLaw::Three($law) => $call,
        }
    };
}

fn convex<const P: usize>(direction: &Star<P>) -> Result<&Convex<P>, Failure> {
    let refused = || parameter("direction", "must be convex, is star-shaped only").into();
    direction.as_convex().ok_or_else(refused)
}

fn make<const P: usize>(
    reservoir: &Star<P>,
    direction: &Star<P>,
    rate: Option<Stribeck>,
) -> Result<FrictionLaw<P>, Failure> {
    let law = FrictionLaw::new(reservoir.clone(), convex(direction)?.clone())?;
    Ok(match rate {
        Some(rate) => law.with_rate(rate),
        None => law,
    })
}

/// Shape, speed, ratio, exponent, viscous factor.
type Rate = (String, f64, f64, f64, f64);

fn stribeck((shape, speed, ratio, exponent, viscous): Rate) -> Result<Stribeck, Failure> {
    let fall = match shape.as_str() {
        "exponential" => Fall::Exponential,
        "hyperbolic" => Fall::Hyperbolic,
        _ => return Err(parameter("shape", "must be 'exponential' or 'hyperbolic'").into()),
    };
    Ok(Stribeck::new(fall, speed, ratio, exponent, viscous)?)
}

/// `f(point, number)` for all points, as rows of `Q` numbers.
fn each_loaded<const P: usize, const Q: usize>(
    py: Python<'_>,
    argument: &str,
    x: &Points<'_>,
    normal_force: &Numbers<'_>,
    f: impl Fn(&Vector<P>, f64) -> Result<[f64; Q], LawError> + Sync,
) -> Result<Vec<f64>, Failure> {
    let normal_force = numbers(normal_force, "normal_force")?;
    if x.as_array().dim().0 != normal_force.len() {
        return Err(dimension("normal_force", "must have one entry per point").into());
    }
    each_point(py, x, argument, Q, |x, i, out| {
        f(x, normal_force[i]).map(|row| out.extend_from_slice(&row))
    })
}

fn components<const P: usize>(v: Vector<P>) -> [f64; P] {
    std::array::from_fn(|i| v[i])
}

#[pymethods]
impl Law {
    #[new]
    #[pyo3(signature = (reservoir, direction, rate))]
    fn new(
        py: Python<'_>,
        reservoir: &Set,
        direction: &Set,
        rate: Option<Rate>,
    ) -> Result<Self, Failure> {
        let rate = rate.map(stribeck).transpose()?;
        let law: CoreLaw = both!(
            &reservoir.0,
            &direction.0,
            (c, d) => py.detach(|| make(c, d, rate))?.into(),
            return Err(dimension("direction", "must have the dimension of the reservoir").into())
        );
        Ok(Self(law))
    }

    /// The same law with its own direction set as Python holds it.
    fn with_direction(&self, direction: &Set) -> Result<Self, Failure> {
        let law: CoreLaw = match (&self.0, &direction.0) {
            (CoreLaw::One(law), AnyStar::One(d)) => law.with_direction(convex(d)?.clone())?.into(),
            (CoreLaw::Two(law), AnyStar::Two(d)) => law.with_direction(convex(d)?.clone())?.into(),
            (CoreLaw::Three(law), AnyStar::Three(d)) => {
                law.with_direction(convex(d)?.clone())?.into()
            }
            _ => {
                let expected = "must have the dimension of the law";
                return Err(dimension("direction", expected).into());
            }
        };
        Ok(Self(law))
    }

    #[getter]
    fn dimension(&self) -> usize {
        self.0.dimension()
    }

    #[getter]
    fn direction_scale(&self) -> f64 {
        each!(&self.0, law => law.direction_scale())
    }

    #[getter]
    fn is_associated(&self) -> bool {
        each!(&self.0, law => law.is_associated())
    }

    fn associativity<'py>(&self, py: Python<'py>) -> PyResult<Answer<'py>> {
        each!(&self.0, law => answer(py, &py.detach(|| law.associativity())))
    }

    fn collinearity<'py>(&self, py: Python<'py>) -> PyResult<Answer<'py>> {
        each!(&self.0, law => answer(py, &py.detach(|| law.collinearity())))
    }

    fn dissipativity<'py>(&self, py: Python<'py>) -> PyResult<Answer<'py>> {
        each!(&self.0, law => answer(py, &py.detach(|| law.dissipativity())))
    }

    fn monotonicity<'py>(&self, py: Python<'py>) -> PyResult<Answer<'py>> {
        each!(&self.0, law => answer(py, &py.detach(|| law.monotonicity())))
    }

    #[getter]
    fn alpha_min(&self) -> f64 {
        self.0.alpha_min()
    }

    fn force<'py>(
        &self,
        py: Python<'py>,
        slip: Points<'_>,
        normal_force: Numbers<'_>,
    ) -> Result<Bound<'py, PyArray2<f64>>, Failure> {
        let out = each!(&self.0, law => {
            each_loaded(py, "slip", &slip, &normal_force, |v, n| law.force(v, n).map(components))
        })?;
        Ok(rows(py, out, self.dimension())?)
    }

    fn slip_direction<'py>(
        &self,
        py: Python<'py>,
        force: Points<'_>,
        normal_force: Numbers<'_>,
        tolerance: f64,
    ) -> Result<Bound<'py, PyArray2<f64>>, Failure> {
        let out = each!(&self.0, law => {
            each_loaded(py, "force", &force, &normal_force, |f, n| {
                law.slip_direction(f, n, tolerance).map(components)
            })
        })?;
        Ok(rows(py, out, self.dimension())?)
    }

    fn jacobian<'py>(
        &self,
        py: Python<'py>,
        slip: Points<'_>,
        normal_force: Numbers<'_>,
    ) -> Result<Bound<'py, PyArray3<f64>>, Failure> {
        // Row by row, as NumPy reads it.
        let out = match &self.0 {
            CoreLaw::Zero(_) => Ok(Vec::new()),
            CoreLaw::One(law) => each_loaded::<1, 1>(py, "slip", &slip, &normal_force, |v, n| {
                law.jacobian(v, n).map(|j| [j[0]])
            }),
            CoreLaw::Two(law) => each_loaded::<2, 4>(py, "slip", &slip, &normal_force, |v, n| {
                law.jacobian(v, n).map(|j| std::array::from_fn(|k| j[(k / 2, k % 2)]))
            }),
            CoreLaw::Three(law) => each_loaded::<3, 9>(py, "slip", &slip, &normal_force, |v, n| {
                law.jacobian(v, n).map(|j| std::array::from_fn(|k| j[(k / 3, k % 3)]))
            }),
        }?;
        let p = self.dimension();
        let n = out.len() / (p * p);
        Ok(PyArray1::from_vec(py, out).reshape([n, p, p])?)
    }

    fn dissipation<'py>(
        &self,
        py: Python<'py>,
        slip: Points<'_>,
        normal_force: Numbers<'_>,
    ) -> Result<Bound<'py, PyArray1<f64>>, Failure> {
        let out = each!(&self.0, law => {
            each_loaded(py, "slip", &slip, &normal_force, |v, n| match law.dissipation(v, n) {
                power if power.is_finite() => Ok([power]),
                _ => Err(SetError::Range { argument: "slip", excess: "large" }.into()),
            })
        })?;
        Ok(PyArray1::from_vec(py, out))
    }
}

type Array<'py> = Bound<'py, PyArray1<f64>>;
/// Angles and radii of *C*, normal angles and support of *D*, and `(closure, convexity defect, smallest
/// resistance, repair)`.
type Flow<'py> = (Array<'py>, Array<'py>, Array<'py>, Array<'py>, (f64, f64, f64, f64));

/// Both sets of a law from its force over the sliding direction.
#[pyfunction]
pub fn flow_law<'py>(
    py: Python<'py>,
    phi: Numbers<'py>,
    force: Points<'py>,
    closure_tolerance: f64,
    convexity_tolerance: f64,
) -> Result<Flow<'py>, Failure> {
    let force: Vec<_> = points(&force, "force")?.collect();
    let phi = numbers(&phi, "phi")?;
    let sets = py.detach(|| flow_sets(phi, &force, closure_tolerance, convexity_tolerance))?;
    let report = sets.report;
    let array = |values| PyArray1::from_vec(py, values);
    Ok((
        array(sets.theta),
        array(sets.radius),
        array(sets.phi),
        array(sets.support),
        (report.closure, report.convexity_defect, report.smallest_resistance, report.repair),
    ))
}

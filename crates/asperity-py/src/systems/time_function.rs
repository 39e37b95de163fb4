//! Functions of time: signals, and functions of Python.

use std::sync::{Arc, Mutex, PoisonError};

use asperity::system::{self, Derivative, Moment, Smoothness, TimeFunction};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

use crate::convert::{Numbers, Points, numbers, returned, rows};
use crate::errors::{Failure, dimension, parameter};

/// The first exception of a function that cannot return one.
pub type Raised = Arc<Mutex<Option<PyErr>>>;

/// Keeps an exception unless there is one already.
pub fn keep(raised: &Raised, error: PyErr) {
    raised.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
}

/// The exception that has been kept, which is then forgotten.
pub fn taken(raised: &Raised) -> Option<PyErr> {
    raised.lock().unwrap_or_else(PoisonError::into_inner).take()
}

/// Polynomials between samples, or a sine.
#[pyclass(frozen, module = "asperity._core")]
pub struct Signal(pub Arc<system::Signal>);

#[pymethods]
impl Signal {
    /// Straight lines through samples, one row of values each.
    #[staticmethod]
    fn linear(times: Numbers<'_>, values: Points<'_>, periodic: bool) -> Result<Self, Failure> {
        let times = numbers(&times, "times")?;
        let values = values.as_slice().map_err(|_| dimension("values", "must be contiguous"))?;
        Ok(Self(Arc::new(system::Signal::linear(times, values, periodic)?)))
    }

    /// Polynomials between knots: four coefficients per piece and component, lowest power first, and the last values.
    #[staticmethod]
    fn cubic(
        knots: Numbers<'_>,
        coefficients: Numbers<'_>,
        last: Numbers<'_>,
        periodic: bool,
    ) -> Result<Self, Failure> {
        let (knots, last) = (numbers(&knots, "knots")?, numbers(&last, "last")?);
        let (coefficients, rest) = numbers(&coefficients, "coefficients")?.as_chunks::<4>();
        if !rest.is_empty() {
            return Err(dimension("coefficients", "must be four per piece and component").into());
        }
        Ok(Self(Arc::new(system::Signal::cubic(knots, coefficients, last, periodic)?)))
    }

    #[staticmethod]
    fn sine(
        frequency: f64,
        amplitude: Numbers<'_>,
        phase: Numbers<'_>,
        offset: Numbers<'_>,
    ) -> Result<Self, Failure> {
        let (amplitude, phase) = (numbers(&amplitude, "amplitude")?, numbers(&phase, "phase")?);
        let offset = numbers(&offset, "offset")?;
        Ok(Self(Arc::new(system::Signal::sine(frequency, amplitude, phase, offset)?)))
    }

    #[getter]
    fn period(&self) -> Option<f64> {
        self.0.period()
    }

    #[getter]
    fn jumps(&self) -> bool {
        self.0.jumps()
    }

    /// Values or derivatives, one row per time.
    fn values<'py>(
        &self,
        py: Python<'py>,
        t: Numbers<'py>,
        order: usize,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let derivative = match order {
            0 => Derivative::Value,
            1 => Derivative::First,
            _ => Derivative::Second,
        };
        let signal = &self.0;
        let at = |&t: &f64| {
            (0..signal.components()).map(move |k| signal.component(Moment::new(t), k, derivative))
        };
        rows(py, numbers(&t, "t")?.iter().flat_map(at).collect(), signal.components())
    }

    /// The integrals of the components from one time to another one.
    fn integral<'py>(&self, py: Python<'py>, start: f64, end: f64) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_iter(py, (0..self.0.components()).map(|k| self.0.integral(start, end, k)))
    }

    /// Times after the first one and up to the second one at which it is not smooth, and whether more than a higher
    /// derivative jumps there; `most` of them at most.
    fn breaks(&self, start: f64, end: f64, most: usize) -> Vec<(f64, bool)> {
        let next = |t: f64| self.0.next_break(t).filter(|b| b.time <= end);
        std::iter::successors(next(start), |b| next(b.time))
            .take(most)
            .map(|b| (b.time, b.smoothness == Smoothness::Kink))
            .collect()
    }
}

/// What a function of Python returns, `R` arrays of `D` entries; not numbers where it has raised, which ends the run.
fn call<const D: usize, const R: usize>(
    function: &Py<PyAny>,
    argument: &'static str,
    raised: &Raised,
    t: f64,
) -> [[f64; D]; R] {
    let answer = Python::attach(|py| -> PyResult<[[f64; D]; R]> {
        let value = function.bind(py).call1((t,))?;
        let shape: &[usize] = if D == 1 { &[] } else { &[D] };
        let one = |value: &Bound<'_, PyAny>| -> PyResult<[f64; D]> {
            let array = returned(value, argument, shape)?;
            let array = array.readonly();
            let values = array.as_slice()?;
            Ok(std::array::from_fn(|k| values[k]))
        };
        let mut out = [[f64::NAN; D]; R];
        if R == 1 {
            out[0] = one(&value)?;
            return Ok(out);
        }
        let pair = "must return a value and its rate";
        let parts: Vec<Bound<'_, PyAny>> =
            value.try_iter().map_err(|_| parameter(argument, pair))?.collect::<PyResult<_>>()?;
        if parts.len() != R {
            return Err(dimension(argument, pair));
        }
        for (out, part) in out.iter_mut().zip(&parts) {
            *out = one(part)?;
        }
        Ok(out)
    });
    answer.unwrap_or_else(|error| {
        keep(raised, error);
        [[f64::NAN; D]; R]
    })
}

/// Numbers, a signal or a function of Python; `with_rate` says whether the latter returns its rate, too.
pub fn time_function<const D: usize>(
    given: &Bound<'_, PyAny>,
    argument: &'static str,
    with_rate: bool,
    raised: &Raised,
) -> PyResult<TimeFunction<D>> {
    if let Ok(signal) = given.cast::<Signal>() {
        return Ok(TimeFunction::Signal(Arc::clone(&signal.get().0)));
    }
    if given.is_callable() {
        let (function, raised) = (given.clone().unbind(), Arc::clone(raised));
        return Ok(if with_rate {
            TimeFunction::WithRate(Arc::new(move |t| call::<D, 2>(&function, argument, &raised, t)))
        } else {
            TimeFunction::Custom(Arc::new(move |t| {
                call::<D, 1>(&function, argument, &raised, t)[0]
            }))
        });
    }
    if let Ok(number) = given.extract::<f64>() {
        return Ok(TimeFunction::Constant([number; D]));
    }
    let values = given.extract::<Numbers<'_>>()?;
    let values = numbers(&values, argument)?;
    let values = values.try_into().map_err(|_| {
        dimension(argument, &format!("must have {D} entries, has {}", values.len()))
    })?;
    Ok(TimeFunction::Constant(values))
}
